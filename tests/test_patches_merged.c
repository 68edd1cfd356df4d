/* SPDX-License-Identifier: BSD-3-Clause */
/* Patches of many small surfaces: numbers as wanted, faces without cracks, points, splitting. */
#include "tests/patch_tools.h"

/* A ball of 2 * u_count * (v_count - 1) triangles beside a large box. */
static void ball_and_box(Mesh *m, int u_count, int v_count)
{
    soup_start(&m->soup);
    soup_box(&m->soup, vec3(3, 0, 0), vec3(7, 4, 4), 0, 0);
    Vec3 *row[2] = { calloc((size_t)u_count, sizeof(Vec3)), calloc((size_t)u_count, sizeof(Vec3)) };
    assert_true(row[0] != NULL && row[1] != NULL);
    for (int j = 0; j <= v_count; j++) {
        Vec3 *p = row[j % 2], *q = row[(j + 1) % 2];
        for (int i = 0; i < u_count; i++) {
            const double a = 2 * M_PI * i / u_count, h = M_PI * j / v_count;
            const double r = j == 0 || j == v_count ? 0 : sin(h);
            p[i] = vec3(r * cos(a), r * sin(a), j == 0 ? 1 : j == v_count ? -1 : cos(h));
        }
        for (int i = 0; j > 0 && i < u_count; i++) {
            const int next = (i + 1) % u_count;
            if (j < v_count)
                soup_polygon(&m->soup, (Vec3[]){ q[i], p[i], p[next] }, 3, 0, 0);
            if (j > 1)
                soup_polygon(&m->soup, (Vec3[]){ q[i], p[next], q[next] }, 3, 0, 0);
        }
    }
    free(row[0]);
    free(row[1]);
}

/* More triangles than patches are wanted: numbers within 20 % all the same, and the box gets its
 * share. */
static void test_wanted(void **state)
{
    (void)state;
    const uint32_t wanted[] = { 500, 2000, 5000, 30000 };
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        Mesh m;
        ball_and_box(&m, 90, 60);
        mesh_make(&m, &(PatchOptions){ .wanted = wanted[i] });
        assert_true(m.surfaces->closed);
        assert_true(fabs((double)m.patches->count - wanted[i]) <= 0.2 * wanted[i]);
        assert_true(m.patches->nu[0] > 1);
        for (unsigned side = 0; side < 2; side++)
            assert_int_equal(euler(m.patches, side), 2 * 2);
        mesh_clear(&m);
    }
    Mesh m;
    ball_and_box(&m, 90, 60);
    mesh_make(&m, &(PatchOptions){ .wanted = 2000, .separate = true });
    assert_int_equal(m.patches->first_piece[m.patches->count], 0);
    assert_true(m.patches->count > 2 * m.surfaces->count);
    mesh_clear(&m);
}

/* Areas, centres and normals against sums over the pieces' own corners. */
static void test_measures(void **state)
{
    (void)state;
    Mesh m;
    ball_and_box(&m, 40, 30);
    mesh_make(&m, &(PatchOptions){ .size = 0.5 });
    const Patches *p = m.patches;
    uint32_t merged = 0;
    for (uint32_t i = 0; i < p->count; i++) {
        const uint32_t pieces = p->first_piece[i + 1] - p->first_piece[i];
        Vec3 centroid = { 0 }, vector = { 0 };
        double area = 0;
        if (pieces == 0)
            continue;
        merged++;
        for (uint32_t k = p->first_piece[i]; k < p->first_piece[i + 1]; k++) {
            SurfacePoint at;
            surfaces_point(m.surfaces, p->piece[k], 1 / 3.0, 1 / 3.0, &at);
            assert_int_equal(m.surfaces->surface[p->piece[k]].kind, SURFACE_TRIANGLE);
            area += at.density / 2;
            centroid = vec3_mad(centroid, at.density / 2, at.point);
            vector = vec3_mad(vector, p->side[i] == 0 ? 1 : -1, vec3_scale(at.normal, at.density));
            assert_true(fabs(p->piece_end[k] * p->area[i] - area) < 1e-12);
        }
        assert_true(fabs(area - p->area[i]) < 1e-12);
        assert_true(vec3_dot(vec3_unit(vector), p->normal[i]) > 1 - 1e-12);
        assert_true(fabs(patches_extent(p, m.surfaces, i) - sqrt(area)) < 1e-12);
        /* On the ball: above the centroid, which is inside, by no more than the ball is bent. */
        centroid = vec3_scale(centroid, 1 / area);
        assert_true(vec3_length(vec3_sub(p->centre[i], centroid)) < 0.2);
        const double radius = vec3_length(p->centre[i]);
        assert_true(radius <= 1 + 1e-12 && radius > cos(M_PI / 30) - 1e-3);
    }
    assert_true(merged > 20);
    mesh_clear(&m);
}

/* Points choose pieces by area, with (s, t) that name the patch again. */
static void test_points(void **state)
{
    (void)state;
    Mesh m;
    ball_and_box(&m, 40, 30);
    mesh_make(&m, &(PatchOptions){ .size = 0.5 });
    const Patches *p = m.patches;
    for (uint32_t i = 0; i < p->count; i++) {
        enum { N = 400 };
        const uint32_t first = p->first_piece[i], pieces = p->first_piece[i + 1] - first;
        if (pieces == 0)
            continue;
        double *share = calloc(pieces, sizeof *share);
        assert_non_null(share);
        for (int k = 0; k < N; k++) {
            PatchPoint at;
            patches_point(p, m.surfaces, i, (k + 0.5) / N, fmod(k * 0.618, 1), &at);
            assert_int_equal(patches_at(p, m.surfaces, at.surface, p->side[i], at.s, at.t), i);
            assert_true(at.weight == 1);
            for (uint32_t j = 0; j < pieces; j++)
                share[j] += p->piece[first + j] == at.surface ? 1.0 / N : 0;
        }
        for (uint32_t j = 0; j < pieces; j++)
            assert_true(fabs(share[j] - m.surfaces->surface[p->piece[first + j]].area / p->area[i])
                        < 1.0 / N);
        free(share);
    }
    mesh_clear(&m);
}

/* Quads that are no parallelograms as pieces: weights have mean 1. */
static void test_bent_pieces(void **state)
{
    (void)state;
    Mesh m;
    soup_start(&m.soup);
    for (int k = 0; k < 6; k++)
        soup_polygon(&m.soup, (Vec3[]){ { k, 0, 0 }, { k + 1, 0, 0 }, { k + 1, k % 2 ? 1 : 2, 0 },
                                        { k, k % 2 ? 2 : 1, 0 } }, 4, 0, 0);
    mesh_make(&m, &(PatchOptions){ .size = 3 });
    assert_true(m.patches->first_piece[m.patches->count] > 0);
    for (uint32_t i = 0; i < m.patches->count; i++) {
        enum { N = 240 };
        double mean = 0;
        for (int k = 0; k < N * N; k++) {
            PatchPoint at;
            patches_point(m.patches, m.surfaces, i, (k % N + 0.5) / N, (k / N + 0.5) / N, &at);
            mean += at.weight / (N * N);
            assert_true(patches_weight(m.patches, m.surfaces, i, at.surface, at.s, at.t)
                        == at.weight);
        }
        /* The midpoint rule errs by 1 / N of the jump at each piece's diagonal. */
        assert_true(fabs(mean - 1) < 6.0 / N);
    }
    mesh_clear(&m);
}

/* Whatever is split, merged or not: closed, interpolated without breaks, until all is single. */
static void test_split(void **state)
{
    (void)state;
    Mesh m;
    uint32_t seed = 41;
    ball_and_box(&m, 20, 14);
    mesh_make(&m, &(PatchOptions){ .size = 1.5 });
    assert_true(m.patches->first_piece[m.patches->count] > 0);
    for (int round = 0; round < 6; round++) {
        mesh_split_some(&m, 3, &seed);
        for (unsigned side = 0; side < 2; side++)
            assert_int_equal(euler(m.patches, side), 2 * 2);
        if (round % 3 == 2)
            check_outlines(&m);
    }
    for (;;) {
        const Patches *p = m.patches;
        uint8_t *split = calloc(p->count, 1);
        assert_non_null(split);
        bool any = false;
        for (uint32_t i = 0; i < p->count; i++) {
            split[i] = p->first_piece[i + 1] > p->first_piece[i];
            any = any || split[i];
        }
        if (any)
            mesh_split(&m, split);
        free(split);
        if (!any)
            break;
    }
    assert_int_equal(euler(m.patches, 0), 2 * 2);
    mesh_clear(&m);
}

static void test_no_memory(void **state)
{
    (void)state;
    Mesh m;
    ball_and_box(&m, 12, 8);
    mesh_make(&m, &(PatchOptions){ .wanted = 80 });
    patches_destroy(m.patches);
    const long before = array_live();
    for (long n = 0;; n++) {
        Error err = { 0 };
        array_fail_after(n);
        m.patches = patches_create(m.surfaces, &(PatchOptions){ .wanted = 80 }, NULL, &err);
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
        cmocka_unit_test(test_wanted),
        cmocka_unit_test(test_measures),
        cmocka_unit_test(test_points),
        cmocka_unit_test(test_bent_pieces),
        cmocka_unit_test(test_split),
        cmocka_unit_test(test_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
