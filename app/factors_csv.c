/* SPDX-License-Identifier: BSD-3-Clause */
/* Form factors as files: a CSV by group or material; Matrix Market by patch. */
#include <assert.h>
#include <inttypes.h>
#include <string.h>

#include "app/commands.h"
#include "app/csv.h"
#include "base/array.h"
#include "base/file.h"

/* Sums of A F between classes (groups or materials) of patches. */
typedef struct {
    uint32_t        count;
    const uint32_t *class_of; /* [patches]  the patch's group or material */
    double         *exchange; /* [count * count]  A F from row to column, scene units^2 */
    double         *escape;   /* [count] */
    double         *area;     /* [count]  visible */
} Classes;

static void classes_clear(Classes *classes)
{
    array_free(classes->exchange);
    array_free(classes->escape);
    array_free(classes->area);
    *classes = (Classes){ 0 };
}

static bool classes_sum(const Pipeline *pipeline, FactorsBy by, Classes *classes, Error *err)
{
    const Links *links = pipeline->links;
    const Polygons *soup = &pipeline->scene->polygons;
    const size_t count = by == BY_GROUP ? soup->group_count : soup->material_count;
    const uint32_t *class_of =
        by == BY_GROUP ? pipeline->patches->group : pipeline->patches->material;
    assert(count > 0 && count <= UINT32_MAX && links->count == pipeline->patches->count);
    *classes = (Classes){ .count = (uint32_t)count, .class_of = class_of };
    if (!pipeline_fits(pipeline, (uint64_t)count * count * sizeof(double), "matrix", err))
        return false;
    if (count > SIZE_MAX / count)
        return error_set(err, ERROR_MEMORY, "a matrix of %zu rows", count);
    classes->exchange = array_create(count * count, sizeof(double), "matrix", err);
    classes->escape = array_create(count, sizeof(double), "matrix", err);
    classes->area = array_create(count, sizeof(double), "matrix", err);
    if (error_is_set(err))
        return false;
    for (uint32_t i = 0; i < links->count; i++) {
        double *row = classes->exchange + (size_t)class_of[i] * count;
        for (uint64_t k = links->first[i]; k < links->first[i + 1]; k++)
            row[class_of[links->source[k]]] += links->area[i] * links->form_factor[k];
        classes->escape[class_of[i]] += links->area[i] * links->escape[i];
        classes->area[class_of[i]] += links->area[i];
    }
    return true;
}

static const char *class_name(const Pipeline *pipeline, FactorsBy by, uint32_t i)
{
    const Polygons *soup = &pipeline->scene->polygons;
    return by == BY_GROUP ? soup->group_name[i] : soup->materials[i].name;
}

static void put_rows(FILE *out, const Pipeline *pipeline, FactorsBy by, const Classes *classes)
{
    const size_t n = classes->count;
    bool open = false;
    for (size_t i = 0; i < n; i++)
        open = open || classes->escape[i] > 0;
    fputs(by == BY_GROUP ? "group,area" : "material,area", out);
    for (uint32_t j = 0; j < n; j++)
        if (classes->area[j] > 0) {
            fputc(',', out);
            csv_text(out, class_name(pipeline, by, j));
        }
    fputs(open ? ",escaped\n" : "\n", out);
    for (uint32_t i = 0; i < n; i++) {
        const double area = classes->area[i];
        if (!(area > 0))
            continue;
        csv_text(out, class_name(pipeline, by, i));
        fprintf(out, ",%.9g", area);
        for (uint32_t j = 0; j < n; j++)
            if (classes->area[j] > 0)
                fprintf(out, ",%.9g", classes->exchange[i * n + j] / area);
        if (open)
            fprintf(out, ",%.9g", classes->escape[i] / area);
        fputc('\n', out);
    }
}

/* Classes without a side in use have no row: told, because someone may look for them. */
static bool warn_unused(const Pipeline *pipeline, FactorsBy by, const Classes *classes, Error *err)
{
    const Polygons *soup = &pipeline->scene->polygons;
    bool *used = array_create(classes->count, sizeof *used, "matrix", err);
    if (used == NULL)
        return false;
    for (size_t k = 0; k < soup->polygon_count; k++)
        used[by == BY_GROUP ? soup->group[k] : soup->material[k]] = true;
    for (size_t k = 0; k < soup->shape_count; k++)
        used[by == BY_GROUP ? soup->shape[k].group : soup->shape[k].material] = true;
    for (uint32_t i = 0; i < classes->count; i++)
        if (used[i] && !(classes->area[i] > 0))
            monitor_warn(&pipeline->session->monitor, "unused-row",
                         class_name(pipeline, by, i),
                         "no side of it takes part, so the matrix has no row for it");
    array_free(used);
    return true;
}

bool factors_write_csv(const Pipeline *pipeline, FactorsBy by, const char *path, Error *err)
{
    Classes classes = { 0 };
    assert(by != BY_PATCH && pipeline->links != NULL);
    OutFile *out = NULL;
    if (classes_sum(pipeline, by, &classes, err) && warn_unused(pipeline, by, &classes, err))
        out = outfile_open(path, err);
    if (out != NULL)
        put_rows(outfile_stream(out), pipeline, by, &classes);
    classes_clear(&classes);
    return out != NULL && outfile_commit(out, err);
}

/* --- by patch --------------------------------------------------------------------------------- */

static bool write_matrix(const Links *links, const char *path, Error *err)
{
    OutFile *file = outfile_open(path, err);
    if (file == NULL)
        return false;
    FILE *out = outfile_stream(file);
    fprintf(out, "%%%%MatrixMarket matrix coordinate real general\n"
                 "%% form factor from the row's patch to the column's; patches count from 1\n"
                 "%" PRIu32 " %" PRIu32 " %" PRIu64 "\n",
            links->count, links->count, links->first[links->count]);
    for (uint32_t i = 0; i < links->count; i++)
        for (uint64_t k = links->first[i]; k < links->first[i + 1]; k++)
            fprintf(out, "%" PRIu32 " %" PRIu32 " %.9g\n", i + 1, links->source[k] + 1,
                    (double)links->form_factor[k]);
    return outfile_commit(file, err);
}

static bool write_patch_table(const Pipeline *pipeline, const char *path, Error *err)
{
    const Patches *p = pipeline->patches;
    const Links *links = pipeline->links;
    OutFile *file = outfile_open(path, err);
    if (file == NULL)
        return false;
    FILE *out = outfile_stream(file);
    fputs("patch,group,material,surface,side,area,visible_area,x,y,z,nx,ny,nz,escaped\n", out);
    for (uint32_t i = 0; i < p->count; i++) {
        fprintf(out, "%" PRIu32 ",", i + 1);
        csv_text(out, class_name(pipeline, BY_GROUP, p->group[i]));
        fputc(',', out);
        csv_text(out, class_name(pipeline, BY_MATERIAL, p->material[i]));
        fprintf(out, ",%" PRIu32 ",%s,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n",
                p->surface[i], p->side[i] == 0 ? "front" : "back", p->area[i], links->area[i],
                p->centre[i].x, p->centre[i].y, p->centre[i].z, p->normal[i].x, p->normal[i].y,
                p->normal[i].z, (double)links->escape[i]);
    }
    return outfile_commit(file, err);
}

bool factors_write_patches(const Pipeline *pipeline, const char *matrix, const char *table,
                           Error *err)
{
    assert(pipeline->links != NULL && matrix != NULL && table != NULL);
    return write_matrix(pipeline->links, matrix, err) && write_patch_table(pipeline, table, err);
}
