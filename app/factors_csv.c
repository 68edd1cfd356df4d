/* SPDX-License-Identifier: BSD-3-Clause */
/* Form factors as text: CSV and View3D's form by group or material; Matrix Market by patch. */
#include <assert.h>
#include <inttypes.h>
#include <string.h>

#include "app/classes.h"
#include "app/commands.h"
#include "app/csv.h"
#include "app/factors_files.h"
#include "app/place.h"
#include "base/array.h"
#include "base/file.h"

static void put_rows(FILE *out, FactorsBy by, const Classes *classes, const double *factor)
{
    const size_t n = classes->count;
    const bool open = classes->open && factor == classes->factor;
    fputs(by == BY_GROUP ? "group,area" : "material,area", out);
    for (size_t j = 0; j < n; j++) {
        fputc(',', out);
        csv_text(out, classes->name[j]);
    }
    fputs(open ? ",escaped\n" : "\n", out);
    for (size_t i = 0; i < n; i++) {
        csv_text(out, classes->name[i]);
        fprintf(out, ",%.9g", classes->area[i]);
        for (size_t j = 0; j < n; j++)
            fprintf(out, ",%.9g", factor[i * n + j]);
        if (open)
            fprintf(out, ",%.9g", classes->escape[i]);
        fputc('\n', out);
    }
}

bool factors_write_csv(const Classes *classes, FactorsBy by, const double *factor,
                       const char *path, Error *err)
{
    assert(by != BY_PATCH && classes != NULL && factor != NULL);
    OutFile *out = outfile_open(path, err);
    if (out == NULL)
        return false;
    put_rows(outfile_stream(out), by, classes, factor);
    return outfile_commit(out, err);
}

/* View3D's form: a line of what it is, areas, the matrix, emissivities. Its columns know no
 * surroundings: what escapes shows as a row that sums to less than 1. */
bool factors_write_view3d(const Classes *classes, const double *factor, bool script,
                          const char *path, Error *err)
{
    assert(classes != NULL && factor != NULL);
    OutFile *file = outfile_open(path, err);
    if (file == NULL)
        return false;
    FILE *out = outfile_stream(file);
    const size_t n = classes->count;
    fprintf(out, "View3D isolux-" ISOLUX_VERSION " 1 %d %d %zu\n", !classes->open, script, n);
    for (size_t i = 0; i < n; i++)
        fprintf(out, "%s%.9g", i > 0 ? " " : "", classes->area[i]);
    fputc('\n', out);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++)
            fprintf(out, "%s%.8f", j > 0 ? " " : "", factor[i * n + j]);
        fputc('\n', out);
    }
    for (size_t i = 0; i < n; i++)
        fprintf(out, "%s%.6g", i > 0 ? " " : "", classes->emissivity[i]);
    fputc('\n', out);
    return outfile_commit(file, err);
}

bool factors_write_flux(const Classes *classes, const double *temperature, const double *flux,
                        const char *path, Error *err)
{
    OutFile *file = outfile_open(path, err);
    if (file == NULL)
        return false;
    FILE *out = outfile_stream(file);
    fputs("group,area,emissivity,temperature,flux,power\n", out);
    for (size_t i = 0; i < classes->count; i++) {
        csv_text(out, classes->name[i]);
        fprintf(out, ",%.9g,%.6g,%.9g,%.9g,%.9g\n", classes->area[i], classes->emissivity[i],
                temperature[i], flux[i], flux[i] * classes->area[i]);
    }
    return outfile_commit(file, err);
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
    const Polygons *soup = &pipeline->scene->polygons;
    const Links *links = pipeline->links;
    OutFile *file = outfile_open(path, err);
    if (file == NULL)
        return false;
    FILE *out = outfile_stream(file);
    fputs("patch,group,material,surface,side,area,visible_area,x,y,z,nx,ny,nz,escaped\n", out);
    for (uint32_t i = 0; i < p->count; i++) {
        char centre[PLACE_TEXT];
        fprintf(out, "%" PRIu32 ",", i + 1);
        csv_text(out, soup->group_name[p->group[i]]);
        fputc(',', out);
        csv_text(out, soup->materials[p->material[i]].name);
        place_text(pipeline->scene, p->centre[i], 9, centre);
        fprintf(out, ",%" PRIu32 ",%s,%.9g,%.9g,%s,%.9g,%.9g,%.9g,%.9g\n", p->surface[i],
                p->side[i] == 0 ? "front" : "back", p->area[i], links->area[i], centre,
                p->normal[i].x, p->normal[i].y, p->normal[i].z, (double)links->escape[i]);
    }
    return outfile_commit(file, err);
}

bool factors_write_patches(const Pipeline *pipeline, const char *matrix, const char *table,
                           Error *err)
{
    assert(pipeline->links != NULL && matrix != NULL && table != NULL);
    return write_matrix(pipeline->links, matrix, err) && write_patch_table(pipeline, table, err);
}
