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
