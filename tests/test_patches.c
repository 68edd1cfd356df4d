/* SPDX-License-Identifier: BSD-3-Clause */
/* Patches: exact areas, lookup and sampling agree, interpolation, counts as wanted. */
#include "tests/soup_tools.h"

/* Numbers in [0, 1) that need no library: the additive recurrence with the golden ratio's kin. */
static double spread(uint32_t i, double step) { return fmod(0.5 + i * step, 1.0); }

/* --- areas and points ------------------------------------------------------------------------- */

static void test_areas(void **state)
{
    (void)state;
    Mesh m;
    soup_start(&m.soup);
    const Affine map = { { 2, 0, 0 }, { 0, 2, 0 }, { 0, 0, 2 }, { 1, 2, 3 } };
    soup_shape(&m.soup, SHAPE_SPHERE, 1, &map);
    mesh_make(&m, &(PatchOptions){ .size = 0.3 });
    double area[2] = { 0, 0 };
    for (uint32_t i = 0; i < m.patches->count; i++)
        area[m.patches->side[i]] += m.patches->area[i];
    assert_true(fabs(area[0] - 16 * M_PI) < 1e-9 * 16 * M_PI);
    assert_true(fabs(area[1] - 16 * M_PI) < 1e-9 * 16 * M_PI);
    assert_true(fabs(m.patches->total_area - 32 * M_PI) < 1e-9 * 32 * M_PI);
    mesh_clear(&m);
}

/* Cells of a trapezoid with corners (0,0) (4,0) (1,1) (0,1): areas by hand. The shorter diagonal
 * runs from (0,0) to (1,1): halves of area 2 and 1/2, so s,t cells away from the diagonal of a
 * 2 x 2 grid have 2 * 2 / 4 = 1 and 1/4, those on it half of each. */
static void test_trapezoid(void **state)
{
    (void)state;
    Mesh m;
    soup_start(&m.soup);
    soup_polygon(&m.soup, (Vec3[]){ { 0, 0, 0 }, { 4, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } }, 4, 0, 0);
    /* bc is sqrt 10: 2 cells of at most 2 */
    mesh_make(&m, &(PatchOptions){ .size = 2, .sides = (const uint8_t[]){ 1 } });
    const double expected[4] = { 0.625, 1, 0.25, 0.625 };
    assert_int_equal(m.patches->count, 4);
    for (uint32_t i = 0; i < 4; i++) {
        const double s = (i % 2 + 0.5) / 2, t = (i / 2 + 0.5) / 2;
        const uint32_t patch = patches_at(m.patches, m.surfaces, 0, 0, s, t);
        SurfacePoint at;
        surfaces_point(m.surfaces, 0, s, t, &at);
        /* whichever corner the quad starts at, the cell nearest to (4,0) is the one of area 1 */
        const double *e = &expected[at.point.x > 2 ? 1 : at.point.y > at.point.x + 0.1 ? 2 : 0];
        assert_true(fabs(m.patches->area[patch] - *e) < 1e-14);
    }
    mesh_clear(&m);
}

static void test_points(void **state)
{
    (void)state;
    Mesh m;
    mesh_of_everything(&m, 0.6);
    const Patches *p = m.patches;
    for (uint32_t i = 0; i < p->count; i++) {
        enum { N = 32 };
        double mean = 0;
        Vec3 point_mean = { 0 };
        for (uint32_t k = 0; k < N * N; k++) {
            PatchPoint at;
            patches_point(p, m.surfaces, i, (k % N + 0.5) / N, (k / N + 0.5) / N, &at);
            mean += at.weight / (N * N);
            point_mean = vec3_mad(point_mean, at.weight / (N * N), at.point.point);
            assert_int_equal(patches_at(p, m.surfaces, p->surface[i], p->side[i], at.s, at.t), i);
            assert_true(vec3_dot(at.point.normal, p->normal[i]) > -0.2);
        }
        /* Midpoint rule: exact where density is constant, off by 1 / (24 N^2) of the second
         * derivative where it curves, by at most 1 / N of the jump where a diagonal crosses. */
        assert_true(fabs(mean - 1) < (m.surfaces->surface[p->surface[i]].kind == SURFACE_QUAD
                                          ? 1.0 / N : 10.0 / (N * N)));
        assert_true(vec3_length(vec3_sub(point_mean, p->centre[i])) < 0.6);
    }
    /* Random points, rims included. */
    for (uint32_t k = 0; k < 200000; k++) {
        const uint32_t i = k % p->count;
        PatchPoint at;
        patches_point(p, m.surfaces, i, k % 7 == 0 ? 0 : spread(k, 0.7548776662466927),
                      k % 5 == 0 ? 1 - 0x1p-24 : spread(k, 0.5698402909980532), &at);
        assert_int_equal(patches_at(p, m.surfaces, p->surface[i], p->side[i], at.s, at.t), i);
    }
    mesh_clear(&m);
}

/* Off the square by rounding, and nonsense: some patch of the surface, never another's. */
static void test_lookup_outside(void **state)
{
    (void)state;
    Mesh m;
    mesh_of_everything(&m, 0.6);
    const double odd[] = { -1e-9, -0.0, 0, 1e-300, 0.5, 1 - 1e-16, 1, 1 + 1e-9, 2, NAN };
    const size_t n = sizeof odd / sizeof *odd;
    for (uint32_t f = 0; f < m.surfaces->count; f++)
        for (size_t k = 0; k < n * n; k++)
            for (unsigned side = 0; side < 2; side++) {
                const uint32_t i = patches_at(m.patches, m.surfaces, f, side, odd[k % n],
                                              odd[k / n]);
                assert_true(i < m.patches->count);
                assert_int_equal(m.patches->surface[i], f);
                assert_int_equal(m.patches->side[i], side);
            }
    mesh_clear(&m);
}

/* --- interpolation ---------------------------------------------------------------------------- */

/* The value of a vertex is its height above a slanted plane: a parallelogram and a triangle give it
 * back at every point, other surfaces at their vertices; weights sum to 1 everywhere. */
static void test_interpolation(void **state)
{
    (void)state;
    Mesh m;
    soup_start(&m.soup);
    soup_polygon(&m.soup, (Vec3[]){ { 0, 0, 0 }, { 3, 1, 0 }, { 4, 3, 1 }, { 1, 2, 1 } }, 4, 0, 0);
    soup_polygon(&m.soup, (Vec3[]){ { 5, 0, 0 }, { 9, 0, 1 }, { 5, 3, 0 } }, 3, 1, 0);
    mesh_make(&m, &(PatchOptions){ .size = 0.4 });
    const Vec3 slope = { 0.3, -1.7, 0.9 };
    for (uint32_t k = 0; k < 20000; k++) {
        const uint32_t f = k % 2;
        const unsigned side = k / 2 % 2;
        double s = spread(k, 0.7548776662466927), t = spread(k, 0.5698402909980532);
        if (f == 1 && s + t > 1) {
            s = 1 - s;
            t = 1 - t;
        }
        SurfacePoint at;
        uint32_t vertex[PATCH_WEIGHTS];
        double weight[PATCH_WEIGHTS], sum = 0, value = 0;
        surfaces_point(m.surfaces, f, s, t, &at);
        const int n = patches_interpolate(m.patches, m.surfaces, f, side, s, t, vertex, weight);
        assert_int_equal(n, f == 0 ? 4 : 3);
        for (int j = 0; j < n; j++) {
            assert_true(weight[j] >= 0);
            sum += weight[j];
            value += weight[j] * vec3_dot(slope, m.patches->position[vertex[j]]);
        }
        assert_true(fabs(sum - 1) < 1e-14);
        assert_true(fabs(value - vec3_dot(slope, at.point)) < 1e-12);
    }
    mesh_clear(&m);
}

/* The seam of a shape and its poles are single vertices: u = 0 and u = 1 interpolate alike. */
static void test_seams(void **state)
{
    (void)state;
    Mesh m;
    mesh_of_everything(&m, 0.4);
    for (uint32_t f = 0; f < m.surfaces->count; f++) {
        if (m.surfaces->surface[f].kind != SURFACE_SHAPE)
            continue;
        for (int k = 0; k < 100; k++) {
            const double t = k / 99.0;
            uint32_t left[PATCH_WEIGHTS], right[PATCH_WEIGHTS];
            double wl[PATCH_WEIGHTS], wr[PATCH_WEIGHTS];
            patches_interpolate(m.patches, m.surfaces, f, 0, 0, t, left, wl);
            patches_interpolate(m.patches, m.surfaces, f, 0, 1, t, right, wr);
            assert_int_equal(left[0], right[1]);
            assert_int_equal(left[3], right[2]);
            assert_true(wl[0] == wr[1] && wl[3] == wr[2] && wl[1] == 0 && wr[0] == 0);
        }
    }
    mesh_clear(&m);
}

/* On both sides of a smooth edge interpolation gives the same value. */
static void test_edge_continuity(void **state)
{
    (void)state;
    Mesh m;
    soup_start(&m.soup);
    soup_polygon(&m.soup, (Vec3[]){ { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } }, 4, 0, 0);
    soup_polygon(&m.soup, (Vec3[]){ { 1, 0, 0 }, { 2, 0, 0 }, { 2, 1, 0 }, { 1, 1, 0 } }, 4, 0, 0);
    mesh_make(&m, &(PatchOptions){ .size = 0.13 });
    for (int k = 0; k <= 100; k++) {
        double value[2] = { 0, 0 };
        for (uint32_t f = 0; f < 2; f++) {
            uint32_t vertex[PATCH_WEIGHTS];
            double weight[PATCH_WEIGHTS];
            /* x is s or t or their mirror, whichever way the square starts: look for the point */
            SurfacePoint at;
            const double y = k / 100.0;
            const double st[4][2] = { { 1, y }, { 0, y }, { y, 0 }, { y, 1 } };
            for (int c = 0; c < 8; c++) {
                const double s = c < 4 ? st[c][0] : 1 - st[c - 4][0];
                const double t = c < 4 ? st[c][1] : 1 - st[c - 4][1];
                surfaces_point(m.surfaces, f, s, t, &at);
                if (fabs(at.point.x - 1) > 1e-12 || fabs(at.point.y - y) > 1e-12)
                    continue;
                value[f] = 0;
                const int n = patches_interpolate(m.patches, m.surfaces, f, 0, s, t, vertex,
                                                  weight);
                for (int j = 0; j < n; j++)
                    value[f] += weight[j] * (vertex[j] % 97);
            }
        }
        assert_true(fabs(value[0] - value[1]) < 1e-9);
    }
    mesh_clear(&m);
}

/* --- numbers ---------------------------------------------------------------------------------- */

static void test_wanted(void **state)
{
    (void)state;
    const uint32_t wanted[] = { 0, 300, 1000, 5000, 50000 };
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        Mesh m;
        soup_start(&m.soup);
        soup_block(&m.soup, skew, 1, 0);
        soup_polygon(&m.soup, (Vec3[]){ { 5, 0, 0 }, { 9, 0, 1 }, { 5, 3, 0 } }, 3, 1, 0);
        const Affine map = affine_identity();
        soup_shape(&m.soup, SHAPE_SPHERE, 1, &map);
        mesh_make(&m, &(PatchOptions){ .wanted = wanted[i] });
        const double aim = wanted[i] == 0 ? 10000 : wanted[i];
        assert_true(fabs(m.patches->count - aim) <= 0.2 * aim);
        mesh_clear(&m);
    }
    /* Fewer than surface sides cannot be. */
    Mesh m;
    soup_start(&m.soup);
    soup_block(&m.soup, cube, 0, 0);
    mesh_make(&m, &(PatchOptions){ .wanted = 3 });
    assert_int_equal(m.patches->count, 12);
    mesh_clear(&m);
}

static void test_divisions(void **state)
{
    (void)state;
    /* 4 x 1 quad with patches of 0.5, of 0.51 and of 0.49; a size that would not end. */
    static const struct {
        double   size;
        uint32_t nu, nv;
    } cases[] = { { 0.5, 8, 2 }, { 0.51, 8, 2 }, { 0.49, 9, 3 }, { 5, 1, 1 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        Mesh m;
        soup_start(&m.soup);
        soup_polygon(&m.soup, (Vec3[]){ { 0, 0, 0 }, { 4, 0, 0 }, { 4, 1, 0 }, { 0, 1, 0 } }, 4, 0,
                     0);
        mesh_make(&m, &(PatchOptions){ .size = cases[i].size });
        const uint32_t nu = m.patches->nu[0], nv = m.patches->nv[0];
        assert_int_equal(nu > nv ? nu : nv, cases[i].nu);
        assert_int_equal(nu > nv ? nv : nu, cases[i].nv);
        assert_true(m.patches->size == cases[i].size);
        patches_destroy(m.patches);
        Error err = { 0 };
        m.patches = patches_create(m.surfaces, &(PatchOptions){ .size = 1e-9 }, NULL, &err);
        assert_null(m.patches);
        assert_int_equal(err.code, ERROR_INPUT);
        mesh_clear(&m);
    }
}

static void test_sides(void **state)
{
    (void)state;
    Mesh m;
    soup_start(&m.soup);
    soup_block(&m.soup, cube, 0, 0);
    const uint8_t sides[6] = { 1, 2, 3, 0, 1, 1 };
    mesh_make(&m, &(PatchOptions){ .size = 0.5, .sides = sides });
    assert_int_equal(m.patches->count, 4 * 6);
    uint32_t next = 0;
    for (uint32_t f = 0; f < 6; f++)
        for (unsigned side = 0; side < 2; side++) {
            const bool used = sides[f] >> side & 1;
            assert_int_equal(m.patches->first[side][f], used ? next : PATCH_NONE);
            next += used ? 4 : 0;
            uint32_t vertex[PATCH_WEIGHTS];
            double weight[PATCH_WEIGHTS];
            assert_int_equal(patches_interpolate(m.patches, m.surfaces, f, side, 0.5, 0.5, vertex,
                                                 weight), used ? 4 : 0);
            if (!used)
                assert_int_equal(patches_at(m.patches, m.surfaces, f, side, 0.5, 0.5), PATCH_NONE);
        }
    /* Polygons turn with their side: Newell's normal of each agrees with the patch's. */
    for (uint32_t i = 0; i < m.patches->count; i++) {
        const uint32_t *c = m.patches->corner + m.patches->first_corner[i];
        const Vec3 *p = m.patches->position;
        const Vec3 n = vec3_cross(vec3_sub(p[c[1]], p[c[0]]), vec3_sub(p[c[2]], p[c[0]]));
        assert_true(vec3_dot(vec3_unit(n), m.patches->normal[i]) > 0.999999);
    }
    mesh_clear(&m);
    soup_start(&m.soup);
    soup_block(&m.soup, cube, 0, 0);
    mesh_make(&m, &(PatchOptions){ .size = 0.5, .sides = (const uint8_t[6]){ 0 } });
    assert_int_equal(m.patches->count, 0);
    mesh_clear(&m);
}

static void test_no_memory(void **state)
{
    (void)state;
    Mesh m;
    mesh_of_everything(&m, 2);
    patches_destroy(m.patches);
    const long before = array_live();
    for (long n = 0;; n++) {
        Error err = { 0 };
        array_fail_after(n);
        m.patches = patches_create(m.surfaces, &(PatchOptions){ .size = 2 }, NULL, &err);
        array_fail_after(-1);
        if (m.patches != NULL) {
            assert_true(n > 10);
            break;
        }
        assert_int_equal(err.code, ERROR_MEMORY);
        assert_int_equal(array_live(), before);
    }
    mesh_clear(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_areas),
        cmocka_unit_test(test_trapezoid),
        cmocka_unit_test(test_points),
        cmocka_unit_test(test_lookup_outside),
        cmocka_unit_test(test_interpolation),
        cmocka_unit_test(test_seams),
        cmocka_unit_test(test_edge_continuity),
        cmocka_unit_test(test_wanted),
        cmocka_unit_test(test_divisions),
        cmocka_unit_test(test_sides),
        cmocka_unit_test(test_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
