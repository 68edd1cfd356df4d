/* SPDX-License-Identifier: BSD-3-Clause */
/* Polygons cut into triangles: areas and outlines kept, for every kind of outline. */
#include "mesh/triangulate.h"
#include "tests/soup_tools.h"

/* Shoelace formula: twice the signed area. */
static double shoelace(const Vec3 *p, size_t n)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += p[i].x * p[(i + 1) % n].y - p[(i + 1) % n].x * p[i].y;
    return sum / 2;
}

/* Length of the outline without bridges, which run to and fro. */
static double outline(const Vec3 *p, size_t n)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++) {
        const Vec3 a = p[i], b = p[(i + 1) % n];
        bool bridge = false;
        for (size_t j = 0; j < n; j++)
            bridge |= vec3_length(vec3_sub(p[j], b)) == 0
                   && vec3_length(vec3_sub(p[(j + 1) % n], a)) == 0;
        sum += bridge ? 0 : vec3_length(vec3_sub(b, a));
    }
    return sum;
}

/* Length of all edges without neighbour: the outline, if no triangle has another's corner on its
 * edge. */
static double rim_of(const Surfaces *s)
{
    double sum = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        const bool quad = s->surface[i].kind == SURFACE_QUAD;
        const uint32_t *c = s->corner + 3 * s->surface[i].primitive;
        const uint32_t corner[5] = { c[0], c[1], c[2], quad ? c[5] : c[0], c[0] };
        for (int k = 0; k < (quad ? 4 : 3); k++)
            if (s->surface[i].neighbour[k] == SURFACE_NONE)
                sum += vec3_length(vec3_sub(s->position[corner[k + 1]], s->position[corner[k]]));
    }
    return sum;
}

/* Area of the polygon as surfaces, in its own plane and in a tilted one, in both windings, each
 * triangle wound as the polygon. */
static void check_polygon(const Vec3 *p, size_t n, double area, uint32_t triangles)
{
    assert_true(fabs(fabs(shoelace(p, n)) - area) < 1e-9 * area);
    for (int variant = 0; variant < 4; variant++) {
        Polygons soup;
        soup_start(&soup);
        Vec3 *q = malloc(n * sizeof *q);
        assert_non_null(q);
        for (size_t i = 0; i < n; i++) {
            q[i] = p[variant & 1 ? n - 1 - i : i];
            /* x, y -> 3-4-5 and 5-12-13 rotations: exact lengths */
            if (variant & 2)
                q[i] = vec3(0.6 * q[i].x - 0.8 * q[i].y * 5 / 13,
                            0.8 * q[i].x + 0.6 * q[i].y * 5 / 13, q[i].y * 12 / 13);
        }
        soup_polygon(&soup, q, n, 0, 0);
        Surfaces *s = connect(&soup);
        assert_true(fabs(area_of(s) - area) < 1e-9 * area);
        assert_true(fabs(rim_of(s) - outline(q, n)) < 1e-9 * outline(q, n));
        assert_int_equal(s->triangle_count, triangles);
        assert_int_equal(s->repairs.degenerate, 0);
        assert_int_equal(s->repairs.nonmanifold + s->repairs.refused, 0);
        SurfacePoint first, other;
        surfaces_point(s, 0, 0.25, 0.25, &first);
        for (uint32_t i = 0; i < s->count; i++) {
            surfaces_point(s, i, 0.25, 0.25, &other);
            assert_true(vec3_dot(first.normal, other.normal) > 1 - 1e-6);
        }
        surfaces_destroy(s);
        polygons_clear(&soup);
        free(q);
    }
}

static void test_star(void **state)
{
    (void)state;
    /* n points on radius 2, n on radius 1 between: 2 n triangles from the centre of area
     * r R sin(pi / n) / 2 each. */
    enum { N = 7 };
    Vec3 p[2 * N];
    for (int i = 0; i < 2 * N; i++) {
        const double r = i % 2 == 0 ? 2 : 1, angle = M_PI * i / N;
        p[i] = vec3(3 + r * cos(angle), r * sin(angle), 0);
    }
    check_polygon(p, 2 * N, 2 * N * sin(M_PI / N), 2 * N - 2);
}

static void test_comb(void **state)
{
    (void)state;
    /* A bar 2 T x 1 with T - 1 teeth 1 x 5 on it. */
    enum { T = 12 };
    Vec3 p[4 * T];
    size_t n = 0;
    p[n++] = vec3(0, 0, 0);
    p[n++] = vec3(2 * T, 0, 0);
    p[n++] = vec3(2 * T, 1, 0);
    for (int i = T - 1; i > 0; i--) {
        p[n++] = vec3(2 * i + 1, 1, 0);
        p[n++] = vec3(2 * i + 1, 6, 0);
        p[n++] = vec3(2 * i, 6, 0);
        p[n++] = vec3(2 * i, 1, 0);
    }
    p[n++] = vec3(0, 1, 0);
    check_polygon(p, n, 2 * T + 5 * (T - 1), (uint32_t)n - 2);
}

static void test_bridged_hole(void **state)
{
    (void)state;
    /* 4 x 4 with a 2 x 1 hole, the bridge from (0, 0) to (1, 1); and with a second hole. */
    const Vec3 one[] = { { 0, 0, 0 }, { 4, 0, 0 }, { 4, 4, 0 }, { 0, 4, 0 }, { 0, 0, 0 },
                         { 1, 1, 0 }, { 1, 2, 0 }, { 3, 2, 0 }, { 3, 1, 0 }, { 1, 1, 0 } };
    check_polygon(one, 10, 14, 8);
    const Vec3 two[] = { { 0, 0, 0 }, { 4, 0, 0 }, { 4, 4, 0 }, { 3, 3, 0 }, { 3, 2.5, 0 },
                         { 2, 2.5, 0 }, { 2, 3, 0 }, { 3, 3, 0 }, { 4, 4, 0 }, { 0, 4, 0 },
                         { 0, 0, 0 }, { 1, 1, 0 }, { 1, 2, 0 }, { 3, 2, 0 }, { 3, 1, 0 },
                         { 1, 1, 0 } };
    check_polygon(two, 16, 16 - 2 - 0.5, 14);
}

static void test_corners_in_line(void **state)
{
    (void)state;
    /* A square with corners on its edges: all of them must become corners of triangles. */
    const Vec3 square[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 2, 0, 0 }, { 3, 0, 0 }, { 4, 0, 0 },
                            { 4, 2, 0 }, { 4, 4, 0 }, { 1, 4, 0 }, { 0, 4, 0 }, { 0, 1, 0 } };
    check_polygon(square, 10, 16, 8);
    const Vec3 quad[] = { { 0, 0, 0 }, { 2, 0, 0 }, { 4, 0, 0 }, { 0, 3, 0 } };
    check_polygon(quad, 4, 6, 2);
    const Vec3 triangle[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 2, 0, 0 }, { 3, 0, 0 }, { 0, 3, 0 } };
    check_polygon(triangle, 5, 4.5, 3);
    const Vec3 arrow[] = { { 0, 0, 0 }, { 4, 2, 0 }, { 0, 4, 0 }, { 1, 2, 0 } };
    check_polygon(arrow, 4, 6, 2);
}

static void test_spiral(void **state)
{
    (void)state;
    /* A corridor of width 1 wound into itself; area by the shoelace formula. */
    enum { TURNS = 40 };
    Vec3 p[2 * TURNS];
    for (int i = 0; i < TURNS; i++) {
        const double angle = 0.7 * i, r = 10 + 1.5 * angle;
        p[i] = vec3(r * cos(angle), r * sin(angle), 0);
        p[2 * TURNS - 1 - i] = vec3((r - 4) * cos(angle), (r - 4) * sin(angle), 0);
    }
    check_polygon(p, 2 * TURNS, fabs(shoelace(p, 2 * TURNS)), 2 * TURNS - 2);
}

/* Random outlines round a point: rising angles, radii from 0.2 to 2. */
static void test_random_outlines(void **state)
{
    (void)state;
    uint32_t seed = 11;
    for (int round = 0; round < 300; round++) {
        Vec3 p[200];
        const size_t n = 5 + (size_t)round * 193 / 300;
        for (size_t i = 0; i < n; i++) {
            seed = seed * 1664525u + 1013904223u;
            const double r = 0.2 + 1.8 * (seed >> 8) / 0x1p24, a = 2 * M_PI * i / n;
            p[i] = vec3(r * cos(a) - 7, r * sin(a) + 2, 0);
        }
        check_polygon(p, n, fabs(shoelace(p, n)), (uint32_t)n - 2);
    }
}

static void test_bent_quad(void **state)
{
    (void)state;
    /* Corner d lifted by 0.3: the shorter diagonal is b d (sqrt 2.09 > sqrt 2 of a c: a c). */
    const Vec3 p[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0.3 } };
    Polygons soup;
    soup_start(&soup);
    soup_polygon(&soup, p, 4, 0, 0);
    Surfaces *s = connect(&soup);
    assert_int_equal(s->count, 1);
    assert_int_equal(s->surface[0].kind, SURFACE_QUAD);
    /* (a,b,c): 1/2; (a,c,d): |(1,1,0) x (0,1,.3)| / 2 = sqrt(.09 + .09 + 1) / 2 */
    assert_true(fabs(s->surface[0].area - (1 + sqrt(1.18)) / 2) < 1e-12);
    const double corner[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
    for (int k = 0; k < 4; k++) {
        SurfacePoint at;
        surfaces_point(s, 0, corner[k][0], corner[k][1], &at);
        assert_true(vec3_length(vec3_sub(at.point, p[k])) < 1e-15);
    }
    surfaces_destroy(s);
    polygons_clear(&soup);
    /* Folded by 90 degrees it is a crease: two triangles. */
    const Vec3 folded[] = { { 0, 0, 0 }, { 1, -1, 0 }, { 1.4, 0, 0 }, { 0.7, 0, 1 } };
    soup_start(&soup);
    soup_polygon(&soup, folded, 4, 0, 0);
    s = connect(&soup);
    assert_int_equal(s->count, 2);
    surfaces_destroy(s);
    polygons_clear(&soup);
}

static void test_crossing(void **state)
{
    (void)state;
    /* An hourglass and a pentagram: something stays, nothing hangs. */
    Polygons soup;
    soup_start(&soup);
    soup_polygon(&soup, (Vec3[]){ { 0, 0, 0 }, { 1, 1, 0 }, { 1, 0, 0 }, { 0, 1, 0 } }, 4, 0, 0);
    Vec3 star[5];
    for (int i = 0; i < 5; i++)
        star[i] = vec3(5 + cos(4 * M_PI * i / 5), sin(4 * M_PI * i / 5), 0);
    soup_polygon(&soup, star, 5, 0, 0);
    Surfaces *s = connect(&soup);
    assert_true(s->count >= 2);
    surfaces_destroy(s);
    polygons_clear(&soup);
}

/* Outlines of thousands of corners are cut in another way: the same must hold. */
static void test_many_corners(void **state)
{
    (void)state;
    enum { N = 3000 };
    static Vec3 p[4 * N];
    uint32_t seed = 7;
    for (size_t i = 0; i < N; i++) { /* spikes round a point */
        seed = seed * 1664525u + 1013904223u;
        const double r = 2 + 18 * (seed >> 8) / 0x1p24, a = 2 * M_PI * (double)i / N;
        p[i] = vec3(r * cos(a) - 7, r * sin(a) + 2, 0);
    }
    check_polygon(p, N, fabs(shoelace(p, N)), N - 2);
    for (size_t i = 0; i < N; i++) { /* a corridor to and fro, 1 wide */
        const size_t j = i < N / 2 ? i : N - 1 - i;
        p[i] = vec3((double)j, (j % 2 ? 3 : 0) + (i < N / 2 ? 0 : 1), 0);
    }
    check_polygon(p, N, N / 2 - 1, N - 2);
    for (size_t i = 0; i < N / 2; i++) { /* a ring, the bridge at angle 0 */
        const double a = 2 * M_PI * (double)i / (N / 2 - 1);
        const bool last = i == N / 2 - 1;
        p[i] = vec3(last ? 2 : 2 * cos(a), last ? 0 : 2 * sin(a), 0);
        p[N - 1 - i] = vec3(last ? 1 : cos(a), last ? 0 : sin(a), 0);
    }
    check_polygon(p, N, fabs(shoelace(p, N)), N - 2);
}

/* Straight through: time must not grow with the square. */
static void test_very_many_corners(void **state)
{
    (void)state;
    enum { N = 100000 };
    Vec3 *p = malloc(N * sizeof *p);
    uint32_t *corner = malloc(N * sizeof *corner);
    assert_non_null(p);
    assert_non_null(corner);
    for (uint32_t i = 0; i < N; i++) { /* a spiral corridor of 40 turns */
        const uint32_t j = i < N / 2 ? i : N - 1 - i;
        const double a = 80 * M_PI * j / (N / 2), r = 1 + 0.1 * a - (i < N / 2 ? 0 : 0.3);
        p[i] = vec3(r * cos(a), r * sin(a), 0);
        corner[i] = i;
    }
    Triangulation cut = { 0 };
    Error err = { 0 };
    assert_true(triangulate(&cut, p, corner, N, &err));
    assert_int_equal(cut.count, N - 2);
    assert_false(cut.crossing);
    double area = 0;
    for (size_t k = 0; k < cut.count; k++) {
        const Vec3 normal = triangulate_normal(p, cut.triangle + 3 * k, 3);
        assert_true(normal.z > 0);
        area += normal.z / 2;
    }
    assert_true(fabs(area - shoelace(p, N)) < 1e-9 * area);
    for (uint32_t i = 0; i < N / 4; i++) { /* crosses itself everywhere: ends */
        const uint32_t x = i * 2654435761u, y = x * 1664525u + 1013904223u;
        p[i] = vec3((x >> 8) / 0x1p24, (y >> 8) / 0x1p24, 0);
    }
    assert_true(triangulate(&cut, p, corner, 2000, &err));
    assert_true(cut.crossing && cut.count > 0);
    triangulation_clear(&cut);
    free(p);
    free(corner);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_star),
        cmocka_unit_test(test_comb),
        cmocka_unit_test(test_bridged_hole),
        cmocka_unit_test(test_corners_in_line),
        cmocka_unit_test(test_spiral),
        cmocka_unit_test(test_random_outlines),
        cmocka_unit_test(test_many_corners),
        cmocka_unit_test(test_very_many_corners),
        cmocka_unit_test(test_bent_quad),
        cmocka_unit_test(test_crossing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
