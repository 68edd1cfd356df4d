/* SPDX-License-Identifier: BSD-3-Clause */
/* Connected triangles to surfaces: numbers, neighbours, stitches, parts. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "mesh/internal.h"
#include "mesh/triangulate.h"

typedef struct {
    const Polygons   *soup;
    const Pieces     *pieces;
    const Connection *connection;
    Repair           *repair;
    uint32_t         *slot;  /* [3 * pieces]  4 * surface + edge of a use; inside: none */
    Surfaces         *out;
} Emitter;

static bool allocate(Emitter *e)
{
    Surfaces *out = e->out;
    Error *err = e->repair->err;
    const uint32_t triangles = e->pieces->count, shapes = (uint32_t)e->soup->shape_count;
    out->surface = array_create((size_t)triangles + shapes, sizeof *out->surface, "surfaces", err);
    out->corner = array_create(3 * (size_t)triangles, sizeof *out->corner, "triangles", err);
    out->triangle_surface = array_create(triangles, sizeof *out->triangle_surface, "triangles",
                                         err);
    out->triangle_face = array_create(triangles, sizeof *out->triangle_face, "triangles", err);
    out->triangle_back = array_create(triangles, sizeof *out->triangle_back, "triangles", err);
    out->shape = array_create(shapes, sizeof *out->shape, "shapes", err);
    out->shape_surface = array_create(shapes, sizeof *out->shape_surface, "shapes", err);
    e->slot = array_create(3 * (size_t)triangles, sizeof *e->slot, "triangles", err);
    return !error_is_set(err);
}

/* --- triangles and quads ---------------------------------------------------------------------- */

static void emit_triangle(Emitter *e, uint32_t piece, uint32_t c0, uint32_t c1, uint32_t c2)
{
    Surfaces *out = e->out;
    const uint32_t triangle = out->triangle_count++;
    uint32_t *corner = out->corner + 3 * (size_t)triangle;
    corner[0] = c0;
    corner[1] = c1;
    corner[2] = c2;
    out->triangle_surface[triangle] = out->count;
    out->triangle_face[triangle] = e->pieces->face[piece];
    out->triangle_back[triangle] = e->pieces->back[piece];
    out->surface[out->count].area +=
        vec3_length(triangulate_normal(out->position, corner, 3)) / 2;
}

/* The quad q r p w of the triangle that holds `use` (p to q, opposite r) and the other half. */
static void emit_quad(Emitter *e, uint32_t use, uint32_t other)
{
    const uint32_t *corner = e->pieces->corner;
    const uint32_t p = corner[use], q = corner[use_next(use)];
    const uint32_t r = corner[use_next(use_next(use))], w = corner[use_next(use_next(other))];
    const uint32_t base = 4 * e->out->count;
    e->slot[use] = e->slot[other] = PIECE_NONE;
    e->slot[use_next(use)] = base;
    e->slot[use_next(use_next(use))] = base + 1;
    e->slot[use_next(other)] = base + 2;
    e->slot[use_next(use_next(other))] = base + 3;
    emit_triangle(e, use / 3, q, r, p);
    emit_triangle(e, other / 3, q, p, w);
}

static void emit_piece(Emitter *e, uint32_t i)
{
    const Pieces *pieces = e->pieces;
    const uint32_t other = pieces->other[i], face = pieces->face[i];
    const uint32_t back = pieces->back[i], behind = back != PIECE_NONE ? back : face;
    if (other != PIECE_NONE && other < i)
        return; /* second half of a quad */
    e->out->surface[e->out->count] = (Surface){
        .kind = other == PIECE_NONE ? SURFACE_TRIANGLE : SURFACE_QUAD,
        .primitive = e->out->triangle_count,
        .face = face,
        .back = back,
        .material = e->soup->material[face],
        .group = e->soup->group[face],
        .back_material = e->soup->material[behind],
        .back_group = e->soup->group[behind],
        .neighbour = { SURFACE_NONE, SURFACE_NONE, SURFACE_NONE, SURFACE_NONE },
    };
    if (other == PIECE_NONE) {
        for (uint32_t k = 0; k < 3; k++)
            e->slot[3 * i + k] = 4 * e->out->count + k;
        const uint32_t *corner = pieces->corner + 3 * (size_t)i;
        emit_triangle(e, i, corner[0], corner[1], corner[2]);
    } else {
        emit_quad(e, pieces->diagonal[i], pieces->diagonal[other]);
    }
    e->out->count++;
}

static bool emit_shapes(Emitter *e)
{
    Surfaces *out = e->out;
    for (uint32_t i = 0; i < e->soup->shape_count; i++) {
        const ShapeFace *face = &e->soup->shape[i];
        const double area = shape_area(&face->shape, 0, 1, 0, 1);
        const uint32_t id = (uint32_t)e->soup->polygon_count + i;
        if (!(area > 0) || !isfinite(area)) {
            e->repair->repairs.degenerate++;
            if (!repair_report(e->repair, &(Defect){
                    .kind = DEFECT_DEGENERATE, .repaired = true, .face = id,
                    .other = DEFECT_NO_FACE }))
                return false;
            continue;
        }
        out->surface[out->count] = (Surface){
            .kind = SURFACE_SHAPE,
            .primitive = out->triangle_count + out->shape_count,
            .face = id, .back = SURFACE_NONE, .material = face->material, .group = face->group,
            .back_material = face->material, .back_group = face->group, .area = area,
            .neighbour = { SURFACE_NONE, SURFACE_NONE, SURFACE_NONE, SURFACE_NONE },
        };
        out->shape[out->shape_count] = face->shape;
        out->shape_surface[out->shape_count++] = out->count++;
    }
    return true;
}

/* --- neighbours ------------------------------------------------------------------------------- */

static uint32_t surface_across(const Emitter *e, uint32_t link)
{
    const uint32_t other = connection_across(e->connection, link);
    const uint32_t use = other == PIECE_NONE ? PIECE_NONE : connection_use(e->connection, other);
    return use == PIECE_NONE || e->slot[use] == PIECE_NONE ? SURFACE_NONE : e->slot[use] / 4;
}

static void link_neighbours(Emitter *e)
{
    for (uint32_t use = 0; use < 3 * e->pieces->count; use++) {
        const uint32_t slot = e->slot[use];
        if (slot != PIECE_NONE)
            e->out->surface[slot / 4].neighbour[slot % 4] =
                surface_across(e, stitches_link(e->connection->stitches, use));
    }
}

static bool emit_stitches(Emitter *e)
{
    Surfaces *out = e->out;
    Error *err = e->repair->err;
    const Stitches *s = e->connection->stitches;
    if (s->count == 0)
        return true;
    const size_t slots = 4 * (size_t)out->count;
    out->stitch_first = array_create(slots + 1, sizeof *out->stitch_first, "stitches", err);
    out->stitch = array_create(s->count, sizeof *out->stitch, "stitches", err);
    if (error_is_set(err))
        return false;
    for (uint32_t use = 0; use < 3 * e->pieces->count; use++) {
        const uint32_t count = s->first[use + 1] - s->first[use];
        assert(count == 0 || e->slot[use] != PIECE_NONE); /* open edges are no diagonals */
        if (count > 0)
            out->stitch_first[e->slot[use] + 1] = count;
    }
    for (size_t slot = 0; slot < slots; slot++)
        out->stitch_first[slot + 1] += out->stitch_first[slot];
    for (uint32_t use = 0; use < 3 * e->pieces->count; use++)
        for (uint32_t i = s->first[use]; i < s->first[use + 1]; i++) {
            Stitch *stitch = &out->stitch[out->stitch_first[e->slot[use]] + i - s->first[use]];
            *stitch = s->stitch[i];
            stitch->neighbour = surface_across(e, use + i + 1);
        }
    return true;
}

/* --- parts ------------------------------------------------------------------------------------ */

/* Neighbours over edge k, the pieces between stitches one by one: number n, or SURFACE_NONE. */
static uint32_t reach(const Surfaces *s, uint32_t surface, unsigned k, uint32_t n)
{
    return n == 0 ? s->surface[surface].neighbour[k]
                  : s->stitch[s->stitch_first[4 * (size_t)surface + k] + n - 1].neighbour;
}

static uint32_t edge_pieces(const Surfaces *s, uint32_t surface, unsigned k)
{
    const size_t slot = 4 * (size_t)surface + k;
    return s->stitch_first == NULL ? 1 : 1 + s->stitch_first[slot + 1] - s->stitch_first[slot];
}

static void walk_part(Surfaces *s, uint32_t seed, uint32_t *queue)
{
    const uint32_t part = s->part_count++;
    uint32_t tail = 0;
    queue[tail++] = seed;
    s->part[seed] = part;
    for (uint32_t head = 0; head < tail; head++)
        for (unsigned k = 0; k < 4; k++)
            for (uint32_t n = 0; n < edge_pieces(s, queue[head], k); n++) {
                const uint32_t next = reach(s, queue[head], k, n);
                if (next != SURFACE_NONE && s->part[next] == SURFACE_NONE) {
                    s->part[next] = part;
                    queue[tail++] = next;
                }
            }
}

static bool emit_parts(Emitter *e)
{
    Surfaces *out = e->out;
    Error *err = e->repair->err;
    out->part = array_create(out->count, sizeof *out->part, "surfaces", err);
    uint32_t *queue = array_create(out->count, sizeof *queue, "surfaces", err);
    for (uint32_t i = 0; queue != NULL && i < out->count; i++)
        out->part[i] = SURFACE_NONE;
    for (uint32_t i = 0; queue != NULL && i < out->count; i++)
        if (out->part[i] == SURFACE_NONE)
            walk_part(out, i, queue);
    array_free(queue);
    out->part_closed = array_create(out->part_count, sizeof *out->part_closed, "surfaces", err);
    if (error_is_set(err))
        return false;
    for (uint32_t i = 0; i < out->part_count; i++)
        out->part_closed[i] = 1;
    for (uint32_t use = 0; use < 3 * e->pieces->count; use++)
        if (e->connection->rim[use / 3] && e->slot[use] != PIECE_NONE)
            out->part_closed[out->part[e->slot[use] / 4]] = 0;
    for (uint32_t i = 0; i < out->shape_count; i++) {
        const ShapeKind kind = out->shape[i].kind;
        if (kind == SHAPE_DISC || kind == SHAPE_FRUSTUM)
            out->part_closed[out->part[out->shape_surface[i]]] = 0;
    }
    out->closed = true;
    for (uint32_t i = 0; i < out->part_count; i++)
        out->closed = out->closed && out->part_closed[i];
    return true;
}

/* --- all -------------------------------------------------------------------------------------- */

static void measure_bounds(Surfaces *s)
{
    s->lo = vec3(INFINITY, INFINITY, INFINITY);
    s->hi = vec3(-INFINITY, -INFINITY, -INFINITY);
    for (size_t i = 0; i < 3 * (size_t)s->triangle_count; i++) {
        s->lo = vec3_min(s->lo, s->position[s->corner[i]]);
        s->hi = vec3_max(s->hi, s->position[s->corner[i]]);
    }
    for (uint32_t i = 0; i < s->shape_count; i++) {
        Vec3 lo, hi;
        shape_bounds(&s->shape[i], &lo, &hi);
        s->lo = vec3_min(s->lo, lo);
        s->hi = vec3_max(s->hi, hi);
    }
    const Vec3 most = vec3_max(s->hi, vec3_scale(s->lo, -1));
    s->largest_coordinate = fmax(most.x, fmax(most.y, most.z));
}

bool surfaces_emit(Surfaces *out, const Pieces *pieces, const Connection *connection,
                   Repair *repair)
{
    assert(out != NULL && pieces != NULL && connection != NULL && repair != NULL);
    Emitter e = { .soup = repair->soup, .pieces = pieces, .connection = connection,
                  .repair = repair, .out = out };
    bool ok = allocate(&e);
    for (uint32_t i = 0; ok && i < pieces->count; i++)
        emit_piece(&e, i);
    ok = ok && emit_shapes(&e);
    if (ok && out->count == 0)
        ok = error_set(repair->err, ERROR_INPUT, "the scene has no face with an area");
    if (ok) {
        link_neighbours(&e);
        measure_bounds(out);
    }
    ok = ok && emit_stitches(&e) && emit_parts(&e);
    array_free(e.slot);
    return ok;
}
