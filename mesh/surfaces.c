/* SPDX-License-Identifier: BSD-3-Clause */
/* The way from the polygon soup to surfaces: weld, cut, stitch, connect, join, number. */
#include "mesh/surfaces.h"

#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "math/tolerance.h"
#include "mesh/internal.h"

static double largest_coordinate(Vec3 p) { return fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))); }

/* A vertex is known as well as the largest face it belongs to: faces are modelled, scaled and moved
 * as a whole, so a corner at the origin carries the error of one far out. */
static double *weld_tolerances(const Polygons *soup, const SurfaceOptions *options, Error *err)
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
        const double derived = polygons_tolerance(soup, largest);
        const double wanted = options->keep_apart ? 0 : options->weld > 0 ? options->weld : derived;
        for (uint32_t i = soup->first[f]; i < soup->first[f + 1]; i++)
            tolerance[soup->corner[i]] = fmax(tolerance[soup->corner[i]], wanted);
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

typedef struct {
    Weld       weld;
    Pieces     pieces;
    Edges      edges;
    Stitches   stitches;
    Connection connection;
    Repair     repair;
} Builder;

static bool weld_soup(Builder *b)
{
    const Polygons *soup = b->repair.soup;
    double *tolerance = weld_tolerances(soup, b->repair.options, b->repair.err);
    const bool ok = tolerance != NULL
                 && weld_create(&b->weld, soup->position, tolerance, (uint32_t)soup->vertex_count,
                                b->repair.err);
    array_free(tolerance);
    b->repair.repairs.welded = b->weld.welded;
    return ok;
}

/* Triangles of which none is double, and their edges. */
static bool make_pieces(Builder *b)
{
    Error *err = b->repair.err;
    const uint32_t vertices = b->weld.vertex_count;
    bool merged = false;
    if (!pieces_create(&b->pieces, &b->weld, &b->repair)
        || !pieces_edges(&b->pieces, vertices, &b->edges, err)
        || !pieces_merge_swapped(&b->pieces, &b->edges, b->weld.position, &merged, &b->repair))
        return false;
    if (!merged)
        return true;
    edges_clear(&b->edges);
    return pieces_edges(&b->pieces, vertices, &b->edges, err);
}

static bool connect_pieces(Builder *b)
{
    if (!stitches_create(&b->stitches, &b->pieces, &b->edges, &b->weld, &b->repair))
        return false;
    edges_clear(&b->edges);
    return connection_create(&b->connection, &b->pieces, &b->stitches, &b->weld, &b->repair)
        && pieces_join(&b->pieces, &b->connection, b->repair.soup, b->weld.position,
                       b->repair.err);
}

static bool make_surfaces(Builder *b, Surfaces *out)
{
    if (!weld_soup(b) || !make_pieces(b) || !connect_pieces(b))
        return false;
    out->position = b->weld.position;
    out->vertex_count = b->weld.vertex_count;
    b->weld.position = NULL;
    if (!surfaces_emit(out, &b->pieces, &b->connection, &b->repair))
        return false;
    out->repairs = b->repair.repairs;
    return true;
}

Surfaces *surfaces_repair(const Polygons *soup, const SurfaceOptions *options, Defects *defects,
                          const Monitor *monitor, Error *err)
{
    static const SurfaceOptions everything = { 0 };
    assert(soup != NULL && err != NULL);
    if (error_is_set(err) || !soup_fits(soup, err))
        return NULL;
    Builder b = { .repair = { .soup = soup, .options = options != NULL ? options : &everything,
                              .defects = defects, .err = err } };
    Surfaces *out = array_create(1, sizeof *out, "surfaces", err);
    if (out != NULL && make_surfaces(&b, out))
        repair_tell(&b.repair, monitor);
    weld_clear(&b.weld);
    pieces_clear(&b.pieces);
    edges_clear(&b.edges);
    stitches_clear(&b.stitches);
    connection_clear(&b.connection);
    return error_is_set(err) ? surfaces_destroy(out) : out;
}

Surfaces *surfaces_create(const Polygons *soup, const Monitor *monitor, Error *err)
{
    return surfaces_repair(soup, NULL, NULL, monitor, err);
}

Surfaces *surfaces_destroy(Surfaces *surfaces)
{
    if (surfaces != NULL) {
        array_free(surfaces->surface);
        array_free(surfaces->position);
        array_free(surfaces->corner);
        array_free(surfaces->triangle_surface);
        array_free(surfaces->triangle_face);
        array_free(surfaces->triangle_back);
        array_free(surfaces->stitch_first);
        array_free(surfaces->stitch);
        array_free(surfaces->part);
        array_free(surfaces->part_closed);
        array_free(surfaces->shape);
        array_free(surfaces->shape_surface);
        array_free(surfaces->cut_first);
        array_free(surfaces->cut);
        array_free(surfaces->slicer);
        array_free(surfaces);
    }
    return NULL;
}
