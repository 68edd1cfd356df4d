/* SPDX-License-Identifier: BSD-3-Clause */
/* Area, centre and normal of every patch. */
#include <assert.h>
#include <math.h>

#include "math/tolerance.h"
#include "mesh/patches_internal.h"

/* --- cells ------------------------------------------------------------------------------------ */

/* Area of s0..s1, t0..t1 that lies under the diagonal t = s, in units of (s, t). */
static double under_diagonal(double s0, double s1, double t0, double t1)
{
    if (s0 >= t1)
        return (s1 - s0) * (t1 - t0);
    if (s1 <= t0)
        return 0;
    /* The integral over s of clamp(s - t0, 0, t1 - t0): a slope, then a plateau. */
    const double from = fmax(s0, t0), to = fmin(s1, t1);
    const double slope = (to - from) * ((to - t0) + (from - t0)) / 2;
    return slope + fmax(s1 - t1, 0) * (t1 - t0);
}

static double quad_cell_area(const Surfaces *s, uint32_t surface, double s0, double s1, double t0,
                             double t1)
{
    SurfacePoint under, over;
    surfaces_point(s, surface, 1, 0, &under);
    surfaces_point(s, surface, 0, 1, &over);
    const double whole = (s1 - s0) * (t1 - t0), part = under_diagonal(s0, s1, t0, t1);
    return under.density * part + over.density * (whole - part);
}

static double cell_area(const PatchBuilder *b, uint32_t surface, PatchCell cell)
{
    const Surface *f = &b->surfaces->surface[surface];
    const double nu = ldexp(b->out->nu[surface], cell.level);
    const double nv = ldexp(b->out->nv[surface], cell.level);
    if (f->kind == SURFACE_TRIANGLE)
        return f->area / (nu * nv);
    const double s0 = cell.i / nu, s1 = (cell.i + 1) / nu;
    const double t0 = cell.j / nv, t1 = (cell.j + 1) / nv;
    if (f->kind == SURFACE_QUAD)
        return quad_cell_area(b->surfaces, surface, s0, s1, t0, t1);
    return shape_area(patches_shape(b->surfaces, f), s0, s1, t0, t1);
}

static void cell_centre(const PatchBuilder *b, uint32_t surface, PatchCell cell, SurfacePoint *at)
{
    const double nu = ldexp(b->out->nu[surface], cell.level);
    const double nv = ldexp(b->out->nv[surface], cell.level);
    double within = 0.5;
    if (b->surfaces->surface[surface].kind == SURFACE_TRIANGLE)
        within = cell.upper ? 2.0 / 3 : 1.0 / 3;
    surfaces_point(b->surfaces, surface, (cell.i + within) / nu, (cell.j + within) / nv, at);
}

/* The front's area of the same cell, where both sides are plain grids: shapes are integrated once.
 * 0 when there is none. */
static double front_area(const Patches *out, uint32_t surface, unsigned side, uint32_t c)
{
    const uint32_t front = out->first[0][surface];
    if (side == 0 || front == PATCH_NONE || front >= out->first[1][surface]
        || out->tree_first[0][surface] != PATCH_NONE || out->tree_first[1][surface] != PATCH_NONE
        || patches_is_merged(out, front))
        return 0;
    return out->area[front + c];
}

static void measure_cells(PatchBuilder *b, uint32_t surface, unsigned side)
{
    Patches *out = b->out;
    const uint32_t first = out->first[side][surface];
    const uint32_t count = patches_side_cells(out, b->surfaces, surface, side);
    for (uint32_t c = 0; c < count; c++) {
        const uint32_t i = first + c;
        const double known = front_area(out, surface, side, c);
        SurfacePoint at;
        cell_centre(b, surface, out->cell[i], &at);
        out->centre[i] = at.point;
        out->normal[i] = side == 0 ? at.normal : vec3_scale(at.normal, -1);
        out->area[i] = known > 0 ? known : cell_area(b, surface, out->cell[i]);
    }
}

/* --- merged patches --------------------------------------------------------------------------- */

/* Centroid and vector area of a piece, seen from its front. */
static void piece_moments(const Surfaces *s, uint32_t surface, Vec3 *moment, Vec3 *vector)
{
    const Surface *f = &s->surface[surface];
    *moment = *vector = vec3(0, 0, 0);
    assert(f->kind != SURFACE_SHAPE);
    for (uint32_t k = 0; k < (f->kind == SURFACE_QUAD ? 2u : 1u); k++) {
        const uint32_t *c = s->corner + 3 * (size_t)(f->primitive + k);
        const Vec3 p = s->position[c[0]], q = s->position[c[1]], r = s->position[c[2]];
        const Vec3 half = vec3_scale(vec3_cross(vec3_sub(q, p), vec3_sub(r, p)), 0.5);
        *vector = vec3_add(*vector, half);
        *moment = vec3_mad(*moment, vec3_length(half) / 3, vec3_add(p, vec3_add(q, r)));
    }
}

/* Point of a triangle nearest to p: by the region that p lies over [ericson05, 5.1.5]. */
static Vec3 nearest_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c)
{
    const Vec3 ab = vec3_sub(b, a), ac = vec3_sub(c, a);
    const Vec3 ap = vec3_sub(p, a), bp = vec3_sub(p, b), cp = vec3_sub(p, c);
    const double d1 = vec3_dot(ab, ap), d2 = vec3_dot(ac, ap);
    const double d3 = vec3_dot(ab, bp), d4 = vec3_dot(ac, bp);
    const double d5 = vec3_dot(ab, cp), d6 = vec3_dot(ac, cp);
    if (d1 <= 0 && d2 <= 0)
        return a;
    if (d3 >= 0 && d4 <= d3)
        return b;
    if (d6 >= 0 && d5 <= d6)
        return c;
    const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    if (vc <= 0 && d1 >= 0 && d3 <= 0)
        return vec3_mad(a, d1 / (d1 - d3), ab);
    if (vb <= 0 && d2 >= 0 && d6 <= 0)
        return vec3_mad(a, d2 / (d2 - d6), ac);
    if (va <= 0 && d4 >= d3 && d5 >= d6)
        return vec3_mad(b, (d4 - d3) / ((d4 - d3) + (d5 - d6)), vec3_sub(c, b));
    const double sum = va + vb + vc;
    return vec3_mad(vec3_mad(a, vb / sum, ab), vc / sum, ac);
}

/* The point nearest to `wanted` on any of the pieces. */
static Vec3 nearest_on_pieces(const Surfaces *s, const uint32_t *piece, uint32_t count, Vec3 wanted)
{
    Vec3 best = wanted;
    double distance = INFINITY;
    for (uint32_t k = 0; k < count; k++) {
        const Surface *f = &s->surface[piece[k]];
        for (uint32_t t = 0; t < (f->kind == SURFACE_QUAD ? 2u : 1u); t++) {
            const uint32_t *c = s->corner + 3 * (size_t)(f->primitive + t);
            const Vec3 p = nearest_on_triangle(wanted, s->position[c[0]], s->position[c[1]],
                                               s->position[c[2]]);
            const Vec3 d = vec3_sub(p, wanted);
            if (vec3_dot(d, d) < distance) {
                distance = vec3_dot(d, d);
                best = p;
            }
        }
    }
    return best;
}

static void measure_merged(PatchBuilder *b, uint32_t patch)
{
    Patches *out = b->out;
    const uint32_t first = out->first_piece[patch], end = out->first_piece[patch + 1];
    Vec3 moment = { 0 }, vector = { 0 };
    double area = 0;
    for (uint32_t k = first; k < end; k++) {
        Vec3 m, v;
        piece_moments(b->surfaces, out->piece[k], &m, &v);
        moment = vec3_add(moment, m);
        vector = vec3_add(vector, v);
        area += b->surfaces->surface[out->piece[k]].area;
        out->piece_end[k] = area;
    }
    for (uint32_t k = first; k < end; k++)
        out->piece_end[k] = k + 1 == end ? 1 : out->piece_end[k] / area;
    out->area[patch] = area;
    out->centre[patch] = nearest_on_pieces(b->surfaces, out->piece + first, end - first,
                                           vec3_scale(moment, 1 / area));
    /* Pieces that cancel each other have no mean: then the first one's. */
    Vec3 normal = surfaces_normal(b->surfaces,
                                  b->surfaces->surface[out->piece[first]].primitive, 0, 0);
    if (vec3_length(vector) > rounding_bound(8) * area)
        normal = vec3_unit(vector);
    out->normal[patch] = out->side[patch] == 0 ? normal : vec3_scale(normal, -1);
}

void patches_measure(PatchBuilder *b)
{
    Patches *out = b->out;
    for (uint32_t k = 0; k < b->block_count; k++) {
        const uint32_t surface = b->block[k] / 2;
        const unsigned side = b->block[k] % 2;
        if (b->block_merged[k] == PATCH_NONE)
            measure_cells(b, surface, side);
        else
            measure_merged(b, out->first[side][surface]);
    }
    for (uint32_t i = 0; i < out->count; i++)
        out->total_area += out->area[i];
}
