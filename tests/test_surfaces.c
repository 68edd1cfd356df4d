/* SPDX-License-Identifier: BSD-3-Clause */
/* Surfaces: nothing lost, nothing doubled, known areas, neighbours, defects counted. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/array.h"
#include "math/tolerance.h"
#include "mesh/surfaces.h"

/* --- building soups ------------------------------------------------------------------------------ */

static void soup_start(Polygons *soup)
{
    Error err = { 0 };
    const Material material = material_default();
    uint32_t index;
    *soup = (Polygons){ 0 };
    assert_true(polygons_add_material(soup, &material, &index, &err));
    assert_true(polygons_add_material(soup, &material, &index, &err));
    assert_true(polygons_add_group(soup, "a", &index, &err));
    assert_true(polygons_add_group(soup, "b", &index, &err));
}

/* A polygon with vertices of its own. */
static void soup_polygon(Polygons *soup, const Vec3 *p, size_t n, uint32_t material, uint32_t group)
{
    Error err = { 0 };
    uint32_t *corner = malloc(n * sizeof *corner);
    assert_non_null(corner);
    for (size_t i = 0; i < n; i++)
        assert_true(polygons_add_vertex(soup, p[i], &corner[i], &err));
    assert_true(polygons_add_polygon(soup, corner, n, material, group, &err));
    free(corner);
}

static Surfaces *connect(const Polygons *soup)
{
    Error err = { 0 };
    Surfaces *s = surfaces_create(soup, NULL, &err);
    assert_int_equal(err.code, ERROR_NONE);
    assert_non_null(s);
    assert_true(surfaces_check(s));
    return s;
}

static double area_of(const Surfaces *s)
{
    double area = 0;
    for (uint32_t i = 0; i < s->count; i++)
        area += s->surface[i].area;
    return area;
}

/* Box x y z from lo to hi, outward; triangles: two per face. `skip`: bit mask of faces left out. */
static void soup_box(Polygons *soup, Vec3 lo, Vec3 hi, bool triangles, unsigned skip)
{
    const Vec3 p[8] = { { lo.x, lo.y, lo.z }, { hi.x, lo.y, lo.z }, { hi.x, hi.y, lo.z },
                        { lo.x, hi.y, lo.z }, { lo.x, lo.y, hi.z }, { hi.x, lo.y, hi.z },
                        { hi.x, hi.y, hi.z }, { lo.x, hi.y, hi.z } };
    static const int face[6][4] = { { 0, 3, 2, 1 }, { 4, 5, 6, 7 }, { 0, 1, 5, 4 },
                                    { 1, 2, 6, 5 }, { 2, 3, 7, 6 }, { 3, 0, 4, 7 } };
    for (int f = 0; f < 6; f++) {
        const Vec3 q[4] = { p[face[f][0]], p[face[f][1]], p[face[f][2]], p[face[f][3]] };
        const Vec3 first[3] = { q[0], q[1], q[2] }, second[3] = { q[2], q[3], q[0] };
        if (skip >> f & 1)
            continue;
        if (!triangles) {
            soup_polygon(soup, q, 4, 0, 0);
        } else {
            soup_polygon(soup, first, 3, 0, 0);
            soup_polygon(soup, second, 3, 0, 0);
        }
    }
}

/* --- polygons ------------------------------------------------------------------------------------ */

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
                q[i] = vec3(0.6 * q[i].x - 0.8 * q[i].y * 5 / 13, 0.8 * q[i].x + 0.6 * q[i].y * 5 / 13,
                            q[i].y * 12 / 13);
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

/* Hits and (s,t): both triangles of a quad give the same parameters on their diagonal, and the
 * point at the parameters of a hit is the hit's point. */
static void test_parameters(void **state)
{
    (void)state;
    const Vec3 p[] = { { 0, 0, 0 }, { 3, 0, 0 }, { 2, 2, 0 }, { 0, 1, 0 } };
    Polygons soup;
    soup_start(&soup);
    soup_polygon(&soup, p, 4, 0, 0);
    soup_polygon(&soup, (Vec3[]){ { 5, 0, 0 }, { 6, 0, 0 }, { 5, 1, 1 } }, 3, 1, 1);
    Surfaces *s = connect(&soup);
    assert_int_equal(s->triangle_count, 3);
    for (uint32_t k = 0; k < 3; k++)
        for (int i = 0; i < 64; i++) {
            const double u = (i % 8 + 0.5) / 16, v = (i / 8 + 0.5) / 16;
            const uint32_t *c = s->corner + 3 * k;
            const Vec3 hit = vec3_add(vec3_scale(s->position[c[0]], 1 - u - v),
                                      vec3_add(vec3_scale(s->position[c[1]], u),
                                               vec3_scale(s->position[c[2]], v)));
            double st[2];
            SurfacePoint at;
            surfaces_parameters(s, k, u, v, &st[0], &st[1]);
            surfaces_point(s, surfaces_of_primitive(s, k), st[0], st[1], &at);
            assert_true(vec3_length(vec3_sub(at.point, hit)) < 1e-14);
            assert_int_equal(at.primitive, k);
            const Vec3 normal = surfaces_normal(s, k, u, v);
            assert_true(vec3_length(vec3_sub(at.normal, normal)) < 1e-14);
        }
    surfaces_destroy(s);
    polygons_clear(&soup);
}

/* --- connecting ---------------------------------------------------------------------------------- */

static void test_box(void **state)
{
    (void)state;
    for (int triangles = 0; triangles < 2; triangles++) {
        Polygons soup;
        soup_start(&soup);
        soup_box(&soup, vec3(-1, 2, 0.3), vec3(1.7, 3, 4.1), triangles == 1, 0);
        Surfaces *s = connect(&soup);
        assert_int_equal(s->count, 6);
        assert_int_equal(s->triangle_count, 12);
        assert_int_equal(s->vertex_count, 8);
        assert_int_equal(s->repairs.welded, (triangles ? 36 : 24) - 8);
        assert_true(s->closed);
        for (uint32_t i = 0; i < 6; i++) {
            assert_int_equal(s->surface[i].kind, SURFACE_QUAD);
            for (int k = 0; k < 4; k++)
                assert_int_not_equal(s->surface[i].neighbour[k], SURFACE_NONE);
        }
        assert_true(fabs(area_of(s) - 2 * (2.7 * 1 + 2.7 * 3.8 + 3.8)) < 1e-9);
        surfaces_destroy(s);
        polygons_clear(&soup);
    }
}

static void test_weld(void **state)
{
    (void)state;
    /* Two squares side by side; the gap between them in float half-ulps of the largest coordinate.
     * A small square far away from a huge one keeps its own detail. */
    static const struct {
        double   gap;
        uint32_t welded;
    } cases[] = { { 0, 2 }, { 4, 2 }, { 20, 0 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double x = 1 + cases[i].gap * 2 * 0x1p-24;
        Polygons soup;
        soup_start(&soup);
        soup_polygon(&soup, (Vec3[]){ { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } }, 4, 0, 0);
        soup_polygon(&soup, (Vec3[]){ { x, 0, 0 }, { 2, 0, 0 }, { 2, 1, 0 }, { x, 1, 0 } }, 4, 0, 0);
        const double far = 1e6;
        soup_polygon(&soup, (Vec3[]){ { -far, -far, -1 }, { far, -far, -1 }, { far, far, -1 },
                                      { -far, far, -1 } }, 4, 0, 0);
        Surfaces *s = connect(&soup);
        assert_int_equal(s->repairs.welded, cases[i].welded);
        assert_int_equal(s->surface[0].neighbour[1], cases[i].welded ? 1 : SURFACE_NONE);
        surfaces_destroy(s);
        polygons_clear(&soup);
    }
}

static void test_duplicates(void **state)
{
    (void)state;
    const Vec3 a = { 0, 0, 0 }, b = { 1, 0, 0 }, c = { 1, 1, 0 }, d = { 0, 1, 0 };
    Polygons soup;
    soup_start(&soup);
    soup_polygon(&soup, (Vec3[]){ a, b, c, d }, 4, 0, 0);
    soup_polygon(&soup, (Vec3[]){ c, d, a, b }, 4, 0, 0);          /* told from elsewhere */
    soup_polygon(&soup, (Vec3[]){ d, c, b, a }, 4, 0, 0);          /* the other way round */
    soup_polygon(&soup, (Vec3[]){ a, b, c }, 3, 0, 0);             /* half of it: cut at a c */
    soup_polygon(&soup, (Vec3[]){ a, b, b, b }, 4, 0, 0);          /* no area */
    soup_polygon(&soup, (Vec3[]){ a, vec3(0.5, 0, 0), b }, 3, 0, 0);
    Surfaces *s = connect(&soup);
    assert_int_equal(s->count, 1);
    assert_int_equal(s->repairs.duplicate, 3);
    assert_int_equal(s->repairs.degenerate, 2);
    assert_true(fabs(area_of(s) - 1) < 1e-15);
    surfaces_destroy(s);
    polygons_clear(&soup);
}

static void test_nonmanifold(void **state)
{
    (void)state;
    /* Three squares at the edge from (0,0,0) to (0,0,1). */
    Polygons soup;
    soup_start(&soup);
    const Vec3 a = { 0, 0, 0 }, b = { 0, 0, 1 };
    soup_polygon(&soup, (Vec3[]){ a, b, { 1, 0, 1 }, { 1, 0, 0 } }, 4, 0, 0);
    soup_polygon(&soup, (Vec3[]){ b, a, { -1, 0, 0 }, { -1, 0, 1 } }, 4, 0, 0);
    soup_polygon(&soup, (Vec3[]){ a, b, { 0, 1, 1 }, { 0, 1, 0 } }, 4, 0, 0);
    Surfaces *s = connect(&soup);
    assert_int_equal(s->count, 3);
    assert_int_equal(s->repairs.nonmanifold, 1);
    assert_int_equal(s->repairs.refused, 0);
    assert_false(s->closed);
    assert_true(fabs(area_of(s) - 3) < 1e-15);
    static const uint32_t expected[3] = { 1, 0, SURFACE_NONE };
    for (int i = 0; i < 3; i++) {
        uint32_t neighbour = SURFACE_NONE;
        for (int k = 0; k < 4; k++)
            if (s->surface[i].neighbour[k] != SURFACE_NONE)
                neighbour = s->surface[i].neighbour[k];
        assert_int_equal(neighbour, expected[i]);
    }
    surfaces_destroy(s);
    polygons_clear(&soup);
}

/* Two boxes that touch at an edge, and two that touch at a corner: all keep their neighbours. */
static void test_touching_boxes(void **state)
{
    (void)state;
    for (int corner = 0; corner < 2; corner++) {
        Polygons soup;
        soup_start(&soup);
        soup_box(&soup, vec3(0, 0, 0), vec3(1, 1, 1), true, 0);
        soup_box(&soup, vec3(1, 1, corner), vec3(2, 2, 1 + corner), true, 0);
        Surfaces *s = connect(&soup);
        assert_int_equal(s->count, 12);
        assert_int_equal(s->repairs.refused, 0);
        for (uint32_t i = 0; i < 12; i++)
            for (int k = 0; k < 4; k++) {
                assert_int_not_equal(s->surface[i].neighbour[k], SURFACE_NONE);
                assert_int_equal(s->surface[i].neighbour[k] / 6, i / 6);
            }
        surfaces_destroy(s);
        polygons_clear(&soup);
    }
}

typedef struct {
    int      warnings;
    char     code[64];
} Heard;

static void hear(void *user, const char *code, const char *where, const char *text)
{
    Heard *heard = user;
    heard->warnings++;
    snprintf(heard->code, sizeof heard->code, "%s", code);
    assert_non_null(where);
    assert_non_null(strstr(text, "group"));
}

static void test_winding(void **state)
{
    (void)state;
    /* One face of a box turned: neighbours stay, its own winding stays, the monitor hears. */
    Polygons soup;
    soup_start(&soup);
    soup_box(&soup, vec3(0, 0, 0), vec3(1, 1, 1), false, 1u << 1);
    soup_polygon(&soup, (Vec3[]){ { 0, 0, 1 }, { 0, 1, 1 }, { 1, 1, 1 }, { 1, 0, 1 } }, 4, 0, 0);
    Heard heard = { 0 };
    const Monitor monitor = { .user = &heard, .warn = hear };
    Error err = { 0 };
    Surfaces *s = surfaces_create(&soup, &monitor, &err);
    assert_non_null(s);
    assert_true(surfaces_check(s) && s->closed);
    assert_int_equal(s->repairs.flipped, 0);
    assert_int_equal(heard.warnings, 1);
    assert_string_equal(heard.code, "winding-inconsistent");
    SurfacePoint at;
    surfaces_point(s, 5, 0.5, 0.5, &at);
    assert_true(at.normal.z == -1);
    for (int k = 0; k < 4; k++)
        assert_int_not_equal(s->surface[5].neighbour[k], SURFACE_NONE);
    surfaces_destroy(s);
    polygons_clear(&soup);
}

/* A Moebius strip of quads cannot be wound: cut at one place, nothing lost. */
static void test_moebius(void **state)
{
    (void)state;
    enum { N = 24 };
    Polygons soup;
    soup_start(&soup);
    for (int i = 0; i < N; i++) {
        Vec3 p[2][2];
        for (int k = 0; k < 2; k++) {
            const double a = 2 * M_PI * ((i + k) % N) / N;
            const double half = i + k == N ? -0.4 : 0.4; /* the last meets the first turned over */
            for (int side = 0; side < 2; side++) {
                const double w = side == 0 ? -half : half;
                p[k][side] = vec3((2 + w * cos(a / 2)) * cos(a), (2 + w * cos(a / 2)) * sin(a),
                                  w * sin(a / 2));
            }
        }
        soup_polygon(&soup, (Vec3[]){ p[0][0], p[1][0], p[1][1], p[0][1] }, 4, 0, 0);
    }
    Surfaces *s = connect(&soup);
    assert_int_equal(s->vertex_count, 2 * N);
    uint32_t links = 0;
    for (uint32_t i = 0; i < s->count; i++)
        for (int k = 0; k < 4; k++)
            links += s->surface[i].neighbour[k] != SURFACE_NONE;
    assert_int_equal(s->triangle_count, 2 * N);
    assert_int_equal(links / 2, (s->count == N ? N : 2 * N) - 1);
    surfaces_destroy(s);
    polygons_clear(&soup);
}

static void test_join_keeps_apart(void **state)
{
    (void)state;
    /* The same square as two triangles: one material joins, two materials or two groups do not. */
    for (int variant = 0; variant < 3; variant++) {
        Polygons soup;
        soup_start(&soup);
        soup_polygon(&soup, (Vec3[]){ { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 } }, 3, 0, 0);
        soup_polygon(&soup, (Vec3[]){ { 0, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } }, 3, variant == 1,
                     variant == 2);
        Surfaces *s = connect(&soup);
        assert_int_equal(s->count, variant == 0 ? 1 : 2);
        surfaces_destroy(s);
        polygons_clear(&soup);
    }
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

/* --- shapes and failures -------------------------------------------------------------------------- */

static void test_shapes(void **state)
{
    (void)state;
    static const struct {
        ShapeKind kind;
        double    ratio, area; /* of the unit form */
        bool      closed;
    } cases[] = {
        { SHAPE_SPHERE, 1, 4 * M_PI, true },
        { SHAPE_DISC, 1, M_PI, false },
        { SHAPE_FRUSTUM, 1, 2 * M_PI, false },
        { SHAPE_FRUSTUM, 0, M_PI * M_SQRT2, false },
        { SHAPE_TORUS, 0.25, 4 * M_PI * M_PI * 0.25, true },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        Polygons soup;
        soup_start(&soup);
        Error err = { 0 };
        Shape shape;
        const Affine map = affine_identity();
        assert_true(shape_init(&shape, cases[i].kind, cases[i].ratio, &map, &err));
        assert_true(polygons_add_shape(&soup, &shape, 1, 1, &err));
        Surfaces *s = connect(&soup);
        assert_int_equal(s->count, 1);
        assert_int_equal(s->surface[0].kind, SURFACE_SHAPE);
        assert_int_equal(s->surface[0].group, 1);
        assert_int_equal(surfaces_of_primitive(s, 0), 0);
        assert_true(fabs(s->surface[0].area - cases[i].area) < 1e-9 * cases[i].area);
        assert_int_equal(s->closed, cases[i].closed);
        surfaces_destroy(s);
        polygons_clear(&soup);
    }
}

static void test_nothing(void **state)
{
    (void)state;
    Polygons soup;
    soup_start(&soup);
    soup_polygon(&soup, (Vec3[]){ { 0, 0, 0 }, { 1, 0, 0 }, { 2, 0, 0 } }, 3, 0, 0);
    Error err = { 0 };
    assert_null(surfaces_create(&soup, NULL, &err));
    assert_int_equal(err.code, ERROR_INPUT);
    assert_null(surfaces_create(&soup, NULL, &err)); /* a set error passes through */
    polygons_clear(&soup);
}

static void test_no_memory(void **state)
{
    (void)state;
    Polygons soup;
    soup_start(&soup);
    soup_box(&soup, vec3(0, 0, 0), vec3(1, 1, 1), true, 0);
    const long before = array_live();
    for (long n = 0;; n++) {
        Error err = { 0 };
        array_fail_after(n);
        Surfaces *s = surfaces_create(&soup, NULL, &err);
        array_fail_after(-1);
        if (s != NULL) {
            surfaces_destroy(s);
            assert_true(n > 10);
            break;
        }
        assert_int_equal(err.code, ERROR_MEMORY);
        assert_int_equal(array_live(), before);
    }
    assert_int_equal(array_live(), before);
    polygons_clear(&soup);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_star),
        cmocka_unit_test(test_comb),
        cmocka_unit_test(test_bridged_hole),
        cmocka_unit_test(test_corners_in_line),
        cmocka_unit_test(test_spiral),
        cmocka_unit_test(test_bent_quad),
        cmocka_unit_test(test_parameters),
        cmocka_unit_test(test_box),
        cmocka_unit_test(test_weld),
        cmocka_unit_test(test_duplicates),
        cmocka_unit_test(test_nonmanifold),
        cmocka_unit_test(test_touching_boxes),
        cmocka_unit_test(test_winding),
        cmocka_unit_test(test_moebius),
        cmocka_unit_test(test_join_keeps_apart),
        cmocka_unit_test(test_crossing),
        cmocka_unit_test(test_shapes),
        cmocka_unit_test(test_nothing),
        cmocka_unit_test(test_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
