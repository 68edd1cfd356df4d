/* SPDX-License-Identifier: BSD-3-Clause */
/* tests/ray_scenes.h -- scenes and random rays for the tests of raycast/, and the comparison of all
 * kernels with brute force. */
#ifndef TESTS_RAY_SCENES_H
#define TESTS_RAY_SCENES_H

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "raycast/internal.h"

#if defined(ISOLUX_MEMCHECK)
#define SLOWER 100u /* fewer rays where each takes longer */
#elif defined(__SANITIZE_ADDRESS__) || defined(ISOLUX_SCALAR) || !defined(__OPTIMIZE__)
#define SLOWER 20u
#else
#define SLOWER 1u
#endif

/* --- scenes ---------------------------------------------------------------------------------- */

typedef struct {
    uint64_t state;
} Random;

static inline double random_unit(Random *r)
{
    r->state += UINT64_C(0x9e3779b97f4a7c15);
    uint64_t x = r->state;
    x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
    return (double)((x ^ x >> 31) >> 11) * 0x1p-53;
}

static inline Vec3 random_cube(Random *r)
{
    const double x = random_unit(r), y = random_unit(r);
    return vec3(2 * x - 1, 2 * y - 1, 2 * random_unit(r) - 1);
}

static inline Vec3 random_direction(Random *r)
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

static inline Scene *scene_create(uint32_t triangles)
{
    Scene *s = calloc(1, sizeof *s);
    s->position = calloc(3 * (size_t)triangles + 1, sizeof *s->position);
    s->corner = calloc(3 * (size_t)triangles + 1, sizeof *s->corner);
    s->in = (Primitives){ .position = s->position, .corner = s->corner, .shape = s->shape };
    return s;
}

static inline void scene_destroy(Scene *s)
{
    free(s->position);
    free(s->corner);
    free(s);
}

static inline void add_triangle(Scene *s, Vec3 a, Vec3 b, Vec3 c)
{
    const Vec3 p[3] = { a, b, c };
    for (int i = 0; i < 3; i++) {
        s->position[s->in.vertex_count] = p[i];
        s->corner[3 * s->in.triangle_count + (uint32_t)i] = s->in.vertex_count++;
    }
    s->in.triangle_count++;
}

static inline void add_quad(Scene *s, Vec3 a, Vec3 b, Vec3 c, Vec3 d)
{
    add_triangle(s, a, b, c);
    add_triangle(s, a, c, d);
}

static inline void add_box(Scene *s, Vec3 lo, Vec3 hi)
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

static inline void add_shape(Scene *s, ShapeKind kind, double ratio, Vec3 at, double size)
{
    Error err = { 0 };
    const Affine scale = { { size, 0, 0 }, { 0, 1.3 * size, 0 }, { 0.2 * size, 0, 0.8 * size },
                           at };
    const Affine turn = affine_rotation(s->in.shape_count % 3 ? 0 : 1, 40);
    const Affine map = affine_then(&scale, &turn);
    assert_true(shape_init(&s->shape[s->in.shape_count++], kind, ratio, &map, &err));
}

static inline Scene *soup_create(uint32_t count, double size, uint64_t seed)
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
static inline Scene *room_create(void)
{
    Scene *s = scene_create(64);
    add_box(s, vec3(0, 0, 0), vec3(10, 10, 10));
    add_box(s, vec3(2, 0, 2), vec3(4, 6, 4));
    add_box(s, vec3(5, 0, 5), vec3(8, 3, 8));
    add_quad(s, vec3(4, 9, 4), vec3(6, 9, 4), vec3(6, 9, 6), vec3(4, 9, 6));
    return s;
}

/* A ball of 20 * 4^levels triangles: each edge halved and its middle pushed out. */
static inline Scene *ball_create(int levels, Vec3 centre, double radius)
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

/* --- comparing ------------------------------------------------------------------------------- */

#define KERNELS 4
#define TREES (KERNELS + 1) /* and one of BVH_HIGH, for the best kernel */
static const char *const kernel_name[TREES] = { "scalar", "sse4.2", "avx2", "avx512", "" };

typedef struct {
    Bvh *bvh[TREES]; /* NULL: not on this machine or in this build */
} Trees;

static inline Trees trees_create(const Primitives *in)
{
    Trees trees = { { 0 } };
    for (int k = 0; k < TREES; k++) {
        Error err = { 0 };
        setenv("ISOLUX_ISA", kernel_name[k], 1);
        trees.bvh[k] = bvh_create_as(in, k < KERNELS ? BVH_MEDIUM : BVH_HIGH, 2, &err);
        if (trees.bvh[k] == NULL) {
            assert_int_equal(err.code, ERROR_USAGE);
            assert_int_not_equal(k, 0);
            continue;
        }
        if (k < KERNELS)
            assert_string_equal(bvh_isa(trees.bvh[k]), kernel_name[k]);
        assert_true(bvh_check(trees.bvh[k]));
    }
    unsetenv("ISOLUX_ISA");
    return trees;
}

static inline void trees_destroy(Trees *trees)
{
    for (int k = 0; k < TREES; k++)
        trees->bvh[k] = bvh_destroy(trees->bvh[k]);
}

static inline void show_ray(const char *what, const Ray *ray, const Hit *want, const Hit *got)
{
    print_error("%s: o %a %a %a d %a %a %a t %a..%a\n", what, ray->ox, ray->oy, ray->oz, ray->dx,
                ray->dy, ray->dz, ray->t_min, ray->t_max);
    print_error("want %u t %a u %a v %a, got %u t %a u %a v %a\n", want->primitive, want->t,
                want->u, want->v, got->primitive, got->t, got->u, got->v);
}

/* All kernels, and the better tree, give the hit that brute force gives, to the bit. */
static inline void compare_ray(const Primitives *in, const Trees *trees, const Ray *ray)
{
    Hit want;
    const bool hit = brute_nearest(in, ray, &want);
    assert_int_equal(hit, want.primitive != RAY_MISS);
    for (int k = 0; k < TREES; k++) {
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

/* The calls for many rays give what the scalar kernel gives ray by ray, to the bit. */
static inline void compare_many(const Trees *trees, const Ray *ray, size_t count)
{
    Hit *want = calloc(count, sizeof *want), *got = calloc(count, sizeof *got);
    bool *blocked = calloc(count, sizeof *blocked);
    for (size_t i = 0; i < count; i++)
        bvh_nearest(trees->bvh[0], &ray[i], &want[i]);
    for (int k = 0; k < TREES; k++)
        for (int sorted = 0; trees->bvh[k] != NULL && sorted < 2; sorted++) {
            memset(got, 0xff, count * sizeof *got);
            memset(blocked, 2, count * sizeof *blocked);
            (sorted ? bvh_nearest_many : bvh_nearest_beam)(trees->bvh[k], ray, got, count);
            (sorted ? bvh_blocked_many : bvh_blocked_beam)(trees->bvh[k], ray, blocked, count);
            for (size_t i = 0; i < count; i++) {
                if (memcmp(&got[i], &want[i], sizeof *got) != 0)
                    show_ray(kernel_name[k], &ray[i], &want[i], &got[i]);
                assert_memory_equal(&got[i], &want[i], sizeof *got);
                assert_int_equal(blocked[i], want[i].primitive != RAY_MISS);
            }
        }
    free(want);
    free(got);
    free(blocked);
}

static inline Ray ray_of(Vec3 o, Vec3 d, float t_min, float t_max)
{
    return (Ray){ .ox = (float)o.x, .oy = (float)o.y, .oz = (float)o.z, .t_min = t_min,
                  .dx = (float)d.x, .dy = (float)d.y, .dz = (float)d.z, .t_max = t_max };
}

/* Random rays through a cube of half width `reach` about the centre; some of them short, some
 * aimed exactly at vertices, some parallel to an axis or a plane of axes. */
static inline Ray random_ray(const Scene *s, Random *r, Vec3 centre, double reach)
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

static inline void compare_scene(const Scene *s, uint32_t rays, Vec3 centre, double reach,
                                 uint64_t seed)
{
    enum { MANY = SLOWER > 20 ? 500 : 5000 };
    Trees trees = trees_create(&s->in);
    Random r = { seed };
    Ray *many = calloc(MANY, sizeof *many);
    for (uint32_t i = 0; i < rays / SLOWER; i++) {
        const Ray ray = random_ray(s, &r, centre, reach);
        compare_ray(&s->in, &trees, &ray);
        many[i % MANY] = ray;
    }
    compare_many(&trees, many, MANY);
    free(many);
    trees_destroy(&trees);
}

#endif
