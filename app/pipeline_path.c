/* SPDX-License-Identifier: BSD-3-Clause */
/* A picture by paths: no patches, no factors, no solver. */
#include "app/pipeline_path.h"

#include <assert.h>
#include <math.h>

#include "app/pipeline_copies.h"
#include "render/whitted.h"

bool pipeline_path_allowed(const Options *options, Error *err)
{
    static const OptionId refused[] = { OPTION_CHECKPOINT, OPTION_RESUME, OPTION_FACTORS,
                                        OPTION_SET, OPTION_CHANGES, OPTION_LIGHT_GROUPS,
                                        OPTION_TRACE };
    char word[32];
    if (options_given(options, OPTION_DEPTH) && options->renderer != RENDERER_WHITTED)
        return error_set(err, ERROR_USAGE, "--depth belongs to --renderer whitted");
    const bool asked = options_given(options, OPTION_ACCURACY) ||
                       options_given(options, OPTION_ERROR);
    if (asked && options->renderer == RENDERER_WHITTED)
        return error_set(err, ERROR_USAGE, "--renderer whitted has no error to be told or reached");
    if (options->renderer == RENDERER_GATHER)
        return true;
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        if (!options_given(options, refused[i]))
            continue;
        value_word(options_table()[OPTION_RENDERER].words, options->renderer, word, sizeof word);
        return error_set(err, ERROR_USAGE, "%s needs a solution; --renderer %s makes none",
                         options_table()[refused[i]].name, word);
    }
    return true;
}

static Image *whitted(Pipeline *pipeline, Error *err)
{
    Session *session = pipeline->session;
    const Options *options = &session->options;
    const double *crop = options->crop, begin = progress_now();
    WhittedReport report;
    const WhittedOptions wo = { .width = pipeline->width, .height = pipeline->height,
                                .samples = options->spp, .depth = options->depth,
                                .background = pipeline->scene->background,
                                .ambient = pipeline->scene->ambient,
                                .filter = (PixelFilter)options->pixel_filter,
                                .crop = { (int)crop[0], (int)crop[1], (int)crop[2],
                                          (int)crop[3] },
                                .seed = session->settings.seed,
                                .threads = session->settings.threads };
    Image *image = render_whitted(&pipeline->room, &pipeline->camera, &wo, &report,
                                  &session->monitor, err);
    session->settings.spp = options->spp > 0 ? options->spp : 1;
    pipeline->render.rays = report.rays;
    pipeline->render.seconds = report.seconds;
    pipeline_note(pipeline, STAGE_GATHER, begin);
    return image;
}

Image *pipeline_path(Pipeline *pipeline, Error *err)
{
    Session *session = pipeline->session;
    const Settings *settings = &session->settings;
    assert(pipeline->has_camera && pipeline->width > 0);
    if (!pipeline_sides(pipeline, err))
        return NULL;
    pipeline_room(pipeline);
    if (session->options.renderer == RENDERER_WHITTED)
        return whitted(pipeline, err);
    RoomCopies *copies = pipeline_copies(pipeline, err);
    if (error_is_set(err))
        return NULL;
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
    copies_destroy(copies);
    pipeline->render.rays = pipeline->path.rays;
    pipeline->render.seconds = pipeline->path.seconds;
    if (settings->accuracy > 0) /* of the picture, not of patches */
        pipeline->accuracy = (LightAccuracy){ .asked = settings->accuracy,
                                              .reached = isnan(pipeline->path.error)
                                                             ? INFINITY : pipeline->path.error };
    pipeline_note(pipeline, STAGE_GATHER, begin);
    return image;
}
