/* SPDX-License-Identifier: BSD-3-Clause */
/* Meshes by reference in the program. */
#include "app/pipeline_copies.h"

#include <assert.h>

/* Per triangle at the peak of a solution without links, a patch to each of 1.12 million triangles:
 * 1.02 GB (docs/ray-engine.md). Factors take more, the more rays are cast. */
static const double FLAT_BYTES = 900;

bool pipeline_copies_allowed(const Pipeline *pipeline, Error *err)
{
    const Scene   *scene = pipeline->scene;
    const Options *options = &pipeline->session->options;
    assert(scene != NULL && err != NULL);
    if (scene->placement_count == 0 || options->command == COMMAND_CHECK ||
        (options->command == COMMAND_RENDER && options->renderer == RENDERER_PATH))
        return true;
    const double triangles = (double)scene_triangles(scene);
    return error_set(err, ERROR_INPUT,
                     "%s: %.4g triangles by reference; patches need them flattened (--instances "
                     "flatten), at least %.2g GB; --renderer path renders them as they are",
                     options->scene, triangles, 1e-9 * FLAT_BYTES * triangles);
}

/* Rays are aimed at lamps among the scene's own faces alone. */
static void warn_lamps(const Pipeline *pipeline)
{
    const Scene *scene = pipeline->scene;
    size_t       lamps = 0;
    for (size_t i = 0; i < scene->placement_count; i++)
        lamps += rgb_max(scene->polygons.materials[scene->placements[i].material].emission) > 0;
    if (lamps > 0)
        monitor_warn(&pipeline->session->monitor, "lamps-by-chance", scene->file,
                     "%zu meshes that give light are kept by reference: only paths that happen to "
                     "meet them find their light, which is noisy; --instances flatten", lamps);
}

RoomCopies *pipeline_copies(Pipeline *pipeline, Error *err)
{
    Session *session = pipeline->session;
    if (pipeline->scene->placement_count == 0)
        return NULL;
    warn_lamps(pipeline);
    const double begin = progress_now();
    pipeline_begin(pipeline, STAGE_BVH);
    RoomCopies *copies = copies_create(&pipeline->room, pipeline->scene, &session->settings.repair,
                                   session->settings.threads, &session->monitor, err);
    pipeline_note(pipeline, STAGE_BVH, begin);
    if (copies == NULL || pipeline_fits(pipeline, 0, session->options.scene, err))
        return copies;
    return copies_destroy(copies);
}
