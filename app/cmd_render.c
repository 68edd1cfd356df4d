/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux render: solve, then a picture for each camera. */
#include <assert.h>

#include "app/blur.h"
#include "app/commands.h"
#include "app/light_layers.h"
#include "app/picture_files.h"
#include "app/pipeline_accuracy.h"
#include "app/pipeline_picture.h"
#include "app/saving.h"
#include "app/summary.h"
#include "app/views.h"

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
        monitor_warn(&session->monitor, "stopped", p->exr, "%s: the picture is not finished, "
                     "%.3g %% of it is rough", session_stop_reason(),
                     100 * pipeline->render.rough);
    }
    const bool written = picture_files_write(pipeline, image, p, err);
    image_destroy(image);
    if (!written)
        return false;
    views_note(pipeline, p);
    session_say(session, "isolux: %s -> %s, %s%s%s", session->options.scene, p->exr, p->png,
                p->values[0] != '\0' ? ", " : "", p->values);
    return true;
}

static bool take_pictures(Pipeline *pipeline, int *exit_code, Error *err)
{
    Session *session = pipeline->session;
    const uint32_t before = saving_views_before(pipeline->saving);
    PictureMaker maker = { 0 };
    bool good = (light_layers_count(pipeline) == 0 || views_fit(pipeline, 1, err)) &&
                picture_maker_begin(&maker, pipeline, err);
    bool stopped = false;
    uint32_t k = 0;
    for (; good && !stopped && k < pipeline->picture_count; k++) {
        PictureReport *p = &pipeline->picture[k];
        /* In a hurry, or asked to stop between two: one picture to look at is enough. */
        if (k > 0 && (session->hurry || session_stopped(session)))
            break;
        views_begin(pipeline, k);
        if (k < before && picture_files_exist(p))
            good = picture_skip(&maker, pipeline, err);
        else
            good = take_picture(pipeline, &maker, p, &stopped, err);
        if (good && !stopped) /* what is written is not to be made again */
            saving_view(pipeline->saving, k + 1);
        if (good) /* a stop that no progress has been told since too */
            saving_tick(pipeline->saving);
    }
    picture_maker_end(&maker);
    views_add_up(pipeline);
    *exit_code = pipeline_exit_code(pipeline);
    if (good && (stopped || k < pipeline->picture_count))
        *exit_code = ERROR_STOPPED;
    for (; good && k < pipeline->picture_count; k++)
        monitor_warn(&session->monitor, "stopped", pipeline->picture[k].exr,
                     "%s: the picture was not made", session_stop_reason());
    return good;
}

static bool render_moments(Pipeline *pipeline, int *exit_code, Error *err)
{
    bool stopped = false;
    if (!blur_render(pipeline, &stopped, err))
        return false;
    views_add_up(pipeline);
    *exit_code = stopped ? ERROR_STOPPED : pipeline_exit_code(pipeline);
    summary_print(pipeline);
    return true;
}

bool cmd_render(Pipeline *pipeline, int *exit_code, Error *err)
{
    const Options *options = &pipeline->session->options;
    assert(options->scene != NULL);
    const bool solved = options->renderer == RENDERER_GATHER;
    if (solved && !pipeline_accuracy_allowed(options, err))
        return false;
    if (!picture_files_allowed(options, err))
        return false;
    if (options_given(options, OPTION_SHUTTER))
        return render_moments(pipeline, exit_code, err);
    if (!pipeline_read(pipeline, err) ||
        !pipeline_mesh(pipeline, err) || !pipeline_camera(pipeline, err) ||
        !picture_files_name(pipeline, err))
        return false;
    if (!views_fit(pipeline, 1, err))
        return false;
    if (solved && (!pipeline_patches(pipeline, err) || !pipeline_accurate(pipeline, err)))
        return false;
    if (!take_pictures(pipeline, exit_code, err))
        return false;
    summary_print(pipeline);
    return true;
}
