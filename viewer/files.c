/* SPDX-License-Identifier: BSD-3-Clause */
/* Names and contents of the pictures that the window saves. */
#include "viewer/files.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "render/pixels.h"
#include "viewer/internal.h"
#include "viewer/still.h"

bool files_free_name(const Viewer *viewer, const char *word, const char *ending, char *path,
                     size_t size)
{
    const char *slash = strrchr(viewer->options->scene, '/');
    const char *title = slash != NULL ? slash + 1 : viewer->options->scene;
    const char *dot = strrchr(title, '.');
    const int length = dot != NULL && dot > title ? (int)(dot - title) : (int)strlen(title);
    for (int n = 1; n < 10000; n++) {
        char number[16] = "";
        if (n > 1)
            snprintf(number, sizeof number, "-%d", n);
        const int used = snprintf(path, size, "%.*s-%s%s%s", length, title, word, number, ending);
        if (used < 0 || (size_t)used >= size)
            return false;
        FILE *there = fopen(path, "rb");
        if (there == NULL)
            return true;
        fclose(there);
    }
    return false;
}

static bool name_view(Viewer *viewer, const char *ending, char *path, size_t size)
{
    if (files_free_name(viewer, "view", ending, path, size))
        return true;
    viewer_say(viewer, "there is no free name like ...-view%s", ending);
    return false;
}

static void tell_how(Viewer *viewer, const char *path, const Error *err)
{
    if (error_is_set(err))
        viewer_say(viewer, "%s", err->text);
    else
        viewer_say(viewer, "saved %s", path);
}

void files_save_frame(Viewer *viewer, const char *path, bool tell)
{
    Error err = { 0 };
    const int w = viewer->view.width, h = viewer->view.height;
    uint8_t *rgb = array_create(3 * (size_t)w, (size_t)h, "picture", &err);
    if (rgb != NULL) {
        gl_read(w, h, rgb);
        pixels_write_png(rgb, w, h, path, &err);
    }
    array_free(rgb);
    if (tell || error_is_set(&err))
        tell_how(viewer, path, &err);
}

static ImageInfo describe(const Viewer *viewer, const Camera *camera)
{
    const ViewerOptions *options = viewer->options;
    const ShownMesh *mesh = viewer->shown->mesh;
    const Vec3 eye = vec3_add(camera->eye, mesh->origin);
    const Vec3 target = vec3_add(camera->target, mesh->origin);
    return (ImageInfo){ .eye = { eye.x, eye.y, eye.z },
                        .target = { target.x, target.y, target.z },
                        .up = { camera->up.x, camera->up.y, camera->up.z },
                        .vertical_fov = camera->vertical_fov,
                        .exposure = viewer->view.exposure,
                        .units = options->photometric ? "photometric" : "radiometric",
                        .version = ISOLUX_VERSION, .scene = options->scene,
                        .command = options->command, .scene_hash = mesh->scene_hash };
}

void files_save_png(Viewer *viewer)
{
    char path[sizeof viewer->screenshot];
    Error err = { 0 };
    if (!name_view(viewer, ".png", path, sizeof path))
        return;
    const Image *image = viewer->view.gathered && viewer->shown != NULL
                             ? easel_image(&viewer->control->easel) : NULL;
    if (image == NULL) {
        memcpy(viewer->screenshot, path, sizeof path);
        viewer->by_key = true;
        return;
    }
    const ImageTone tone = { viewer->view.exposure, viewer->view.tone };
    const ImageInfo info = describe(viewer, &viewer->view.camera);
    image_write_png(image, &tone, &info, path, &err);
    easel_shut(&viewer->control->easel);
    tell_how(viewer, path, &err);
}

void files_save_exr(Viewer *viewer)
{
    char path[sizeof viewer->screenshot];
    Error err = { 0 };
    if (viewer->shown == NULL) {
        viewer_say(viewer, "nothing is to be seen yet");
        return;
    }
    if (!name_view(viewer, ".exr", path, sizeof path))
        return;
    const ImageInfo info = describe(viewer, &viewer->view.camera);
    const Image *image = viewer->view.gathered ? easel_image(&viewer->control->easel) : NULL;
    if (image != NULL) {
        image_write_exr(image, &info, path, &err);
        easel_shut(&viewer->control->easel);
    } else {
        Image *still = still_take(viewer->shown, &viewer->view, &err);
        if (still != NULL)
            image_write_exr(still, &info, path, &err);
        image_destroy(still);
    }
    tell_how(viewer, path, &err);
}
