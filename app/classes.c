/* SPDX-License-Identifier: BSD-3-Clause */
/* Sums of A F between groups or materials, as factors. */
#include "app/classes.h"

#include <assert.h>

#include "base/array.h"

typedef struct {
    uint32_t        all;      /* groups or materials of the scene */
    const uint32_t *class_of; /* [patches] */
    uint32_t       *row;      /* [all]  row of the matrix, PATCH_NONE: none */
} Sums;

static const char *class_name(const Pipeline *pipeline, FactorsBy by, uint32_t i)
{
    const Polygons *soup = &pipeline->scene->polygons;
    return by == BY_GROUP ? soup->group_name[i] : soup->materials[i].name;
}

void classes_clear(Classes *classes)
{
    array_free(classes->name);
    array_free(classes->factor);
    array_free(classes->escape);
    array_free(classes->sum);
    array_free(classes->raw_sum);
    array_free(classes->raw_escape);
    array_free(classes->area);
    array_free(classes->error);
    array_free(classes->emissivity);
    array_free(classes->row);
    *classes = (Classes){ 0 };
}

/* Rows for all classes that have a visible patch, in the scene's order. */
static void number_rows(const Pipeline *pipeline, const Sums *sums, Classes *classes)
{
    const Links *links = pipeline->links;
    for (uint32_t i = 0; i < sums->all; i++)
        sums->row[i] = PATCH_NONE;
    for (uint32_t i = 0; i < links->count; i++)
        if (links->area[i] > 0)
            sums->row[sums->class_of[i]] = 0;
    for (uint32_t i = 0; i < sums->all; i++)
        if (sums->row[i] == 0)
            sums->row[i] = classes->count++;
}

static bool allocate(const Pipeline *pipeline, Classes *classes, Error *err)
{
    const size_t n = classes->count;
    const uint64_t matrices = pipeline->groups != NULL ? 2 : 1;
    if (!pipeline_fits(pipeline, matrices * n * n * sizeof(double), "matrix", err))
        return false;
    if (n > 0 && n > SIZE_MAX / n)
        return error_set(err, ERROR_MEMORY, "a matrix of %zu rows", n);
    classes->name = array_create(n, sizeof *classes->name, "matrix", err);
    classes->factor = array_create(n * n, sizeof *classes->factor, "matrix", err);
    classes->escape = array_create(n, sizeof *classes->escape, "matrix", err);
    if (pipeline->groups != NULL)
        classes->error = array_create(n * n, sizeof *classes->error, "matrix", err);
    classes->sum = array_create(n, sizeof *classes->sum, "matrix", err);
    classes->raw_sum = array_create(n, sizeof *classes->raw_sum, "matrix", err);
    classes->raw_escape = array_create(n, sizeof *classes->raw_escape, "matrix", err);
    classes->area = array_create(n, sizeof *classes->area, "matrix", err);
    classes->emissivity = array_create(n, sizeof *classes->emissivity, "matrix", err);
    return !error_is_set(err);
}

/* Sums of rows: means over the area of each class. */
static void add_sums(const Links *links, const Sums *sums, LinksScratch *scratch, double *sum,
                     double *escape)
{
    for (uint32_t i = 0; i < links->count; i++) {
        const LinksRow row = links_row(links, i, scratch);
        const uint32_t r = sums->row[sums->class_of[i]];
        if (!(links->area[i] > 0))
            continue;
        double all = links->escape[i];
        for (uint64_t k = 0; k < row.count; k++)
            all += row.form_factor[k];
        sum[r] += links->area[i] * all;
        if (escape != NULL)
            escape[r] += links->area[i] * links->escape[i];
        links_leave(links, i, i + 1);
    }
}

static void add_links(const Pipeline *pipeline, const Sums *sums, LinksScratch *scratch,
                      Classes *classes)
{
    const Links *links = pipeline->links;
    const size_t n = classes->count;
    for (uint32_t i = 0; i < links->count; i++) {
        const double area = links->area[i];
        if (!(area > 0))
            continue;
        const uint32_t r = sums->row[sums->class_of[i]];
        const LinksRow row = links_row(links, i, scratch);
        for (uint64_t k = 0; k < row.count; k++) {
            const uint32_t c = sums->row[sums->class_of[row.source[k]]];
            if (c != PATCH_NONE)
                classes->factor[r * n + c] += area * row.form_factor[k];
        }
        links_leave(links, i, i + 1);
        classes->escape[r] += area * links->escape[i];
        classes->area[r] += area;
    }
    for (size_t r = 0; r < n; r++) {
        for (size_t c = 0; c < n; c++)
            classes->factor[r * n + c] /= classes->area[r];
        classes->escape[r] /= classes->area[r];
        classes->open = classes->open || classes->escape[r] > 0;
    }
}

static void take_errors(const Pipeline *pipeline, const Sums *sums, Classes *classes)
{
    const GroupFactors *groups = pipeline->groups;
    const size_t n = classes->count;
    for (uint32_t i = 0; i < groups->count; i++)
        for (uint32_t j = 0; j < groups->count; j++) {
            const uint32_t r = sums->row[sums->class_of[i]], c = sums->row[sums->class_of[j]];
            if (r != PATCH_NONE && c != PATCH_NONE)
                classes->error[r * n + c] = group_factor_error(groups, i, j);
        }
}

static void add_all(const Pipeline *pipeline, const Sums *sums, Classes *classes, Error *err)
{
    const Links *raw = pipeline->raw_links != NULL ? pipeline->raw_links : pipeline->links;
    LinksScratch scratch;
    if (!links_scratch_create(pipeline->links, &scratch, err))
        return;
    add_links(pipeline, sums, &scratch, classes);
    if (pipeline->groups != NULL)
        take_errors(pipeline, sums, classes);
    add_sums(pipeline->links, sums, &scratch, classes->sum, NULL);
    add_sums(raw, sums, &scratch, classes->raw_sum, classes->raw_escape);
    for (size_t r = 0; r < classes->count; r++) {
        classes->sum[r] /= classes->area[r];
        classes->raw_sum[r] /= classes->area[r];
        classes->raw_escape[r] /= classes->area[r];
    }
    links_scratch_clear(&scratch);
}

/* Means over the patches of each class. */
static bool mean_emissivity(const Pipeline *pipeline, FactorsBy by, const Sums *sums,
                            Classes *classes, Error *err)
{
    const Patches *patches = pipeline->patches;
    const Material *materials = pipeline->scene->polygons.materials;
    const uint32_t *of = by == BY_GROUP ? patches->group : patches->material;
    double *area = array_create(classes->count, sizeof *area, "matrix", err);
    if (area == NULL)
        return false;
    for (uint32_t i = 0; i < patches->count; i++) {
        const uint32_t r = sums->row[of[i]];
        const double part = pipeline->groups == NULL ? pipeline->links->area[i]
                                                     : patches->area[i];
        if (r == PATCH_NONE)
            continue;
        area[r] += part;
        classes->emissivity[r] +=
            part * (1 - rgb_luminance(materials[patches->material[i]].reflectance));
    }
    for (uint32_t r = 0; r < classes->count; r++)
        classes->emissivity[r] /= area[r];
    array_free(area);
    return true;
}

/* Someone may look for the row. */
static bool warn_unused(const Pipeline *pipeline, FactorsBy by, const Sums *sums, Error *err)
{
    const Polygons *soup = &pipeline->scene->polygons;
    bool *used = array_create(sums->all, sizeof *used, "matrix", err);
    if (used == NULL)
        return false;
    for (size_t k = 0; k < soup->polygon_count; k++)
        used[by == BY_GROUP ? soup->group[k] : soup->material[k]] = true;
    for (size_t k = 0; k < soup->shape_count; k++)
        used[by == BY_GROUP ? soup->shape[k].group : soup->shape[k].material] = true;
    for (uint32_t i = 0; i < sums->all; i++)
        if (used[i] && sums->row[i] == PATCH_NONE)
            monitor_warn(&pipeline->session->monitor, "unused-row", class_name(pipeline, by, i),
                         "no side of it takes part, so the matrix has no row for it");
    array_free(used);
    return true;
}

bool classes_sum(const Pipeline *pipeline, FactorsBy by, Classes *classes, Error *err)
{
    const Polygons *soup = &pipeline->scene->polygons;
    assert(by != BY_PATCH && pipeline->links != NULL);
    assert(pipeline->groups != NULL || pipeline->links->count == pipeline->patches->count);
    Sums sums = { .all = (uint32_t)(by == BY_GROUP ? soup->group_count : soup->material_count),
                  .class_of = pipeline->groups != NULL ? pipeline->group_class
                              : by == BY_GROUP         ? pipeline->patches->group
                                                       : pipeline->patches->material };
    *classes = (Classes){ 0 };
    classes->row = array_create(sums.all, sizeof *sums.row, "matrix", err);
    sums.row = classes->row;
    if (sums.row != NULL) {
        number_rows(pipeline, &sums, classes);
        if (allocate(pipeline, classes, err) && warn_unused(pipeline, by, &sums, err) &&
            mean_emissivity(pipeline, by, &sums, classes, err)) {
            for (uint32_t i = 0; i < sums.all; i++)
                if (sums.row[i] != PATCH_NONE)
                    classes->name[sums.row[i]] = class_name(pipeline, by, i);
            add_all(pipeline, &sums, classes, err);
        }
    }
    return !error_is_set(err);
}
