/* SPDX-License-Identifier: BSD-3-Clause */
/* Form factors and their closures against closed forms, furnaces and rooms with known light. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "math/polygon_factor.h"
#include "tests/room_maker.h"

static const Vec3 ORIGIN = { 0, 0, 0 }, UNIT = { 1, 1, 1 };

typedef struct {
    int  count;
    char code[64];
} Warnings;

static void note(void *user, const char *code, const char *where, const char *text)
{
    Warnings *w = user;
    (void)where;
    (void)text;
    w->count++;
    snprintf(w->code, sizeof w->code, "%s", code);
}

/* --- closed forms ----------------------------------------------------------------------------- */

static void test_cube_factors(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    room_box(&r, ORIGIN, UNIT, BOX_ALL, true, room_material(&r, 0.5, 0), "");
    room_finish(&r, 0.25, &(SidesOptions){ 0 }, NULL, 0, NULL);
    /* No lamp and no eye: every side takes part; the outsides of the cube see nothing. */
    assert_int_equal(r.report.both, 6);
    room_clear(&r);

    room_box(&r, ORIGIN, UNIT, BOX_ALL, true, room_material(&r, 0.5, 0), "");
    const Vec3 eye = vec3(0.5, 0.5, 0.5);
    room_finish(&r, 0.25, &(SidesOptions){ .eye = &eye, .eye_count = 1 }, NULL, 0, NULL);
    assert_int_equal(r.patches->count, 96);
    const uint32_t rays = 256;
    Links *links = room_links(&r, rays, CLOSURE_NONE);
    /* Three standard errors of a share p out of N independent rays; the net does much better. */
    const double n = 16.0 * rays, opposite = 0.199824896, adjacent = 0.200043776;
    const double allowed = 3 * sqrt(0.2 * 0.8 / n);
    static const char *const names[6] = { "x0", "x1", "y0", "y1", "z0", "z1" };
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++) {
            const double f = room_factor(&r, links, names[i], names[j]);
            const double exact = i == j ? 0 : i / 2 == j / 2 ? opposite : adjacent;
            assert_true(fabs(f - exact) <= (i == j ? 0 : allowed));
        }
    LinksReport report;
    Error err = { 0 };
    assert_true(links_report(links, &report, &err));
    /* Each row: 256 shares of 1/256 summed and stored in float. */
    assert_true(report.row_sum_error_max < 256 * 0x1p-24);
    assert_true(report.escaped == 0);
    assert_int_equal(report.nonzeros, links->first[links->count]);
    links_destroy(links);
    room_clear(&r);
}

/* An open box: what the missing ceiling would have received escapes. */
static void test_open_box(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    room_box(&r, ORIGIN, UNIT, BOX_ALL - BOX_Z1, true, room_material(&r, 0.5, 0), "");
    const Vec3 eye = vec3(0.5, 0.5, 0.5);
    room_finish(&r, 0.25, &(SidesOptions){ .eye = &eye, .eye_count = 1 }, NULL, 0, NULL);
    Links *links = room_links(&r, 256, CLOSURE_BOTH);
    double floor = 0, wall = 0;
    for (uint32_t i = 0; i < links->count; i++) {
        const bool down = r.patches->group[i] == room_group(&r, "z0");
        *(down ? &floor : &wall) += links->escape[i] / (down ? 16.0 : 64.0);
    }
    assert_true(fabs(floor - 0.199824896) < 3 * sqrt(0.2 * 0.8 / (16 * 256)));
    assert_true(fabs(wall - 0.200043776) < 3 * sqrt(0.2 * 0.8 / (64 * 256)));
    LinksReport report;
    Error err = { 0 };
    assert_true(links_report(links, &report, &err));
    assert_true(report.row_sum_error_max < 1e-6 && report.reciprocity_error_max < 1e-6);
    links_destroy(links);
    room_clear(&r);
}

/* A_i F_ij between a rectangle and a lamp, both parallel to the axes, by a product rule: the kernel
 * is smooth where they keep their distance. */
static double exchange(const Vec3 a[3], Vec3 na, const Vec3 b[3], Vec3 nb)
{
    enum { N = 12 };
    double sum = 0;
    for (int k = 0; k < N * N * N * N; k++) {
        const double x[4] = { (k % N + 0.5) / N, (k / N % N + 0.5) / N, (k / N / N % N + 0.5) / N,
                              (k / N / N / N + 0.5) / N };
        const Vec3 p = vec3_mad(vec3_mad(a[0], x[0], a[1]), x[1], a[2]);
        const Vec3 q = vec3_mad(vec3_mad(b[0], x[2], b[1]), x[3], b[2]);
        const Vec3 d = vec3_sub(q, p);
        const double square = vec3_dot(d, d);
        sum += fmax(0, vec3_dot(d, na)) * fmax(0, -vec3_dot(d, nb)) / (M_PI * square * square);
    }
    return sum * vec3_length(vec3_cross(a[1], a[2])) * vec3_length(vec3_cross(b[1], b[2])) /
           (N * N * N * N);
}

static void test_small_lamp(void **state)
{
    (void)state;
    /* A lamp of 1/1000 of the ceiling, a little below it; 1 in 16,000 of a floor patch's rays. */
    TestRoom r = { 0 };
    const double edge = sqrt(0.001);
    room_box(&r, ORIGIN, UNIT, BOX_ALL, true, room_material(&r, 0.5, 0), "");
    const Vec3 lamp[3] = { { 0.6, 0.3, 0.97 }, { 0, edge, 0 }, { edge, 0, 0 } };
    room_quad(&r, lamp[0], lamp[1], lamp[2], room_material(&r, 0, 1000), "lamp");
    room_finish(&r, 0.1, &(SidesOptions){ 0 }, NULL, 0, NULL);
    Links *links = room_links(&r, 256, CLOSURE_NONE);
    Links *closed = room_links(&r, 256, CLOSURE_BOTH);
    double worst = 0, worst_closed = 0;
    int patches = 0;
    for (uint32_t i = 0; i < links->count; i++) {
        if (r.patches->group[i] != room_group(&r, "z0"))
            continue;
        const Vec3 c = r.patches->centre[i];
        const Vec3 patch[3] = { { c.x - 0.05, c.y - 0.05, 0 }, { 0.1, 0, 0 }, { 0, 0.1, 0 } };
        const double exact = exchange(patch, vec3(0, 0, 1), lamp, vec3(0, 0, -1)) / 0.01;
        double f[2] = { 0, 0 };
        for (uint64_t k = links->first[i]; k < links->first[i + 1]; k++)
            if (r.emitting[r.patches->surface[links->source[k]]])
                f[0] += links->form_factor[k];
        for (uint64_t k = closed->first[i]; k < closed->first[i + 1]; k++)
            if (r.emitting[r.patches->surface[closed->source[k]]])
                f[1] += closed->form_factor[k];
        worst = fmax(worst, fabs(f[0] / exact - 1));
        worst_closed = fmax(worst_closed, fabs(f[1] / exact - 1));
        patches++;
    }
    assert_int_equal(patches, 100);
    assert_true(worst < 0.01);
    assert_true(worst_closed < 0.01);
    links_destroy(links);
    links_destroy(closed);
    room_clear(&r);
}

/* A lamp that shines up at a ceiling of 9 patches from 0.1 below, under the middle of one and under
 * the corner of four: visibility rays from the patches say anything from 0.1 to 3 there. What it
 * sends each by the contour integral; three standard errors of its own 64 rays. */
static void test_uplight(void **state)
{
    (void)state;
    static const double at[2] = { 2 - 0.05, 4.0 / 3 - 0.05 };
    for (int k = 0; k < 2; k++) {
        TestRoom r = { 0 };
        Error err = { 0 };
        Warnings warnings = { 0 };
        LinksReport report;
        const Monitor monitor = { .user = &warnings, .warn = note };
        room_box(&r, ORIGIN, vec3(4, 4, 3), BOX_ALL, true, room_material(&r, 0.7, 0), "");
        const Vec3 o = { at[k], at[k], 2.9 }, x = { 0.1, 0, 0 }, y = { 0, 0.1, 0 };
        room_quad(&r, o, x, y, room_material(&r, 0.5, 1), "lamp");
        room_finish(&r, 1.5, &(SidesOptions){ 0 }, NULL, 0, NULL);
        Links *raw = room_links(&r, 64, CLOSURE_NONE);
        Links *links = links_close(raw, r.patches, CLOSURE_BOTH, 0, &monitor, &err);
        assert_true(links_report(links, &report, &err));
        assert_int_equal(warnings.count, 0);
        assert_true(report.escaped == 0 && report.row_sum_error_max < 1e-6);
        const FlatPolygon lamp = { { o, vec3_add(o, x), vec3_add(vec3_add(o, x), y),
                                     vec3_add(o, y) }, 4 };
        int patches = 0;
        for (uint32_t i = 0; i < links->count; i++) {
            if (r.patches->group[i] != room_group(&r, "z1"))
                continue;
            const Vec3 c = r.patches->centre[i], h = { 2.0 / 3, 2.0 / 3, 0 };
            const FlatPolygon patch = { { vec3_sub(c, h), { c.x - h.x, c.y + h.y, 3 },
                                          vec3_add(c, h), { c.x + h.x, c.y - h.y, 3 } }, 4 };
            const double exact = polygon_factor_area(&lamp, &patch) / 0.01;
            double f = 0;
            for (uint64_t n = links->first[i]; n < links->first[i + 1]; n++)
                if (r.emitting[r.patches->surface[links->source[n]]])
                    f += links->area[i] * links->form_factor[n] / 0.01;
            assert_true(fabs(f - exact) < 3 * sqrt(exact * (1 - exact) / 64));
            patches++;
        }
        assert_int_equal(patches, 9);
        links_destroy(raw);
        links_destroy(links);
        room_clear(&r);
    }
}

/* --- furnaces --------------------------------------------------------------------------------- */

static void check_furnace(const TestRoom *r, double rho)
{
    Error err = { 0 };
    double *emission, *reflectance;
    room_problem(r, &emission, &reflectance);
    Links *links = room_links(r, 256, CLOSURE_BOTH);
    LinksReport report;
    assert_true(links_report(links, &report, &err));
    assert_true(report.row_sum_error_max < 1e-6 && report.reciprocity_error_max < 1e-6);
    const SolveProblem p = { .bands = ROOM_BANDS, .emission = emission,
                             .reflectance = reflectance };
    Solution *s = solve(links, &p, &(SolveOptions){ .tolerance = 1e-7 }, NULL, &err);
    assert_non_null(s);
    assert_true(s->converged);
    for (uint32_t i = 0; i < links->count; i++)
        if (links->area[i] > 0)
            assert_true(fabs(s->radiosity[3 * (size_t)i] * (1 - rho) - 1) < 1e-4);
    Energy energy;
    solution_energy(s, links, &p, 0, 0, 0, &energy);
    assert_true(energy.error < 1e-6);
    solution_destroy(s);
    links_destroy(links);
    array_free(emission);
    array_free(reflectance);
}

static void test_furnace_cube(void **state)
{
    (void)state;
    static const double rhos[] = { 0.1, 0.5, 0.9 };
    for (int k = 0; k < 3; k++) {
        TestRoom r = { 0 };
        room_box(&r, ORIGIN, UNIT, BOX_ALL, true, room_material(&r, rhos[k], 1), "");
        room_finish(&r, 0.1, &(SidesOptions){ 0 }, NULL, 0, NULL);
        check_furnace(&r, rhos[k]);
        room_clear(&r);
    }
}

static void test_furnace_plate(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    const uint32_t wall = room_material(&r, 0.5, 1);
    room_box(&r, ORIGIN, UNIT, BOX_ALL, true, wall, "");
    const uint32_t plate = room_material(&r, 0.5, 1);
    r.soup.materials[plate].emits_both = true;
    room_quad(&r, vec3(0.25, 0.25, 0.5), vec3(0.5, 0, 0), vec3(0, 0.5, 0), plate, "plate");
    room_finish(&r, 0.1, &(SidesOptions){ 0 }, NULL, 0, NULL);
    assert_int_equal(r.report.both, 1);
    assert_int_equal(r.report.front, 6);
    check_furnace(&r, 0.5);
    room_clear(&r);
}

/* An L with arms of width 1: concave floor and ceiling. */
static void test_furnace_l_room(void **state)
{
    (void)state;
    static const double x[6] = { 0, 2, 2, 1, 1, 0 }, y[6] = { 0, 0, 1, 1, 2, 2 };
    TestRoom r = { 0 };
    Error err = { 0 };
    const uint32_t wall = room_material(&r, 0.6, 1);
    uint32_t down[6], up[6], turned[6], group = 0;
    assert_true(polygons_add_group(&r.soup, "l", &group, &err));
    for (int k = 0; k < 6; k++) {
        assert_true(polygons_add_vertex(&r.soup, vec3(x[k], y[k], 0), &down[k], &err));
        assert_true(polygons_add_vertex(&r.soup, vec3(x[k], y[k], 1), &up[k], &err));
    }
    for (int k = 0; k < 6; k++)
        turned[k] = up[5 - k];
    assert_true(polygons_add_polygon(&r.soup, down, 6, wall, group, &err));
    assert_true(polygons_add_polygon(&r.soup, turned, 6, wall, group, &err));
    for (int k = 0; k < 6; k++) {
        const int n = (k + 1) % 6;
        const uint32_t side[4] = { down[k], up[k], up[n], down[n] };
        assert_true(polygons_add_polygon(&r.soup, side, 4, wall, group, &err));
    }
    room_finish(&r, 0.15, &(SidesOptions){ 0 }, NULL, 0, NULL);
    assert_int_equal(r.report.both + r.report.none, 0);
    check_furnace(&r, 0.6);
    room_clear(&r);
}

/* --- rooms with known light ------------------------------------------------------------------- */

static double mean(const TestRoom *r, const Links *links, const Solution *s, const char *group,
                   unsigned side)
{
    const uint32_t g = room_group(r, group);
    double sum = 0, area = 0;
    for (uint32_t i = 0; i < links->count; i++)
        if (r->patches->group[i] == g && r->patches->side[i] == side) {
            sum += links->area[i] * s->radiosity[3 * (size_t)i];
            area += links->area[i];
        }
    assert_true(area > 0);
    return sum / area;
}

static Solution *solve_room(const TestRoom *r, const Links *links)
{
    Error err = { 0 };
    double *emission, *reflectance;
    room_problem(r, &emission, &reflectance);
    const SolveProblem p = { .bands = ROOM_BANDS, .emission = emission,
                             .reflectance = reflectance };
    Solution *s = solve(links, &p, &(SolveOptions){ .tolerance = 1e-7 }, NULL, &err);
    assert_non_null(s);
    array_free(emission);
    array_free(reflectance);
    return s;
}

/* Unit cube, the ceiling emits 1, reflectance 0.5: means of the continuous radiosity equation, by
 * an integral equation solver, good to 1e-8. */
static void test_cube_light(void **state)
{
    (void)state;
    /* Not RECIPROCITY alone: its rows do not close, and 1 - rho of each error stays in the room. */
    static const Closure closures[] = { CLOSURE_NONE, CLOSURE_ROWS, CLOSURE_BOTH };
    for (int k = 0; k < 3; k++) {
        TestRoom r = { 0 };
        const uint32_t wall = room_material(&r, 0.5, 0);
        room_box(&r, ORIGIN, UNIT, BOX_ALL - BOX_Z1, true, wall, "");
        room_box(&r, ORIGIN, UNIT, BOX_Z1, true, room_material(&r, 0.5, 1), "");
        room_finish(&r, 0.05, &(SidesOptions){ 0 }, NULL, 0, NULL);
        Links *links = room_links(&r, 256, closures[k]);
        Solution *s = solve_room(&r, links);
        /* The constant patches' own error falls as h^2: 1.2e-3 at h = 0.1, so 3e-4 here. A face has
         * 10^5 rays, and what they see varies by about its mean: 3e-3 if they were independent, a
         * third of that on a net and with the lamp sampled. */
        assert_true(fabs(mean(&r, links, s, "z0", 0) / 0.1712160573 - 1) < 1.3e-3);
        assert_true(fabs(mean(&r, links, s, "x1", 0) / 0.1811055969 - 1) < 1.3e-3);
        assert_true(fabs(mean(&r, links, s, "z1", 0) / 1.104361555 - 1) < 1.3e-3);
        solution_destroy(s);
        links_destroy(links);
        room_clear(&r);
    }
}

/* The same cube with a free plate, both sides 0.5: face means to 1e-5, from the same solver. */
static void test_plate_light(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    const uint32_t wall = room_material(&r, 0.5, 0);
    room_box(&r, ORIGIN, UNIT, BOX_ALL - BOX_Z1, true, wall, "");
    room_box(&r, ORIGIN, UNIT, BOX_Z1, true, room_material(&r, 0.5, 1), "");
    room_quad(&r, vec3(0.25, 0.25, 0.5), vec3(0.5, 0, 0), vec3(0, 0.5, 0), wall, "plate");
    room_finish(&r, 0.05, &(SidesOptions){ 0 }, NULL, 0, NULL);
    for (int closure = CLOSURE_NONE; closure <= CLOSURE_BOTH; closure += CLOSURE_BOTH) {
        Links *links = room_links(&r, 256, (Closure)closure);
        Solution *s = solve_room(&r, links);
        static const struct {
            const char *group;
            unsigned side;
            double b;
        } faces[] = { { "z0", 0, 0.10754288 },    { "x0", 0, 0.17005594 },
                      { "z1", 0, 1.1126046 },     { "plate", 0, 0.34737086 },
                      { "plate", 1, 0.051120198 } };
        for (size_t k = 0; k < sizeof faces / sizeof *faces; k++) {
            const double b = mean(&r, links, s, faces[k].group, faces[k].side);
            /* What the rays of a face see varies by about its mean: one standard error of the
             * 25,600 rays of the plate is 6.3e-3, of the walls' 10^5 half of that, if they were
             * independent; on a net and with the lamp sampled, three of them fit in there, and 3e-4
             * for h. */
            assert_true(fabs(b / faces[k].b - 1) < 6.3e-3 + 3e-4);
        }
        solution_destroy(s);
        links_destroy(links);
    }
    room_clear(&r);
}

/* --- inside solids ---------------------------------------------------------------------------- */

static void test_box_on_floor(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    const uint32_t wall = room_material(&r, 0.5, 0);
    room_box(&r, ORIGIN, UNIT, BOX_ALL - BOX_Z1, true, wall, "");
    room_box(&r, ORIGIN, UNIT, BOX_Z1, true, room_material(&r, 0.5, 1), "");
    /* Footprint 0.31 x 0.27, across the patches' edges; once closed, once without bottom. */
    const Vec3 lo = { 0.33, 0.42, 0 }, hi = { 0.64, 0.69, 0.4 };
    const double footprint = 0.31 * 0.27;
    for (int bottom = 0; bottom < 2; bottom++) {
        TestRoom b = { 0 };
        const uint32_t m = room_material(&b, 0.5, 0);
        room_box(&b, ORIGIN, UNIT, BOX_ALL - BOX_Z1, true, m, "");
        room_box(&b, ORIGIN, UNIT, BOX_Z1, true, room_material(&b, 0.5, 1), "");
        room_box(&b, lo, hi, bottom ? BOX_ALL : BOX_ALL - BOX_Z0, false, m, "box-");
        room_finish(&b, 0.1, &(SidesOptions){ 0 }, NULL, 0, NULL);
        Links *links = room_links(&b, 256, CLOSURE_BOTH);
        Solution *s = solve_room(&b, links);
        double area = 0, hidden = 0;
        for (uint32_t i = 0; i < links->count; i++) {
            if (b.patches->group[i] != room_group(&b, "z0"))
                continue;
            const Vec3 c = b.patches->centre[i];
            area += links->area[i];
            if (c.x - 0.05 > lo.x && c.x + 0.05 < hi.x && c.y - 0.05 > lo.y && c.y + 0.05 < hi.y) {
                hidden += b.patches->area[i];
                assert_true(links->area[i] == 0);
                assert_true(s->radiosity[3 * (size_t)i] == 0);
            } else {
                /* No patch that is in view is dark because a part of it is hidden. */
                assert_true(links->area[i] == 0 || s->radiosity[3 * (size_t)i] > 0.02);
            }
        }
        assert_true(hidden > 0.01);
        /* 12 patches lie across the rim; each has 64 points, so its part is known to 1/16. */
        assert_true(fabs(area - (1 - footprint)) < 3 * sqrt(12.0) * 0.01 / 16);
        solution_destroy(s);
        links_destroy(links);
        room_clear(&b);
    }
    room_clear(&r);
}

/* --- closures by hand ------------------------------------------------------------------------- */

static void test_closure_impossible(void **state)
{
    (void)state;
    /* Two patches that see only each other, one twice as large: no symmetric matrix has these
     * rows. */
    uint64_t first[] = { 0, 1, 2 };
    uint32_t source[] = { 1, 0 };
    float factor[] = { 1, 1 }, escape[] = { 0, 0 };
    double area[] = { 1, 2 };
    const Links links = { .count = 2, .first = first, .source = source, .form_factor = factor,
                          .escape = escape, .area = area };
    Warnings warnings = { 0 };
    const Monitor monitor = { .user = &warnings, .warn = note };
    Error err = { 0 };
    Links *closed = links_close(&links, NULL, CLOSURE_BOTH, 1, &monitor, &err);
    assert_non_null(closed);
    assert_true(links_check(closed));
    assert_int_equal(warnings.count, 1);
    assert_string_equal(warnings.code, "closure-opened");
    /* What can be: all of patch 1 goes to 2, half of 2 to 1, and the other half escapes. */
    assert_true(fabs(closed->form_factor[0] - 1) < 2e-2);
    LinksReport report;
    assert_true(links_report(closed, &report, &err));
    assert_true(report.row_sum_error_max < 1e-6 && report.reciprocity_error_max < 1e-6);
    links_destroy(closed);
}

static void test_closure_alone(void **state)
{
    (void)state;
    /* Patch 2 sees patch 3 alone, which is hidden; patches 0 and 1 are whole. */
    uint64_t first[] = { 0, 1, 2, 3, 3 };
    uint32_t source[] = { 1, 0, 3 };
    float factor[] = { 0.9F, 0.7F, 1 }, escape[] = { 0, 0.25F, 0, 0 };
    double area[] = { 1, 4.0 / 3, 1, 0 };
    const Links links = { .count = 4, .first = first, .source = source, .form_factor = factor,
                          .escape = escape, .area = area };
    Warnings warnings = { 0 };
    const Monitor monitor = { .user = &warnings, .warn = note };
    Error err = { 0 };
    Links *closed = links_close(&links, NULL, CLOSURE_BOTH, 1, &monitor, &err);
    assert_non_null(closed);
    assert_true(links_check(closed));
    assert_string_equal(warnings.code, "closure-alone");
    assert_true(closed->escape[2] == 1);
    /* F01 = 1, F10 = 3/4: the only factors whose rows close and that are reciprocal. */
    assert_true(fabs(closed->form_factor[0] - 1) < 1e-7);
    assert_true(fabs(closed->form_factor[1] - 0.75) < 1e-7);
    links_destroy(closed);

    closed = links_close(&links, NULL, CLOSURE_RECIPROCITY, 1, &monitor, &err);
    /* (0.9 * 4/3 / (7/3), by 1/A), the same power both ways */
    const double s = (0.9F + 0.7F) * (4.0 / 3) / (7.0 / 3);
    assert_true(fabs(closed->form_factor[0] - s) < 1e-7);
    assert_true(fabs(closed->form_factor[1] * 4 / 3 - s) < 1e-7);
    links_destroy(closed);

    closed = links_close(&links, NULL, CLOSURE_ROWS, 1, &monitor, &err);
    assert_true(closed->form_factor[0] == 1 && fabs(closed->form_factor[1] - 0.7 / 0.95) < 1e-7);
    assert_true(fabs(closed->escape[1] - 0.25 / 0.95) < 1e-7);
    links_destroy(closed);
}

static void test_two_walls(void **state)
{
    (void)state;
    /* Two walls that see each other and the sky: both sides' sums are counted by chance, and yet
     * one matrix must serve both. F between perpendicular unit squares with a common edge:
     * 0.200043776. */
    TestRoom r = { 0 };
    const uint32_t m = room_material(&r, 0.5, 1);
    room_quad(&r, ORIGIN, vec3(1, 0, 0), vec3(0, 1, 0), m, "floor");
    room_quad(&r, ORIGIN, vec3(0, 0, 1), vec3(1, 0, 0), m, "wall");
    room_finish(&r, 0.1, &(SidesOptions){ 0 }, NULL, 0, NULL);
    assert_int_equal(r.report.front, 2);
    Warnings warnings = { 0 };
    const Monitor monitor = { .user = &warnings, .warn = note };
    Error err = { 0 };
    Links *raw = room_links(&r, 256, CLOSURE_NONE);
    Links *links = links_close(raw, r.patches, CLOSURE_BOTH, 0, &monitor, &err);
    LinksReport report;
    assert_true(links_report(links, &report, &err));
    assert_int_equal(warnings.count, 0);
    assert_true(report.row_sum_error_max < 1e-6 && report.reciprocity_error_max < 1e-6);
    assert_true(fabs(report.escaped - (1 - 0.200043776)) < 3 * sqrt(0.2 * 0.8 / (200 * 256)));
    links_destroy(raw);
    links_destroy(links);
    room_clear(&r);
}

/* --- the program's promises ------------------------------------------------------------------- */

static void make_lit_room(TestRoom *r, double size)
{
    const uint32_t wall = room_material(r, 0.7, 0);
    room_box(r, ORIGIN, UNIT, BOX_ALL, true, wall, "");
    room_box(r, vec3(0.2, 0.2, 0), vec3(0.5, 0.45, 0.5), BOX_ALL, false, wall, "box-");
    room_quad(r, vec3(0.4, 0.4, 0.99), vec3(0, 0.2, 0), vec3(0.2, 0, 0), room_material(r, 0, 9),
              "lamp");
    room_finish(r, size, &(SidesOptions){ 0 }, NULL, 0, NULL);
}

static void test_threads(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    make_lit_room(&r, 0.1);
    Links *made[2];
    Error err = { 0 };
    for (unsigned k = 0; k < 2; k++) {
        const LinksOptions o = { .rays = 100, .threads = 1 + 2 * k, .seed = 5 };
        Links *raw = links_create(&r.room, &o, NULL, &err);
        assert_non_null(raw);
        made[k] = links_close(raw, r.patches, CLOSURE_BOTH, 1 + 2 * k, NULL, &err);
        assert_non_null(made[k]);
        links_destroy(raw);
    }
    const uint64_t n = made[0]->first[made[0]->count];
    assert_int_equal(n, made[1]->first[made[1]->count]);
    assert_memory_equal(made[0]->source, made[1]->source, n * sizeof(uint32_t));
    assert_memory_equal(made[0]->form_factor, made[1]->form_factor, n * sizeof(float));
    assert_memory_equal(made[0]->escape, made[1]->escape, made[0]->count * sizeof(float));
    assert_memory_equal(made[0]->area, made[1]->area, made[0]->count * sizeof(double));
    links_destroy(made[0]);
    links_destroy(made[1]);
    room_clear(&r);
}

static bool stop_at_once(void *user)
{
    (void)user;
    return true;
}

static void test_limits(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    make_lit_room(&r, 0.05);
    Error err = { 0 };
    assert_null(links_create(&r.room, &(LinksOptions){ .max_bytes = 1 << 20 }, NULL, &err));
    assert_int_equal(err.code, ERROR_MEMORY);
    assert_non_null(strstr(err.text, "1 MiB are allowed"));

    err = (Error){ 0 };
    Links *links = links_create(&r.room, &(LinksOptions){ .max_bytes = 1 << 26 }, NULL, &err);
    assert_non_null(links);
    links_destroy(links);

    const Monitor monitor = { .stop = stop_at_once };
    assert_null(links_create(&r.room, &(LinksOptions){ 0 }, &monitor, &err));
    assert_int_equal(err.code, ERROR_STOPPED);
    room_clear(&r);
}

static void test_memory(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    make_lit_room(&r, 0.25);
    const long before = array_live();
    bool made = false;
    for (long n = 0; n < 1000 && !made; n++) {
        Error err = { 0 };
        array_fail_after(n);
        Links *raw = links_create(&r.room, &(LinksOptions){ .rays = 16, .threads = 1 }, NULL, &err);
        Links *links = links_close(raw, r.patches, CLOSURE_BOTH, 1, NULL, &err);
        array_fail_after(-1);
        made = links != NULL;
        assert_int_equal(err.code, made ? ERROR_NONE : ERROR_MEMORY);
        links_destroy(raw);
        links_destroy(links);
        assert_int_equal(array_live(), before);
    }
    assert_true(made);
    room_clear(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cube_factors),   cmocka_unit_test(test_open_box),
        cmocka_unit_test(test_small_lamp),     cmocka_unit_test(test_furnace_cube),
        cmocka_unit_test(test_furnace_plate),  cmocka_unit_test(test_furnace_l_room),
        cmocka_unit_test(test_cube_light),     cmocka_unit_test(test_plate_light),
        cmocka_unit_test(test_box_on_floor),   cmocka_unit_test(test_closure_impossible),
        cmocka_unit_test(test_closure_alone),  cmocka_unit_test(test_two_walls),
        cmocka_unit_test(test_threads),        cmocka_unit_test(test_limits),
        cmocka_unit_test(test_memory),        cmocka_unit_test(test_uplight),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
