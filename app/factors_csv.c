/* SPDX-License-Identifier: BSD-3-Clause */
/* Form factors as text: CSV and View3D's form by group or material; Matrix Market by patch. */
#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "app/classes.h"
#include "app/commands.h"
#include "app/csv.h"
#include "app/digits.h"
#include "app/factors_files.h"
#include "app/place.h"
#include "base/array.h"
#include "base/file.h"

/* The whole buffer is too large for a thread's stack with small limits. */
static Digits *digits_open(OutFile *file, Error *err)
{
    Digits *digits = array_create(1, sizeof *digits, "a matrix as text", err);
    if (digits != NULL)
        digits->out = outfile_stream(file);
    return digits;
}

static bool digits_close(Digits *digits, OutFile *file, Error *err)
{
    if (digits == NULL) {
        outfile_discard(file);
        return false;
    }
    digits_flush(digits);
    array_free(digits);
    return outfile_commit(file, err);
}

/* A group's name; one that is the name of a column of the table's own gets a word more, in rows and
 * columns, so that each column is there once. */
static void put_name(FILE *out, FactorsBy by, const char *name)
{
    static const char *const own[] = { "area", "escaped", "group", "material" };
    char longer[32];
    for (size_t k = 0; k < sizeof own / sizeof *own; k++)
        if (strcmp(name, own[k]) == 0) {
            snprintf(longer, sizeof longer, "%s (%s)", name,
                     by == BY_GROUP ? "group" : "material");
            name = longer;
            break;
        }
    csv_text(out, name);
}

static void put_rows(Digits *d, FactorsBy by, const Classes *classes, const double *factor)
{
    const size_t n = classes->count;
    const bool open = classes->open && factor == classes->factor;
    assert(factor != NULL);
    fputs(by == BY_GROUP ? "group,area" : "material,area", d->out);
    for (size_t j = 0; j < n; j++) {
        fputc(',', d->out);
        put_name(d->out, by, classes->name[j]);
    }
    fputs(open ? ",escaped\n" : "\n", d->out);
    for (size_t i = 0; i < n; i++) {
        put_name(d->out, by, classes->name[i]);
        digits_letter(d, ',');
        digits_number(d, classes->area[i]);
        for (size_t j = 0; j < n; j++) {
            digits_letter(d, ',');
            digits_number(d, factor[i * n + j]);
        }
        if (open) {
            digits_letter(d, ',');
            digits_number(d, classes->escape[i]);
        }
        digits_letter(d, '\n');
        digits_flush(d);
    }
}

bool factors_write_csv(const Classes *classes, FactorsBy by, const double *factor,
                       const char *path, Error *err)
{
    assert(by != BY_PATCH && classes != NULL && factor != NULL);
    OutFile *out = outfile_open(path, err);
    if (out == NULL)
        return false;
    Digits *digits = digits_open(out, err);
    if (digits != NULL)
        put_rows(digits, by, classes, factor);
    return digits_close(digits, out, err);
}

bool factors_write_class_mtx(const Classes *classes, const double *factor, const char *path,
                             Error *err)
{
    OutFile *file = outfile_open(path, err);
    if (file == NULL)
        return false;
    const size_t n = classes->count;
    uint64_t nonzeros = 0;
    Digits *d = digits_open(file, err);
    for (size_t k = 0; k < n * n; k++)
        nonzeros += factor[k] != 0;
    fputs("%%MatrixMarket matrix coordinate real general\n% row, name, area, escaped\n",
          outfile_stream(file));
    for (size_t i = 0; i < n; i++) {
        fprintf(outfile_stream(file), "%% %zu,", i + 1);
        csv_text(outfile_stream(file), classes->name[i]);
        fprintf(outfile_stream(file), ",%.9g,%.9g\n", classes->area[i], classes->escape[i]);
    }
    fprintf(outfile_stream(file), "%zu %zu %" PRIu64 "\n", n, n, nonzeros);
    for (size_t k = 0; d != NULL && k < n * n; k++)
        if (factor[k] != 0) {
            digits_count(d, k / n + 1);
            digits_letter(d, ' ');
            digits_count(d, k % n + 1);
            digits_letter(d, ' ');
            digits_number(d, factor[k]);
            digits_letter(d, '\n');
        }
    return digits_close(d, file, err);
}

bool factors_write_class_rows(const Classes *classes, FactorsBy by, const char *path, Error *err)
{
    OutFile *file = outfile_open(path, err);
    if (file == NULL)
        return false;
    FILE *out = outfile_stream(file);
    fprintf(out, "%s,area,row_sum,escaped,raw_row_sum,raw_escaped%s\n",
            by == BY_GROUP ? "group" : "material",
            classes->error != NULL ? ",standard_error" : "");
    for (size_t i = 0; i < classes->count; i++) {
        csv_text(out, classes->name[i]);
        fprintf(out, ",%.9g,%.9g,%.9g,%.9g,%.9g", classes->area[i], classes->sum[i],
                classes->escape[i], classes->raw_sum[i], classes->raw_escape[i]);
        double worst = 0;
        for (size_t j = 0; classes->error != NULL && j < classes->count; j++)
            worst = fmax(worst, classes->error[i * classes->count + j]);
        if (classes->error != NULL)
            fprintf(out, ",%.3g", worst);
        fputc('\n', out);
    }
    return outfile_commit(file, err);
}

/* The first line is filled up with blanks to this length; its readers allow 34. Its first number
 * says that what follows is text. */
enum { HEADING_LETTERS = 30 };

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
    char heading[64];
    snprintf(heading, sizeof heading, "View3D isolux-" ISOLUX_VERSION " 0 %d %d %zu",
             !classes->open, script, n);
    fprintf(out, "%-*s\n", HEADING_LETTERS, heading);
    for (size_t i = 0; i < n; i++)
        fprintf(out, "%s%.9g", i > 0 ? " " : "", classes->area[i]);
    fputc('\n', out);
    Digits *d = digits_open(file, err);
    for (size_t k = 0; d != NULL && k < n * n; k++) {
        digits_number(d, factor[k]);
        digits_letter(d, (k + 1) % n == 0 ? '\n' : ' ');
    }
    if (d != NULL)
        digits_flush(d);
    for (size_t i = 0; i < n; i++)
        fprintf(out, "%s%.6g", i > 0 ? " " : "", classes->emissivity[i]);
    fputc('\n', out);
    return digits_close(d, file, err);
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
    fprintf(outfile_stream(file), "%%%%MatrixMarket matrix coordinate real general\n"
            "%% form factor from the row's patch to the column's; patches count from 1\n"
            "%" PRIu32 " %" PRIu32 " %" PRIu64 "\n",
            links->count, links->count, links->first[links->count]);
    LinksScratch scratch = { NULL, NULL };
    Digits *d = digits_open(file, err);
    const bool good = links_scratch_create(links, &scratch, err);
    for (uint32_t i = 0; good && d != NULL && i < links->count; i++) {
        const LinksRow row = links_row(links, i, &scratch);
        for (uint64_t k = 0; k < row.count; k++) {
            digits_count(d, (uint64_t)i + 1);
            digits_letter(d, ' ');
            digits_count(d, (uint64_t)row.source[k] + 1);
            digits_letter(d, ' ');
            digits_number(d, row.form_factor[k]);
            digits_letter(d, '\n');
        }
        links_leave(links, i, i + 1);
    }
    links_scratch_clear(&scratch);
    return digits_close(d, file, err) && good;
}

/* The sum of a row, what escapes included. */
static double row_sum(const Links *links, uint32_t i, LinksScratch *scratch)
{
    const LinksRow row = links_row(links, i, scratch);
    double sum = links->escape[i];
    for (uint64_t k = 0; k < row.count; k++)
        sum += row.form_factor[k];
    links_leave(links, i, i + 1);
    return sum;
}

static void put_row_errors(FILE *out, const LinksErrors *errors, uint32_t i)
{
    fprintf(out, ",%.3g,%.3g,%.3g", spread_error(&errors->sum[i], errors->casts),
            spread_error(&errors->escape[i], errors->casts), links_row_error(errors, i));
}

static bool write_patch_table(const Pipeline *pipeline, const LinksErrors *errors,
                              const char *path, Error *err)
{
    const Patches *p = pipeline->patches;
    const Polygons *soup = &pipeline->scene->polygons;
    const Links *links = pipeline->links;
    OutFile *file = outfile_open(path, err);
    if (file == NULL)
        return false;
    FILE *out = outfile_stream(file);
    const Links *raw = pipeline->raw_links != NULL ? pipeline->raw_links : links;
    LinksScratch scratch;
    if (!links_scratch_create(links, &scratch, err)) {
        outfile_discard(file);
        return false;
    }
    fprintf(out, "patch,group,material,surface,side,area,visible_area,x,y,z,nx,ny,nz,escaped,"
            "row_sum,raw_row_sum,raw_escaped%s\n",
            errors != NULL ? ",row_sum_error,escaped_error,standard_error" : "");
    for (uint32_t i = 0; i < p->count; i++) {
        char centre[PLACE_TEXT];
        fprintf(out, "%" PRIu32 ",", i + 1);
        csv_text(out, soup->group_name[p->group[i]]);
        fputc(',', out);
        csv_text(out, soup->materials[p->material[i]].name);
        place_text(pipeline->scene, p->centre[i], 9, centre);
        fprintf(out, ",%" PRIu32 ",%s,%.9g,%.9g,%s,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g",
                p->surface[i], p->side[i] == 0 ? "front" : "back", p->area[i], links->area[i],
                centre,
                p->normal[i].x, p->normal[i].y, p->normal[i].z, (double)links->escape[i],
                row_sum(links, i, &scratch), row_sum(raw, i, &scratch), (double)raw->escape[i]);
        if (errors != NULL)
            put_row_errors(out, errors, i);
        fputc('\n', out);
    }
    links_scratch_clear(&scratch);
    return outfile_commit(file, err);
}

bool factors_write_patches(const Pipeline *pipeline, const LinksErrors *errors, const char *matrix,
                           const char *table, Error *err)
{
    assert(pipeline->links != NULL && matrix != NULL && table != NULL);
    return write_matrix(pipeline->links, matrix, err) &&
           write_patch_table(pipeline, errors, table, err);
}

bool factors_write_errors(const LinksErrors *errors, const char *path, Error *err)
{
    OutFile *file = outfile_open(path, err);
    if (file == NULL)
        return false;
    fprintf(outfile_stream(file), "%%%%MatrixMarket matrix coordinate real general\n"
            "%% standard error of the form factor from the row's patch to the column's\n"
            "%" PRIu32 " %" PRIu32 " %" PRIu64 "\n",
            errors->count, errors->count, errors->begin[errors->count]);
    Digits *d = digits_open(file, err);
    for (uint32_t i = 0; d != NULL && i < errors->count; i++)
        for (uint64_t k = errors->begin[i]; k < errors->begin[i + 1]; k++) {
            const LinksPair *pair = &errors->pair[k];
            digits_count(d, (uint64_t)i + 1);
            digits_letter(d, ' ');
            digits_count(d, (uint64_t)pair->source + 1);
            digits_letter(d, ' ');
            digits_number(d, links_pair_error(errors, pair));
            digits_letter(d, '\n');
        }
    return digits_close(d, file, err);
}
