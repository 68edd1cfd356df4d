/* SPDX-License-Identifier: BSD-3-Clause */
/* What must be true of any Surfaces. */
#include <assert.h>
#include <math.h>

#include "math/tolerance.h"
#include "mesh/surfaces.h"

static uint32_t surface_primitives(const Surface *f) { return f->kind == SURFACE_QUAD ? 2 : 1; }

static unsigned surface_edges(const Surface *f)
{
    return f->kind == SURFACE_TRIANGLE ? 3 : f->kind == SURFACE_QUAD ? 4 : 0;
}

static bool check_primitives(const Surfaces *s)
{
    uint32_t next_triangle = 0, next_shape = s->triangle_count;
    for (uint32_t i = 0; i < s->count; i++) {
        const Surface *f = &s->surface[i];
        uint32_t *next = f->kind == SURFACE_SHAPE ? &next_shape : &next_triangle;
        if (f->primitive != *next)
            return false;
        *next += surface_primitives(f);
        if (*next > surfaces_primitive_count(s))
            return false;
        for (uint32_t k = 0; k < surface_primitives(f); k++)
            if (surfaces_of_primitive(s, f->primitive + k) != i)
                return false;
        if (f->kind != SURFACE_SHAPE && (s->triangle_face[f->primitive] != f->face
                                         || s->triangle_back[f->primitive] != f->back))
            return false;
    }
    for (size_t i = 0; i < 3 * (size_t)s->triangle_count; i++)
        if (s->corner[i] >= s->vertex_count)
            return false;
    return next_triangle == s->triangle_count && next_shape == surfaces_primitive_count(s);
}

static double triangle_area(const Surfaces *s, uint32_t triangle)
{
    const uint32_t *c = s->corner + 3 * (size_t)triangle;
    const Vec3 a = s->position[c[0]];
    return vec3_length(vec3_cross(vec3_sub(s->position[c[1]], a),
                                  vec3_sub(s->position[c[2]], a))) / 2;
}

static bool check_areas(const Surfaces *s)
{
    /* Area is a sum of two lengths of cross products, here formed once more in the same way. */
    const double slack = rounding_bound(64);
    for (uint32_t i = 0; i < s->count; i++) {
        const Surface *f = &s->surface[i];
        double area = 0;
        if (!(f->area > 0) || !isfinite(f->area))
            return false;
        if (f->kind == SURFACE_SHAPE)
            continue;
        for (uint32_t k = 0; k < surface_primitives(f); k++)
            area += triangle_area(s, f->primitive + k);
        if (!(fabs(area - f->area) <= slack * area))
            return false;
        const uint32_t *c = s->corner + 3 * (size_t)f->primitive;
        if (f->kind == SURFACE_QUAD && (c[0] != c[3] || c[2] != c[4]))
            return false;
    }
    return true;
}

/* --- neighbours ------------------------------------------------------------------------------- */

static uint32_t edge_corner(const Surfaces *s, uint32_t surface, unsigned k)
{
    const Surface *f = &s->surface[surface];
    return s->corner[3 * (size_t)f->primitive + (k == 3 ? 5 : k)];
}

static uint32_t stitch_count(const Surfaces *s, size_t edge)
{
    return s->stitch_first == NULL ? 0 : s->stitch_first[edge + 1] - s->stitch_first[edge];
}

/* End n of the pieces that edge k of a surface is in: 0 is its first corner. */
static uint32_t edge_end(const Surfaces *s, uint32_t surface, unsigned k, uint32_t n)
{
    const size_t edge = 4 * (size_t)surface + k;
    if (n == 0)
        return edge_corner(s, surface, k);
    if (n > stitch_count(s, edge))
        return edge_corner(s, surface, (k + 1) % surface_edges(&s->surface[surface]));
    return s->stitch[s->stitch_first[edge] + n - 1].vertex;
}

static uint32_t edge_neighbour(const Surfaces *s, uint32_t surface, unsigned k, uint32_t n)
{
    return n == 0 ? s->surface[surface].neighbour[k]
                  : s->stitch[s->stitch_first[4 * (size_t)surface + k] + n - 1].neighbour;
}

/* Whether surface j names i as its neighbour over the piece of an edge from p to q. */
static bool names_back(const Surfaces *s, uint32_t j, uint32_t i, uint32_t p, uint32_t q)
{
    for (unsigned k = 0; k < surface_edges(&s->surface[j]); k++)
        for (uint32_t n = 0; n <= stitch_count(s, 4 * (size_t)j + k); n++) {
            if (edge_neighbour(s, j, k, n) != i)
                continue;
            const uint32_t a = edge_end(s, j, k, n), b = edge_end(s, j, k, n + 1);
            if ((a == p && b == q) || (a == q && b == p))
                return true;
        }
    return false;
}

static bool check_edge(const Surfaces *s, uint32_t i, unsigned k)
{
    const size_t edge = 4 * (size_t)i + k;
    double before = 0;
    for (uint32_t n = 0; n <= stitch_count(s, edge); n++) {
        const uint32_t j = edge_neighbour(s, i, k, n);
        if (n > 0) {
            const Stitch *stitch = &s->stitch[s->stitch_first[edge] + n - 1];
            if (stitch->vertex >= s->vertex_count || !(stitch->fraction >= before)
                || !(stitch->fraction > 0 && stitch->fraction < 1))
                return false;
            before = stitch->fraction;
        }
        if (j != SURFACE_NONE
            && (j >= s->count || s->part[j] != s->part[i]
                || !names_back(s, j, i, edge_end(s, i, k, n), edge_end(s, i, k, n + 1))))
            return false;
    }
    return true;
}

static bool check_neighbours(const Surfaces *s)
{
    for (uint32_t i = 0; i < s->count; i++) {
        const unsigned edges = surface_edges(&s->surface[i]);
        if (s->part[i] >= s->part_count)
            return false;
        for (unsigned k = 0; k < edges; k++)
            if (!check_edge(s, i, k))
                return false;
        for (unsigned k = edges; k < 4; k++)
            if (s->surface[i].neighbour[k] != SURFACE_NONE
                || stitch_count(s, 4 * (size_t)i + k) > 0)
                return false;
    }
    return true;
}

bool surfaces_check(const Surfaces *surfaces)
{
    assert(surfaces != NULL);
    return check_primitives(surfaces) && check_areas(surfaces) && check_neighbours(surfaces);
}
