/* SPDX-License-Identifier: BSD-3-Clause */
/* A picture by paths: no patches, no factors, no solver. */
#include "app/pipeline_path.h"

#include <assert.h>
#include <math.h>

#include "app/pipeline_copies.h"
#include "render/whitted.h"

static Image *whitted(Pipeline *pipeline, Error *err)
{
    Session *session = pipeline->session;
    const Options *options = &session->options;
    const double *crop = options->crop, begin = progress_now();
    WhittedReport report;
    const WhittedOptions wo = { .width = pipeline->width, .height = pipeline->height,
                                .samples = session->hurry ? 1 : session->settings.spp,
                                .depth = options->depth,
                                .background = pipeline->scene->background,
                                .ambient = pipeline->scene->ambient,
                                .filter = (PixelFilter)options->pixel_filter,
                                .crop = { (int)crop[0], (int)crop[1], (int)crop[2],
                                          (int)crop[3] },
                                .seed = session->settings.seed,
                                .threads = session->settings.threads };
    Image *image = render_whitted(&pipeline->room, &pipeline->camera, &wo, &report,
                                  &session->monitor, err);
    pipeline->render.samples = wo.samples;
    pipeline->render.rays = report.rays;
    pipeline->render.seconds = report.seconds;
    pipeline->render.rough = report.rough;
    pipeline_note(pipeline, STAGE_GATHER, begin);
    return image;
}

bool pipeline_path_begin(Pipeline *pipeline, RoomCopies **copies, Error *err)
{
    *copies = NULL;
    if (!pipeline_sides(pipeline, err))
        return false;
    pipeline_room(pipeline);
    if (pipeline->session->options.renderer == RENDERER_PATH)
        *copies = pipeline_copies(pipeline, err);
    return !error_is_set(err);
}

Image *pipeline_path(Pipeline *pipeline, const RoomCopies *copies, Error *err)
{
    Session *session = pipeline->session;
    const Settings *settings = &session->settings;
    assert(pipeline->has_camera && pipeline->width > 0 && pipeline->sides != NULL);
    if (session->options.renderer == RENDERER_WHITTED)
        return whitted(pipeline, err);
    const double begin = progress_now();
    const double *crop = session->options.crop;
    const PathOptions po = { .width = pipeline->width, .height = pipeline->height,
                             .samples = session->hurry ? 1 : settings->spp,
                             .error = settings->accuracy,
                             .diffuse_only = session->options.diffuse,
                             .background = pipeline->scene->background,
                             .copies = copies,
                             .filter = (PixelFilter)session->options.pixel_filter,
                             .crop = { (int)crop[0], (int)crop[1], (int)crop[2], (int)crop[3] },
                             .seed = settings->seed, .threads = settings->threads };
    Image *image = render_path(&pipeline->room, &pipeline->camera, &po, &pipeline->path,
                               &session->monitor, err);
    pipeline->render.rays = pipeline->path.rays;
    pipeline->render.seconds = pipeline->path.seconds;
    pipeline->render.rough = pipeline->path.rough;
    const double reached = isnan(pipeline->path.error) ? INFINITY : pipeline->path.error;
    if (settings->accuracy > 0) /* of the pictures, not of patches */
        pipeline->accuracy = (LightAccuracy){ .asked = settings->accuracy,
                                              .reached = fmax(pipeline->accuracy.reached,
                                                              reached) };
    pipeline_note(pipeline, STAGE_GATHER, begin);
    return image;
}
