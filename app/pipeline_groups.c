/* SPDX-License-Identifier: BSD-3-Clause */
/* Form factors between groups or materials, pair by pair, in the place of those between patches. */
#include <assert.h>
#include <math.h>

#include "app/pipeline_groups.h"
#include "base/array.h"

/* Patches that rays start from: stratified by these, but each with a net of its own. */
enum { GROUP_PATCHES = 512 };

/* From quality high on rays go on, up to so many times as many, until no factor's standard error is
 * above what factors are to be trusted to: crowds and curved faces, which rays alone can do, need
 * them. Who gives --rays means it. */
enum { TRUSTED_TIMES = 4 };
static const double TRUSTED_ERROR = 2e-4;

/* Memory that group_factors_create takes, about: 16 scramblings and some sums; a thousand sides in
 * pairs. */
enum { BYTES_PER_PAIR = 24 * sizeof(double), SIDES_BYTES = 12 << 20 };

bool pipeline_groups_wanted(const Pipeline *pipeline)
{
    const Options *options = &pipeline->session->options;
    const Polygons *soup = &pipeline->scene->polygons;
    const size_t count = options->by == BY_GROUP ? soup->group_count : soup->material_count;
    return options->command == COMMAND_FACTORS && options->by != BY_PATCH &&
           options->patches == 0 && !(options->patch_size > 0) && options->factors == NULL &&
           !options_given(options, OPTION_CHECKPOINT) && !options_given(options, OPTION_RESUME) &&
           count <= GROUP_CLASSES_MOST;
}

uint32_t pipeline_groups_patches(const Pipeline *pipeline)
{
    const uint32_t wanted = pipeline->session->settings.patches;
    return pipeline_groups_wanted(pipeline) ? GROUP_PATCHES : wanted;
}

/* Numbers the groups or materials that have patches, in the scene's order. */
static bool number_classes(Pipeline *pipeline, uint32_t *patch_class, uint32_t *count, Error *err)
{
    const Polygons *soup = &pipeline->scene->polygons;
    const Patches *patches = pipeline->patches;
    const bool by_group = pipeline->session->options.by == BY_GROUP;
    const size_t all = by_group ? soup->group_count : soup->material_count;
    const uint32_t *of = by_group ? patches->group : patches->material;
    uint32_t *row = array_create(all, sizeof *row, "groups", err);
    if (row == NULL)
        return false;
    *count = 0;
    for (uint32_t i = 0; i < patches->count; i++)
        row[of[i]] = 1;
    for (size_t k = 0; k < all; k++)
        *count += row[k];
    pipeline->group_class = array_create(*count, sizeof *pipeline->group_class, "groups", err);
    for (uint32_t k = 0, n = 0; pipeline->group_class != NULL && k < all; k++)
        if (row[k] != 0) {
            pipeline->group_class[n] = k;
            row[k] = n++;
        }
    for (uint32_t i = 0; i < patches->count; i++)
        patch_class[i] = row[of[i]];
    array_free(row);
    return pipeline->group_class != NULL;
}

/* One row per class: what reports and closure work on. */
static Links *make_links(const GroupFactors *f, Error *err)
{
    uint64_t nonzeros = 0;
    for (uint32_t i = 0; i < f->count; i++)
        for (uint32_t j = 0; j < f->count; j++)
            nonzeros += (float)group_factor(f, i, j) > 0;
    Links *links = links_empty(f->count, nonzeros, err);
    if (links == NULL)
        return NULL;
    for (uint32_t i = 0; i < f->count; i++) {
        uint64_t at = links->first[i];
        for (uint32_t j = 0; j < f->count; j++) {
            const float factor = (float)group_factor(f, i, j);
            if (!(factor > 0))
                continue;
            links->source[at] = j;
            links->form_factor[at++] = factor;
        }
        links->first[i + 1] = at;
        links->escape[i] = (float)f->escape[i];
        links->area[i] = f->area[i];
    }
    links->rays = f->rays;
    links->seconds = f->seconds;
    return links;
}

/* Sums of the scramblings, and what is kept of each pair of sides. */
static bool fits(const Pipeline *pipeline, uint32_t count, Error *err)
{
    const uint64_t pairs = (uint64_t)count * count;
    return pipeline_fits(pipeline, pairs * BYTES_PER_PAIR + SIDES_BYTES, "matrix", err);
}

static bool run(Pipeline *pipeline, const uint32_t *patch_class, uint32_t count, Error *err)
{
    const Settings *settings = &pipeline->session->settings;
    GroupOptions go = { .count = count, .patch_class = patch_class,
                        .accuracy = settings->accuracy,
                        .most_rays = (uint64_t)settings->rays * settings->patches,
                        .seed = settings->seed, .threads = settings->threads };
    const Options *options = &pipeline->session->options;
    if (options->quality >= QUALITY_HIGH && options->rays == 0) {
        go.trusted = fmax(TRUSTED_ERROR, go.accuracy);
        go.trusted_rays = TRUSTED_TIMES * go.most_rays;
    }
    do {
        pipeline->groups = group_factors_create(&pipeline->room, &go,
                                                &pipeline->session->monitor, err);
        go.most_rays = go.trusted_rays = 0; /* in a hurry: the first round alone */
    } while (pipeline->groups == NULL && pipeline_hurry(pipeline, err));
    if (pipeline->groups != NULL)
        pipeline->links = make_links(pipeline->groups, err);
    return pipeline->links != NULL;
}

bool pipeline_groups(Pipeline *pipeline, Error *err)
{
    assert(pipeline->patches != NULL && pipeline->links == NULL && pipeline->groups == NULL);
    uint32_t count = 0;
    uint32_t *patch_class = array_create(pipeline->patches->count, sizeof *patch_class, "groups",
                                         err);
    const bool done = patch_class != NULL && number_classes(pipeline, patch_class, &count, err) &&
                      fits(pipeline, count, err) && run(pipeline, patch_class, count, err);
    array_free(patch_class);
    return done;
}
