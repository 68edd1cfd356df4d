/* SPDX-License-Identifier: BSD-3-Clause */
/* Rays from one origin, as a camera's: all kernels against each ray alone, to the bit. */
#include "tests/ray_scenes.h"

#ifdef BEAMS_MORE /* for a long search by hand */
enum { BEAMS = 400 * BEAMS_MORE };
#else
enum { BEAMS = 400 / (SLOWER > 20 ? 40 : SLOWER > 1 ? 8 : 1) };
#endif
enum { BEAM = 64 };

/* Sheets in one place: the same square cut along either diagonal, turned over, and once more a
 * little behind. */
static Scene *sheets_create(void)
{
    Scene *s = scene_create(64);
    for (int i = 0; i < 4; i++) {
        const double y = i == 3 ? 0x1p-22 : 0;
        const Vec3 a = vec3(-1, y, -1), b = vec3(1, y, -1), c = vec3(1, y, 1), d = vec3(-1, y, 1);
        if (i == 0)
            add_quad(s, a, b, c, d);
        else if (i == 1)
            add_quad(s, d, c, b, a);
        else
            add_quad(s, b, c, d, a);
    }
    add_box(s, vec3(-0.5, -0.5, -0.5), vec3(0.5, 0, 0.5));
    return s;
}

/* Slivers around one corner, each beside the next, over a floor that they touch. */
static Scene *fan_create(void)
{
    enum { BLADES = 600 };
    Scene *s = scene_create(BLADES + 2);
    for (int i = 0; i < BLADES; i++) {
        const double a = 2 * M_PI * i / BLADES, b = 2 * M_PI * (i + 1) / BLADES;
        add_triangle(s, vec3(0, 0, 0), vec3(cos(a), 0.3 * sin(7 * a), sin(a)),
                     vec3(cos(b), 0.3 * sin(7 * b), sin(b)));
    }
    add_quad(s, vec3(-1, -0.3, -1), vec3(1, -0.3, -1), vec3(1, -0.3, 1), vec3(-1, -0.3, 1));
    return s;
}

/* Around the direction to a corner: through it, through the middles of its triangle's edges and
 * along them, and near them. */
static void beam_fill(const Scene *s, Random *r, Vec3 o, double width, Ray *ray)
{
    const uint32_t t = (uint32_t)(random_unit(r) * s->in.triangle_count);
    const Vec3 *p = &s->position[3 * t];
    const Vec3 d = vec3_sub(p[0], o);
    const double length = vec3_length(d) + 1e-30;
    const double begin = random_unit(r), end = random_unit(r), scale = exp(6 * random_unit(r) - 3);
    for (int i = 0; i < BEAM; i++) {
        Vec3 to = vec3_mad(d, width * length, random_cube(r));
        if (i % 9 == 1)
            to = d;
        else if (i % 9 == 3)
            to = vec3_sub(vec3_lerp(p[0], p[1], width * random_unit(r)), o);
        else if (i % 9 == 5)
            to = vec3_sub(vec3_lerp(p[0], p[2], width / 2), o);
        to = vec3_scale(to, scale / length);
        ray[i] = ray_of(o, to, begin < 0.8 ? 0 : (float)(begin / scale * length),
                        end < 0.7 ? INFINITY : (float)(2 * end / scale * length));
    }
}

static void compare_beams(Scene *s, Vec3 centre, double reach, uint64_t seed)
{
    static const double width[] = { 0, 1e-6, 1e-4, 0.003, 0.03, 0.1, 0.5 };
    Trees trees = trees_create(&s->in);
    Random r = { seed };
    Ray *ray = calloc((size_t)BEAM * BEAMS, sizeof *ray);
    for (int b = 0; b < BEAMS; b++) {
        Vec3 o = vec3_mad(centre, reach, random_cube(&r));
        if (b % 5 == 0) /* in the plane of walls, at the height of edges */
            o.y = floor(o.y);
        if (b % 11 == 0)
            o = s->position[(uint32_t)(random_unit(&r) * s->in.vertex_count)];
        beam_fill(s, &r, o, width[b % 7], ray + (size_t)b * BEAM);
    }
    compare_many(&trees, ray, (size_t)BEAM * BEAMS);
    free(ray);
    trees_destroy(&trees);
    scene_destroy(s);
}

static void rooms_agree(void **state)
{
    (void)state;
    compare_beams(room_create(), vec3(5, 5, 5), 4.9, 1);
    compare_beams(room_create(), vec3(5, 5, 5), 50, 2);
    compare_beams(sheets_create(), vec3(0, 0, 0), 3, 3);
    compare_beams(sheets_create(), vec3(0, 0, 0), 1e-3, 4);
}

static void slivers_agree(void **state)
{
    (void)state;
    compare_beams(fan_create(), vec3(0, 0, 0), 2, 5);
    compare_beams(soup_create(4000, 0.1, 3), vec3(0, 0, 0), 1, 6);
    compare_beams(soup_create(300, 1, 4), vec3(0, 0, 0), 2, 7);
}

static void balls_agree(void **state)
{
    (void)state;
    static const double radius[] = { 1, 1e-3, 1e6, 1e-18, 1e11 };
    for (size_t i = 0; i < sizeof radius / sizeof *radius; i++) {
        const double far = i < 3 ? 300 * (double)i : 0;
        const Vec3 centre = vec3_scale(vec3(far, -far / 2, 1), radius[i]);
        compare_beams(ball_create(3, centre, radius[i]), centre, 0.7 * radius[i], 8 + i);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rooms_agree),
        cmocka_unit_test(slivers_agree),
        cmocka_unit_test(balls_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
