/* SPDX-License-Identifier: BSD-3-Clause */
/* The way from the polygon soup to surfaces: weld, cut, connect, join, number. */
#include "mesh/surfaces.h"

#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "math/tolerance.h"
#include "mesh/internal.h"
#include "mesh/triangulate.h"

typedef struct {
    const Polygons *soup;
    Weld            weld;
    Pieces          pieces;
    Connection      connection;
    Notes           notes;
    uint32_t       *slot;  /* [3 * pieces.count]  4 * surface + edge of a use; inside: none */
    Surfaces       *out;
    Error          *err;
} Builder;

static double largest_coordinate(Vec3 p) { return fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))); }

/* A vertex is known as well as the largest face it belongs to: faces are modelled, scaled and moved
 * as a whole, so a corner at the origin carries the error of one far out. */
static double *weld_tolerances(const Polygons *soup, Error *err)
{
    double *tolerance = array_create(soup->vertex_count, sizeof *tolerance, "vertices", err);
    if (tolerance == NULL)
        return NULL;
    for (size_t i = 0; i < soup->vertex_count; i++)
        tolerance[i] = -1;
    for (size_t f = 0; f < soup->polygon_count; f++) {
        double largest = 0;
        for (uint32_t i = soup->first[f]; i < soup->first[f + 1]; i++)
            largest = fmax(largest, largest_coordinate(soup->position[soup->corner[i]]));
        for (uint32_t i = soup->first[f]; i < soup->first[f + 1]; i++)
            tolerance[soup->corner[i]] =
                fmax(tolerance[soup->corner[i]], position_tolerance(largest));
    }
    return tolerance;
}

static bool soup_fits(const Polygons *soup, Error *err)
{
    /* 2 * (4 * surface + edge) + side is one number. */
    const uint32_t most = UINT32_MAX / 8 - 1;
    const size_t corners = soup->polygon_count > 0 ? soup->first[soup->polygon_count] : 0;
    if (soup->vertex_count < most && corners < most && soup->shape_count < most - corners)
        return true;
    return error_set(err, ERROR_INPUT, "too many polygon corners: %zu, at most %u", corners, most);
}

static void make_pieces(Builder *b)
{
    const uint32_t count = (uint32_t)b->soup->vertex_count;
    double *tolerance = weld_tolerances(b->soup, b->err);
    if (tolerance != NULL && weld_create(&b->weld, b->soup->position, tolerance, count, b->err)
        && pieces_create(&b->pieces, b->soup, &b->weld, &b->notes, b->err)
        && connection_create(&b->connection, &b->pieces, b->soup, b->weld.vertex_count, &b->notes,
                             b->err))
        pieces_join(&b->pieces, &b->connection, b->soup, b->weld.position, b->err);
    array_free(tolerance);
}

static bool allocate_surfaces(Builder *b)
{
    Surfaces *out = b->out;
    Error *err = b->err;
    const uint32_t triangles = b->pieces.count, shapes = (uint32_t)b->soup->shape_count;
    out->surface = array_create((size_t)triangles + shapes, sizeof *out->surface, "surfaces", err);
    out->corner = array_create(3 * (size_t)triangles, sizeof *out->corner, "triangles", err);
    out->triangle_surface = array_create(triangles, sizeof *out->triangle_surface, "triangles",
                                         err);
    out->shape = array_create(shapes, sizeof *out->shape, "shapes", err);
    out->shape_surface = array_create(shapes, sizeof *out->shape_surface, "shapes", err);
    b->slot = array_create(3 * (size_t)triangles, sizeof *b->slot, "triangles", err);
    return !error_is_set(err);
}

static double triangle_area(const Surfaces *s, uint32_t triangle)
{
    return vec3_length(triangulate_normal(s->position, s->corner + 3 * (size_t)triangle, 3)) / 2;
}

static void emit_triangle(Builder *b, uint32_t c0, uint32_t c1, uint32_t c2)
{
    Surfaces *out = b->out;
    uint32_t *corner = out->corner + 3 * (size_t)out->triangle_count;
    corner[0] = c0;
    corner[1] = c1;
    corner[2] = c2;
    out->triangle_surface[out->triangle_count] = out->count;
    out->surface[out->count].area += triangle_area(out, out->triangle_count);
    out->triangle_count++;
}

/* The quad q r p w of the triangle that holds `use` (p to q, opposite r) and the other half. */
static void emit_quad(Builder *b, uint32_t use, uint32_t other)
{
    const uint32_t *corner = b->pieces.corner;
    const uint32_t p = corner[use], q = corner[use_next(use)];
    const uint32_t r = corner[use_next(use_next(use))], w = corner[use_next(use_next(other))];
    const uint32_t base = 4 * b->out->count;
    b->slot[use] = b->slot[other] = PIECE_NONE;
    b->slot[use_next(use)] = base;
    b->slot[use_next(use_next(use))] = base + 1;
    b->slot[use_next(other)] = base + 2;
    b->slot[use_next(use_next(other))] = base + 3;
    emit_triangle(b, q, r, p);
    emit_triangle(b, q, p, w);
}

static void emit_piece(Builder *b, uint32_t i)
{
    const uint32_t other = b->pieces.other[i], face = b->pieces.face[i];
    const uint32_t back = b->pieces.back[i], behind = back != PIECE_NONE ? back : face;
    if (other != PIECE_NONE && other < i)
        return; /* second half of a quad */
    b->out->surface[b->out->count] = (Surface){
        .kind = other == PIECE_NONE ? SURFACE_TRIANGLE : SURFACE_QUAD,
        .primitive = b->out->triangle_count,
        .face = face,
        .back = back,
        .material = b->soup->material[face],
        .group = b->soup->group[face],
        .back_material = b->soup->material[behind],
        .back_group = b->soup->group[behind],
        .neighbour = { SURFACE_NONE, SURFACE_NONE, SURFACE_NONE, SURFACE_NONE },
    };
    if (other == PIECE_NONE) {
        for (uint32_t k = 0; k < 3; k++)
            b->slot[3 * i + k] = 4 * b->out->count + k;
        const uint32_t *corner = b->pieces.corner + 3 * (size_t)i;
        emit_triangle(b, corner[0], corner[1], corner[2]);
    } else {
        emit_quad(b, b->pieces.diagonal[i], b->pieces.diagonal[other]);
    }
    b->out->count++;
}

static void emit_shapes(Builder *b)
{
    Surfaces *out = b->out;
    for (uint32_t i = 0; i < b->soup->shape_count; i++) {
        const ShapeFace *face = &b->soup->shape[i];
        const double area = shape_area(&face->shape, 0, 1, 0, 1);
        const uint32_t id = (uint32_t)b->soup->polygon_count + i;
        if (!(area > 0) || !isfinite(area)) {
            note_face(&b->notes.degenerate, id);
            continue;
        }
        const bool rim = face->shape.kind == SHAPE_DISC || face->shape.kind == SHAPE_FRUSTUM;
        b->connection.closed = b->connection.closed && !rim;
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
}

static void link_neighbours(Builder *b)
{
    for (uint32_t use = 0; use < 3 * b->pieces.count; use++) {
        const uint32_t other = connection_across(&b->connection, use);
        if (b->slot[use] != PIECE_NONE && other != PIECE_NONE && b->slot[other] != PIECE_NONE)
            b->out->surface[b->slot[use] / 4].neighbour[b->slot[use] % 4] = b->slot[other] / 4;
    }
}

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
    s->largest_coordinate = fmax(largest_coordinate(s->lo), largest_coordinate(s->hi));
}

static bool make_surfaces(Builder *b)
{
    Surfaces *out = b->out;
    if (error_is_set(b->err) || !allocate_surfaces(b))
        return false;
    out->position = b->weld.position;
    out->vertex_count = b->weld.vertex_count;
    b->weld.position = NULL;
    /* Shapes alone leave no edge open. */
    b->connection.closed = b->connection.closed || b->pieces.count == 0;
    for (uint32_t i = 0; i < b->pieces.count; i++)
        emit_piece(b, i);
    emit_shapes(b);
    if (out->count == 0)
        return error_set(b->err, ERROR_INPUT, "the scene has no face with an area");
    link_neighbours(b);
    measure_bounds(out);
    out->closed = b->connection.closed;
    out->repairs = (Repairs){
        .welded = b->weld.welded,
        .duplicate = b->notes.duplicate.count,
        .degenerate = b->notes.degenerate.count,
        .nonmanifold = b->notes.nonmanifold.count,
        .refused = b->notes.refused.count,
    };
    return true;
}

static void tell_note(const Builder *b, const Monitor *monitor, const Note *note,
                      const char *code, const char *text)
{
    if (note->count == 0)
        return;
    const bool polygon = note->first < b->soup->polygon_count;
    const size_t shape = polygon ? 0 : note->first - b->soup->polygon_count;
    const uint32_t group = polygon ? b->soup->group[note->first] : b->soup->shape[shape].group;
    monitor_warn(monitor, code, b->soup->group_name[group],
                 "%u %s; the first is %s %zu of the file, in group \"%s\"", note->count, text,
                 polygon ? "face" : "curved face", polygon ? (size_t)note->first + 1 : shape + 1,
                 b->soup->group_name[group]);
}

static void tell_notes(const Builder *b, const Monitor *monitor)
{
    const Notes *n = &b->notes;
    tell_note(b, monitor, &n->degenerate, "degenerate", "triangles without area were left out");
    tell_note(b, monitor, &n->duplicate, "duplicate",
              "faces lie exactly on an earlier face and were left out");
    tell_note(b, monitor, &n->crossing, "polygon-crossing",
              "polygons have an outline that crosses itself; their filling is a guess");
    tell_note(b, monitor, &n->nonmanifold, "nonmanifold",
              "triangles share an edge with two others; they are kept, apart from them");
    tell_note(b, monitor, &n->inconsistent, "winding-inconsistent",
              "triangles are wound against their neighbours; fronts and backs are as in the file");
    tell_note(b, monitor, &n->refused, "refused",
              "triangles did not fit into the half-edge mesh; they are kept, apart from it");
}

Surfaces *surfaces_create(const Polygons *soup, const Monitor *monitor, Error *err)
{
    return surfaces_repair(soup, NULL, NULL, monitor, err);
}

static bool one_part(Surfaces *out, Error *err)
{
    out->part = array_create(out->count, sizeof *out->part, "surfaces", err);
    out->part_closed = array_create(1, sizeof *out->part_closed, "surfaces", err);
    out->part_count = 1;
    if (error_is_set(err))
        return false;
    out->part_closed[0] = out->closed;
    return true;
}

Surfaces *surfaces_repair(const Polygons *soup, const SurfaceOptions *options, Defects *defects,
                          const Monitor *monitor, Error *err)
{
    (void)options;
    (void)defects;
    assert(soup != NULL && err != NULL);
    if (error_is_set(err) || !soup_fits(soup, err))
        return NULL;
    Builder b = { .soup = soup, .err = err };
    b.out = array_create(1, sizeof *b.out, "surfaces", err);
    if (b.out == NULL)
        return NULL;
    make_pieces(&b);
    if (make_surfaces(&b) && one_part(b.out, err))
        tell_notes(&b, monitor);
    weld_clear(&b.weld);
    pieces_clear(&b.pieces);
    connection_clear(&b.connection);
    array_free(b.slot);
    if (error_is_set(err))
        return surfaces_destroy(b.out);
    return b.out;
}

Surfaces *surfaces_destroy(Surfaces *surfaces)
{
    if (surfaces != NULL) {
        array_free(surfaces->surface);
        array_free(surfaces->position);
        array_free(surfaces->corner);
        array_free(surfaces->triangle_surface);
        array_free(surfaces->stitch_first);
        array_free(surfaces->stitch);
        array_free(surfaces->part);
        array_free(surfaces->part_closed);
        array_free(surfaces->shape);
        array_free(surfaces->shape_surface);
        array_free(surfaces);
    }
    return NULL;
}
