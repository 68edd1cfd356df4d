/* SPDX-License-Identifier: BSD-3-Clause */
/* Form factors as NumPy arrays. */
#include "app/factors_files.h"

#include <assert.h>
#include <string.h>

#include "app/npz.h"
#include "base/array.h"

/* Larger matrices are written in single precision, half as long to write. */
enum { DOUBLE_MOST = 4096 };

typedef struct {
    const double *factor;
} FloatStream;

/* Doubles as 32-bit floats, from any byte on. */
static void read_floats(void *context, uint64_t at, void *buffer, size_t size)
{
    const double *factor = ((const FloatStream *)context)->factor;
    char *to = buffer;
    for (size_t done = 0; done < size;) {
        const float value = (float)factor[(at + done) / sizeof value];
        const size_t into = (at + done) % sizeof value, left = sizeof value - into;
        const size_t take = left < size - done ? left : size - done;
        memcpy(to + done, (const char *)&value + into, take);
        done += take;
    }
}

bool factors_write_npz(const Classes *classes, const double *factor, const char *path,
                       Error *err)
{
    const size_t n = classes->count;
    Npz *npz = npz_open(path, err);
    if (npz == NULL)
        return false;
    FloatStream stream = { factor };
    const bool matrix = n <= DOUBLE_MOST
                            ? npz_add(npz, "F", "<f8", n, n, factor, err)
                            : npz_add_stream(npz, "F", "<f4", n, n, read_floats, &stream, err);
    const bool added = matrix &&
                       (classes->error == NULL || n > DOUBLE_MOST ||
                        npz_add(npz, "standard_error", "<f8", n, n, classes->error, err)) &&
                       npz_add(npz, "area", "<f8", n, 0, classes->area, err) &&
                       npz_add(npz, "escaped", "<f8", n, 0, classes->escape, err) &&
                       npz_add(npz, "row_sum", "<f8", n, 0, classes->sum, err) &&
                       npz_add(npz, "raw_row_sum", "<f8", n, 0, classes->raw_sum, err) &&
                       npz_add(npz, "raw_escaped", "<f8", n, 0, classes->raw_escape, err) &&
                       npz_add(npz, "emissivity", "<f8", n, 0, classes->emissivity, err) &&
                       npz_add_words(npz, "names", classes->name, n, err);
    return npz_commit(npz, err) && added; /* after a failure it writes nothing */
}

/* Rows that a stream goes through before it lets go of mapped ones. */
enum { STREAM_ROWS = 1024 };

/* first[] of the links in the type that scipy takes for row pointers beside 32-bit indices. */
static int64_t *row_pointers(const Links *links, Error *err)
{
    int64_t *pointer = array_create((size_t)links->count + 1, sizeof *pointer, "matrix", err);
    for (uint32_t i = 0; pointer != NULL && i <= links->count; i++)
        pointer[i] = (int64_t)links->first[i];
    return pointer;
}

/* Centres in the file's coordinates. */
static bool add_centres(Npz *npz, const Pipeline *pipeline, Error *err)
{
    const Patches *p = pipeline->patches;
    _Static_assert(sizeof(Vec3) == 3 * sizeof(double), "a position is three doubles");
    Vec3 *centre = array_create(p->count, sizeof *centre, "patches", err);
    for (uint32_t i = 0; centre != NULL && i < p->count; i++)
        centre[i] = scene_to_file(pipeline->scene, p->centre[i]);
    return npz_give(npz, "centre", "<f8", p->count, 3, centre, err);
}

static bool add_patches(Npz *npz, const Pipeline *pipeline, Error *err)
{
    const Patches *p = pipeline->patches;
    const Links *links = pipeline->links;
    const size_t n = p->count;
    return npz_add(npz, "area", "<f8", n, 0, p->area, err) &&
           npz_add(npz, "visible_area", "<f8", n, 0, links->area, err) &&
           add_centres(npz, pipeline, err) &&
           npz_add(npz, "normal", "<f8", n, 3, p->normal, err) &&
           npz_add(npz, "group", "<u4", n, 0, p->group, err) &&
           npz_add(npz, "side", "|u1", n, 0, p->side, err) &&
           npz_add(npz, "escaped", "<f4", n, 0, links->escape, err) &&
           npz_add_words(npz, "group_names",
                         (const char *const *)pipeline->scene->polygons.group_name,
                         pipeline->scene->polygons.group_count, err);
}

/* Sources or factors of all rows in order, wherever they lie. */
typedef struct {
    const Links *links;
    LinksScratch scratch;
    bool         factors;
    uint32_t     row;    /* that the last byte was of */
} RowStream;

static void read_rows(void *context, uint64_t at, void *buffer, size_t size)
{
    RowStream *s = context;
    char *to = buffer;
    const uint64_t *first = s->links->first;
    _Static_assert(sizeof(float) == 4 && sizeof(uint32_t) == 4, "entries of four bytes");
    if (at == 0)
        s->row = 0;
    for (uint64_t done = 0; done < size;) {
        while (first[s->row + 1] * 4 <= at + done) {
            s->row++;
            if (s->row % STREAM_ROWS == 0)
                links_leave(s->links, s->row - STREAM_ROWS, s->row);
        }
        const LinksRow row = links_row(s->links, s->row, &s->scratch);
        const uint64_t into = at + done - first[s->row] * 4, left = row.count * 4 - into;
        const uint64_t take = left < size - done ? left : size - done;
        const char *from = s->factors ? (const char *)row.form_factor : (const char *)row.source;
        memcpy(to + done, from + into, take);
        done += take;
    }
}

/* What independent casts say of each row. */
static bool add_errors(Npz *npz, const LinksErrors *errors, Error *err)
{
    static const char *const name[] = { "row_sum_error", "escaped_error", "standard_error" };
    for (int k = 0; errors != NULL && k < 3; k++) {
        double *value = array_create(errors->count, sizeof *value, "standard errors", err);
        for (uint32_t i = 0; value != NULL && i < errors->count; i++)
            value[i] = k == 0   ? spread_error(&errors->sum[i], errors->casts)
                       : k == 1 ? spread_error(&errors->escape[i], errors->casts)
                                : links_row_error(errors, i);
        if (!npz_give(npz, name[k], "<f8", errors->count, 0, value, err))
            return false;
    }
    return true;
}

static bool add_matrix(Npz *npz, const Links *links, RowStream stream[2], Error *err)
{
    const size_t nonzeros = links->first[links->count];
    for (int k = 0; k < 2; k++) {
        stream[k] = (RowStream){ .links = links, .factors = k == 0 };
        if (!links_scratch_create(links, &stream[k].scratch, err))
            return false;
    }
    return npz_add_stream(npz, "data", "<f4", nonzeros, 0, read_rows, &stream[0], err) &&
           npz_add_stream(npz, "indices", "<i4", nonzeros, 0, read_rows, &stream[1], err) &&
           npz_give(npz, "indptr", "<i8", (size_t)links->count + 1, 0, row_pointers(links, err),
                    err);
}

bool factors_write_patches_npz(const Pipeline *pipeline, const LinksErrors *errors,
                               const char *path, Error *err)
{
    const Links *links = pipeline->links;
    const int64_t shape[2] = { links->count, links->count };
    RowStream stream[2] = { { .links = NULL }, { .links = NULL } };
    Npz *npz = npz_open(path, err);
    if (npz == NULL)
        return false;
    const bool added =
        add_matrix(npz, links, stream, err) &&
        npz_add(npz, "shape", "<i8", 2, 0, shape, err) &&
        npz_add(npz, "format", "|S3", SIZE_MAX, 0, "csr", err) && add_patches(npz, pipeline, err) &&
        add_errors(npz, errors, err);
    const bool good = npz_commit(npz, err) && added;
    links_scratch_clear(&stream[0].scratch);
    links_scratch_clear(&stream[1].scratch);
    return good;
}
