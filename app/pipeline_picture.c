/* SPDX-License-Identifier: BSD-3-Clause */
/* Pictures, by the renderer that was asked for. */
#include "app/pipeline_picture.h"

#include <assert.h>

#include "app/light_layers.h"
#include "app/pipeline_path.h"
#include "app/saving.h"

/* A picture that was asked to stop before it began is made with one ray per pixel: something to
 * look at, in about a second. */
static void hurry_picture(Pipeline *pipeline)
{
    Session *session = pipeline->session;
    if (!session->hurry && session_stopped(session)) {
        session->hurry = true;
        monitor_warn(&session->monitor, "hurried", session->options.scene,
                     "%s: finishing roughly", session_stop_reason());
    }
    if (session->hurry) {
        session->settings.spp = session->settings.gather_rays = 1;
        session->settings.record_rays = 0;
        session->settings.error = 0;
    }
}

bool picture_maker_begin(PictureMaker *maker, Pipeline *pipeline, Error *err)
{
    *maker = (PictureMaker){ 0 };
    if (pipeline->session->options.renderer != RENDERER_GATHER)
        return pipeline_path_begin(pipeline, &maker->copies, err);
    hurry_picture(pipeline);
    maker->gatherer = gatherer_create(&pipeline->room, pipeline->solution, pipeline->links, err);
    if (maker->gatherer == NULL || !light_layers_split(pipeline, maker->gatherer, err))
        return false;
    const uint32_t groups = light_layers_count(pipeline);
    if (pipeline->session->settings.record_rays > 0 && groups <= RECORDS_GROUPS_MOST)
        maker->records = records_create(err);
    if (maker->records != NULL)
        records_split(maker->records, groups);
    return !error_is_set(err);
}

void picture_maker_end(PictureMaker *maker)
{
    records_destroy(maker->records);
    gatherer_destroy(maker->gatherer);
    copies_destroy(maker->copies);
    *maker = (PictureMaker){ 0 };
}

static RenderOptions render_options(const PictureMaker *maker, const Pipeline *pipeline)
{
    const Session *session = pipeline->session;
    const Settings *settings = &session->settings;
    const double *crop = session->options.crop;
    return (RenderOptions){ .width = pipeline->width, .height = pipeline->height,
                            .samples = settings->spp,
                            .gather_rays = settings->gather_rays,
                            .filter = (PixelFilter)session->options.pixel_filter,
                            .crop = { (int)crop[0], (int)crop[1], (int)crop[2], (int)crop[3] },
                            .diffuse_only = session->options.diffuse,
                            .background = pipeline->scene->background,
                            .seed = settings->seed, .whole = true,
                            .threads = settings->threads,
                            .kept = saving_tiles(pipeline->saving),
                            .records = maker->records,
                            .record_rays = settings->record_rays,
                            .error = settings->error };
}

Image *picture_make(PictureMaker *maker, Pipeline *pipeline, Error *err)
{
    assert(pipeline->has_camera && pipeline->width > 0);
    if (maker->gatherer == NULL)
        return pipeline_path(pipeline, maker->copies, err);
    const double begin = progress_now();
    const RenderOptions ro = render_options(maker, pipeline);
    Image *image = render_gather(maker->gatherer, &pipeline->camera, &ro, &pipeline->render,
                                 &pipeline->session->monitor, err);
    pipeline_note(pipeline, STAGE_GATHER, begin);
    return image;
}

bool picture_skip(PictureMaker *maker, Pipeline *pipeline, Error *err)
{
    if (maker->gatherer == NULL)
        return true;
    const double begin = progress_now();
    const RenderOptions ro = render_options(maker, pipeline);
    const bool done = render_records(maker->gatherer, &pipeline->camera, &ro,
                                     &pipeline->session->monitor, err);
    pipeline_note(pipeline, STAGE_GATHER, begin);
    return done;
}
