/* SPDX-License-Identifier: BSD-3-Clause */
/* The tree of boxes: answers known in advance, rays and scenes at the limits, threads, bad input,
 * memory that runs out. */
#include "tests/ray_scenes.h"

#define TRIANGLES_MANY (SLOWER > 20 ? 70000u : 200000u)

/* --- answers known in advance ---------------------------------------------------------------- */

static void one_triangle(void **state)
{
    (void)state;
    Scene *s = scene_create(1);
    add_triangle(s, vec3(0, 0, 2), vec3(4, 0, 2), vec3(0, 4, 2));
    Trees trees = trees_create(&s->in);
    /* A hit's t is 2 / d_z; its weights are x / 4 and y / 4 there. Exact in float. */
    static const struct {
        Ray   ray;
        bool  hit;
        float t, u, v;
    } table[] = {
        { { 1, 2, 0, 0, 0, 0, 1, INFINITY }, true, 2, 0.25f, 0.5f },
        { { 1, 2, 4, 0, 0, 0, -4, INFINITY }, true, 0.5f, 0.25f, 0.5f },
        { { 0, 0, 0, 0, 1, 1, 2, INFINITY }, true, 1, 0.25f, 0.25f },
        { { 0, 0, 0, 0, 0, 0, 1, INFINITY }, true, 2, 0, 0 },           /* corner 0 */
        { { 4, 0, 0, 0, 0, 0, 1, INFINITY }, true, 2, 1, 0 },           /* corner 1 */
        { { 2, 2, 0, 0, 0, 0, 1, INFINITY }, true, 2, 0.5f, 0.5f },     /* on an edge */
        { { 2.001f, 2, 0, 0, 0, 0, 1, INFINITY }, false, 0, 0, 0 },
        { { -1e-6f, 2, 0, 0, 0, 0, 1, INFINITY }, false, 0, 0, 0 },
        { { 1, 1, 0, 0, 0, 0, -1, INFINITY }, false, 0, 0, 0 },         /* behind */
        { { 1, 1, 0, 0, 0, 0, 1, 2 }, false, 0, 0, 0 },                 /* t < t_max, strictly */
        { { 1, 1, 0, 0, 0, 0, 1, 2.000001f }, true, 2, 0.25f, 0.25f },
        { { 1, 1, 0, 2, 0, 0, 1, INFINITY }, false, 0, 0, 0 },          /* t > t_min, strictly */
        { { 1, 1, 0, 1.999999f, 0, 0, 1, INFINITY }, true, 2, 0.25f, 0.25f },
        { { 1, 1, 2, 0, 0, 0, 1, INFINITY }, false, 0, 0, 0 },          /* starts on it */
        { { -1, 1, 2, 0, 1, 0, 0, INFINITY }, false, 0, 0, 0 },         /* in its plane */
        { { 1, 2, 0, 0, 0, 0, 0x1p-120f, INFINITY }, true, 0x1p121f, 0.25f, 0.5f },
        { { 1, 2, 0, 0, 0, 0, 0x1p-128f, 0x1p-1f }, false, 0, 0, 0 },   /* denormal, too short */
        { { 1, 2, 2 - 0x1p-10f, 0, 0, 0, 0x1p-130f, INFINITY }, true, 0x1p120f, 0.25f, 0.5f },
        { { 1, 2, 0, 0, 0, 0, 0x1p-128f, INFINITY }, false, 0, 0, 0 },  /* t is no float */
        { { 1, 2, 0, 0, 0, 0, 0x1p100f, 1 }, true, 0x1p-99f, 0.25f, 0.5f },
    };
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        compare_ray(&s->in, &trees, &table[i].ray);
        Hit hit;
        const bool found = bvh_nearest(trees.bvh[0], &table[i].ray, &hit);
        const Hit want = { table[i].t, table[i].u, table[i].v, 0 };
        if (found != table[i].hit || (found && memcmp(&hit, &want, sizeof hit) != 0))
            show_ray("one triangle", &table[i].ray, &want, &hit);
        assert_int_equal(found, table[i].hit);
        if (found)
            assert_memory_equal(&hit, &want, sizeof hit);
    }
    trees_destroy(&trees);
    scene_destroy(s);
}

/* A sphere of radius 2 about (0, 0, 5) seen from the origin and from its centre. */
static void one_sphere(void **state)
{
    (void)state;
    Error err = { 0 };
    Scene *s = scene_create(0);
    const Affine map = { { 2, 0, 0 }, { 0, 2, 0 }, { 0, 0, 2 }, { 0, 0, 5 } };
    assert_true(shape_init(&s->shape[0], SHAPE_SPHERE, 0, &map, &err));
    s->in.shape_count = 1;
    Trees trees = trees_create(&s->in);
    Hit hit;
    assert_true(bvh_nearest(trees.bvh[0], &(Ray){ 0, 0, 0, 0, 0, 0, 1, INFINITY }, &hit));
    assert_int_equal(hit.primitive, 0);
    assert_true(hit.t == 3);
    assert_true(bvh_nearest(trees.bvh[0], &(Ray){ 0, 0, 5, 0, 0, 0.5f, 0, INFINITY }, &hit));
    assert_true(hit.t == 4);
    assert_false(bvh_nearest(trees.bvh[0], &(Ray){ 0, 0, 0, 0, 0, 0, 1, 3 }, &hit));
    assert_true(bvh_nearest(trees.bvh[0], &(Ray){ 0, 0, 0, 3, 0, 0, 1, 8 }, &hit));
    assert_true(hit.t == 7);
    assert_int_equal(hit.primitive, 0);
    trees_destroy(&trees);
    scene_destroy(s);
}

/* Along the floor into the wall: the floor is edge-on, the wall is hit on its lower edge. */
static void edge_on(void **state)
{
    (void)state;
    Scene *s = scene_create(4);
    add_quad(s, vec3(0, 0, 0), vec3(1, 0, 0), vec3(1, 0, 1), vec3(0, 0, 1));
    add_quad(s, vec3(1, 0, 0), vec3(1, 1, 0), vec3(1, 1, 1), vec3(1, 0, 1));
    Trees trees = trees_create(&s->in);
    const Ray along = { 0, 0, 0.5f, 0, 1, 0, 0, INFINITY };
    compare_ray(&s->in, &trees, &along);
    Hit hit;
    assert_true(bvh_nearest(trees.bvh[0], &along, &hit));
    assert_true(hit.t == 1);
    assert_in_range(hit.primitive, 2, 3);
    trees_destroy(&trees);
    scene_destroy(s);
}

/* Equal t: the smaller number, wherever it stands in the tree. */
static void ties_go_to_the_smaller(void **state)
{
    (void)state;
    const uint32_t copies = 5000 / SLOWER;
    Scene *s = scene_create(2 * copies);
    Random r = { 8 };
    for (uint32_t i = 0; i < copies; i++) {
        const double x = floor(random_unit(&r) * 8);
        add_triangle(s, vec3(x, 0, 1), vec3(x + 1, 0, 1), vec3(x, 1, 1));
        add_triangle(s, vec3(x, 1, 1), vec3(x + 1, 0, 1), vec3(x + 1, 1, 1));
    }
    Trees trees = trees_create(&s->in);
    for (uint32_t i = 0; i < 300 / SLOWER + 10; i++) {
        const Ray ray = ray_of(vec3(random_unit(&r) * 8, random_unit(&r), 0), vec3(0, 0, 1), 0,
                               INFINITY);
        compare_ray(&s->in, &trees, &ray);
    }
    /* A corner that eight columns share is hit at t = 1 by all around it. */
    for (int x = 0; x <= 8; x++) {
        const Ray ray = ray_of(vec3(x, 1, 0), vec3(0, 0, 1), 0, INFINITY);
        compare_ray(&s->in, &trees, &ray);
    }
    trees_destroy(&trees);
    scene_destroy(s);
}

/* --- rounding at its worst -------------------------------------------------------------------- */

/* Thin triangles, far from the origin and at all scales, where rounding is worst. */
static void slivers_agree(void **state)
{
    (void)state;
    static const double scale[] = { 1e-3, 1, 1e6 }, offset[] = { 0, 30, 1000 };
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            Random r = { (uint64_t)(10 * a + b) };
            Scene *s = scene_create(60);
            const Vec3 centre = vec3(offset[b] * scale[a], -offset[b] * scale[a], 0);
            for (int i = 0; i < 60; i++) {
                const Vec3 p = vec3_mad(centre, scale[a], random_cube(&r));
                const Vec3 q = vec3_mad(p, scale[a], random_cube(&r));
                add_triangle(s, p, q, vec3_mad(vec3_lerp(p, q, random_unit(&r)), 1e-4 * scale[a],
                                               random_cube(&r)));
            }
            compare_scene(s, 20000, centre, 1.5 * scale[a], 5);
            scene_destroy(s);
        }
}

/* Rays on the lattice the room stands on: along axes, in the planes of boxes, through corners. */
static void lattice_rays_agree(void **state)
{
    (void)state;
    Scene *s = room_create();
    Trees trees = trees_create(&s->in);
    Random r = { 31 };
    for (uint32_t i = 0; i < 100000 / SLOWER; i++) {
        Vec3 o, d;
        do {
            o = vec3(floor(random_unit(&r) * 11), floor(random_unit(&r) * 11),
                     floor(random_unit(&r) * 11));
            d = vec3(floor(random_unit(&r) * 3) - 1, floor(random_unit(&r) * 3) - 1,
                     floor(random_unit(&r) * 3) - 1);
        } while (vec3_length(d) == 0);
        if (i % 2)
            d = vec3(copysign(d.x, -1), d.y, d.z); /* -0 too */
        const Ray ray = ray_of(o, d, 0, i % 3 ? INFINITY : 4);
        compare_ray(&s->in, &trees, &ray);
    }
    trees_destroy(&trees);
    scene_destroy(s);
}

/* --- faces in one place ---------------------------------------------------------------------- */

/* A square of two triangles in the plane of p, cut by one diagonal or the other; `turned`: facing
 * the other way. */
static void add_square(Scene *s, const Vec3 p[4], int diagonal, bool turned)
{
    const Vec3 a = p[diagonal], b = p[(diagonal + 1) % 4], c = p[(diagonal + 2) % 4];
    const Vec3 d = p[(diagonal + 3) % 4];
    if (turned)
        add_quad(s, d, c, b, a);
    else
        add_quad(s, a, b, c, d);
}

/* Squares back to back in planes at random, cut along different diagonals and one of them larger,
 * in either order: a ray meets the one that faces it. Shears and roundings differ, so that t does,
 * by an ulp or more. */
static void the_face_that_looks_here_is_hit(void **state)
{
    (void)state;
    Random r = { 41 };
    for (int round = 0; round < 60; round++) {
        const double size = (double[]){ 1, 1e-3, 1e4 }[round % 3];
        const Vec3 centre = vec3_scale(random_cube(&r), 3 * size);
        const Vec3 u = random_direction(&r), w = vec3_unit(vec3_cross(u, random_direction(&r)));
        const Vec3 n = vec3_cross(u, w);
        Vec3 p[4], q[4];
        for (int i = 0; i < 4; i++) {
            const double a = i == 1 || i == 2 ? size : -size, b = i >= 2 ? size : -size;
            p[i] = vec3_mad(vec3_mad(centre, a, u), b, w);
            q[i] = vec3_mad(vec3_mad(centre, 1.7 * a, u), 1.3 * b, w);
        }
        Scene *s = scene_create(4);
        const bool first_is_turned = round & 1; /* u x w = n is the normal of p as it stands */
        add_square(s, p, round / 2 % 4, first_is_turned);
        add_square(s, q, round / 3 % 4, !first_is_turned);
        Trees trees = trees_create(&s->in);
        Ray many[500];
        for (uint32_t i = 0; i < 2000 / SLOWER; i++) {
            const Vec3 on = vec3_mad(vec3_mad(centre, size * (1.9 * random_unit(&r) - 0.95), u),
                                     size * (1.9 * random_unit(&r) - 0.95), w);
            const Vec3 d = random_direction(&r);
            const Ray ray = ray_of(vec3_mad(on, -2 * size, d), d, 0, INFINITY);
            compare_ray(&s->in, &trees, &ray);
            many[i % 500] = ray;
            /* Gradients up to 10, of the BEST_GRADIENT that are covered. */
            if (fabs(vec3_dot(d, n)) < 0.1)
                continue;
            Hit hit;
            assert_true(bvh_nearest(trees.bvh[0], &ray, &hit));
            const bool p_faces = (vec3_dot(d, n) < 0) != first_is_turned;
            assert_int_equal(hit.primitive < 2, p_faces);
        }
        compare_many(&trees, many, 2000 / SLOWER < 500 ? 2000 / SLOWER : 500);
        trees_destroy(&trees);
        scene_destroy(s);
    }
}

/* A disc on a floor, looking down into it, or a gap above or below: only rounding is forgiven. */
static void shapes_and_gaps(void **state)
{
    (void)state;
    static const struct {
        double gap;
        bool   disc_is_hit;
    } table[] = { { 0, true }, { 0x1p-23, true }, { 1e-3, false }, { -1e-3, true } };
    for (int i = 0; i < 4; i++) {
        Error err = { 0 };
        Scene *s = scene_create(2);
        /* The floor looks up; the disc, facing down, lies on it or `gap` above. */
        add_quad(s, vec3(-1, -1, 0), vec3(1, -1, 0), vec3(1, 1, 0), vec3(-1, 1, 0));
        const Affine map = { { 0.5, 0, 0 }, { 0, -0.5, 0 }, { 0, 0, -0.5 },
                             { 0, 0, table[i].gap } };
        assert_true(shape_init(&s->shape[0], SHAPE_DISC, 0, &map, &err));
        s->in.shape_count = 1;
        Trees trees = trees_create(&s->in);
        const Ray up = { 0.1f, 0.2f, -2, 0, 0.1f, 0.05f, 1, INFINITY };
        const Ray down = { 0.1f, 0.2f, 2, 0, 0.1f, 0.05f, -1, INFINITY };
        compare_ray(&s->in, &trees, &up);
        compare_ray(&s->in, &trees, &down);
        Hit hit;
        assert_true(bvh_nearest(trees.bvh[0], &up, &hit));
        assert_int_equal(hit.primitive == 2, table[i].disc_is_hit);
        assert_true(bvh_nearest(trees.bvh[0], &down, &hit));
        assert_int_equal(hit.primitive == 2, table[i].gap > 1e-5);
        trees_destroy(&trees);
        scene_destroy(s);
    }
}

static void flat_triangles_are_never_hit(void **state)
{
    (void)state;
    Scene *s = scene_create(100);
    Random r = { 17 };
    for (int i = 0; i < 90; i++) {
        const Vec3 p = random_cube(&r), q = random_cube(&r);
        if (i % 3 == 0)
            add_triangle(s, p, p, q);
        else if (i % 3 == 1)
            add_triangle(s, p, p, p);
        else
            add_triangle(s, vec3(i, 0, 0), vec3(i + 1, 1, 1), vec3(i + 3, 3, 3));
    }
    Trees empty = trees_create(&s->in);
    BvhStats stats;
    bvh_stats(empty.bvh[0], &stats);
    assert_int_equal(stats.triangles, 90);
    for (int i = 0; i < 1000; i++) {
        const Ray ray = random_ray(s, &r, vec3(0, 0, 0), 1);
        assert_false(bvh_blocked(empty.bvh[0], &ray));
        compare_ray(&s->in, &empty, &ray);
    }
    trees_destroy(&empty);
    add_triangle(s, vec3(-9, -9, 2), vec3(9, -9, 2), vec3(0, 9, 2));
    Trees trees = trees_create(&s->in);
    Hit hit;
    assert_true(bvh_nearest(trees.bvh[0], &(Ray){ 0, 0, 0, 0, 0, 0, 1, INFINITY }, &hit));
    assert_int_equal(hit.primitive, 90);
    trees_destroy(&trees);
    scene_destroy(s);
}

static void nothing_is_a_valid_tree(void **state)
{
    (void)state;
    const Primitives nothing = { 0 };
    Trees trees = trees_create(&nothing);
    for (int k = 0; k < TREES; k++) {
        Hit hit;
        if (trees.bvh[k] == NULL)
            continue;
        assert_false(bvh_nearest(trees.bvh[k], &(Ray){ 0, 0, 0, 0, 1, 0, 0, INFINITY }, &hit));
        assert_int_equal(hit.primitive, RAY_MISS);
        assert_false(bvh_blocked(trees.bvh[k], &(Ray){ 0, 0, 0, 0, 1, 0, 0, INFINITY }));
    }
    trees_destroy(&trees);
    assert_null(bvh_destroy(NULL));
}

static void bad_rays_miss(void **state)
{
    (void)state;
    Scene *s = ball_create(1, vec3(0, 0, 0), 1);
    add_shape(s, SHAPE_SPHERE, 0, vec3(0, 0, 0), 3);
    Trees trees = trees_create(&s->in);
    static const float bad[] = { NAN, INFINITY, -INFINITY };
    for (int b = 0; b < 3; b++)
        for (int k = 0; k < 6; k++) {
            float c[6] = { 0.1f, 0.2f, 0.1f, 0.3f, 0.5f, 0.8f };
            c[k] = bad[b];
            const Ray ray = { c[0], c[1], c[2], 0, c[3], c[4], c[5], INFINITY };
            Hit hit;
            assert_false(brute_nearest(&s->in, &ray, &hit));
            compare_ray(&s->in, &trees, &ray);
        }
    const Ray still = { 0, 0, 0, 0, 0, -0.0f, 0, INFINITY };
    const Ray far = { 0x1p60f, 0, 0, 0, -1, 0, 0, INFINITY };
    const Ray no_range = { 0, 0, 0, 0, 1, 0, 0, NAN };
    const Ray *ray[] = { &still, &far, &no_range };
    for (int i = 0; i < 3; i++) {
        assert_false(brute_blocked(&s->in, ray[i]));
        compare_ray(&s->in, &trees, ray[i]);
    }
    trees_destroy(&trees);
    scene_destroy(s);
}

/* --- many rays, threads, bad input, memory --------------------------------------------------- */

static void many_equal_single(void **state)
{
    (void)state;
    enum { COUNT = 1003 };
    static Ray ray[COUNT];
    static Hit hit[COUNT];
    static bool blocked[COUNT];
    Scene *s = soup_create(300, 0.2, 5);
    Trees trees = trees_create(&s->in);
    Random r = { 6 };
    for (int i = 0; i < COUNT; i++)
        ray[i] = random_ray(s, &r, vec3(0, 0, 0), 1.5);
    ray[7].dx = NAN;
    for (int k = 0; k < TREES; k++) {
        if (trees.bvh[k] == NULL)
            continue;
        bvh_nearest_many(trees.bvh[k], ray, hit, COUNT);
        bvh_blocked_many(trees.bvh[k], ray, blocked, COUNT);
        bvh_nearest_many(trees.bvh[k], NULL, NULL, 0);
        for (int i = 0; i < COUNT; i++) {
            Hit one;
            assert_int_equal(bvh_nearest(trees.bvh[k], &ray[i], &one), blocked[i]);
            assert_memory_equal(&one, &hit[i], sizeof one);
        }
    }
    trees_destroy(&trees);
    scene_destroy(s);
}

/* Large enough for tasks and for cuts by all threads. */
static void threads_make_the_same_tree(void **state)
{
    (void)state;
    Scene *s = soup_create(TRIANGLES_MANY, 0.01, 12);
    add_shape(s, SHAPE_TORUS, 0.3, vec3(0, 0, 0.6), 0.5);
    Error err = { 0 };
    Bvh *one = bvh_create(&s->in, 1, &err);
    assert_non_null(one);
    assert_true(bvh_check(one));
    for (unsigned threads = 2; threads <= 5; threads += 3) {
        Bvh *more = bvh_create(&s->in, threads, &err);
        assert_non_null(more);
        assert_int_equal(more->node_count, one->node_count);
        assert_int_equal(more->group_count, one->group_count);
        assert_memory_equal(more->node, one->node, one->node_count * sizeof *one->node);
        assert_memory_equal(more->group, one->group, one->group_count * sizeof *one->group);
        bvh_destroy(more);
    }
    Random r = { 13 };
    for (uint32_t i = 0; i < 40; i++) {
        const Ray ray = random_ray(s, &r, vec3(0, 0, 0), 1.5);
        Hit got, want;
        assert_int_equal(bvh_nearest(one, &ray, &got), brute_nearest(&s->in, &ray, &want));
        assert_int_equal(got.primitive, want.primitive);
    }
    bvh_destroy(one);
    scene_destroy(s);
}

/* Each triangle half as large as the one before: cuts take off one at a time; the tree's depth
 * (checked by bvh_check) must stay within the stack. */
static void deep_trees_stay_in_bounds(void **state)
{
    (void)state;
    Scene *s = scene_create(4000);
    for (int i = 0; i < 4000; i++) {
        const double x = ldexp(1, -(i % 100));
        add_triangle(s, vec3(x, 0, 0), vec3(x, x, 0), vec3(x, 0, x));
    }
    Trees trees = trees_create(&s->in);
    Random r = { 1 };
    for (uint32_t i = 0; i < 2000 / SLOWER; i++) {
        const Ray ray = random_ray(s, &r, vec3(0, 0, 0), 0.5);
        compare_ray(&s->in, &trees, &ray);
    }
    trees_destroy(&trees);
    scene_destroy(s);
}

static void expect_error(const Primitives *in, ErrorCode code, const char *text)
{
    Error err = { 0 };
    const long live = array_live();
    assert_null(bvh_create(in, 2, &err));
    assert_int_equal(err.code, code);
    assert_non_null(strstr(err.text, text));
    assert_int_equal(array_live(), live);
}

static void bad_input_is_told(void **state)
{
    (void)state;
    Scene *s = soup_create(70000, 0.1, 2);
    s->corner[3 * 60000] = s->in.vertex_count;
    s->corner[3 * 65000] = UINT32_MAX;
    expect_error(&s->in, ERROR_INPUT, "triangle 60000 names vertex 210000 of 210000");
    s->corner[3 * 60000] = s->corner[3 * 65000] = 0;
    static const double bad[] = { NAN, INFINITY, 1e300 };
    for (int i = 0; i < 3; i++) {
        s->position[30000].y = bad[i];
        expect_error(&s->in, ERROR_INPUT, "vertex 30000");
    }
    s->position[30000].y = 0;
    setenv("ISOLUX_ISA", "z80", 1);
    expect_error(&s->in, ERROR_USAGE, "z80");
    unsetenv("ISOLUX_ISA");
    Error earlier = { .code = ERROR_FAILED };
    assert_null(bvh_create(&s->in, 1, &earlier));
    scene_destroy(s);
}

/* Every allocation fails once; for the large scene, every one of a sample. */
static void memory_failures_leave_nothing(void **state)
{
    (void)state;
    for (int large = 0; large < 2; large++) {
        Scene *s = soup_create(large ? 140000 : 3000, 0.02, 3);
        const long live = array_live();
        Bvh *bvh = NULL;
        for (long n = 0; bvh == NULL; n += large ? 1 + 2 * n : 1) {
            Error err = { 0 };
            array_fail_after(n);
            bvh = bvh_create(&s->in, 2, &err);
            array_fail_after(-1);
            if (bvh == NULL) {
                assert_int_equal(err.code, ERROR_MEMORY);
                assert_int_equal(array_live(), live);
            }
        }
        assert_true(bvh_check(bvh));
        bvh_destroy(bvh);
        assert_int_equal(array_live(), live);
        scene_destroy(s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slivers_agree),
        cmocka_unit_test(lattice_rays_agree),
        cmocka_unit_test(one_triangle),
        cmocka_unit_test(one_sphere),
        cmocka_unit_test(edge_on),
        cmocka_unit_test(ties_go_to_the_smaller),
        cmocka_unit_test(the_face_that_looks_here_is_hit),
        cmocka_unit_test(shapes_and_gaps),
        cmocka_unit_test(flat_triangles_are_never_hit),
        cmocka_unit_test(nothing_is_a_valid_tree),
        cmocka_unit_test(bad_rays_miss),
        cmocka_unit_test(many_equal_single),
        cmocka_unit_test(threads_make_the_same_tree),
        cmocka_unit_test(deep_trees_stay_in_bounds),
        cmocka_unit_test(bad_input_is_told),
        cmocka_unit_test(memory_failures_leave_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
