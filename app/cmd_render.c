/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux render: solve, then a picture for each camera. */
#include <assert.h>
#include <math.h>
#include <stdio.h>

#include "app/commands.h"
#include "app/light_layers.h"
#include "app/picture_files.h"
#include "app/pipeline_accuracy.h"
#include "app/pipeline_picture.h"
#include "app/saving.h"
#include "app/summary.h"

/* Makes the camera that of the next picture. */
static void choose_view(Pipeline *pipeline, uint32_t k)
{
    assert(k < pipeline->view_count);
    pipeline->camera = pipeline->view[k];
    view_size(pipeline);
}

/* The same, and tells so. */
static void begin_view(Pipeline *pipeline, uint32_t k)
{
    char part[sizeof pipeline->session->printer.part];
    choose_view(pipeline, k);
    saving_view(pipeline->saving, k);
    if (pipeline->view_count == 1)
        return;
    snprintf(part, sizeof part, "%u of %u, %.40s", k + 1, pipeline->view_count,
             pipeline->camera.name);
    progress_part(&pipeline->session->printer, part);
}

/* Bytes of all layers of the largest picture, and as much again while they are packed for the
 * file. */
static bool images_fit(Pipeline *pipeline, Error *err)
{
    uint64_t pixels = 0;
    const uint64_t layers = (3 * 6 + 1 + 3 * (uint64_t)light_layers_count(pipeline)) *
                                sizeof(float) + sizeof(uint32_t);
    for (uint32_t k = pipeline->view_count; k-- > 0;) { /* the first last: it is to stay */
        choose_view(pipeline, k);
        const uint64_t n = (uint64_t)pipeline->width * (uint64_t)pipeline->height;
        pixels = n > pixels ? n : pixels;
    }
    return pipeline_fits(pipeline, 2 * layers * pixels, "picture", err);
}

/* What the picture under way came to, into its report. */
static void note_picture(const Pipeline *pipeline, PictureReport *p)
{
    const bool paths = pipeline->session->options.renderer == RENDERER_PATH;
    p->made = true;
    p->width = pipeline->width;
    p->height = pipeline->height;
    p->samples = paths ? pipeline->path.samples : pipeline->render.samples;
    if (pipeline->session->options.renderer == RENDERER_WHITTED)
        p->samples = pipeline->session->settings.spp;
    p->error = paths ? pipeline->path.error : pipeline->render.error;
    p->exposure = pipeline->exposure;
    p->rays = pipeline->render.rays;
    p->seconds = pipeline->render.seconds;
}

/* All pictures together, for the summary and the exit code. */
static void add_up(Pipeline *pipeline)
{
    RenderReport all = { 0 };
    uint32_t     made = 0;
    bool         known = true;
    for (uint32_t k = 0; k < pipeline->picture_count; k++) {
        const PictureReport *p = &pipeline->picture[k];
        made += p->made;
        all.rays += p->rays;
        all.seconds += p->seconds;
        all.samples += p->samples;
        all.error = fmax(all.error, p->error);
        known = known && !isnan(p->error);
    }
    all.samples /= made > 0 ? made : 1;
    if (pipeline->session->options.renderer == RENDERER_PATH) {
        pipeline->path = (PathReport){ .rays = all.rays, .seconds = all.seconds,
                                       .samples = all.samples, .error = known ? all.error : NAN };
        all.error = all.samples = 0;
    }
    pipeline->render = all;
}

/* Makes a picture and writes it; *stopped: it is not whole, the rest is to be left. */
static bool take_picture(Pipeline *pipeline, PictureMaker *maker, PictureReport *p, bool *stopped,
                         Error *err)
{
    Session *session = pipeline->session;
    Image *image = picture_make(maker, pipeline, err);
    if (image != NULL && err->code == ERROR_STOPPED && session->broken)
        image = image_destroy(image);
    if (image == NULL)
        return false;
    *stopped = err->code == ERROR_STOPPED;
    if (*stopped) {
        *err = (Error){ 0 };
        monitor_warn(&session->monitor, "stopped", p->exr, "%s: the picture is not whole",
                     session_stop_reason());
    }
    const bool written = picture_files_write(pipeline, image, p, err);
    image_destroy(image);
    if (!written)
        return false;
    note_picture(pipeline, p);
    session_say(session, "isolux: %s -> %s, %s%s%s", session->options.scene, p->exr, p->png,
                p->values[0] != '\0' ? ", " : "", p->values);
    return true;
}

static bool take_pictures(Pipeline *pipeline, int *exit_code, Error *err)
{
    Session *session = pipeline->session;
    const uint32_t before = saving_views_before(pipeline->saving);
    PictureMaker maker = { 0 };
    bool good = (light_layers_count(pipeline) == 0 || images_fit(pipeline, err)) &&
                picture_maker_begin(&maker, pipeline, err);
    bool stopped = false;
    uint32_t k = 0;
    for (; good && !stopped && k < pipeline->picture_count; k++) {
        PictureReport *p = &pipeline->picture[k];
        /* In a hurry, or asked to stop between two: one picture to look at is enough. */
        if (k > 0 && (session->hurry || session_stopped(session)))
            break;
        begin_view(pipeline, k);
        if (k < before && picture_files_exist(p))
            good = picture_skip(&maker, pipeline, err);
        else
            good = take_picture(pipeline, &maker, p, &stopped, err);
    }
    picture_maker_end(&maker);
    add_up(pipeline);
    *exit_code = pipeline_exit_code(pipeline);
    if (good && (stopped || k < pipeline->picture_count))
        *exit_code = ERROR_STOPPED;
    for (; good && k < pipeline->picture_count; k++)
        monitor_warn(&session->monitor, "stopped", pipeline->picture[k].exr,
                     "%s: the picture was not made", session_stop_reason());
    return good;
}

bool cmd_render(Pipeline *pipeline, int *exit_code, Error *err)
{
    const Options *options = &pipeline->session->options;
    assert(options->scene != NULL);
    const bool solved = options->renderer == RENDERER_GATHER;
    if (solved && !pipeline_accuracy_allowed(options, err))
        return false;
    if (!picture_files_allowed(options, err) || !pipeline_read(pipeline, err) ||
        !pipeline_mesh(pipeline, err) || !pipeline_camera(pipeline, err) ||
        !picture_files_name(pipeline, err))
        return false;
    if (!images_fit(pipeline, err))
        return false;
    if (solved && (!pipeline_patches(pipeline, err) || !pipeline_accurate(pipeline, err)))
        return false;
    if (!take_pictures(pipeline, exit_code, err))
        return false;
    summary_print(pipeline);
    return true;
}
