/* SPDX-License-Identifier: BSD-3-Clause */
/* Surfaces: nothing lost, nothing doubled, known areas, neighbours, defects counted. */
#include "tests/soup_tools.h"

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

/* --- connecting ------------------------------------------------------------------------------- */

static void test_box(void **state)
{
    (void)state;
    for (int triangles = 0; triangles < 2; triangles++) {
        Polygons soup;
        soup_start(&soup);
        soup_box(&soup, vec3(-1, 2, 0.3), vec3(1.7, 3, 4.1), triangles == 1 ? 63 : 0, 0);
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
        soup_polygon(&soup, (Vec3[]){ { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } }, 4, 0,
                     0);
        soup_polygon(&soup, (Vec3[]){ { x, 0, 0 }, { 2, 0, 0 }, { 2, 1, 0 }, { x, 1, 0 } }, 4, 0,
                     0);
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
    soup_polygon(&soup, (Vec3[]){ d, c, b, a }, 4, 0, 0);          /* its back */
    soup_polygon(&soup, (Vec3[]){ b, a, d, c }, 4, 0, 0);          /* a second back */
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

/* Thin plates are two faces that lie on each other back to back: both sides count. */
static void test_backs(void **state)
{
    (void)state;
    const Vec3 a = { 0, 0, 0 }, b = { 1, 0, 0 }, c = { 1, 1, 0 }, d = { 0, 1, 0 };
    static const struct {
        int front, back;    /* 0: a quad; 1: cut at a c; 2: only its half a b c */
        uint32_t material, group; /* of the back; the front's are 0 */
        uint32_t count;
        uint32_t backs;     /* surfaces that have one */
        bool     closed;
    } cases[] = {
        { 0, 0, 1, 1, 1, 1, true },  { 1, 1, 1, 0, 1, 1, true },  { 0, 1, 0, 1, 1, 1, true },
        { 1, 0, 1, 1, 1, 1, true },  { 0, 0, 0, 0, 1, 1, true },  { 0, 2, 1, 1, 2, 1, false },
        { 1, 2, 0, 0, 2, 1, false },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        Polygons soup;
        soup_start(&soup);
        for (int side = 0; side < 2; side++) {
            const int cut = side == 0 ? cases[i].front : cases[i].back;
            const uint32_t m = side == 0 ? 0 : cases[i].material;
            const uint32_t g = side == 0 ? 0 : cases[i].group;
            const Vec3 p[4] = { a, side == 0 ? b : d, c, side == 0 ? d : b };
            if (cut == 0)
                soup_polygon(&soup, p, 4, m, g);
            if (cut == 1)
                soup_polygon(&soup, (Vec3[]){ p[2], p[3], p[0] }, 3, m, g);
            if (cut == 1)
                soup_polygon(&soup, (Vec3[]){ p[0], p[1], p[2] }, 3, m, g);
            if (cut == 2)
                soup_polygon(&soup, (Vec3[]){ c, b, a }, 3, m, g);
        }
        Surfaces *s = connect(&soup);
        uint32_t backs = 0;
        assert_int_equal(s->count, cases[i].count);
        assert_int_equal(s->repairs.duplicate, 0);
        assert_int_equal(s->closed, cases[i].closed);
        assert_true(fabs(area_of(s) - 1) < 1e-15);
        for (uint32_t k = 0; k < s->count; k++) {
            const bool has = s->surface[k].back != SURFACE_NONE;
            backs += has;
            assert_int_equal(surfaces_material(s, k, 0), 0);
            assert_int_equal(surfaces_group(s, k, 0), 0);
            assert_int_equal(surfaces_material(s, k, 1), has ? cases[i].material : 0);
            assert_int_equal(surfaces_group(s, k, 1), has ? cases[i].group : 0);
        }
        assert_int_equal(backs, cases[i].backs);
        surfaces_destroy(s);
        polygons_clear(&soup);
    }
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
        soup_box(&soup, vec3(0, 0, 0), vec3(1, 1, 1), 63, 0);
        soup_box(&soup, vec3(1, 1, corner), vec3(2, 2, 1 + corner), 63, 0);
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
    /* One face of a box turned: it is turned back, the monitor hears. Neighbours do not mind. */
    for (int keep = 0; keep < 2; keep++) {
        Polygons soup;
        soup_start(&soup);
        soup_box(&soup, vec3(0, 0, 0), vec3(1, 1, 1), 0, 1u << 1);
        soup_polygon(&soup, (Vec3[]){ { 0, 0, 1 }, { 0, 1, 1 }, { 1, 1, 1 }, { 1, 0, 1 } }, 4, 0,
                     0);
        Heard heard = { 0 };
        const Monitor monitor = { .user = &heard, .warn = hear };
        const SurfaceOptions options = { .keep_winding = keep != 0 };
        Error err = { 0 };
        Surfaces *s = surfaces_repair(&soup, &options, NULL, &monitor, &err);
        assert_non_null(s);
        assert_true(surfaces_check(s) && s->closed);
        assert_int_equal(s->repairs.flipped, !keep);
        assert_int_equal(heard.warnings, 1);
        assert_string_equal(heard.code, keep ? "winding-inconsistent" : "winding-repaired");
        SurfacePoint at;
        surfaces_point(s, 5, 0.5, 0.5, &at);
        assert_true(at.normal.z == (keep ? -1 : 1));
        for (int k = 0; k < 4; k++)
            assert_int_not_equal(s->surface[5].neighbour[k], SURFACE_NONE);
        surfaces_destroy(s);
        polygons_clear(&soup);
    }
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

/* --- shapes and failures ---------------------------------------------------------------------- */

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
    soup_box(&soup, vec3(0, 0, 0), vec3(1, 1, 1), 63, 0);
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
        cmocka_unit_test(test_parameters),
        cmocka_unit_test(test_box),
        cmocka_unit_test(test_weld),
        cmocka_unit_test(test_duplicates),
        cmocka_unit_test(test_backs),
        cmocka_unit_test(test_nonmanifold),
        cmocka_unit_test(test_touching_boxes),
        cmocka_unit_test(test_winding),
        cmocka_unit_test(test_moebius),
        cmocka_unit_test(test_join_keeps_apart),
        cmocka_unit_test(test_shapes),
        cmocka_unit_test(test_nothing),
        cmocka_unit_test(test_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
