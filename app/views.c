/* SPDX-License-Identifier: BSD-3-Clause */
/* Views, one after the other. */
#include "app/views.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>

#include "app/commands.h"
#include "app/light_layers.h"
#include "app/saving.h"

/* Makes the camera that of the next picture. */
static void choose_view(Pipeline *pipeline, uint32_t k)
{
    assert(k < pipeline->view_count);
    pipeline->camera = pipeline->view[k];
    view_size(pipeline);
}

void views_begin(Pipeline *pipeline, uint32_t k)
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

bool views_fit(Pipeline *pipeline, uint32_t pictures, Error *err)
{
    uint64_t pixels = 0;
    const uint64_t layers = (3 * 6 + 1 + 3 * (uint64_t)light_layers_count(pipeline)) *
                                sizeof(float) + sizeof(uint32_t);
    for (uint32_t k = pipeline->view_count; k-- > 0;) { /* the first last: it is to stay */
        choose_view(pipeline, k);
        const uint64_t n = (uint64_t)pipeline->width * (uint64_t)pipeline->height;
        pixels = n > pixels ? n : pixels;
    }
    return pipeline_fits(pipeline, (1 + (uint64_t)pictures) * layers * pixels, "picture", err);
}

void views_note(const Pipeline *pipeline, PictureReport *p)
{
    const bool paths = pipeline->session->options.renderer == RENDERER_PATH;
    p->made = true;
    p->width = pipeline->width;
    p->height = pipeline->height;
    p->samples = paths ? pipeline->path.samples : pipeline->render.samples;
    p->error = paths ? pipeline->path.error : pipeline->render.error;
    p->records_error = pipeline->render.records_error;
    p->exposure = pipeline->exposure;
    p->rays = pipeline->render.rays;
    p->seconds = pipeline->render.seconds;
}

void views_add_up(Pipeline *pipeline)
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
        all.records_error = fmax(all.records_error, p->records_error);
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
