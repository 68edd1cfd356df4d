/* SPDX-License-Identifier: BSD-3-Clause */
/* The tree of boxes against every primitive in turn, its kernels against each other bit for bit,
 * and closed meshes that no ray may leave. */
#include "tests/ray_scenes.h"

/* --- tree against brute force ---------------------------------------------------------------- */

static void soups_agree(void **state)
{
    (void)state;
    static const struct {
        uint32_t triangles, rays;
        double   size;
    } table[] = { { 1, 20000, 1 }, { 3, 20000, 1 }, { 9, 30000, 0.5 }, { 40, 50000, 0.4 },
                  { 150, 50000, 0.3 }, { 400, 60000, 0.1 }, { 3000, 5000, 0.02 } };
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
    compare_scene(s, 100000, vec3(5, 5, 5), 6, 3);
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

/* --- rays in company ------------------------------------------------------------------------- */

/* Beams: rays that differ a little in origin and direction, so that packets stay together down to
 * the triangles; some of a beam are no rays at all, some end early. */
static void beams_agree(void **state)
{
    (void)state;
    enum { BEAM = 50, BEAMS = 400 / (SLOWER > 1 ? 4 : 1) };
    static const double width[] = { 0, 1e-4, 0.02, 0.3 };
    for (int scene = 0; scene < 3; scene++) {
        Scene *s = scene == 0 ? room_create() : scene == 1 ? soup_create(4000, 0.1, 3)
                                                           : ball_create(3, vec3(0, 0, 0), 1);
        const Vec3 centre = scene == 0 ? vec3(5, 5, 5) : vec3(0, 0, 0);
        const double reach = scene == 0 ? 4.9 : 1;
        if (scene == 1)
            add_shape(s, SHAPE_TORUS, 0.3, vec3(0, 0, 0.2), 0.5);
        Trees trees = trees_create(&s->in);
        Random r = { 77 };
        Ray *ray = calloc(BEAM * BEAMS, sizeof *ray);
        for (int b = 0; b < BEAMS; b++) {
            const Vec3 o = vec3_mad(centre, reach, random_cube(&r)), d = random_direction(&r);
            for (int i = 0; i < BEAM; i++) {
                const double w = width[b % 4];
                const Vec3 oi = vec3_mad(o, w * reach, random_cube(&r));
                Ray *one = &ray[b * BEAM + i];
                *one = ray_of(oi, vec3_mad(d, w, random_cube(&r)), 0,
                              i % 7 == 0 ? (float)reach : INFINITY);
                if (i % 17 == 3)
                    one->dx = 0;
                if (i % 29 == 5)
                    one->oy = b % 2 ? NAN : INFINITY;
                if (i % 31 == 7)
                    one->t_max = b % 2 ? NAN : -1;
            }
        }
        compare_many(&trees, ray, BEAM * BEAMS);
        free(ray);
        trees_destroy(&trees);
        scene_destroy(s);
    }
}

/* --- closed meshes --------------------------------------------------------------------------- */

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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(soups_agree),
        cmocka_unit_test(slivers_agree),
        cmocka_unit_test(room_agrees),
        cmocka_unit_test(shapes_agree),
        cmocka_unit_test(lattice_rays_agree),
        cmocka_unit_test(beams_agree),
        cmocka_unit_test(balls_are_closed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
