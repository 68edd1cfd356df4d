/* SPDX-License-Identifier: BSD-3-Clause */
/* Where the picture is taken from, and how large it is. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "app/commands.h"
#include "scenes/view.h"

/* Whole vertical angle of a view of one's own: a normal lens seen upright. */
static const double OWN_FOV = 50;

static bool camera_by_name(Pipeline *pipeline, const char *name, Error *err)
{
    const Scene *scene = pipeline->scene;
    char known[256] = "";
    for (size_t i = 0; i < scene->camera_count; i++) {
        const size_t n = strlen(known);
        if (strcmp(scene->cameras[i].name, name) == 0) {
            pipeline->camera = scene->cameras[i];
            return true;
        }
        snprintf(known + n, sizeof known - n, "%s'%s'", n > 0 ? ", " : "", scene->cameras[i].name);
    }
    return error_set(err, ERROR_USAGE, "%s: no camera '%s'; the file has %s", scene->file, name,
                     scene->camera_count > 0 ? known : "none");
}

static bool camera_of_own(Pipeline *pipeline, Error *err)
{
    const Options *options = &pipeline->session->options;
    const Scene *scene = pipeline->scene;
    const Vec3 middle = vec3_lerp(pipeline->surfaces->lo, pipeline->surfaces->hi, 0.5);
    const bool aimed = options_given(options, OPTION_TARGET);
    pipeline->camera = (Camera){ .name = "own", .eye = scene_from_file(scene, options->eye),
                                 .vertical_fov = OWN_FOV,
                                 .target = aimed ? scene_from_file(scene, options->target) : middle,
                                 .up = scene->up };
    if (!(vec3_length(vec3_sub(pipeline->camera.target, pipeline->camera.eye)) > 0))
        return error_set(err, ERROR_USAGE, "--eye and --target are the same point");
    return true;
}

/* What the options say of projection and lens. */
static bool camera_options(Pipeline *pipeline, Error *err)
{
    static const double ALL_ROUND = 180; /* degrees up and down */
    const Options *options = &pipeline->session->options;
    Camera *camera = &pipeline->camera;
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
    const Options *options = &pipeline->session->options;
    const Scene *scene = pipeline->scene;
    assert(pipeline->bvh != NULL && pipeline->patches == NULL);
    bool found = true;
    if (options->camera != NULL)
        found = camera_by_name(pipeline, options->camera, err);
    else if (options_given(options, OPTION_EYE))
        found = camera_of_own(pipeline, err);
    else if (scene->camera_count > 0)
        pipeline->camera = scene->cameras[0];
    else
        view_of_surfaces(scene, pipeline->surfaces, pipeline->bvh, &pipeline->camera);
    found = found && camera_options(pipeline, err);
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
