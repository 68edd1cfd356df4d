/* SPDX-License-Identifier: BSD-3-Clause */
/* What an MSD file says once for the whole scene: globals, SCREEN, cameras, lights. */
#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "math/tolerance.h"
#include "scenes/msd.h"

enum { PIXELS_MAX = 65535 }; /* a side of a picture */

bool msd_is_global(const MsdReader *r)
{
    if (r->token.kind != TOKEN_WORD)
        return false;
    switch (r->token.word) {
    case WORD_BACKGROUND:
    case WORD_COLORRANGE:
    case WORD_EPSILON:
    case WORD_GAMMACOLOR:
    case WORD_MAXLEVEL:
    case WORD_OUTFILE:
    case WORD_SCREEN:
    case WORD_AMB_LIGHT:
    case WORD_ATT_POS_LIGHT:
    case WORD_ATT_SPOT_LIGHT: return true;
    default: return false;
    }
}

/* --- cameras --------------------------------------------------------------------------------- */

static double half_tangent(double degrees) { return tan(degrees * (M_PI / 360)); }

static bool angle_read(MsdReader *r, double *degrees)
{
    const MsdPlace place = r->token.place;

    if (!msd_number(r, degrees))
        return false;
    if (!(*degrees > 0 && *degrees < 180))
        return msd_error(r, place, "found %g, expected a field of view in degrees between 0 and "
                                   "180", *degrees);
    return true;
}

/* An eye, a target and an up that make a view. */
static bool view_check(MsdReader *r, MsdPlace place, const Camera *c)
{
    const Vec3   ahead = vec3_sub(c->target, c->eye);
    const double length = vec3_length(ahead), up = vec3_length(c->up);

    if (!(length > 0 && isfinite(length)))
        return msd_error(r, place, "the view's eye and look point are the same, expected two "
                                   "points");
    if (!(up > 0 && isfinite(up)))
        return msd_error(r, place, "the view's up direction is no direction");
    /* Two unit vectors and their cross product: some ten roundings. */
    const double sine = vec3_length(vec3_cross(vec3_unit(ahead), vec3_unit(c->up)));
    if (!(sine > rounding_bound(16)))
        return msd_error(r, place, "the view looks along its up direction, expected another one");
    return true;
}

bool msd_camera(MsdReader *r, uint32_t symbol, Camera *camera)
{
    const MsdPlace place = r->token.place;
    double         across = 0, down = 0;

    *camera = (Camera){ 0 };
    snprintf(camera->name, sizeof camera->name, "%s", r->symbols[symbol].text);
    if (!msd_take(r, '(') || !msd_vector(r, &camera->eye) || !msd_vector(r, &camera->target) ||
        !msd_vector(r, &camera->up) || !angle_read(r, &across) || !angle_read(r, &down) ||
        !msd_take(r, ')') || !view_check(r, place, camera))
        return false;
    camera->vertical_fov = down;
    camera->aspect = half_tangent(across) / half_tangent(down);
    /* Those declared for the whole file can be chosen by name. */
    const bool whole = r->scope_count == 1 && r->dry == 0;
    for (size_t i = r->scene->has_screen; whole && i < r->scene->camera_count; i++)
        if (strcmp(r->scene->cameras[i].name, camera->name) == 0) {
            r->scene->cameras[i] = *camera;
            return true;
        }
    return !whole || scene_add_camera(r->scene, camera, r->err);
}

/* --- SCREEN ---------------------------------------------------------------------------------- */

static bool pixels_read(MsdReader *r, int *width, int *height)
{
    const MsdPlace place = r->token.place;
    double         size[3] = { 0 };
    int            count = 0;

    if (!msd_sizes(r, 2, 2, false, size, &count))
        return false;
    for (int i = 0; i < 2; i++)
        if (!(size[i] >= 1 && size[i] <= PIXELS_MAX) || size[i] != floor(size[i]))
            return msd_error(r, place, "found a picture of %g by %g, expected whole numbers from 1 "
                                       "to %d", size[0], size[1], PIXELS_MAX);
    *width = (int)size[0];
    *height = (int)size[1];
    return true;
}

/* FOV <h> or <h, v>, whole angles. With h alone pixels are square. */
static bool fov_read(MsdReader *r, int width, int height, Camera *camera)
{
    double across = 0, down = 0;

    if (!msd_take_word(r, WORD_FOV, "FOV") || !msd_take(r, '<') || !angle_read(r, &across))
        return false;
    if (!msd_is(r, ',')) {
        camera->aspect = (double)width / height;
        camera->vertical_fov = atan(half_tangent(across) / camera->aspect) * (360 / M_PI);
        return msd_take(r, '>');
    }
    if (!msd_next(r) || !angle_read(r, &down))
        return false;
    camera->vertical_fov = down;
    camera->aspect = half_tangent(across) / half_tangent(down);
    return msd_take(r, '>');
}

static bool screen_view(MsdReader *r, int width, int height, Camera *camera)
{
    const MsdPlace place = r->token.place;
    uint32_t       index = 0;

    if (msd_is_word(r, WORD_CAMERA)) {
        if (!msd_next(r) || !msd_named(r, NAME_CAMERA, &index))
            return false;
        *camera = r->bindings[index].as.camera;
        return true;
    }
    return msd_take_word(r, WORD_EYEP, "EYEP or CAMERA") && msd_vector(r, &camera->eye) &&
           msd_take_word(r, WORD_LOOKP, "LOOKP") && msd_vector(r, &camera->target) &&
           msd_take_word(r, WORD_UP, "UP") && msd_vector(r, &camera->up) &&
           fov_read(r, width, height, camera) && view_check(r, place, camera);
}

/* The screen's view is the scene's first camera. */
static bool screen_keep(MsdReader *r, MsdPlace place, const Camera *camera)
{
    Scene *scene = r->scene;

    if (scene->has_screen)
        msd_warn(r, place, "screen-again", "SCREEN is given again; the last one holds");
    else if (!scene_add_camera(scene, camera, r->err))
        return false;
    else
        memmove(scene->cameras + 1, scene->cameras,
                (scene->camera_count - 1) * sizeof *scene->cameras);
    scene->cameras[0] = *camera;
    scene->has_screen = true;
    scene->up = vec3_unit(camera->up);
    return true;
}

static bool screen_read(MsdReader *r, bool ignored)
{
    const MsdPlace place = r->token.place;
    Camera         camera = { 0 };
    int            width = 0, height = 0;

    if (!msd_next(r) || !pixels_read(r, &width, &height) ||
        !screen_view(r, width, height, &camera))
        return false;
    if (ignored)
        return true;
    snprintf(camera.name, sizeof camera.name, "SCREEN");
    r->scene->width = width;
    r->scene->height = height;
    return screen_keep(r, place, &camera);
}

/* --- lights ---------------------------------------------------------------------------------- */

static bool light_read(MsdReader *r, bool spot, bool ignored)
{
    const MsdPlace place = r->token.place;
    Light          light = { .kind = spot ? LIGHT_SPOT : LIGHT_POINT };
    double         aperture = 0;

    if (!msd_next(r) || !msd_colour(r, &light.intensity) || !msd_vector(r, &light.position))
        return false;
    if (spot) {
        /* The whole angle of the cone, with a sharp edge: what the language's aperture says. */
        if (!msd_direction(r, "the spot's direction", &light.direction) ||
            !msd_number_in(r, "an aperture in degrees", 0, true, 360, &aperture))
            return false;
        light.cos_inner = light.cos_outer = cos(aperture * (M_PI / 360));
    }
    if (!msd_reachable(r, place, light.position))
        return false;
    snprintf(light.name, sizeof light.name, "light-%zu", r->scene->light_count + 1);
    return ignored || scene_add_light(r->scene, &light, r->err);
}

/* --- globals --------------------------------------------------------------------------------- */

/* Words that steer other renderers: understood, checked, and said to be without effect. */
static bool unused_read(MsdReader *r, bool ignored)
{
    const MsdToken word = r->token;
    const int      length = (int)(word.end - word.place.offset);
    uint32_t       whole = 0;
    double         number = 0;
    char           text[MSD_PATH_MAX];
    bool           good;

    if (!msd_next(r))
        return false;
    if (word.word == WORD_OUTFILE)
        good = msd_string(r, "a file name in quotes", text, sizeof text);
    else if (word.word == WORD_MAXLEVEL)
        good = msd_integer(r, "a level", 0, PIXELS_MAX, &whole);
    else
        good = msd_length(r, "a number", &number);
    if (good && !ignored)
        msd_warn(r, word.place, "no-effect", "%.*s is read and has no effect", length,
                 r->sources[word.place.source].text + word.place.offset);
    return good;
}

static bool colour_read(MsdReader *r, bool ignored, Rgb *target)
{
    Rgb colour = { 0 };

    if (!msd_next(r) || !msd_colour(r, &colour))
        return false;
    if (!ignored)
        *target = colour;
    return true;
}

bool msd_global(MsdReader *r, bool included)
{
    const MsdToken word = r->token;

    assert(msd_is_global(r));
    if (included && word.word != WORD_COLORRANGE)
        msd_warn(r, word.place, "include-ignored",
                 "%.*s in an included file is ignored", (int)(word.end - word.place.offset),
                 r->sources[word.place.source].text + word.place.offset);
    switch (word.word) {
    case WORD_SCREEN: return screen_read(r, included);
    case WORD_BACKGROUND: return colour_read(r, included, &r->scene->background);
    case WORD_AMB_LIGHT: return colour_read(r, included, &r->scene->ambient);
    case WORD_ATT_POS_LIGHT: return light_read(r, false, included);
    case WORD_ATT_SPOT_LIGHT: return light_read(r, true, included);
    /* Tells how the colours that follow are written: to the end of this file. */
    case WORD_COLORRANGE: return msd_next(r) && msd_length(r, "a colour range", &r->colour_range);
    default: return unused_read(r, included);
    }
}
