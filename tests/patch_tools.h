/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks of the faces of patches, and patches split at random. */
#ifndef TESTS_PATCH_TOOLS_H
#define TESTS_PATCH_TOOLS_H

#include "tests/soup_tools.h"

static inline uint32_t next_random(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return *seed >> 8;
}

/* --- faces by position ------------------------------------------------------------------------ */

typedef struct {
    Vec3 from, to;
} DirectedEdge;

static inline int edge_compare(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(DirectedEdge));
}

static inline int point_compare(const void *a, const void *b) { return memcmp(a, b, sizeof(Vec3)); }

/* Zero has two signs, which memcmp tells apart. */
static inline Vec3 plus_zero(Vec3 p) { return vec3(p.x + 0.0, p.y + 0.0, p.z + 0.0); }

static inline uint32_t next_corner(const Patches *p, uint32_t face, uint32_t k)
{
    return k + 1 < p->first_corner[face + 1] ? k + 1 : p->first_corner[face];
}

static inline unsigned face_side(const Patches *p, uint32_t face)
{
    return p->side[p->face_patch[face]];
}

/* Of a merged patch: the piece. */
static inline uint32_t face_surface(const Patches *p, uint32_t face)
{
    const uint32_t patch = p->face_patch[face], first = p->first_piece[patch];
    return p->first_piece[patch + 1] > first ? p->piece[first + (face - p->face_of[patch])]
                                             : p->surface[patch];
}

/* Every directed edge of one side's faces is there once, and once in the other direction. Returns
 * how many. */
static inline size_t check_closed(const Patches *p, unsigned side)
{
    DirectedEdge *edge = calloc(p->first_corner[p->face_count], sizeof *edge);
    assert_non_null(edge);
    size_t n = 0;
    for (uint32_t f = 0; f < p->face_count; f++)
        for (uint32_t k = p->first_corner[f]; face_side(p, f) == side && k < p->first_corner[f + 1];
             k++) {
            edge[n].from = plus_zero(p->position[p->corner[k]]);
            edge[n++].to = plus_zero(p->position[p->corner[next_corner(p, f, k)]]);
        }
    qsort(edge, n, sizeof *edge, edge_compare);
    for (size_t i = 0; i < n; i++) {
        const DirectedEdge back = { edge[i].to, edge[i].from };
        assert_non_null(bsearch(&back, edge, n, sizeof *edge, edge_compare));
        assert_true(i == 0 || edge_compare(&edge[i - 1], &edge[i]) != 0);
    }
    free(edge);
    return n;
}

/* Different positions among one side's corners. */
static inline size_t count_points(const Patches *p, unsigned side)
{
    Vec3 *point = calloc(p->first_corner[p->face_count], sizeof *point);
    assert_non_null(point);
    size_t n = 0, different = 0;
    for (uint32_t f = 0; f < p->face_count; f++)
        for (uint32_t k = p->first_corner[f]; face_side(p, f) == side && k < p->first_corner[f + 1];
             k++)
            point[n++] = plus_zero(p->position[p->corner[k]]);
    qsort(point, n, sizeof *point, point_compare);
    for (size_t i = 0; i < n; i++)
        different += i == 0 || point_compare(&point[i - 1], &point[i]) != 0;
    free(point);
    return different;
}

static inline size_t count_faces(const Patches *p, unsigned side)
{
    size_t faces = 0;
    for (uint32_t f = 0; f < p->face_count; f++)
        faces += face_side(p, f) == side;
    return faces;
}

/* V - E + F of one side, by position. */
static inline int euler(const Patches *p, unsigned side)
{
    const size_t edges = check_closed(p, side) / 2;
    return (int)(count_points(p, side) + count_faces(p, side)) - (int)edges;
}

/* --- interpolation ---------------------------------------------------------------------------- */

/* (s, t) of a place on the outline of a face's cell: corner k and a fraction of the way on. */
static inline void outline_place(const Mesh *m, uint32_t face, double along, double *s, double *t)
{
    const Patches *p = m->patches;
    const uint32_t patch = p->face_patch[face], surface = face_surface(p, face);
    const PatchCell cell = p->cell[patch];
    static const double corner[3][4][2] = {
        { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } },
        { { 0, 0 }, { 1, 0 }, { 0, 1 }, { 0, 0 } },
        { { 1, 1 }, { 0, 1 }, { 1, 0 }, { 0, 0 } },
    };
    const bool triangle = m->surfaces->surface[surface].kind == SURFACE_TRIANGLE;
    const int n = triangle ? 3 : 4, k = (int)along % n;
    const double(*c)[2] = corner[triangle ? 1 + cell.upper : 0];
    const double f = along - floor(along);
    const double scale = pow(2, cell.level);
    *s = (cell.i + c[k][0] + f * (c[(k + 1) % n][0] - c[k][0])) / (scale * p->nu[surface]);
    *t = (cell.j + c[k][1] + f * (c[(k + 1) % n][1] - c[k][1])) / (scale * p->nv[surface]);
}

static inline double interpolated(const Mesh *m, uint32_t surface, unsigned side, double s,
                                  double t, const double *value)
{
    uint32_t vertex[PATCH_WEIGHTS];
    double weight[PATCH_WEIGHTS], sum = 0, all = 0;
    const int n = patches_interpolate(m->patches, m->surfaces, surface, side, s, t, vertex, weight);
    assert_true(n >= 3 && n <= PATCH_WEIGHTS);
    for (int j = 0; j < n; j++) {
        sum += weight[j];
        all += weight[j] * value[vertex[j]];
    }
    assert_true(fabs(sum - 1) < 1e-13);
    return all;
}

/* Along every face's outline, from vertex to vertex, values run linearly: so cells of whatever size
 * and surface that share the vertices agree there. Vertices have random values in [0, 1]. */
static inline void check_outlines(const Mesh *m)
{
    const Patches *p = m->patches;
    uint32_t seed = 17;
    double *value = calloc(p->vertex_count, sizeof *value);
    assert_non_null(value);
    for (uint32_t v = 0; v < p->vertex_count; v++)
        value[v] = next_random(&seed) / (double)(1 << 24);
    for (uint32_t face = 0; face < p->face_count; face++) {
        const uint32_t patch = p->face_patch[face], surface = face_surface(p, face);
        const bool triangle = m->surfaces->surface[surface].kind == SURFACE_TRIANGLE;
        for (uint32_t k = p->first_corner[face]; k < p->first_corner[face + 1]; k++) {
            const uint32_t next = next_corner(p, face, k);
            double from = p->corner_along[k], to = p->corner_along[next];
            /* Backs run the other way round. */
            if (p->side[patch] == 0)
                to = to == 0 ? (triangle ? 3 : 4) : to;
            else
                from = from == 0 ? (triangle ? 3 : 4) : from;
            for (int g = 0; g <= 3; g++) {
                double s, t;
                outline_place(m, face, from + g / 3.0 * (to - from), &s, &t);
                const double expected = (1 - g / 3.0) * value[p->corner[k]]
                                      + g / 3.0 * value[p->corner[next]];
                /* (s, t) is off by some 2^-52, magnified by the cells' number. */
                assert_true(fabs(interpolated(m, surface, p->side[patch], s, t, value) - expected)
                            < 1e-11);
            }
        }
    }
    free(value);
}

/* --- splitting -------------------------------------------------------------------------------- */

/* What patches_split promises about parents. */
static inline void check_parents(const Patches *old, const Patches *p, const uint8_t *split,
                                 const uint32_t *parent)
{
    double *area = calloc(old->count, sizeof *area);
    uint32_t *parts = calloc(old->count, sizeof *parts);
    assert_true(area != NULL && parts != NULL);
    for (uint32_t i = 0; i < p->count; i++) {
        assert_true(parent[i] < old->count && (i == 0 || parent[i] >= parent[i - 1]));
        assert_int_equal(p->side[i], old->side[parent[i]]);
        assert_int_equal(p->material[i], old->material[parent[i]]);
        area[parent[i]] += p->area[i];
        parts[parent[i]]++;
    }
    for (uint32_t i = 0; i < old->count; i++) {
        assert_true(fabs(area[i] - old->area[i]) <= 1e-8 * old->area[i]);
        assert_true(parts[i] >= (split[i] ? 2u : 1u));
    }
    free(area);
    free(parts);
}

/* Splits m->patches as marked, with all checks. */
static inline void mesh_split(Mesh *m, const uint8_t *split)
{
    Error err = { 0 };
    uint32_t *parent = NULL;
    Patches *p = patches_split(m->patches, m->surfaces, split, &parent, &err);
    assert_int_equal(err.code, ERROR_NONE);
    assert_non_null(p);
    assert_true(patches_check(p, m->surfaces));
    assert_true(p->size == m->patches->size);
    check_parents(m->patches, p, split, parent);
    array_free(parent);
    patches_destroy(m->patches);
    m->patches = p;
}

/* Splits about one in `one_in` of all patches. */
static inline void mesh_split_some(Mesh *m, uint32_t one_in, uint32_t *seed)
{
    uint8_t *split = calloc(m->patches->count, 1);
    assert_non_null(split);
    for (uint32_t i = 0; i < m->patches->count; i++)
        split[i] = next_random(seed) % one_in == 0;
    mesh_split(m, split);
    free(split);
}

#endif
