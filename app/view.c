/* SPDX-License-Identifier: BSD-3-Clause */
/* Where pictures are taken from, and how large they are. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "app/commands.h"
#include "base/array.h"
#include "scenes/view.h"

/* Whole vertical angle of a view of one's own: a normal lens seen upright. */
static const double OWN_FOV = 50;

/* Number of the camera of that name of `length` letters, or camera_count. */
static size_t find_camera(const Scene *scene, const char *name, size_t length)
{
    size_t i = 0;
    for (; i < scene->camera_count; i++)
        if (strlen(scene->cameras[i].name) == length &&
            strncmp(scene->cameras[i].name, name, length) == 0)
            break;
    return i;
}

static bool no_camera(const Scene *scene, const char *name, size_t length, Error *err)
{
    char known[256] = "";
    for (size_t i = 0; i < scene->camera_count; i++) {
        const size_t n = strlen(known);
        snprintf(known + n, sizeof known - n, "%s'%s'", n > 0 ? ", " : "", scene->cameras[i].name);
    }
    return error_set(err, ERROR_USAGE, "%s: no camera '%.*s'; the file has %s", scene->file,
                     (int)length, name, scene->camera_count > 0 ? known : "none");
}

/* Cameras of "A,B", each once. */
static bool cameras_of_list(Pipeline *pipeline, const char *list, Error *err)
{
    const Scene *scene = pipeline->scene;
    for (const char *p = list, *end; p != NULL; p = *end == ',' ? end + 1 : NULL) {
        end = p + strcspn(p, ",");
        const size_t length = (size_t)(end - p), i = find_camera(scene, p, length);
        if (i == scene->camera_count)
            return no_camera(scene, p, length, err);
        for (uint32_t k = 0; k < pipeline->view_count; k++)
            if (strcmp(pipeline->view[k].name, scene->cameras[i].name) == 0)
                return error_set(err, ERROR_USAGE, "--camera %s: '%.*s' stands there twice", list,
                                 (int)length, p);
        pipeline->view[pipeline->view_count++] = scene->cameras[i];
    }
    return true;
}

/* A name, "all" unless a camera is called so, or names with commas between. */
static bool cameras_by_name(Pipeline *pipeline, const char *names, Error *err)
{
    const Scene *scene = pipeline->scene;
    const size_t count = scene->camera_count, length = strlen(names);
    const size_t i = find_camera(scene, names, length);
    const bool   all = i == count && count > 0 && strcmp(names, "all") == 0;
    if (i == count && !all && strchr(names, ',') == NULL)
        return no_camera(scene, names, length, err);
    if (i < count)
        pipeline->view[pipeline->view_count++] = scene->cameras[i];
    for (size_t k = 0; all && k < count; k++)
        pipeline->view[pipeline->view_count++] = scene->cameras[k];
    if (pipeline->view_count == 0 && !cameras_of_list(pipeline, names, err))
        return false;
    if (pipeline->view_count > 1 && pipeline->session->options.command != COMMAND_RENDER)
        return error_set(err, ERROR_USAGE, "--camera %s: several cameras are for render", names);
    return true;
}

static bool camera_of_own(const Pipeline *pipeline, Camera *camera, Error *err)
{
    const Options *options = &pipeline->session->options;
    const Scene *scene = pipeline->scene;
    const Vec3 middle = vec3_lerp(pipeline->surfaces->lo, pipeline->surfaces->hi, 0.5);
    const bool aimed = options_given(options, OPTION_TARGET);
    *camera = (Camera){ .name = "own", .eye = scene_from_file(scene, options->eye),
                                 .vertical_fov = OWN_FOV,
                                 .target = aimed ? scene_from_file(scene, options->target) : middle,
                                 .up = scene->up };
    if (!(vec3_length(vec3_sub(camera->target, camera->eye)) > 0))
        return error_set(err, ERROR_USAGE, "--eye and --target are the same point");
    return true;
}

/* What the options say of projection and lens. */
static bool camera_options(const Options *options, Camera *camera, Error *err)
{
    static const double ALL_ROUND = 180; /* degrees up and down */
    if (options_given(options, OPTION_PROJECTION)) {
        camera->projection = (Projection)options->projection;
        if (camera->projection == CAMERA_FISHEYE || camera->projection == CAMERA_PANORAMA)
            camera->vertical_fov = ALL_ROUND;
    }
    if (options->fov > 0)
        camera->vertical_fov = options->fov;
    if (options->view_height > 0)
        camera->view_height = options->view_height;
    if (options_given(options, OPTION_APERTURE))
        camera->aperture = options->aperture / 2;
    if (options->focus > 0)
        camera->focus = options->focus;
    if (options->focus > 0 && !(camera->aperture > 0))
        return error_set(err, ERROR_USAGE, "--focus belongs to a lens: give --aperture");
    if (options->view_height > 0 && camera->projection != CAMERA_ORTHOGRAPHIC)
        return error_set(err, ERROR_USAGE, "--view-height belongs to --projection orthographic");
    const bool around = camera->projection == CAMERA_FISHEYE ||
                        camera->projection == CAMERA_PANORAMA;
    if (!around && camera->vertical_fov >= ALL_ROUND)
        return error_set(err, ERROR_USAGE, "--fov %g: below 180, but for fisheye and panorama",
                         camera->vertical_fov);
    /* As much as a perspective view of the same field shows at the target. */
    if (!(camera->view_height > 0))
        camera->view_height = 2 * tan(fmin(camera->vertical_fov, 170) * 3.14159265358979 / 360) *
                              vec3_length(vec3_sub(camera->target, camera->eye));
    return true;
}

bool pipeline_camera(Pipeline *pipeline, Error *err)
{
    assert(pipeline->patches == NULL && pipeline->view == NULL);
    return pipeline_views(pipeline, err);
}

bool pipeline_views(Pipeline *pipeline, Error *err)
{
    const Options *options = &pipeline->session->options;
    const Scene *scene = pipeline->scene;
    assert(pipeline->bvh != NULL);
    array_free(pipeline->view);
    pipeline->view_count = 0;
    pipeline->view = array_create(scene->camera_count + 1, sizeof *pipeline->view, "cameras", err);
    bool found = pipeline->view != NULL;
    if (found && options->camera != NULL) {
        found = cameras_by_name(pipeline, options->camera, err);
    } else if (found) {
        Camera *camera = &pipeline->view[pipeline->view_count++];
        if (options_given(options, OPTION_EYE))
            found = camera_of_own(pipeline, camera, err);
        else if (scene->camera_count > 0)
            *camera = scene->cameras[0];
        else
            view_of_surfaces(scene, pipeline->surfaces, pipeline->bvh, camera);
    }
    for (uint32_t k = 0; found && k < pipeline->view_count; k++)
        found = camera_options(options, &pipeline->view[k], err);
    if (found)
        pipeline->camera = pipeline->view[0];
    pipeline->has_camera = found;
    return found;
}

/* --size, else the scene's own, else 512 x 512, else 1024 along the longer side when the camera
 * wants a picture that is not square. */
void view_size(Pipeline *pipeline)
{
    enum { SQUARE = 512, LONG = 1024 };
    const Options *options = &pipeline->session->options;
    const Scene *scene = pipeline->scene;
    const double aspect = pipeline->camera.aspect;
    const bool of_file = options->camera == NULL && !options_given(options, OPTION_EYE);
    const double nearly = 1.0 / SQUARE; /* less than a pixel off square */
    pipeline->width = pipeline->height = SQUARE;
    if (options->size[0] > 0) {
        pipeline->width = options->size[0];
        pipeline->height = options->size[1];
    } else if (of_file && scene->width > 0 && scene->height > 0) {
        pipeline->width = scene->width;
        pipeline->height = scene->height;
    } else if (aspect > 0 && fabs(aspect - 1) > nearly) {
        const double w = aspect > 1 ? LONG : LONG * aspect, h = aspect > 1 ? LONG / aspect : LONG;
        pipeline->width = (int)fmax(1, round(w));
        pipeline->height = (int)fmax(1, round(h));
    }
}
