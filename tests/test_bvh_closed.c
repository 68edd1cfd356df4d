/* SPDX-License-Identifier: BSD-3-Clause */
/* Rays in company against rays alone, and closed meshes that no ray may leave. */
#include "tests/ray_scenes.h"

/* --- rays in company ------------------------------------------------------------------------- */

/* Beams: rays that differ a little in origin and direction, so that packets stay together down to
 * the triangles; some of a beam are no rays at all, some end early. */
static void beams_agree(void **state)
{
    (void)state;
    enum { BEAM = 50, BEAMS = 400 / (SLOWER > 20 ? 40 : SLOWER > 1 ? 4 : 1) };
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
            for (int k = 0; k < TREES; k++) {
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
        cmocka_unit_test(beams_agree),
        cmocka_unit_test(balls_are_closed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
