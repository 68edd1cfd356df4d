/* SPDX-License-Identifier: BSD-3-Clause */
/* The tree of boxes against every primitive in turn, its kernels against each other bit for bit,
 * and both against answers known in advance. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "raycast/internal.h"

#if defined(__SANITIZE_ADDRESS__) || defined(ISOLUX_SCALAR) || !defined(__OPTIMIZE__)
#define SLOWER 20u /* fewer rays where each takes longer */
#else
#define SLOWER 1u
#endif

#define PI 3.14159265358979323846
#define TRIANGLES_MAX 200000u

/* --- scenes ------------------------------------------------------------------------------------ */

typedef struct {
    uint64_t state;
} Random;

static double random_unit(Random *r)
{
    r->state += UINT64_C(0x9e3779b97f4a7c15);
    uint64_t x = r->state;
    x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
    return (double)((x ^ x >> 31) >> 11) * 0x1p-53;
}

static Vec3 random_cube(Random *r)
{
    const double x = random_unit(r), y = random_unit(r);
    return vec3(2 * x - 1, 2 * y - 1, 2 * random_unit(r) - 1);
}

static Vec3 random_direction(Random *r)
{
    for (;;) {
        const Vec3 d = random_cube(r);
        const double l = vec3_length(d);
        if (l > 0.1 && l < 1)
            return vec3_scale(d, 1 / l);
    }
}

typedef struct {
    Primitives in;
    Vec3      *position;
    uint32_t  *corner;
    Shape      shape[16];
} Scene;

static Scene *scene_create(uint32_t triangles)
{
    Scene *s = calloc(1, sizeof *s);
    s->position = calloc(3 * (size_t)triangles + 1, sizeof *s->position);
    s->corner = calloc(3 * (size_t)triangles + 1, sizeof *s->corner);
    s->in = (Primitives){ .position = s->position, .corner = s->corner, .shape = s->shape };
    return s;
}

static void scene_destroy(Scene *s)
{
    free(s->position);
    free(s->corner);
    free(s);
}

static void add_triangle(Scene *s, Vec3 a, Vec3 b, Vec3 c)
{
    const Vec3 p[3] = { a, b, c };
    for (int i = 0; i < 3; i++) {
        s->position[s->in.vertex_count] = p[i];
        s->corner[3 * s->in.triangle_count + (uint32_t)i] = s->in.vertex_count++;
    }
    s->in.triangle_count++;
}

static void add_quad(Scene *s, Vec3 a, Vec3 b, Vec3 c, Vec3 d)
{
    add_triangle(s, a, b, c);
    add_triangle(s, a, c, d);
}

static void add_box(Scene *s, Vec3 lo, Vec3 hi)
{
    Vec3 p[8];
    for (int i = 0; i < 8; i++)
        p[i] = vec3(i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z);
    add_quad(s, p[0], p[1], p[3], p[2]);
    add_quad(s, p[4], p[6], p[7], p[5]);
    add_quad(s, p[0], p[4], p[5], p[1]);
    add_quad(s, p[2], p[3], p[7], p[6]);
    add_quad(s, p[0], p[2], p[6], p[4]);
    add_quad(s, p[1], p[5], p[7], p[3]);
}

static void add_shape(Scene *s, ShapeKind kind, double ratio, Vec3 at, double size)
{
    Error err = { 0 };
    const Affine scale = { { size, 0, 0 }, { 0, 1.3 * size, 0 }, { 0.2 * size, 0, 0.8 * size }, at };
    const Affine turn = affine_rotation(s->in.shape_count % 3 ? 0 : 1, 40);
    const Affine map = affine_then(&scale, &turn);
    assert_true(shape_init(&s->shape[s->in.shape_count++], kind, ratio, &map, &err));
}

static Scene *soup_create(uint32_t count, double size, uint64_t seed)
{
    Random r = { seed };
    Scene *s = scene_create(count);
    for (uint32_t i = 0; i < count; i++) {
        const Vec3 c = random_cube(&r);
        Vec3 p[3];
        for (int k = 0; k < 3; k++)
            p[k] = vec3_mad(c, size, random_cube(&r));
        add_triangle(s, p[0], p[1], p[2]);
    }
    return s;
}

/* A room with two blocks and a lamp in its ceiling: 38 triangles, everything on whole numbers. */
static Scene *room_create(void)
{
    Scene *s = scene_create(64);
    add_box(s, vec3(0, 0, 0), vec3(10, 10, 10));
    add_box(s, vec3(2, 0, 2), vec3(4, 6, 4));
    add_box(s, vec3(5, 0, 5), vec3(8, 3, 8));
    add_quad(s, vec3(4, 9, 4), vec3(6, 9, 4), vec3(6, 9, 6), vec3(4, 9, 6));
    return s;
}

/* --- comparing --------------------------------------------------------------------------------- */

#define KERNELS 3
static const char *const kernel_name[KERNELS] = { "scalar", "sse2", "avx2" };

typedef struct {
    Bvh *bvh[KERNELS]; /* NULL: not on this machine or in this build */
} Trees;

static Trees trees_create(const Primitives *in)
{
    Trees trees = { { 0 } };
    for (int k = 0; k < KERNELS; k++) {
        Error err = { 0 };
        setenv("ISOLUX_ISA", kernel_name[k], 1);
        trees.bvh[k] = bvh_create(in, 2, &err);
        if (trees.bvh[k] == NULL) {
            assert_int_equal(err.code, ERROR_USAGE);
            assert_int_not_equal(k, 0);
            continue;
        }
        assert_string_equal(bvh_isa(trees.bvh[k]), kernel_name[k]);
        assert_true(bvh_check(trees.bvh[k]));
    }
    unsetenv("ISOLUX_ISA");
    return trees;
}

static void trees_destroy(Trees *trees)
{
    for (int k = 0; k < KERNELS; k++)
        trees->bvh[k] = bvh_destroy(trees->bvh[k]);
}

static void show_ray(const char *what, const Ray *ray, const Hit *want, const Hit *got)
{
    print_error("%s: o %a %a %a d %a %a %a t %a..%a: want %u t %a u %a v %a, got %u t %a u %a v %a\n",
                what, ray->ox, ray->oy, ray->oz, ray->dx, ray->dy, ray->dz, ray->t_min, ray->t_max,
                want->primitive, want->t, want->u, want->v, got->primitive, got->t, got->u, got->v);
}

/* All kernels give the hit that brute force gives, to the bit. */
static void compare_ray(const Primitives *in, const Trees *trees, const Ray *ray)
{
    Hit want;
    const bool hit = brute_nearest(in, ray, &want);
    assert_int_equal(hit, want.primitive != RAY_MISS);
    for (int k = 0; k < KERNELS; k++) {
        if (trees->bvh[k] == NULL)
            continue;
        Hit got;
        const bool found = bvh_nearest(trees->bvh[k], ray, &got);
        if (found != hit || (hit && memcmp(&got, &want, sizeof got) != 0)
            || got.primitive != want.primitive)
            show_ray(kernel_name[k], ray, &want, &got);
        assert_int_equal(found, hit);
        assert_int_equal(got.primitive, want.primitive);
        if (hit)
            assert_memory_equal(&got, &want, sizeof got);
        assert_int_equal(bvh_blocked(trees->bvh[k], ray), hit);
    }
}

static Ray ray_of(Vec3 o, Vec3 d, float t_min, float t_max)
{
    return (Ray){ .ox = (float)o.x, .oy = (float)o.y, .oz = (float)o.z, .t_min = t_min,
                  .dx = (float)d.x, .dy = (float)d.y, .dz = (float)d.z, .t_max = t_max };
}

/* Random rays through a cube of half width `reach` about the centre; some of them short, some
 * aimed exactly at vertices, some parallel to an axis or a plane of axes. */
static Ray random_ray(const Scene *s, Random *r, Vec3 centre, double reach)
{
    const Vec3 o = vec3_mad(centre, reach, random_cube(r));
    Vec3 d = random_direction(r);
    const double what = random_unit(r);
    if (what < 0.1 && s->in.vertex_count > 0) {
        const uint32_t i = (uint32_t)(random_unit(r) * s->in.vertex_count);
        d = vec3_sub(s->position[i], o);
    } else if (what < 0.2) {
        const double axis = random_unit(r);
        d = vec3(axis < 0.5 ? d.x : 0, axis > 0.8 ? d.y : -0.0, axis < 0.7 ? d.z : 0);
        if (vec3_length(d) == 0)
            d.y = 1;
    }
    const double end = random_unit(r);
    const float t_max = end < 0.7 ? INFINITY : (float)(end * reach);
    return ray_of(o, d, end < 0.3 ? 0 : (float)(0.01 * end * reach), t_max);
}

static void compare_scene(const Scene *s, uint32_t rays, Vec3 centre, double reach, uint64_t seed)
{
    Trees trees = trees_create(&s->in);
    Random r = { seed };
    for (uint32_t i = 0; i < rays / SLOWER; i++) {
        const Ray ray = random_ray(s, &r, centre, reach);
        compare_ray(&s->in, &trees, &ray);
    }
    trees_destroy(&trees);
}

/* --- tree against brute force ------------------------------------------------------------------ */

static void soups_agree(void **state)
{
    (void)state;
    static const struct {
        uint32_t triangles, rays;
        double   size;
    } table[] = { { 1, 20000, 1 }, { 3, 20000, 1 }, { 9, 30000, 0.5 }, { 40, 100000, 0.4 },
                  { 150, 400000, 0.3 }, { 400, 60000, 0.1 }, { 3000, 5000, 0.02 } };
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        Scene *s = soup_create(table[i].triangles, table[i].size, 7 + i);
        compare_scene(s, table[i].rays, vec3(0, 0, 0), 1.5, 70 + i);
        scene_destroy(s);
    }
}

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

static void room_agrees(void **state)
{
    (void)state;
    Scene *s = room_create();
    compare_scene(s, 200000, vec3(5, 5, 5), 6, 3);
    scene_destroy(s);
}

static void shapes_agree(void **state)
{
    (void)state;
    Scene *s = soup_create(40, 0.3, 99);
    add_shape(s, SHAPE_SPHERE, 0, vec3(0.3, 0.2, 0.1), 0.4);
    add_shape(s, SHAPE_DISC, 0, vec3(-0.5, 0.2, 0.4), 0.5);
    add_shape(s, SHAPE_FRUSTUM, 1, vec3(-0.3, -0.6, 0.1), 0.3);
    add_shape(s, SHAPE_FRUSTUM, 0, vec3(0.7, -0.6, 0.1), 0.3);
    add_shape(s, SHAPE_TORUS, 0.3, vec3(0, 0, -0.6), 0.5);
    add_shape(s, SHAPE_SPHERE, 0, vec3(0, 0, 0), 2);
    compare_scene(s, 60000, vec3(0, 0, 0), 1.5, 4);
    s->in.triangle_count = 0;
    compare_scene(s, 30000, vec3(0, 0, 0), 1.5, 5);
    scene_destroy(s);
}

/* Rays on the lattice the room stands on: along axes, in the planes of boxes, through corners. */
static void lattice_rays_agree(void **state)
{
    (void)state;
    Scene *s = room_create();
    Trees trees = trees_create(&s->in);
    Random r = { 31 };
    for (uint32_t i = 0; i < 200000 / SLOWER; i++) {
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

/* --- closed meshes ----------------------------------------------------------------------------- */

/* A ball of 20 * 4^levels triangles: each edge halved and its middle pushed out. */
static Scene *ball_create(int levels, Vec3 centre, double radius)
{
    const double g = (1 + sqrt(5)) / 2;
    const Vec3 p[12] = { { -1, g, 0 }, { 1, g, 0 }, { -1, -g, 0 }, { 1, -g, 0 },
                         { 0, -1, g }, { 0, 1, g }, { 0, -1, -g }, { 0, 1, -g },
                         { g, 0, -1 }, { g, 0, 1 }, { -g, 0, -1 }, { -g, 0, 1 } };
    static const int face[20][3] = {
        { 0, 11, 5 }, { 0, 5, 1 }, { 0, 1, 7 }, { 0, 7, 10 }, { 0, 10, 11 }, { 1, 5, 9 },
        { 5, 11, 4 }, { 11, 10, 2 }, { 10, 7, 6 }, { 7, 1, 8 }, { 3, 9, 4 }, { 3, 4, 2 },
        { 3, 2, 6 }, { 3, 6, 8 }, { 3, 8, 9 }, { 4, 9, 5 }, { 2, 4, 11 }, { 6, 2, 10 },
        { 8, 6, 7 }, { 9, 8, 1 } };
    Scene *s = scene_create(20u << 2 * levels);
    for (int f = 0; f < 20; f++)
        add_triangle(s, vec3_unit(p[face[f][0]]), vec3_unit(p[face[f][1]]),
                     vec3_unit(p[face[f][2]]));
    for (int l = 0; l < levels; l++)
        for (uint32_t t = s->in.triangle_count; t-- > 0;) {
            const Vec3 a = s->position[3 * t], b = s->position[3 * t + 1];
            const Vec3 c = s->position[3 * t + 2];
            const Vec3 ab = vec3_unit(vec3_add(a, b)), bc = vec3_unit(vec3_add(b, c));
            const Vec3 ca = vec3_unit(vec3_add(c, a));
            s->position[3 * t] = ab;
            s->position[3 * t + 1] = bc;
            s->position[3 * t + 2] = ca;
            add_triangle(s, a, ab, ca);
            add_triangle(s, ab, b, bc);
            add_triangle(s, ca, bc, c);
        }
    for (uint32_t i = 0; i < s->in.vertex_count; i++)
        s->position[i] = vec3_mad(centre, radius, s->position[i]);
    return s;
}

/* From inside: at random, at a vertex, at the middle of an edge, at a point along an edge. */
static Ray ball_ray(const Scene *s, Random *r, Vec3 centre, double radius)
{
    const Ray from = ray_of(vec3_mad(centre, 0.5 * radius, random_cube(r)), vec3(1, 0, 0), 0,
                            INFINITY);
    const Vec3 o = vec3(from.ox, from.oy, from.oz);
    const uint32_t t = (uint32_t)(random_unit(r) * s->in.triangle_count);
    const Vec3 a = s->position[3 * t], b = s->position[3 * t + 1];
    const double what = random_unit(r);
    Vec3 d = random_direction(r);
    if (what < 0.25)
        d = vec3_sub(a, o);
    else if (what < 0.5)
        d = vec3_sub(vec3_lerp(a, b, 0.5), o);
    else if (what < 0.75)
        d = vec3_sub(vec3_lerp(a, b, random_unit(r)), o);
    return ray_of(o, d, 0, INFINITY);
}

static void balls_are_closed(void **state)
{
    (void)state;
    static const struct {
        double radius;
        Vec3   centre; /* in radii */
    } table[] = { { 1, { 0, 0, 0 } }, { 1e-3, { 0, 0, 0 } }, { 1e6, { 0, 0, 0 } },
                  { 1, { 300, -200, 100 } }, { 1e-3, { 900, 0, -500 } }, { 1e6, { 30, 500, 7 } } };
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        const Vec3 centre = vec3_scale(table[i].centre, table[i].radius);
        Scene *s = ball_create(3, centre, table[i].radius);
        Trees trees = trees_create(&s->in);
        Random r = { i };
        uint32_t escaped = 0;
        for (uint32_t j = 0; j < 120000 / SLOWER; j++) {
            const Ray ray = ball_ray(s, &r, centre, table[i].radius);
            for (int k = 0; k < KERNELS; k++) {
                Hit hit;
                if (trees.bvh[k] != NULL)
                    escaped += !bvh_nearest(trees.bvh[k], &ray, &hit)
                               + !bvh_blocked(trees.bvh[k], &ray);
            }
            if (j % 200 == 0)
                compare_ray(&s->in, &trees, &ray);
        }
        assert_int_equal(escaped, 0);
        trees_destroy(&trees);
        scene_destroy(s);
    }
}

/* --- answers known in advance ------------------------------------------------------------------ */

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
    for (int k = 0; k < KERNELS; k++) {
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

/* --- many rays, threads, bad input, memory ----------------------------------------------------- */

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
    for (int k = 0; k < KERNELS; k++) {
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
    Scene *s = soup_create(TRIANGLES_MAX, 0.01, 12);
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
        cmocka_unit_test(one_triangle),
        cmocka_unit_test(one_sphere),
        cmocka_unit_test(edge_on),
        cmocka_unit_test(soups_agree),
        cmocka_unit_test(slivers_agree),
        cmocka_unit_test(room_agrees),
        cmocka_unit_test(shapes_agree),
        cmocka_unit_test(lattice_rays_agree),
        cmocka_unit_test(balls_are_closed),
        cmocka_unit_test(ties_go_to_the_smaller),
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
