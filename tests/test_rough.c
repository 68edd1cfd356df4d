/* SPDX-License-Identifier: BSD-3-Clause */
/* Pictures that are stopped early: whole, if rough; in a furnace every pixel's answer is known. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "render/gather.h"
#include "render/path.h"
#include "render/rough.h"
#include "render/whitted.h"
#include "room_maker.h"

/* Odd sizes: blocks and tiles are cut at the edges. */
enum { WIDTH = 75, HEIGHT = 41 };

static const Camera camera = { .eye = { 0.3, 0.4, 0.5 }, .target = { 1, 0.6, 0.5 },
                               .up = { 0, 0, 1 }, .vertical_fov = 70 };

static bool at_once(void *user)
{
    (void)user;
    return true;
}

/* Stops at the so many-th question. */
static bool soon(void *user)
{
    int *left = user;
    return --*left < 0;
}

/* A closed unit cube with E = 1, rho = 1/2 on all sides: B = 2, radiance 2 / pi everywhere, half of
 * it emitted. */
static void furnace(TestRoom *r)
{
    *r = (TestRoom){ 0 };
    room_box(r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL, true, room_material(r, 0.5, 1), "");
    room_connect(r);
    memset(r->sides, 1, r->surfaces->count);
    memset(r->emitting, 1, r->surfaces->count);
    r->room = (Room){ .surfaces = r->surfaces, .bvh = r->bvh, .materials = r->soup.materials,
                      .material_count = r->soup.material_count, .sides = r->sides,
                      .emitting = r->emitting,
                      .offset = ray_offset(r->surfaces->largest_coordinate) };
    room_divide(r, 0.5);
}

/* Mean radiance; no pixel is below `least`, all show a surface. */
static double check_whole(const Image *image, double least)
{
    double sum = 0;
    for (int i = 0; i < image->width * image->height; i++) {
        assert_true(image->radiance[3 * i + 1] >= least * (1 - 1e-6));
        assert_true(isfinite(image->depth[i]));
        sum += image->radiance[3 * i + 1];
    }
    return sum / (image->width * image->height);
}

static void paths_are_whole(void **state)
{
    (void)state;
    TestRoom r;
    furnace(&r);
    for (int most = 0; most < 40; most += 13) {
        int   left = most;
        Error err = { 0 };
        const Monitor monitor = { .user = &left, .stop = soon };
        const PathOptions o = { .width = WIDTH, .height = HEIGHT, .samples = 64, .threads = 1 };
        PathReport report;
        Image *image = render_path(&r.room, &camera, &o, &report, &monitor, &err);
        assert_non_null(image);
        assert_int_equal(err.code, ERROR_STOPPED);
        assert_true(report.rough > 0 && report.rough <= 1);
        const double mean = check_whole(image, 1 / M_PI);
        /* Of a path the reflected half is 1/2 + 1/4 + ... of chances: its deviation is below 1 of
         * 1 / pi, and there are thousands. */
        assert_true(fabs(mean * M_PI - 2) < 4 / sqrt(WIDTH * HEIGHT));
        image_destroy(image);
    }
    room_clear(&r);
    assert_int_equal(array_live(), 0);
}

static void plain_rays_are_whole(void **state)
{
    (void)state;
    TestRoom r;
    Error    err = { 0 };
    furnace(&r);
    const Monitor monitor = { .stop = at_once };
    const WhittedOptions o = { .width = WIDTH, .height = HEIGHT, .samples = 64, .threads = 1 };
    WhittedReport report;
    Image *image = render_whitted(&r.room, &camera, &o, &report, &monitor, &err);
    assert_non_null(image);
    assert_int_equal(err.code, ERROR_STOPPED);
    assert_true(report.rough == 1);
    check_whole(image, 1 / M_PI);
    image_destroy(image);
    room_clear(&r);
    assert_int_equal(array_live(), 0);
}

/* The gather's answer is right in every pixel, however few the samples; without `whole` what was
 * not reached stays black, and a picture that is not stopped is the same either way. */
static void gathered_pictures_are_whole(void **state)
{
    (void)state;
    TestRoom r;
    Error    err = { 0 };
    furnace(&r);
    Links *links = room_links(&r, 64, CLOSURE_ROWS);
    double *emission, *reflectance;
    room_problem(&r, &emission, &reflectance);
    Solution *solution = solve(links, &(SolveProblem){ ROOM_BANDS, emission, reflectance, NULL },
                               &(SolveOptions){ .tolerance = 1e-9 }, NULL, &err);
    Gatherer *g = gatherer_create(&r.room, solution, links, &err);
    const Monitor monitor = { .stop = at_once };
    RenderOptions o = { .width = WIDTH, .height = HEIGHT, .samples = 4, .threads = 1 };
    RenderReport report;
    for (int k = 0; k < 2; k++) {
        o.error = k == 0 ? 0 : 0.1;
        o.whole = true;
        Image *image = render_gather(g, &camera, &o, &report, &monitor, &err);
        assert_non_null(image);
        assert_int_equal(err.code, ERROR_STOPPED);
        err = (Error){ 0 };
        assert_true(report.rough > 0.9);
        assert_true(fabs(check_whole(image, 1 / M_PI) * M_PI - 2) < 0.02);
        image_destroy(image);
        o.whole = false;
        image = render_gather(g, &camera, &o, &report, &monitor, &err);
        assert_true(image->radiance[3 * WIDTH * HEIGHT - 1] == 0);
        image_destroy(image);
        err = (Error){ 0 };
        Image *plain = render_gather(g, &camera, &o, &report, NULL, &err);
        o.whole = true;
        image = render_gather(g, &camera, &o, &report, NULL, &err);
        assert_true(report.rough == 0);
        assert_memory_equal(plain->radiance, image->radiance,
                            3 * WIDTH * HEIGHT * sizeof *image->radiance);
        image_destroy(plain);
        image_destroy(image);
    }
    gatherer_destroy(g);
    solution_destroy(solution);
    array_free(emission);
    array_free(reflectance);
    links_destroy(links);
    room_clear(&r);
    assert_int_equal(array_live(), 0);
}

static void blocks_are_as_large_as_they_must(void **state)
{
    (void)state;
    assert_int_equal(rough_step(0, 10, 8), 1);
    assert_int_equal(rough_step(10, 10, 8), 1);
    assert_int_equal(rough_step(11, 10, 8), 2);
    assert_int_equal(rough_step(40, 10, 8), 2);
    assert_int_equal(rough_step(1000000, 10, 8), 8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(paths_are_whole), cmocka_unit_test(plain_rays_are_whole),
        cmocka_unit_test(gathered_pictures_are_whole),
        cmocka_unit_test(blocks_are_as_large_as_they_must),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
