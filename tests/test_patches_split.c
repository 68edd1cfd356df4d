/* SPDX-License-Identifier: BSD-3-Clause */
/* Patches divided by quadtrees: balanced, without cracks, interpolated without breaks. */
#include "tests/patch_tools.h"

/* --- cracks and numbers ----------------------------------------------------------------------- */

/* Blocks of quads and triangles stay closed however they are split, both sides on their own. */
static void test_closed_blocks(void **state)
{
    (void)state;
    const Vec3 *block[] = { cube, skew };
    const unsigned cut[] = { 0, 1u << 0, 1u << 0 | 1u << 3, 63 };
    const double size[] = { 3, 0.5, 0.37 };
    uint32_t seed = 3;
    for (int s = 0; s < 2 * 4 * 3; s++) {
        Mesh m;
        soup_start(&m.soup);
        soup_block(&m.soup, block[s % 2], cut[s / 2 % 4], 0);
        mesh_make(&m, &(PatchOptions){ .size = size[s / 8] });
        for (int round = 0; round < 4; round++) {
            mesh_split_some(&m, 3 + 2 * round, &seed);
            assert_int_equal(euler(m.patches, 0), 2);
            assert_int_equal(euler(m.patches, 1), 2);
        }
        mesh_clear(&m);
    }
}

/* Shapes: seams and poles stay closed. Sphere 2, torus 0. */
static void test_closed_shapes(void **state)
{
    (void)state;
    const Affine map = { { 1, 0.2, 0 }, { 0, 2, 0 }, { 0, 0.3, 0.7 }, { 20, 0, 0 } };
    uint32_t seed = 5;
    for (int k = 0; k < 2; k++) {
        Mesh m;
        soup_start(&m.soup);
        soup_shape(&m.soup, k == 0 ? SHAPE_SPHERE : SHAPE_TORUS, k == 0 ? 1 : 0.3, &map);
        mesh_make(&m, &(PatchOptions){ .size = 2 });
        for (int round = 0; round < 4; round++) {
            mesh_split_some(&m, 4, &seed);
            for (unsigned side = 0; side < 2; side++)
                assert_int_equal(euler(m.patches, side), k == 0 ? 2 : 0);
        }
        mesh_clear(&m);
    }
}

/* --- balance ---------------------------------------------------------------------------------- */

/* A plate of squares, or of right triangles, all alike: 2:1 means that no edge of a face has more
 * than one vertex between its corners, over the seams of the plate as well. */
static void plate(Mesh *m, bool triangles, double size)
{
    enum { N = 3 };
    soup_start(&m->soup);
    for (int j = 0; j < N; j++)
        for (int i = 0; i < N; i++) {
            const Vec3 a = { i, j, 0 }, b = { i + 1, j, 0 }, c = { i + 1, j + 1, 0 },
                       d = { i, j + 1, 0 };
            if (triangles) {
                /* Halves of a parallelogram would be joined to one, but for their groups. */
                soup_polygon(&m->soup, (Vec3[]){ a, b, d }, 3, 0, 0);
                soup_polygon(&m->soup, (Vec3[]){ d, b, c }, 3, 0, 1);
            } else {
                soup_polygon(&m->soup, (Vec3[]){ a, b, c, d }, 4, 0, 0);
            }
        }
    mesh_make(m, &(PatchOptions){ .size = size, .separate = true });
}

static void test_balance(void **state)
{
    (void)state;
    for (int s = 0; s < 4; s++) {
        Mesh m;
        uint32_t seed = 11;
        plate(&m, s % 2 == 1, s < 2 ? 1.5 : 0.5);
        /* Again and again the patch at one place, then some anywhere. */
        for (int round = 0; round < 9; round++) {
            uint8_t *split = calloc(m.patches->count, 1);
            assert_non_null(split);
            split[patches_at(m.patches, m.surfaces, 0, 0, 0.96, 0.03)] = 1;
            for (uint32_t i = 0; round > 6 && i < m.patches->count; i++)
                split[i] = next_random(&seed) % 50 == 0;
            mesh_split(&m, split);
            free(split);
            size_t between = 0;
            for (uint32_t c = 1; c < m.patches->first_corner[m.patches->face_count]; c++) {
                const double along = m.patches->corner_along[c];
                if (along == floor(along))
                    continue;
                assert_true(along - floor(along) == 0.5);
                between++;
            }
            assert_true(between > 0 || round == 0);
        }
        mesh_clear(&m);
    }
}

typedef struct {
    double  low, high; /* y */
    double  extent;
    bool    right;
    uint8_t level;
} Span;

/* Fronts' cells that have an edge on the line x = 1. */
static size_t spans_at_seam(const Mesh *m, Span *span, size_t most)
{
    const Patches *p = m->patches;
    size_t n = 0;
    for (uint32_t f = 0; f < p->face_count; f++) {
        const uint32_t patch = p->face_patch[f];
        double y[2] = { 0 };
        int found = 0;
        for (uint32_t c = p->first_corner[f]; p->side[patch] == 0 && c < p->first_corner[f + 1];
             c++)
            if (p->corner_along[c] == floor(p->corner_along[c])
                && p->position[p->corner[c]].x == 1 && found < 2)
                y[found++] = p->position[p->corner[c]].y;
        if (found == 2) {
            assert_true(n < most);
            span[n++] = (Span){ fmin(y[0], y[1]), fmax(y[0], y[1]),
                                patches_extent(p, m->surfaces, patch), p->centre[patch].x > 1,
                                p->cell[patch].level };
        }
    }
    return n;
}

/* Where a square's grid and a triangle's differ, lengths are what counts: a divided cell has no
 * neighbour more than 2 sqrt 2 times as long, there or in all, twice for the level and half of that
 * for rounding. */
static void test_unlike_grids(void **state)
{
    (void)state;
    enum { MOST = 1000 };
    static Span span[MOST];
    static const double size[] = { 0.34, 0.26, 3 };
    for (int k = 0; k < 3; k++) {
        Mesh m;
        uint32_t seed = 47 + (uint32_t)k;
        soup_start(&m.soup);
        soup_polygon(&m.soup, (Vec3[]){ { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } }, 4, 0,
                     0);
        soup_polygon(&m.soup, (Vec3[]){ { 1, 0, 0 }, { k == 2 ? 9 : 2, 0, 0 }, { 1, 1, 0 } }, 3, 0,
                     0);
        mesh_make(&m, &(PatchOptions){ .size = size[k], .separate = true });
        assert_true(m.patches->nu[0] != m.patches->nu[1]);
        for (int round = 0; round < 4; round++) {
            mesh_split_some(&m, 12, &seed);
            const size_t n = spans_at_seam(&m, span, MOST);
            for (size_t i = 0; i < n; i++)
                for (size_t j = 0; j < n; j++) {
                    const Span *a = &span[i], *b = &span[j];
                    if (a->right == b->right || a->level == 0 || a->low > b->high - 1e-9
                        || b->low > a->high - 1e-9)
                        continue;
                    const double most = 2 * sqrt(2);
                    assert_true(b->high - b->low < most * (a->high - a->low) + 1e-9
                                || b->extent < most * a->extent + 1e-9);
                }
            check_outlines(&m);
        }
        mesh_clear(&m);
    }
}

/* A long triangle meets a square with an edge a thousand times shorter: dividing it three times
 * leaves the square whole, which still is no longer than its cells; five times divide the square,
 * but not down to that edge. */
static void test_short_edge(void **state)
{
    (void)state;
    Mesh m;
    soup_start(&m.soup);
    soup_polygon(&m.soup, (Vec3[]){ { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } }, 4, 0, 0);
    soup_polygon(&m.soup, (Vec3[]){ { 1, 0.5, 0 }, { 9, 0.5, 0 }, { 1, 0.501, 0 } }, 3, 0, 0);
    mesh_make(&m, &(PatchOptions){ .size = 10, .separate = true });
    const uint32_t square = m.patches->first[0][0] < m.patches->first[0][1] ? 0 : 1;
    for (int round = 1; round <= 5; round++) {
        uint8_t *split = calloc(m.patches->count, 1);
        uint32_t squares = 0;
        assert_non_null(split);
        for (uint32_t i = 0; i < m.patches->count; i++)
            split[i] = m.patches->side[i] == 0 && m.patches->surface[i] != square
                       && m.patches->centre[i].x < 2;
        mesh_split(&m, split);
        free(split);
        for (uint32_t i = 0; i < m.patches->count; i++)
            if (m.patches->surface[i] == square && m.patches->side[i] == 0) {
                assert_true(m.patches->cell[i].level <= 2);
                squares++;
            }
        assert_true(round > 3 || squares == 1);
        check_outlines(&m);
    }
    mesh_clear(&m);
}

/* --- interpolation ---------------------------------------------------------------------------- */

static void test_outlines(void **state)
{
    (void)state;
    uint32_t seed = 23;
    for (int s = 0; s < 6; s++) {
        Mesh m;
        if (s < 4) {
            plate(&m, s % 2 == 1, s < 2 ? 1.5 : 0.4);
        } else {
            soup_start(&m.soup);
            soup_block(&m.soup, skew, s == 4 ? 9 : 63, 0);
            mesh_make(&m, &(PatchOptions){ .size = 0.7 });
        }
        for (int round = 0; round < 4; round++)
            mesh_split_some(&m, 6, &seed);
        check_outlines(&m);
        mesh_clear(&m);
    }
}

/* Heights above a slanted plane are given back at every point of parallelograms and triangles. */
static void test_linear(void **state)
{
    (void)state;
    uint32_t seed = 29;
    Mesh m;
    soup_start(&m.soup);
    soup_polygon(&m.soup, (Vec3[]){ { 0, 0, 0 }, { 3, 1, 0 }, { 4, 3, 1 }, { 1, 2, 1 } }, 4, 0, 0);
    soup_polygon(&m.soup, (Vec3[]){ { 5, 0, 0 }, { 9, 0, 1 }, { 5, 3, 0 } }, 3, 1, 0);
    /* Beside both, cut otherwise: vertices at thirds meet vertices at halves. */
    soup_polygon(&m.soup, (Vec3[]){ { 3, 1, 0 }, { 4, 3, 1 }, { 3.4, 2, 3 } }, 3, 0, 0);
    mesh_make(&m, &(PatchOptions){ .size = 0.7 });
    for (int round = 0; round < 4; round++)
        mesh_split_some(&m, 5, &seed);
    const Vec3 slope = { 0.3, -1.7, 0.9 };
    double *value = calloc(m.patches->vertex_count, sizeof *value);
    assert_non_null(value);
    for (uint32_t v = 0; v < m.patches->vertex_count; v++)
        value[v] = vec3_dot(slope, m.patches->position[v]);
    for (uint32_t k = 0; k < 30000; k++) {
        const uint32_t f = k % 3;
        double s = next_random(&seed) / (double)(1 << 24);
        double t = next_random(&seed) / (double)(1 << 24);
        if (f > 0 && s + t > 1) {
            s = 1 - s;
            t = 1 - t;
        }
        SurfacePoint at;
        surfaces_point(m.surfaces, f, s, t, &at);
        assert_true(fabs(interpolated(&m, f, k / 3 % 2, s, t, value)
                         - vec3_dot(slope, at.point)) < 1e-12);
    }
    free(value);
    mesh_clear(&m);
}

/* Points of patches are found again and weigh what they should, on all kinds of surfaces. */
static void test_points(void **state)
{
    (void)state;
    Mesh m;
    uint32_t seed = 31;
    mesh_of_everything(&m, 2);
    for (int round = 0; round < 3; round++)
        mesh_split_some(&m, 8, &seed);
    for (uint32_t i = 0; i < m.patches->count; i++) {
        enum { N = 8 };
        double mean = 0;
        for (uint32_t k = 0; k < N * N; k++) {
            PatchPoint at;
            patches_point(m.patches, m.surfaces, i, (k % N + 0.5) / N, (k / N + 0.5) / N, &at);
            mean += at.weight / (N * N);
            assert_int_equal(patches_at(m.patches, m.surfaces, at.surface, m.patches->side[i],
                                        at.s, at.t), i);
            assert_true(patches_weight(m.patches, m.surfaces, i, at.surface, at.s, at.t)
                        == at.weight);
        }
        /* As for undivided ones in test_patches: a jump along a diagonal, or a bent density. */
        assert_true(fabs(mean - 1) < 1.0 / N);
    }
    mesh_clear(&m);
}

/* The four children of cells, as the header lists them, come in that order. */
static void test_order(void **state)
{
    (void)state;
    static const PatchCell quad[4] = { { 0, 0, 0, 1 }, { 1, 0, 0, 1 }, { 0, 1, 0, 1 },
                                       { 1, 1, 0, 1 } };
    static const PatchCell lower[4] = { { 0, 0, 0, 1 }, { 1, 0, 0, 1 }, { 0, 1, 0, 1 },
                                        { 0, 0, 1, 1 } };
    static const PatchCell upper[4] = { { 1, 0, 1, 1 }, { 0, 1, 1, 1 }, { 1, 1, 1, 1 },
                                        { 1, 1, 0, 1 } };
    Mesh m;
    soup_start(&m.soup);
    soup_polygon(&m.soup, (Vec3[]){ { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } }, 4, 0, 0);
    soup_polygon(&m.soup, (Vec3[]){ { 5, 0, 0 }, { 7, 0, 0 }, { 5, 2, 0 } }, 3, 0, 0);
    mesh_make(&m, &(PatchOptions){ .size = 1.2, .sides = (const uint8_t[]){ 1, 1 } });
    assert_int_equal(m.patches->count, 5);
    mesh_split(&m, (const uint8_t[]){ 1, 1, 1, 0, 1 });
    /* Triangle: cell 0, cell 1 (upper), cell 2, cell 3; both neighbours are halved alike. */
    assert_int_equal(m.patches->count, 4 + 4 + 4 + 1 + 4);
    assert_memory_equal(m.patches->cell, quad, sizeof quad);
    assert_memory_equal(m.patches->cell + 4, lower, sizeof lower);
    assert_memory_equal(m.patches->cell + 8, upper, sizeof upper);
    assert_int_equal(m.patches->cell[12].level, 0);
    assert_int_equal(m.patches->face_of[16], 16);
    mesh_clear(&m);
}

/* At the last level a patch stays whole. */
static void test_last_level(void **state)
{
    (void)state;
    Mesh m;
    soup_start(&m.soup);
    soup_polygon(&m.soup, (Vec3[]){ { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } }, 4, 0, 0);
    mesh_make(&m, &(PatchOptions){ .size = 2, .sides = (const uint8_t[]){ 1 } });
    uint32_t before = 0;
    for (int round = 0; round < PATCH_LEVELS + 2; round++) {
        Error err = { 0 };
        uint32_t *parent = NULL;
        uint8_t *split = calloc(m.patches->count, 1);
        assert_non_null(split);
        split[patches_at(m.patches, m.surfaces, 0, 0, 0.3, 0.4)] = 1;
        before = m.patches->count;
        Patches *p = patches_split(m.patches, m.surfaces, split, &parent, &err);
        assert_non_null(p);
        assert_true(patches_check(p, m.surfaces));
        patches_destroy(m.patches);
        m.patches = p;
        assert_true(round < PATCH_LEVELS ? p->count > before : p->count == before);
        array_free(parent);
        free(split);
    }
    mesh_clear(&m);
}

static void test_no_memory(void **state)
{
    (void)state;
    Mesh m;
    uint32_t seed = 37;
    mesh_of_everything(&m, 2);
    mesh_split_some(&m, 8, &seed);
    uint8_t *split = calloc(m.patches->count, 1);
    assert_non_null(split);
    for (uint32_t i = 0; i < m.patches->count; i += 5)
        split[i] = 1;
    const long before = array_live();
    for (long n = 0;; n++) {
        Error err = { 0 };
        uint32_t *parent = NULL;
        array_fail_after(n);
        Patches *p = patches_split(m.patches, m.surfaces, split, &parent, &err);
        array_fail_after(-1);
        if (p != NULL) {
            assert_true(n > 10);
            patches_destroy(p);
            array_free(parent);
            break;
        }
        assert_int_equal(err.code, ERROR_MEMORY);
        assert_null(parent);
        assert_int_equal(array_live(), before);
    }
    free(split);
    mesh_clear(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_closed_blocks),
        cmocka_unit_test(test_closed_shapes),
        cmocka_unit_test(test_balance),     cmocka_unit_test(test_short_edge),
        cmocka_unit_test(test_unlike_grids),
        cmocka_unit_test(test_outlines),
        cmocka_unit_test(test_linear),
        cmocka_unit_test(test_points),
        cmocka_unit_test(test_order),
        cmocka_unit_test(test_last_level),
        cmocka_unit_test(test_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
