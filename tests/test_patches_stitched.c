/* SPDX-License-Identifier: BSD-3-Clause */
/* Patches of surfaces with corners of others on their edges: no crack, smooth across each piece. */
#include "tests/patch_tools.h"

/* A unit cube whose lid is three pieces: the half y < h, and two quarters beyond it that meet at
 * x = w. Corners lie inside four edges. */
static void pieced_cube(Mesh *m, double w, double h, bool triangles)
{
    soup_start(&m->soup);
    soup_block(&m->soup, cube, triangles ? 1 | 4 : 0, 2);
    soup_polygon(&m->soup, (Vec3[]){ { 0, 0, 1 }, { 1, 0, 1 }, { 1, h, 1 }, { 0, h, 1 } }, 4, 0, 0);
    soup_polygon(&m->soup, (Vec3[]){ { 0, h, 1 }, { w, h, 1 }, { w, 1, 1 }, { 0, 1, 1 } }, 4, 0, 0);
    if (triangles) {
        soup_polygon(&m->soup, (Vec3[]){ { w, h, 1 }, { 1, h, 1 }, { 1, 1, 1 } }, 3, 0, 0);
        soup_polygon(&m->soup, (Vec3[]){ { w, h, 1 }, { 1, 1, 1 }, { w, 1, 1 } }, 3, 0, 1);
    } else {
        soup_polygon(&m->soup, (Vec3[]){ { w, h, 1 }, { 1, h, 1 }, { 1, 1, 1 }, { w, 1, 1 } }, 4,
                     0, 0);
    }
}

/* Corners that are one vertex. */
typedef struct {
    Vec3     normal, position;
    uint32_t vertex;
} Corner;

static int corner_compare(const void *a, const void *b) { return memcmp(a, b, sizeof(Corner)); }

/* On a cube corners of faces are one vertex if and only if they have the same place and the same
 * wall. */
static void check_sharing(const Patches *p)
{
    const uint32_t n = p->first_corner[p->face_count];
    Corner *corner = calloc(n, sizeof *corner);
    assert_non_null(corner);
    for (uint32_t f = 0; f < p->face_count; f++)
        for (uint32_t c = p->first_corner[f]; c < p->first_corner[f + 1]; c++) {
            const Vec3 normal = p->normal[p->face_patch[f]];
            /* Normals of a cube's walls are whole numbers but for rounding. */
            corner[c].normal = vec3(round(normal.x) + 0.0, round(normal.y) + 0.0,
                                    round(normal.z) + 0.0);
            corner[c].position = plus_zero(p->position[p->corner[c]]);
            corner[c].vertex = p->corner[c];
        }
    qsort(corner, n, sizeof *corner, corner_compare);
    uint32_t different = 0;
    for (uint32_t c = 0; c < n; c++) {
        const bool first = c == 0 || memcmp(&corner[c - 1], &corner[c], 2 * sizeof(Vec3)) != 0;
        different += first;
        assert_true(first || corner[c].vertex == corner[c - 1].vertex);
    }
    /* One vertex for each, and none for two, else there would be fewer. */
    assert_int_equal(different, p->vertex_count);
    free(corner);
}

static void test_cubes(void **state)
{
    (void)state;
    static const double place[3][2] = { { 0.5, 0.5 }, { 0.3, 0.6 }, { 1 / 3.0, 0.01 } };
    uint32_t seed = 43, stitches = 0;
    for (int s = 0; s < 3 * 2 * 3; s++) {
        Mesh m;
        pieced_cube(&m, place[s % 3][0], place[s % 3][1], s / 3 % 2 == 1);
        mesh_make(&m, &(PatchOptions){ .size = s / 6 == 0 ? 2 : s / 6 == 1 ? 0.5 : 0.17,
                                       .separate = true });
        assert_true(m.surfaces->closed);
        stitches += m.surfaces->repairs.stitched;
        for (int round = 0; round < 4; round++) {
            for (unsigned side = 0; side < 2; side++)
                assert_int_equal(euler(m.patches, side), 2);
            check_sharing(m.patches);
            check_outlines(&m);
            mesh_split_some(&m, 4 + (uint32_t)round, &seed);
        }
        mesh_clear(&m);
    }
    assert_int_equal(stitches, 3 * 2 * 3 * 4);
}

/* With cells of the same size everywhere balance is 2:1 over stitched edges too: inside the lid no
 * edge of a face has anything but its middle. */
static void test_balance(void **state)
{
    (void)state;
    Mesh m;
    size_t between = 0;
    pieced_cube(&m, 0.5, 0.5, false);
    mesh_make(&m, &(PatchOptions){ .size = 0.5, .separate = true });
    for (int round = 0; round < 6; round++) {
        const Patches *p = m.patches;
        uint8_t *split = calloc(p->count, 1);
        assert_non_null(split);
        /* The patch of the half next to the corner of the quarters. */
        uint32_t nearest = 0;
        for (uint32_t i = 0; i < p->count; i++) {
            const Vec3 d = vec3_sub(p->centre[i], vec3(0.49, 0.499, 1));
            const Vec3 e = vec3_sub(p->centre[nearest], vec3(0.49, 0.499, 1));
            if (p->side[i] == 0 && vec3_length(d) < vec3_length(e))
                nearest = i;
        }
        split[nearest] = 1;
        mesh_split(&m, split);
        free(split);
        p = m.patches;
        for (uint32_t c = 0; c < p->first_corner[p->face_count]; c++) {
            const double at = p->corner_along[c] - floor(p->corner_along[c]);
            const Vec3 v = p->position[p->corner[c]];
            if (v.z != 1 || v.x == 0 || v.x == 1 || v.y == 0 || v.y == 1 || at == 0)
                continue;
            assert_true(fabs(at - 0.5) < 1e-12);
            between++;
        }
    }
    assert_true(between > 10);
    mesh_clear(&m);
}

/* A corner nearer to a division point than positions are known is that point. */
static void test_near_points(void **state)
{
    (void)state;
    Mesh m;
    pieced_cube(&m, 0.5 + 1e-7, 0.5, false);
    mesh_make(&m, &(PatchOptions){ .size = 0.25, .separate = true });
    for (unsigned side = 0; side < 2; side++)
        assert_int_equal(euler(m.patches, side), 2);
    check_sharing(m.patches);
    /* 6 walls of 4 x 4 cells: all corners fall together. */
    assert_int_equal(count_points(m.patches, 0), 6 * 16 + 2);
    mesh_clear(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cubes),
        cmocka_unit_test(test_balance),
        cmocka_unit_test(test_near_points),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
