/* SPDX-License-Identifier: BSD-3-Clause */
/* The marked mesh as PLY, binary little endian. */
#include "app/marked.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/place.h"
#include "app/ply_read.h"
#include "base/array.h"
#include "base/file.h"

/* Cells of a curved face, along and across. */
enum { CELLS_U = 24, CELLS_V = 12, CELLS = CELLS_U * CELLS_V };
enum { CELL_VERTICES = (CELLS_U + 1) * (CELLS_V + 1) };

/* By kind; of several on a face the one with the highest rank shows. */
static const struct {
    unsigned char colour[3];
    unsigned char rank;
    const char   *name;
} marks[DEFECT_KINDS] = {
    [DEFECT_DEGENERATE] = { { 128, 128, 0 }, 16, "olive" },
    [DEFECT_NONFINITE] = { { 0, 0, 0 }, 20, "black" },
    [DEFECT_DUPLICATE] = { { 255, 128, 0 }, 10, "orange" },
    [DEFECT_BACK_TO_BACK] = { { 205, 190, 150 }, 2, "sand" },
    [DEFECT_NONPLANAR] = { { 150, 75, 0 }, 6, "brown" },
    [DEFECT_CROSSING] = { { 110, 0, 60 }, 17, "wine" },
    [DEFECT_NONMANIFOLD] = { { 0, 90, 255 }, 7, "blue" },
    [DEFECT_T_JUNCTION] = { { 0, 200, 200 }, 4, "cyan" },
    [DEFECT_WINDING] = { { 255, 220, 0 }, 7, "yellow" },
    [DEFECT_UNORIENTABLE] = { { 200, 255, 0 }, 15, "lime" },
    [DEFECT_REFUSED] = { { 255, 150, 200 }, 5, "pink" },
    [DEFECT_OPEN_EDGE] = { { 150, 200, 255 }, 3, "light blue" },
    [DEFECT_INTERSECTION] = { { 230, 0, 0 }, 14, "red" },
    [DEFECT_OVERLAP] = { { 255, 0, 255 }, 13, "magenta" },
    [DEFECT_INSIDE_SOLID] = { { 120, 0, 220 }, 19, "violet" },
    [DEFECT_MATERIAL] = { { 255, 80, 120 }, 11, "rose" },
    [DEFECT_CUT] = { { 170, 190, 150 }, 1, "grey green" },
    [DEFECT_COVERED] = { { 0, 110, 40 }, 9, "dark green" },
    [DEFECT_COVERED_PART] = { { 0, 190, 90 }, 8, "green" },
    [DEFECT_CONTACT_LEFT] = { { 90, 120, 140 }, 12, "slate" },
};
static const unsigned char clean[3] = { 170, 170, 170 };
static const unsigned char edge_colour[3] = { 0, 60, 255 };

typedef struct {
    const Check *check;
    FILE        *out;
    uint8_t     *mark;     /* [faces]  kind + 1 of what is shown, 0: clean */
    uint8_t     *repaired; /* [faces]  that was repaired */
    uint32_t     vertices; /* of polygons and curved faces, before those of edges */
    bool         wide;     /* some face has more than 255 corners */
} Marked;

/* --- what to show ----------------------------------------------------------------------------- */

static void mark_face(Marked *m, uint32_t face, DefectKind kind, bool repaired)
{
    const unsigned shown = m->mark[face];
    if (shown != 0 && marks[shown - 1].rank > marks[kind].rank)
        return;
    m->repaired[face] = repaired && (shown != (unsigned)kind + 1 || m->repaired[face]);
    m->mark[face] = (uint8_t)(kind + 1);
}

/* All faces of a buried part, not only its first, which is in the list. */
static bool mark_buried(Marked *m, Error *err)
{
    const Surfaces   *s = m->check->pipeline->surfaces;
    const Inspection *found = &m->check->inspection;
    uint8_t          *buried = array_create(found->parts, 1, "parts", err);
    for (uint32_t p = 0; buried != NULL && p < found->parts; p++)
        buried[p] = m->mark[s->surface[found->part[p].first].face] == DEFECT_INSIDE_SOLID + 1;
    for (uint32_t k = 0; buried != NULL && k < s->triangle_count; k++)
        if (buried[s->part[s->triangle_surface[k]]])
            mark_face(m, s->triangle_face[k], DEFECT_INSIDE_SOLID, false);
    array_free(buried);
    return buried != NULL;
}

static bool choose_marks(Marked *m, size_t faces, Error *err)
{
    const Defects *list = &m->check->pipeline->defects;
    m->mark = array_create(faces, 1, "faces", err);
    m->repaired = array_create(faces, 1, "faces", err);
    if (error_is_set(err))
        return false;
    for (size_t i = 0; i < list->count; i++) {
        const Defect *d = &list->item[i];
        assert(d->face < faces);
        mark_face(m, d->face, d->kind, d->repaired);
        if (d->other != DEFECT_NO_FACE && d->kind != DEFECT_INSIDE_SOLID)
            mark_face(m, d->other, d->kind, d->repaired);
    }
    return mark_buried(m, err);
}

static const unsigned char *face_colour(const Marked *m, size_t face)
{
    return m->mark[face] != 0 ? marks[m->mark[face] - 1].colour : clean;
}

/* --- bytes, whatever the machine's own order -------------------------------------------------- */

typedef struct {
    unsigned char byte[64];
    size_t        size;
} Record;

static void put_bytes(Record *record, uint32_t value, int bytes)
{
    assert(record->size + (size_t)bytes <= sizeof record->byte);
    for (int i = 0; i < bytes; i++)
        record->byte[record->size++] = (unsigned char)(value >> 8 * i);
}

static void put_colour(Record *record, const unsigned char colour[3])
{
    for (int k = 0; k < 3; k++)
        put_bytes(record, colour[k], 1);
}

static void write_record(FILE *out, Record *record)
{
    fwrite(record->byte, 1, record->size, out);
    record->size = 0;
}

static void write_vertex(const Marked *m, Vec3 p, const unsigned char colour[3])
{
    const Scene *scene = m->check->pipeline->scene;
    const Vec3   place = scene_to_file(scene, p);
    Record       record = { .size = 0 };
    for (int k = 0; k < 3; k++) {
        const double value = vec3_axis(place, k);
        const float  single = (float)value;
        uint64_t     bits = 0;
        if (place_is_far(scene))
            memcpy(&bits, &value, sizeof value);
        else
            memcpy(&bits, &single, sizeof single);
        put_bytes(&record, (uint32_t)bits, 4);
        if (place_is_far(scene))
            put_bytes(&record, (uint32_t)(bits >> 32), 4);
    }
    put_colour(&record, colour);
    write_record(m->out, &record);
}

/* --- header ----------------------------------------------------------------------------------- */

static void put_legend(const Marked *m)
{
    const Defects *d = &m->check->pipeline->defects;
    fprintf(m->out, "comment %u %u %u grey: clean\n", clean[0], clean[1], clean[2]);
    for (int k = 0; k < DEFECT_KINDS; k++)
        fprintf(m->out, "comment %u %u %u %s: %s, defect %d, found %" PRIu64 ", repaired %" PRIu64
                "\n", marks[k].colour[0], marks[k].colour[1], marks[k].colour[2], marks[k].name,
                defect_name((DefectKind)k), k, d->found[k], d->repaired[k]);
    fputs("comment edges: open edges, dark blue\n"
          "comment defect 255: none; of several on a face the worst one shows\n"
          "comment repaired 1: isolux has mended it, here it is as in the file\n", m->out);
}

/* Names may hold anything; a comment ends with its line. */
static void put_names(const Marked *m)
{
    const Polygons *soup = &m->check->pipeline->scene->polygons;
    for (size_t i = 0; i < soup->group_count; i++) {
        fprintf(m->out, "comment group %zu ", i);
        for (const char *c = soup->group_name[i]; *c != '\0'; c++)
            fputc((unsigned char)*c < ' ' ? ' ' : *c, m->out);
        fputc('\n', m->out);
    }
}

static void put_header(const Marked *m)
{
    const Polygons *soup = &m->check->pipeline->scene->polygons;
    const uint64_t  edges = m->check->inspection.open_edges;
    const uint64_t  faces = soup->polygon_count + (uint64_t)CELLS * soup->shape_count;
    fputs("ply\nformat binary_little_endian 1.0\ncomment made by isolux " ISOLUX_VERSION "\n",
          m->out);
    put_legend(m);
    put_names(m);
    fprintf(m->out, "element vertex %" PRIu64 "\n", m->vertices + 2 * edges);
    fputs(place_is_far(m->check->pipeline->scene) ? PLY_DOUBLES : PLY_FLOATS, m->out);
    fputs("property uchar red\nproperty uchar green\nproperty uchar blue\n", m->out);
    fprintf(m->out, "element face %" PRIu64 "\nproperty list %s int vertex_indices\n", faces,
            m->wide ? "int" : "uchar");
    fputs("property uchar red\nproperty uchar green\nproperty uchar blue\n"
          "property uchar defect\nproperty uchar repaired\nproperty int group\n", m->out);
    fprintf(m->out, "element edge %" PRIu64 "\nproperty int vertex1\nproperty int vertex2\n",
            edges);
    fputs("property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n", m->out);
}

/* --- body ------------------------------------------------------------------------------------- */

/* Each face has corners of its own, so that programs which know only colours of vertices show the
 * faces' all the same. What is not a number would spoil the whole picture: such a corner is put
 * where the scene begins. */
static void put_vertices(const Marked *m)
{
    const Pipeline *pipeline = m->check->pipeline;
    const Polygons *soup = &pipeline->scene->polygons;
    for (size_t f = 0; f < soup->polygon_count; f++)
        for (uint32_t i = soup->first[f]; i < soup->first[f + 1]; i++) {
            const Vec3 p = soup->position[soup->corner[i]];
            write_vertex(m, vec3_finite(p) ? p : pipeline->surfaces->lo, face_colour(m, f));
        }
    for (size_t k = 0; k < soup->shape_count; k++)
        for (int i = 0; i < CELL_VERTICES; i++) {
            const double u = (double)(i % (CELLS_U + 1)) / CELLS_U;
            const double v = (double)(i / (CELLS_U + 1)) / CELLS_V;
            write_vertex(m, shape_point(&soup->shape[k].shape, u, v),
                         face_colour(m, soup->polygon_count + k));
        }
    for (uint64_t i = 0; i < m->check->inspection.open_edges; i++) {
        const OpenEdge *e = &m->check->inspection.edge[i];
        write_vertex(m, pipeline->surfaces->position[e->from], edge_colour);
        write_vertex(m, pipeline->surfaces->position[e->to], edge_colour);
    }
}

static void put_face_end(const Marked *m, Record *record, size_t face, uint32_t group)
{
    put_colour(record, face_colour(m, face));
    put_bytes(record, m->mark[face] != 0 ? m->mark[face] - 1u : 255, 1);
    put_bytes(record, m->repaired[face], 1);
    put_bytes(record, group, 4);
    write_record(m->out, record);
}

static void put_faces(const Marked *m)
{
    const Polygons *soup = &m->check->pipeline->scene->polygons;
    const int       wide = m->wide ? 4 : 1;
    Record          record = { .size = 0 };
    for (size_t f = 0; f < soup->polygon_count; f++) {
        put_bytes(&record, soup->first[f + 1] - soup->first[f], wide);
        for (uint32_t i = soup->first[f]; i < soup->first[f + 1]; i++) {
            put_bytes(&record, i, 4);
            write_record(m->out, &record);
        }
        put_face_end(m, &record, f, soup->group[f]);
    }
    for (size_t k = 0; k < soup->shape_count; k++)
        for (uint32_t i = 0; i < CELLS; i++) {
            const uint32_t base = m->vertices - CELL_VERTICES * (uint32_t)(soup->shape_count - k);
            const uint32_t at = base + i / CELLS_U * (CELLS_U + 1) + i % CELLS_U;
            put_bytes(&record, 4, wide);
            put_bytes(&record, at, 4);
            put_bytes(&record, at + 1, 4);
            put_bytes(&record, at + CELLS_U + 2, 4);
            put_bytes(&record, at + CELLS_U + 1, 4);
            put_face_end(m, &record, soup->polygon_count + k, soup->shape[k].group);
        }
}

static void put_edges(const Marked *m)
{
    Record record = { .size = 0 };
    for (uint32_t i = 0; i < m->check->inspection.open_edges; i++) {
        put_bytes(&record, m->vertices + 2 * i, 4);
        put_bytes(&record, m->vertices + 2 * i + 1, 4);
        put_colour(&record, edge_colour);
        write_record(m->out, &record);
    }
}

static bool prepare(Marked *m, Error *err)
{
    const Polygons *soup = &m->check->pipeline->scene->polygons;
    const uint64_t  corners = soup->polygon_count > 0 ? soup->first[soup->polygon_count] : 0;
    const uint64_t  vertices = corners + (uint64_t)CELL_VERTICES * soup->shape_count;
    if (vertices + 2 * m->check->inspection.open_edges > INT32_MAX)
        return error_set(err, ERROR_FAILED, "the marked mesh has more vertices than PLY can count");
    for (size_t f = 0; f < soup->polygon_count; f++)
        m->wide = m->wide || soup->first[f + 1] - soup->first[f] > UINT8_MAX;
    m->vertices = (uint32_t)vertices;
    return choose_marks(m, soup->polygon_count + soup->shape_count, err);
}

bool marked_write(const Check *check, const char *path, Error *err)
{
    assert(check != NULL && path != NULL && err != NULL);
    Marked   m = { .check = check };
    OutFile *file = prepare(&m, err) ? outfile_open(path, err) : NULL;
    if (file != NULL) {
        m.out = outfile_stream(file);
        put_header(&m);
        put_vertices(&m);
        put_faces(&m);
        put_edges(&m);
    }
    array_free(m.mark);
    array_free(m.repaired);
    return file != NULL && outfile_commit(file, err);
}
