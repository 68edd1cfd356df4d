/* SPDX-License-Identifier: BSD-3-Clause */
/* Solved meshes out of PLY files that isolux wrote: known lines, then records of known size. */
#include "app/ply_read.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"

#define PLY_BEGIN "ply\nformat binary_little_endian 1.0\ncomment made by isolux "

static const size_t FILE_LIMIT = (size_t)16 << 30;

typedef struct {
    const uint8_t *at, *end;   /* not read yet */
    const char    *path;
    Error         *err;
} PlyBytes;

static bool foreign(const PlyBytes *in)
{
    return error_at(in->err, ERROR_INPUT, in->path, 0,
                    "not a solved mesh as this version of isolux solve writes it");
}

static bool cut_off(const PlyBytes *in, const char *what)
{
    return error_at(in->err, ERROR_INPUT, in->path, 0, "the file ends within its %s", what);
}

/* --- header ----------------------------------------------------------------------------------- */

/* Passes over `text` if it comes next. */
static bool take(PlyBytes *in, const char *text)
{
    const size_t length = strlen(text);
    if ((size_t)(in->end - in->at) < length || memcmp(in->at, text, length) != 0)
        return false;
    in->at += length;
    return true;
}

/* A number up to 2^32 - 2, without sign or leading blanks. */
static bool take_number(PlyBytes *in, uint32_t *number)
{
    uint64_t value = 0;
    const uint8_t *const begin = in->at;
    while (in->at < in->end && *in->at >= '0' && *in->at <= '9' && value < UINT32_MAX)
        value = 10 * value + (uint64_t)(*in->at++ - '0');
    *number = (uint32_t)value;
    return in->at > begin && value < UINT32_MAX;
}

/* What is left of the line; NULL when the file ends in it. */
static const uint8_t *take_line(PlyBytes *in)
{
    const uint8_t *const begin = in->at;
    const uint8_t *const end = memchr(begin, '\n', (size_t)(in->end - begin));
    in->at = end != NULL ? end + 1 : in->end;
    return end != NULL ? begin : NULL;
}

static bool add_group(SolvedMesh *mesh, PlyBytes *in)
{
    uint32_t number;
    if (!take_number(in, &number) || number != mesh->group_count || !take(in, " "))
        return foreign(in);
    const uint8_t *const name = take_line(in);
    if (name == NULL)
        return cut_off(in, "header");
    const size_t length = (size_t)(in->at - name) - 1;
    char *copy = array_create(length + 1, 1, "group names", in->err);
    if (copy == NULL || !array_reserve((void **)&mesh->group_name, &mesh->group_capacity,
                                       (size_t)number + 1, sizeof *mesh->group_name,
                                       "group names", in->err)) {
        array_free(copy);
        return false;
    }
    for (size_t i = 0; i < length; i++) /* said in messages: one line */
        copy[i] = name[i] < ' ' ? ' ' : (char)name[i];
    mesh->group_name[mesh->group_count++] = copy;
    return true;
}

/* The rest of a comment's line. */
static bool take_note(SolvedMesh *mesh, PlyBytes *in)
{
    char text[512];
    const uint8_t *const begin = take_line(in);
    if (begin == NULL)
        return cut_off(in, "header");
    const size_t length = (size_t)(in->at - begin) - 1;
    if (length >= sizeof text)
        return true;
    for (size_t i = 0; i < length; i++)
        text[i] = begin[i] < ' ' ? ' ' : (char)begin[i];
    text[length] = '\0';
    return ply_notes_take(&mesh->notes, text, in->err);
}

/* *count_bytes: of the number that precedes a face's corners. */
static bool parse_header(SolvedMesh *mesh, PlyBytes *in, unsigned *count_bytes)
{
    if (!take(in, PLY_BEGIN))
        return foreign(in);
    if (take_line(in) == NULL)
        return cut_off(in, "header");
    while (take(in, "comment ")) {
        if (take(in, "group ") ? !add_group(mesh, in) : !take_note(mesh, in))
            return error_is_set(in->err) ? false : cut_off(in, "header");
    }
    if (!take(in, "element vertex ") || !take_number(in, &mesh->vertex_count) ||
        !take(in, "\n") ||
        !((mesh->far = take(in, PLY_DOUBLES)) || take(in, PLY_FLOATS)) ||
        !take(in, PLY_VERTEX_LAYOUT "element face ") ||
        !take_number(in, &mesh->face_count) || !take(in, "\nproperty list "))
        return foreign(in);
    *count_bytes = take(in, "uchar") ? 1 : take(in, "ushort") ? 2 : 0;
    if (*count_bytes == 0 || !take(in, " int vertex_indices\n" PLY_FACE_LAYOUT "end_header\n"))
        return foreign(in);
    return true;
}

/* --- body ------------------------------------------------------------------------------------- */

static uint32_t get_bytes(const uint8_t *at, unsigned bytes)
{
    uint32_t value = 0;
    for (unsigned i = 0; i < bytes; i++)
        value |= (uint32_t)at[i] << 8 * i;
    return value;
}

static double get_float(const uint8_t *at)
{
    const uint32_t bits = get_bytes(at, 4);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

static bool get_bands(const uint8_t *at, double *value)
{
    bool good = true;
    for (int band = 0; band < 3; band++) {
        value[band] = get_float(at + 4 * band);
        good = good && isfinite(value[band]);
    }
    return good;
}

static bool get_doubles(const uint8_t *at, double *value)
{
    bool good = true;
    for (int k = 0; k < 3; k++, at += 8) {
        const uint64_t bits = get_bytes(at, 4) | (uint64_t)get_bytes(at + 4, 4) << 32;
        memcpy(&value[k], &bits, sizeof bits);
        good = good && isfinite(value[k]);
    }
    return good;
}

static bool odd_number(const PlyBytes *in, const char *what, uint32_t number)
{
    return error_at(in->err, ERROR_INPUT, in->path, 0, "%s %u holds a number out of range", what,
                    number);
}

static bool parse_vertices(SolvedMesh *mesh, PlyBytes *in)
{
    const uint32_t n = mesh->vertex_count;
    const size_t place = mesh->far ? 24 : 12;
    if ((size_t)(in->end - in->at) / (place + PLY_VERTEX_BYTES) < n)
        return cut_off(in, "vertices");
    mesh->position = array_create(n, sizeof *mesh->position, "vertices", in->err);
    mesh->radiosity = array_create(3 * (size_t)n, sizeof *mesh->radiosity, "vertices", in->err);
    mesh->irradiance = array_create(3 * (size_t)n, sizeof *mesh->irradiance, "vertices", in->err);
    if (error_is_set(in->err))
        return false;
    for (uint32_t i = 0; i < n; i++, in->at += PLY_VERTEX_BYTES) {
        double p[3];
        const bool known = mesh->far ? get_doubles(in->at, p) : get_bands(in->at, p);
        in->at += place;
        if (!known ||
            !get_bands(in->at + PLY_VERTEX_RADIOSITY, mesh->radiosity + 3 * (size_t)i) ||
            !get_bands(in->at + PLY_VERTEX_IRRADIANCE, mesh->irradiance + 3 * (size_t)i))
            return odd_number(in, "vertex", i);
        mesh->position[i] = vec3(p[0], p[1], p[2]);
    }
    return true;
}

/* Where faces and corners begin; *corners gets their total. */
static bool count_corners(SolvedMesh *mesh, const PlyBytes *in, unsigned count_bytes)
{
    const uint8_t *at = in->at;
    uint64_t corners = 0;
    for (uint32_t i = 0; i < mesh->face_count; i++) {
        if ((size_t)(in->end - at) < count_bytes)
            return cut_off(in, "faces");
        const uint32_t n = get_bytes(at, count_bytes);
        const size_t bytes = count_bytes + 4 * (size_t)n + PLY_FACE_BYTES;
        if ((size_t)(in->end - at) < bytes)
            return cut_off(in, "faces");
        corners += n;
        if (n < 3 || corners > UINT32_MAX)
            return odd_number(in, "face", i);
        mesh->first_corner[i + 1] = (uint32_t)corners;
        at += bytes;
    }
    return true;
}

static bool allocate_faces(SolvedMesh *mesh, Error *err)
{
    const size_t n = mesh->face_count;
    mesh->first_corner = array_create(n + 1, sizeof *mesh->first_corner, "faces", err);
    mesh->patch = array_create(n, sizeof *mesh->patch, "faces", err);
    mesh->group = array_create(n, sizeof *mesh->group, "faces", err);
    mesh->material = array_create(n, sizeof *mesh->material, "faces", err);
    mesh->side = array_create(n, sizeof *mesh->side, "faces", err);
    mesh->area = array_create(n, sizeof *mesh->area, "faces", err);
    mesh->whole_area = array_create(n, sizeof *mesh->whole_area, "faces", err);
    mesh->face_radiosity = array_create(3 * n, sizeof *mesh->face_radiosity, "faces", err);
    mesh->face_reflectance = array_create(3 * n, sizeof *mesh->face_reflectance, "faces", err);
    mesh->face_irradiance = array_create(3 * n, sizeof *mesh->face_irradiance, "faces", err);
    return !error_is_set(err);
}

/* What stands behind a face's corners. */
static bool parse_face(SolvedMesh *mesh, const uint8_t *at, uint32_t face)
{
    const uint32_t side = get_bytes(at + PLY_FACE_SIDE, 4);
    const double area = get_float(at + PLY_FACE_AREA), visible = get_float(at + PLY_FACE_VISIBLE);
    mesh->patch[face] = get_bytes(at + PLY_FACE_PATCH, 4);
    mesh->group[face] = get_bytes(at + PLY_FACE_GROUP, 4);
    mesh->material[face] = get_bytes(at + PLY_FACE_MATERIAL, 4);
    mesh->side[face] = side == 1;
    mesh->whole_area[face] = area;
    mesh->area[face] = visible;
    return side <= 1 && mesh->group[face] < mesh->group_count && isfinite(area) &&
           area >= 0 && visible >= 0 && isfinite(visible) &&
           get_bands(at + PLY_FACE_RADIOSITY, mesh->face_radiosity + 3 * (size_t)face) &&
           get_bands(at + PLY_FACE_REFLECTANCE, mesh->face_reflectance + 3 * (size_t)face) &&
           get_bands(at + PLY_FACE_IRRADIANCE, mesh->face_irradiance + 3 * (size_t)face);
}

static bool parse_faces(SolvedMesh *mesh, PlyBytes *in, unsigned count_bytes)
{
    const size_t least = count_bytes + 3 * 4 + PLY_FACE_BYTES;
    if ((size_t)(in->end - in->at) / least < mesh->face_count)
        return cut_off(in, "faces");
    if (!allocate_faces(mesh, in->err) || !count_corners(mesh, in, count_bytes))
        return false;
    const uint32_t corners = mesh->first_corner[mesh->face_count];
    mesh->corner = array_create(corners, sizeof *mesh->corner, "faces", in->err);
    if (mesh->corner == NULL)
        return false;
    for (uint32_t i = 0; i < mesh->face_count; i++) {
        in->at += count_bytes;
        for (uint32_t k = mesh->first_corner[i]; k < mesh->first_corner[i + 1]; k++) {
            mesh->corner[k] = get_bytes(in->at, 4);
            in->at += 4;
            if (mesh->corner[k] >= mesh->vertex_count)
                return odd_number(in, "face", i);
        }
        if (!parse_face(mesh, in->at, i))
            return odd_number(in, "face", i);
        in->at += PLY_FACE_BYTES;
    }
    if (in->at != in->end)
        return error_at(in->err, ERROR_INPUT, in->path, 0, "the file goes on after its last face");
    return true;
}

/* --- whole ------------------------------------------------------------------------------------ */

bool solved_mesh_parse(SolvedMesh *mesh, const uint8_t *bytes, size_t size, const char *path,
                       Error *err)
{
    assert(mesh != NULL && (bytes != NULL || size == 0) && mesh->position == NULL);
    PlyBytes in = { bytes, bytes + size, path, err };
    unsigned count_bytes = 0;
    return parse_header(mesh, &in, &count_bytes) && parse_vertices(mesh, &in) &&
           parse_faces(mesh, &in, count_bytes);
}

bool solved_mesh_read(SolvedMesh *mesh, const char *path, Error *err)
{
    size_t size;
    char *bytes = file_read(path, FILE_LIMIT, &size, err);
    if (bytes == NULL)
        return false;
    const bool good = solved_mesh_parse(mesh, (const uint8_t *)bytes, size, path, err);
    array_free(bytes);
    return good;
}

bool solved_mesh_is(const char *path)
{
    char begin[sizeof PLY_BEGIN - 1];
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        return false;
    const bool is = fread(begin, 1, sizeof begin, file) == sizeof begin &&
                    memcmp(begin, PLY_BEGIN, sizeof begin) == 0;
    fclose(file);
    return is;
}

void solved_mesh_move(SolvedMesh *mesh, Vec3 by)
{
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        mesh->position[i] = vec3_sub(mesh->position[i], by);
}

void solved_mesh_clear(SolvedMesh *mesh)
{
    for (uint32_t i = 0; i < mesh->group_count; i++)
        array_free(mesh->group_name[i]);
    array_free(mesh->group_name);
    array_free(mesh->position);
    array_free(mesh->radiosity);
    array_free(mesh->irradiance);
    array_free(mesh->first_corner);
    array_free(mesh->corner);
    array_free(mesh->patch);
    array_free(mesh->group);
    array_free(mesh->material);
    array_free(mesh->side);
    array_free(mesh->whole_area);
    array_free(mesh->face_radiosity);
    array_free(mesh->face_reflectance);
    ply_notes_clear(&mesh->notes);
    array_free(mesh->area);
    array_free(mesh->face_irradiance);
    *mesh = (SolvedMesh){ 0 };
}
