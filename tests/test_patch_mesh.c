/* SPDX-License-Identifier: BSD-3-Clause */
/* The patches' polygons: no crack, vertices shared where the surface is smooth, any soup. */
#include "tests/patch_tools.h"

/* V - E + F = 2, by position. The triangles' divisions differ from the quads', so there are
 * vertices on edges of coarser neighbours. */
static void test_euler(void **state)
{
    (void)state;
    const Vec3 *block[] = { cube, skew };
    const unsigned cut[] = { 0, 1u << 0, 1u << 0 | 1u << 3, 63 };
    const double size[] = { 3, 0.5, 0.37, 0.1, 0.031 };
    size_t differing = 0;
    for (int s = 0; s < 2 * 4 * 5; s++) {
        Mesh m;
        soup_start(&m.soup);
        soup_block(&m.soup, block[s % 2], cut[s / 2 % 4], 0);
        mesh_make(&m, &(PatchOptions){ .size = size[s / 8] });
        assert_true(m.surfaces->closed);
        for (uint32_t f = 0; f < m.patches->face_count; f++)
            differing += m.patches->first_corner[f + 1] - m.patches->first_corner[f] > 4;
        assert_int_equal(euler(m.patches, 0), 2);
        mesh_clear(&m);
    }
    assert_true(differing > 100);
}

/* A ball of triangles, each of another size: closed, and smooth, so that all vertices are shared:
 * V - E + F = 2 by vertex numbers too, on both sides. */
static void test_smooth_ball(void **state)
{
    (void)state;
    enum { U = 17, V = 13 };
    Mesh m;
    soup_start(&m.soup);
    Vec3 p[V + 1][U];
    for (int j = 0; j <= V; j++)
        for (int i = 0; i < U; i++) {
            const double a = 2 * M_PI * i / U, h = M_PI * pow((double)j / V, 1.2);
            p[j][i] = j == 0 ? vec3(0, 0, 1) : j == V ? vec3(0, 0, -1)
                    : vec3(sin(h) * cos(a), sin(h) * sin(a), cos(h));
        }
    for (int j = 0; j < V; j++)
        for (int i = 0; i < U; i++) {
            const Vec3 a = p[j][i], b = p[j + 1][i], c = p[j + 1][(i + 1) % U],
                       d = p[j][(i + 1) % U];
            if (j < V - 1)
                soup_polygon(&m.soup, (Vec3[]){ a, b, c }, 3, 0, 0);
            if (j == V - 1)
                soup_polygon(&m.soup, (Vec3[]){ a, b, d }, 3, 0, 0);
            else if (j > 0)
                soup_polygon(&m.soup, (Vec3[]){ a, c, d }, 3, 0, 0);
        }
    mesh_make(&m, &(PatchOptions){ .size = 0.05 });
    assert_true(m.surfaces->closed);
    assert_int_equal(m.surfaces->repairs.degenerate, 0);
    assert_int_equal(euler(m.patches, 0), 2);
    /* Both sides have vertices of their own, nothing else is split. */
    assert_int_equal(m.patches->vertex_count, 2 * count_points(m.patches, 0));
    mesh_clear(&m);
}

/* Vertices are shared over flat edges and split at creases and material borders; a neighbour wound
 * the other way round shares them with its back. */
static void test_sharing(void **state)
{
    (void)state;
    static const struct {
        double   height;    /* of the second square's far edge */
        uint32_t material;
        bool     turned;
        uint32_t vertices;  /* on both sides; two squares cut 2 x 2 */
    } cases[] = {
        { 0, 0, false, 2 * 15 },
        { 0.2, 0, false, 2 * 15 },  /* 11 degrees */
        { 1, 0, false, 2 * 18 },    /* 45 degrees */
        { 0, 1, false, 2 * 18 },
        { 0.2, 0, true, 2 * 15 },
        { 1, 0, true, 2 * 18 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double h = cases[i].height, length = sqrt(1 - h * h / 2);
        Mesh m;
        soup_start(&m.soup);
        const Vec3 a = { 1, 0, 0 }, b = { 1 + length, 0, h }, c = { 1 + length, 1, h },
                   d = { 1, 1, 0 };
        soup_polygon(&m.soup, (Vec3[]){ { 0, 0, 0 }, a, d, { 0, 1, 0 } }, 4, 0, 0);
        if (cases[i].turned)
            soup_polygon(&m.soup, (Vec3[]){ d, c, b, a }, 4, cases[i].material, 0);
        else
            soup_polygon(&m.soup, (Vec3[]){ a, b, c, d }, 4, cases[i].material, 0);
        mesh_make(&m, &(PatchOptions){ .size = 0.7 });
        assert_int_equal(m.patches->count, 16);
        assert_int_equal(m.patches->vertex_count, cases[i].vertices);
        mesh_clear(&m);
    }
}

/* Patches of a shape lie like it: chord polygons turn the way the normal points, vertices on the
 * surface, poles with three corners. */
static void test_shape_polygons(void **state)
{
    (void)state;
    Mesh m;
    mesh_of_everything(&m, 0.3);
    const Patches *p = m.patches;
    for (uint32_t i = 0; i < p->count; i++) {
        const uint32_t n = p->first_corner[i + 1] - p->first_corner[i];
        const uint32_t *c = p->corner + p->first_corner[i];
        if (m.surfaces->surface[p->surface[i]].kind != SURFACE_SHAPE)
            continue;
        assert_true(n == 3 || n == 4);
        const Vec3 *q = p->position;
        const Vec3 d = vec3_cross(vec3_sub(q[c[2]], q[c[0]]),
                                  vec3_sub(q[c[n - 1]], q[c[1]]));
        assert_true(vec3_dot(d, p->normal[i]) > 0);
    }
    mesh_clear(&m);
}

/* Polygons between random points of a small lattice: faces that repeat, fold, cross themselves,
 * share edges by the dozen, at every scale and with points that are none. All checks must hold. */
static void test_random_soups(void **state)
{
    (void)state;
    const double scale[] = { 1, 1e-3, 1e6, 1e-200, 1e160, 1e300 };
    uint32_t seed = 7;
    int made = 0;
    for (int round = 0; round < 600; round++) {
        Mesh m;
        soup_start(&m.soup);
        const uint32_t side = 2 + next_random(&seed) % 3, faces = 1 + next_random(&seed) % 40;
        for (uint32_t f = 0; f < faces; f++) {
            Vec3 p[8];
            const size_t n = 3 + next_random(&seed) % 6;
            for (size_t i = 0; i < n; i++) {
                p[i] = vec3(next_random(&seed) % side, next_random(&seed) % side,
                            round % 3 == 0 ? 0 : next_random(&seed) % side);
                p[i] = vec3_scale(p[i], scale[round % 6]);
                if (next_random(&seed) % 500 == 0)
                    p[i].x = round % 2 ? NAN : INFINITY;
            }
            soup_polygon(&m.soup, p, n, next_random(&seed) % 2, 0);
        }
        Error err = { 0 };
        m.patches = NULL;
        m.surfaces = surfaces_create(&m.soup, NULL, &err);
        if (m.surfaces != NULL) {
            assert_true(surfaces_check(m.surfaces));
            m.patches = patches_create(m.surfaces, &(PatchOptions){ .wanted = 200 }, NULL, &err);
            assert_non_null(m.patches);
            assert_true(patches_check(m.patches, m.surfaces));
            made++;
        } else {
            assert_int_equal(err.code, ERROR_INPUT);
        }
        mesh_clear(&m);
    }
    /* Half of the scales have areas beyond a double: those must say so. */
    assert_true(made > 200);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_euler),
        cmocka_unit_test(test_smooth_ball),
        cmocka_unit_test(test_sharing),
        cmocka_unit_test(test_shape_polygons),
        cmocka_unit_test(test_random_soups),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
