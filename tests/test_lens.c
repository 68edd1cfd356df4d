/* SPDX-License-Identifier: BSD-3-Clause */
/* What a lens blurs, by all renderers: the rim of a bright half-plane that is out of focus. */
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
#include "render/whitted.h"
#include "room_maker.h"

enum { WIDTH = 21, SAMPLES = 256 };
static const double RADIUS = 0.1, FOCUS = 2, FAR = 4;

/* Looks along -z; the picture's height shows 0.4 at the focus. */
static Camera lens(void)
{
    return (Camera){ .eye = { 0, 0, 0 }, .target = { 0, 0, -1 }, .up = { 0, 1, 0 },
                     .vertical_fov = 2 * atan(0.2 / FOCUS) * 180 / M_PI, .aperture = RADIUS,
                     .focus = FOCUS };
}

/* Light of radiance 1 from x < 0 in the plane z = -FAR. */
static void half_plane(TestRoom *r)
{
    *r = (TestRoom){ 0 };
    room_quad(r, vec3(-9, -9, -FAR), vec3(9, 0, 0), vec3(0, 18, 0), room_material(r, 0, M_PI),
              "lamp");
    room_connect(r);
    memset(r->sides, 1, r->surfaces->count);
    memset(r->emitting, 1, r->surfaces->count);
    r->room = (Room){ .surfaces = r->surfaces, .bvh = r->bvh, .materials = r->soup.materials,
                      .material_count = r->soup.material_count, .sides = r->sides,
                      .emitting = r->emitting,
                      .offset = ray_offset(r->surfaces->largest_coordinate) };
    room_divide(r, 9);
}

/* Share of the lens that sees the light when the pixel's rays meet at x in the plane of focus: a
 * ray from a on the lens goes on to a + (x - a) FAR / FOCUS. */
static double seen_at(double x)
{
    const double u = fmin(fmax(x * (FAR / FOCUS) / (FAR / FOCUS - 1) / RADIUS, -1), 1);
    return (acos(u) - u * sqrt(1 - u * u)) / M_PI;
}

static Image *take(const TestRoom *r, int renderer)
{
    Error  err = { 0 };
    const Camera camera = lens();
    Image *image;
    if (renderer == 0) {
        const WhittedOptions o = { .width = WIDTH, .height = WIDTH, .samples = SAMPLES,
                                   .threads = 1 };
        image = render_whitted(&r->room, &camera, &o, NULL, NULL, &err);
    } else if (renderer == 1) {
        const PathOptions o = { .width = WIDTH, .height = WIDTH, .samples = SAMPLES,
                                .threads = 1 };
        image = render_path(&r->room, &camera, &o, NULL, NULL, &err);
    } else {
        const RenderOptions o = { .width = WIDTH, .height = WIDTH, .samples = SAMPLES,
                                  .gather_rays = 1, .threads = 1 };
        Links *links = room_links(r, 16, CLOSURE_NONE);
        double *emission, *reflectance;
        room_problem(r, &emission, &reflectance);
        const Solution solution = { .count = r->patches->count, .bands = ROOM_BANDS,
                                    .radiosity = emission, .irradiance = reflectance };
        Gatherer *g = gatherer_create(&r->room, &solution, links, &err);
        image = render_gather(g, &camera, &o, NULL, NULL, &err);
        gatherer_destroy(g);
        links_destroy(links);
        array_free(emission);
        array_free(reflectance);
    }
    assert_non_null(image);
    return image;
}

static void a_rim_out_of_focus(void **state)
{
    (void)state;
    TestRoom r;
    half_plane(&r);
    for (int renderer = 0; renderer < 3; renderer++) {
        Image *image = take(&r, renderer);
        double error = 0;
        for (int i = 0; i < WIDTH * WIDTH; i++) {
            const double x = (i % WIDTH + 0.5 - WIDTH / 2.0) * 0.4 / WIDTH;
            const double off = image->radiance[3 * i + 1] - seen_at(x);
            /* A pixel of 256 points, of which an edge through net and disc misplaces some 16. */
            assert_true(fabs(off) < 16.0 / SAMPLES);
            error += off / (WIDTH * WIDTH);
        }
        assert_true(fabs(error) < 1e-3);
        image_destroy(image);
    }
    room_clear(&r);
    assert_int_equal(array_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(a_rim_out_of_focus) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
