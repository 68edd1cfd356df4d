/* SPDX-License-Identifier: BSD-3-Clause */
/* Factors by way of mirrors and glass against closed forms: images in mirrors, panes, furnaces. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "radiosity/mirrors.h"
#include "render/specular.h"
#include "tests/room_maker.h"

static uint32_t special(TestRoom *r, double specular, double transmittance, double ior)
{
    Error    err = { 0 };
    uint32_t index = 0;
    Material m = material_default();
    m.reflectance = rgb(0, 0, 0);
    m.specular = rgb(specular, specular, specular);
    m.exponent = INFINITY;
    m.transmittance = rgb(transmittance, transmittance, transmittance);
    m.ior = ior;
    assert_true(polygons_add_material(&r->soup, &m, &index, &err));
    return index;
}

static void finish(TestRoom *r, double size, const Light *light, size_t lights)
{
    const Vec3 eye = vec3(0.2, 0.3, 0.3); /* in the room */
    const SidesOptions options = { .emit = EMIT_FRONT, .eye = &eye, .eye_count = 1 };
    room_finish(r, size, &options, light, lights, NULL);
    r->room.mirrors = true;
}

/* Factor between opposite squares of side 1 at distance c [howell, C-11]. */
static double opposite(double c)
{
    const double x = 1 / c, x1 = 1 + x * x;
    return 2 / (M_PI * x * x) * (log(x1 / sqrt(1 + 2 * x * x)) + 2 * x * sqrt(x1) *
                                 atan(x / sqrt(x1)) - 2 * x * atan(x));
}

/* A row's factor is known from 16 patches of 1024 rays of a net, each share of a part hit by a half
 * or less: off by far less than 1 / sqrt(16 * 1024) / 2 of 1, three times over. */
static const double BY_RAYS = 0.004;

/* The wall opposite a mirror sees itself in it, at twice the distance; the side walls bring nothing
 * of it, for they do not send light on. */
static void mirror_shows_images(void **state)
{
    (void)state;
    static const double share[] = { 1, 0.6, 0 };
    for (int emits = 0; emits < 2; emits++)
        for (int k = 0; k < 3; k++) {
            TestRoom r = { 0 };
            room_box(&r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_X0, true, special(&r, share[k], 0, 1),
                     "");
            room_box(&r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL & ~BOX_X0, true,
                     room_material(&r, 0.5, emits), "");
            finish(&r, 0.25, NULL, 0);
            Links       *raw = room_links(&r, 1024, CLOSURE_NONE);
            const double own = share[k] * opposite(2), mirror = (1 - share[k]) * opposite(1);
            assert_true(fabs(room_factor(&r, raw, "x1", "x1") - own) < BY_RAYS);
            assert_true(fabs(room_factor(&r, raw, "x1", "x0") - mirror) < BY_RAYS);
            /* Closed, all hold exactly; no light gets lost, and none is counted twice. */
            Links      *closed = room_links(&r, 1024, CLOSURE_BOTH);
            LinksReport report;
            Error       err = { 0 };
            assert_true(links_report(closed, &report, &err));
            assert_true(report.row_sum_error_max < 1e-6 && report.reciprocity_error_max < 1e-6);
            assert_true(report.escaped < 1e-6);
            assert_true(fabs(room_factor(&r, closed, "x1", "x1") - own) < BY_RAYS);
            links_destroy(raw);
            links_destroy(closed);
            room_clear(&r);
        }
}

/* A pane in the middle that lets 0.7 through and sends nothing back: the walls behind it count 0.7
 * times, and the pane takes the rest; the same for lamps, which are found by samples of theirs. */
static void pane_lets_light_pass(void **state)
{
    (void)state;
    for (int emits = 0; emits < 2; emits++) {
        TestRoom r = { 0 };
        room_box(&r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL & ~BOX_X1, true,
                 room_material(&r, 0.5, 0), "");
        room_box(&r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_X1, true, room_material(&r, 0.5, emits),
                 "");
        room_quad(&r, vec3(0.5, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), special(&r, 0, 0.7, 1),
                  "pane");
        finish(&r, 0.25, NULL, 0);
        Links *raw = room_links(&r, 1024, CLOSURE_NONE);
        assert_true(fabs(room_factor(&r, raw, "x0", "x1") - 0.7 * opposite(1)) < BY_RAYS);
        assert_true(fabs(room_factor(&r, raw, "x0", "pane") - 0.3 * opposite(0.5)) < BY_RAYS);
        links_destroy(raw);
        room_clear(&r);
    }
}

static void solve_room(const TestRoom *r, Links *links, const double *received, double **radiosity)
{
    Error        err = { 0 };
    const size_t n = r->patches->count;
    double *e = array_create(3 * n, sizeof *e, "test", &err);
    double *rho = array_create(3 * n, sizeof *rho, "test", &err);
    for (uint32_t i = 0; i < n; i++) {
        Rgb emission, reflectance;
        mirrors_problem(&r->room, i, &emission, &reflectance);
        memcpy(e + 3 * i, &emission, sizeof emission);
        memcpy(rho + 3 * i, &reflectance, sizeof reflectance);
    }
    const SolveProblem problem = { .bands = 3, .emission = e, .reflectance = rho,
                                   .received = received };
    Solution *s = solve(links, &problem, &(SolveOptions){ .tolerance = 1e-9, .threads = 1 }, NULL,
                        &err);
    assert_non_null(s);
    *radiosity = array_create(3 * n, sizeof **radiosity, "test", &err);
    for (size_t i = 0; i < 3 * n; i++)
        (*radiosity)[i] = s->radiosity[i] * mirrors_kept(&r->room, (uint32_t)(i / 3));
    solution_destroy(s);
    array_free(e);
    array_free(rho);
}

/* Walls of emission 1 and reflectance 0.5 give 2 everywhere, whatever perfect mirrors, panes and
 * bodies of clear glass stand in the room; a mirror of 0.4 that is diffuse by 0.2 and sends out 0.4
 * itself gives 0.2 H + 0.4 of H = 2: 0.8, diffusely, and the rest by its mirror. */
static void furnace_with_mirrors(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    room_box(&r, vec3(0, 0, 0), vec3(3, 3, 3), BOX_ALL & ~BOX_Y0, true, room_material(&r, 0.5, 1),
             "");
    Error    err = { 0 };
    uint32_t mixed = 0;
    Material m = material_default();
    m.reflectance = rgb(0.2, 0.2, 0.2);
    m.specular = rgb(0.4, 0.4, 0.4);
    m.exponent = INFINITY;
    m.emission = rgb(0.8 / M_PI, 0.8 / M_PI, 0.8 / M_PI);
    assert_true(polygons_add_material(&r.soup, &m, &mixed, &err));
    room_box(&r, vec3(0, 0, 0), vec3(3, 3, 3), BOX_Y0, true, mixed, "");
    room_quad(&r, vec3(0.5, 0.5, 2.5), vec3(1, 0, 0), vec3(0, 1, 0), special(&r, 0, 1, 1.5),
              "pane");
    room_box(&r, vec3(1, 1, 0.5), vec3(2, 2, 1.5), BOX_ALL, false, special(&r, 0, 1, 1.5), "glass");
    room_quad(&r, vec3(0.2, 2, 0.2), vec3(0, 0.5, 0), vec3(0, 0, 1), special(&r, 1, 0, 1),
              "mirror");
    finish(&r, 0.75, NULL, 0);
    Links  *links = room_links(&r, 256, CLOSURE_ROWS);
    double *b = NULL;
    solve_room(&r, links, NULL, &b);
    for (uint32_t i = 0; i < r.patches->count; i++) {
        const double kept = mirrors_kept(&r.room, i);
        const bool   is_mixed = r.patches->material[i] == mixed;
        if (kept == 0)
            assert_true(links->area[i] == 0);
        else if (!is_mixed && r.soup.materials[r.patches->material[i]].reflectance.g > 0)
            assert_true(fabs(b[3 * i] - 2) < 1e-4);
        else if (is_mixed)
            assert_true(fabs(b[3 * i] - 1.2) < 1e-4); /* 0.8 + 0.2 * 2 */
    }
    array_free(b);
    links_destroy(links);
    room_clear(&r);
}

/* A light behind a pane lights the floor 0.7 times as much, and what is thrown on by a mirror is
 * told as escaped: no ray finds it. */
static void lights_and_panes(void **state)
{
    (void)state;
    const Light light = { .kind = LIGHT_POINT, .position = { 0.5, 0.5, 1.5 },
                          .intensity = { 8, 8, 8 } };
    for (int pane = 0; pane < 2; pane++) {
        TestRoom r = { 0 };
        Error    err = { 0 };
        Direct   direct;
        room_box(&r, vec3(0, 0, 0), vec3(1, 1, 2), BOX_ALL & ~BOX_X0, true,
                 room_material(&r, 0.5, 0), "");
        room_box(&r, vec3(0, 0, 0), vec3(1, 1, 2), BOX_X0, true, special(&r, pane ? 0 : 1, 0, 1),
                 "");
        if (pane)
            room_quad(&r, vec3(0, 0, 1), vec3(1, 0, 0), vec3(0, 1, 0), special(&r, 0, 0.7, 1),
                      "pane");
        finish(&r, 0.125, &light, 1);
        Links *links = room_links(&r, 64, CLOSURE_ROWS);
        assert_true(direct_create(&r.room, links, &(DirectOptions){ .balance = !pane }, &direct,
                                  NULL, &err));
        double sum = 0, arrived = 0;
        for (uint32_t i = 0; i < links->count; i++) {
            const double flux = links->area[i] * direct.irradiance[3 * (size_t)i];
            arrived += flux;
            sum += r.patches->group[i] == room_group(&r, "z0") ? flux : 0;
        }
        /* Solid angle of a square of side 1 at distance 1.5 over its middle, times intensity. */
        const double exact = 8 * 4 * asin(0.25 / (0.25 + 2.25));
        /* Points of a net on 64 patches: better than 1 %. */
        assert_true(fabs(sum / (pane ? 0.7 : 1) - exact) < 0.01 * exact);
        /* The mirror takes the solid angle of [0,1] x [0,2] at distance 0.5: what arrives elsewhere
         * and what escapes make up all. */
        const double a = 0.5, c = 0.5, d = 0.5, up = 1.5;
        const double mirror = 8 * 2 * (atan(a * d / (c * sqrt(a * a + c * c + d * d))) +
                                       atan(a * up / (c * sqrt(a * a + c * c + up * up))));
        if (!pane) {
            assert_true(fabs(direct.escaped.g - mirror) < 0.01 * mirror);
            assert_true(fabs(arrived + direct.escaped.g - direct.flux.g) < 1e-6 * direct.flux.g);
        }
        array_free(direct.irradiance);
        links_destroy(links);
        room_clear(&r);
    }
}

/* What stands in and behind glass takes part: light reaches it. */
static void sight_passes_glass(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    room_box(&r, vec3(0, 0, 0), vec3(3, 3, 3), BOX_ALL, true, room_material(&r, 0.5, 1), "");
    room_box(&r, vec3(1, 1, 1), vec3(2, 2, 2), BOX_ALL, false, special(&r, 0, 1, 1), "case");
    room_box(&r, vec3(1.3, 1.3, 1.3), vec3(1.6, 1.6, 1.6), BOX_ALL, false,
             room_material(&r, 0.5, 0), "in");
    finish(&r, 1, NULL, 0);
    assert_int_equal(r.sides[room_surface(&r, "inz1")], 1);
    assert_int_equal(r.sides[room_surface(&r, "casez1")], 3);
    room_clear(&r);
    assert_int_equal(array_live(), 0);
}

static double area_of(const TestRoom *r, const Links *links, const char *group)
{
    double area = 0;
    for (uint32_t i = 0; i < links->count; i++)
        area += r->patches->group[i] == room_group(r, group) ? links->area[i] : 0;
    return area;
}

/* A pane that fills a hole in a wall has neighbours all round, and does not bend light for that; a
 * thing in a block of glass shares light with the room in the proportion of n^2 times its area. */
static void skins_and_bodies(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    Error    err = { 0 };
    room_box(&r, vec3(0, 0, 0), vec3(3, 3, 3), BOX_ALL & ~BOX_Z1, true, room_material(&r, 0.5, 0),
             "");
    room_box(&r, vec3(0, 0, 0), vec3(3, 3, 3), BOX_Z1, true, special(&r, 0, 0.9, 1.5), "pane");
    room_box(&r, vec3(1, 1, 1), vec3(2, 2, 2), BOX_ALL, false, special(&r, 0, 1, 1.5), "glass");
    room_box(&r, vec3(1.3, 1.3, 1.3), vec3(1.7, 1.7, 1.7), BOX_ALL, false,
             room_material(&r, 0.5, 0), "in");
    finish(&r, 0.5, NULL, 0);
    uint8_t *skin = mirrors_skins(r.surfaces, r.soup.materials, &err);
    assert_non_null(skin);
    r.room.skin = skin;
    assert_false(mirrors_is_skin(&r.room, room_surface(&r, "panez1")));
    assert_true(mirrors_is_skin(&r.room, room_surface(&r, "glassz1")));
    assert_false(mirrors_is_skin(&r.room, room_surface(&r, "inz1")));
    Links *links = room_links(&r, 4096, CLOSURE_NONE);
    const double there = area_of(&r, links, "inz0") * room_factor(&r, links, "inz0", "z0");
    const double back = area_of(&r, links, "z0") * room_factor(&r, links, "z0", "inz0");
    assert_true(fabs(area_of(&r, links, "inz0") - 0.16 * 2.25) < 1e-6);
    /* Of 36 * 4096 rays some 500 come back, those that leave meet by thousands: 4 sigma. */
    assert_true(there > 0 && fabs(back - there) < 0.2 * there);
    links_destroy(links);
    array_free(skin);
    room_clear(&r);
    assert_int_equal(array_live(), 0);
}

/* What is left of a ray, mean over many chances; *steps: how many it took; *ends: whether
 * any did. */
static double followed(const TestRoom *r, Vec3 from, Vec3 way, double *steps, bool *ends)
{
    enum { TRIES = 4096 };
    double left = 0;
    *ends = false;
    *steps = 0;
    for (uint32_t seed = 0; seed < TRIES; seed++) {
        Ray ray = { .ox = (float)from.x, .oy = (float)from.y, .oz = (float)from.z,
                    .dx = (float)way.x, .dy = (float)way.y, .dz = (float)way.z,
                    .t_max = INFINITY };
        Hit         hit;
        SpecularWay met;
        uint64_t    rays = 0;
        assert_true(bvh_nearest(r->room.bvh, &ray, &hit));
        const Rgb weight = specular_follow(&r->room, NULL, seed, &ray, &hit, &met, &rays);
        left += hit.primitive != RAY_MISS ? weight.g / TRIES : 0;
        *ends = *ends || hit.primitive != RAY_MISS;
        *steps += (double)rays / TRIES;
    }
    return left;
}

/* Roulette ends rays that lose nothing, too, and takes nothing away in the mean. In a cube of index
 * 2 along its diagonal all is reflected for good, at 54.7 degrees against 30: 4 steps are free, and
 * with the chance 7/8 from there 7 more follow in the mean, of deviation 7.5. Between two perfect
 * mirrors 12 steps lead to the wall with all of the light: the 8 that are not free leave
 * (7/8)^8 of the rays, weighed up: of 4096 a deviation of sqrt((8/7)^8 - 1) / 64 = 0.022. */
static void roulette_of_what_is_caught(void **state)
{
    (void)state;
    TestRoom glass = { 0 }, hall = { 0 };
    double   steps;
    bool     ends;
    room_box(&glass, vec3(0, 0, 0), vec3(3, 3, 3), BOX_ALL, true, room_material(&glass, 0.5, 0),
             "");
    room_box(&glass, vec3(1, 1, 1), vec3(2, 2, 2), BOX_ALL, false, special(&glass, 0, 1, 2),
             "glass");
    finish(&glass, 1, NULL, 0);
    const double none = followed(&glass, vec3(1.5, 1.4, 1.3), vec3(1, 1, 1), &steps, &ends);
    assert_true(none == 0 && !ends);
    assert_true(fabs(steps - 11) < 0.5); /* 4 x 7.5 / 64 */
    room_clear(&glass);
    room_box(&hall, vec3(0, 0, 0), vec3(12, 1, 1), BOX_ALL & ~(BOX_Z0 | BOX_Z1), true,
             room_material(&hall, 0.5, 0), "");
    room_box(&hall, vec3(0, 0, 0), vec3(12, 1, 1), BOX_Z0 | BOX_Z1, true, special(&hall, 1, 0, 1),
             "");
    finish(&hall, 1, NULL, 0);
    const double all = followed(&hall, vec3(0, 0.5, 0.5), vec3(1, 0, 1), &steps, &ends);
    assert_true(ends && fabs(all - 1) < 4 * 0.022);
    room_clear(&hall);
    assert_int_equal(array_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mirror_shows_images), cmocka_unit_test(pane_lets_light_pass),
        cmocka_unit_test(furnace_with_mirrors), cmocka_unit_test(lights_and_panes),
        cmocka_unit_test(sight_passes_glass),  cmocka_unit_test(skins_and_bodies),
        cmocka_unit_test(roulette_of_what_is_caught),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
