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

RoomCopies *pipeline_copies(Pipeline *pipeline, Error *err)
{
    Session *session = pipeline->session;
    if (pipeline->scene->placement_count == 0)
        return NULL;
    const double begin = progress_now();
    pipeline_begin(pipeline, STAGE_BVH);
    RoomCopies *copies = copies_create(&pipeline->room, pipeline->scene, &session->settings.repair,
                                   session->settings.threads, &session->monitor, err);
    pipeline_note(pipeline, STAGE_BVH, begin);
    if (copies == NULL || pipeline_fits(pipeline, 0, session->options.scene, err))
        return copies;
    return copies_destroy(copies);
}
