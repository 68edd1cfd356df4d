/* SPDX-License-Identifier: BSD-3-Clause */
/* Parts of pictures: the same pixels as in the whole, by all renderers, so that a picture can be
 * made in pieces. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <string.h>

#include "render/gather.h"
#include "render/path.h"
#include "render/whitted.h"
#include "room_maker.h"

enum { WIDTH = 70, HEIGHT = 50, EDGE = 16 };

static const Camera camera = { .eye = { 0.3, 0.4, 1.2 }, .target = { 2, 1.6, 0.8 },
                               .up = { 0, 0, 1 }, .vertical_fov = 70, .aperture = 0.01 };

typedef struct {
    TestRoom  room;
    Links    *links;
    Solution *solution;
    Gatherer *gatherer;
} Hall;

/* A room with a block in it and a lamp: each pixel has noise of its own. */
static void hall_make(Hall *h)
{
    TestRoom *r = &h->room;
    Error err = { 0 };
    *h = (Hall){ 0 };
    const uint32_t wall = room_material(r, 0.6, 0);
    room_box(r, vec3(0, 0, 0), vec3(3, 3, 2.5), BOX_ALL, true, wall, "wall");
    room_box(r, vec3(1.4, 1, 0), vec3(1.7, 2, 1), BOX_ALL & ~BOX_Z0, false, wall, "block");
    room_quad(r, vec3(0.4, 1.8, 2.4), vec3(0, 0.5, 0), vec3(0.5, 0, 0),
              room_material(r, 0.3, 30), "lamp");
    room_connect(r);
    memset(r->sides, 1, r->surfaces->count);
    r->emitting[room_surface(r, "lamp")] = 1;
    r->room = (Room){ .surfaces = r->surfaces, .bvh = r->bvh, .materials = r->soup.materials,
                      .material_count = r->soup.material_count, .sides = r->sides,
                      .emitting = r->emitting,
                      .offset = ray_offset(r->surfaces->largest_coordinate) };
    room_divide(r, 0.6);
    h->links = room_links(r, 64, CLOSURE_ROWS);
    double *emission, *reflectance;
    room_problem(r, &emission, &reflectance);
    h->solution = solve(h->links, &(SolveProblem){ ROOM_BANDS, emission, reflectance, NULL },
                        &(SolveOptions){ .tolerance = 1e-6, .threads = 1 }, NULL, &err);
    h->gatherer = gatherer_create(&r->room, h->solution, h->links, &err);
    assert_non_null(h->gatherer);
    array_free(emission);
    array_free(reflectance);
}

static void hall_clear(Hall *h)
{
    gatherer_destroy(h->gatherer);
    solution_destroy(h->solution);
    links_destroy(h->links);
    room_clear(&h->room);
    assert_int_equal(array_live(), 0);
}

enum { GATHER, PATHS, PLAIN, RENDERERS };

/* The part of the picture; all 0: the whole. */
static Image *take(const Hall *h, int renderer, const int part[4])
{
    Error err = { 0 };
    RenderOptions  ro = { .width = WIDTH, .height = HEIGHT, .samples = 4, .gather_rays = 64,
                          .threads = 1 }; /* enough for guides */
    PathOptions    po = { .width = WIDTH, .height = HEIGHT, .samples = 2, .threads = 1 };
    WhittedOptions wo = { .width = WIDTH, .height = HEIGHT, .samples = 3, .threads = 1 };
    memcpy(ro.crop, part, sizeof ro.crop);
    memcpy(po.crop, part, sizeof po.crop);
    memcpy(wo.crop, part, sizeof wo.crop);
    Image *image = renderer == GATHER
                       ? render_gather(h->gatherer, &camera, &ro, NULL, NULL, &err)
                   : renderer == PATHS ? render_path(&h->room.room, &camera, &po, NULL, NULL, &err)
                                       : render_whitted(&h->room.room, &camera, &wo, NULL, NULL,
                                                        &err);
    assert_non_null(image);
    return image;
}

/* Parts whose corners are those of tiles, some cut by the picture's edges, cover the whole. */
static void parts_are_pieces_of_the_whole(void **state)
{
    (void)state;
    Hall h;
    hall_make(&h);
    for (int renderer = 0; renderer < RENDERERS; renderer++) {
        Image *whole = take(&h, renderer, (int[4]){ 0, 0, 0, 0 });
        for (int left = 0; left < WIDTH; left += 2 * EDGE)
            for (int top = 0; top < HEIGHT; top += 2 * EDGE) {
                const int right = left + 2 * EDGE < WIDTH ? left + 2 * EDGE : WIDTH;
                const int bottom = top + 2 * EDGE < HEIGHT ? top + 2 * EDGE : HEIGHT;
                Image *part = take(&h, renderer, (int[4]){ left, top, right, bottom });
                assert_int_equal(part->width, right - left);
                for (int y = top; y < bottom; y++) {
                    const size_t from = (size_t)(y - top) * (size_t)part->width;
                    const size_t at = (size_t)y * WIDTH + (size_t)left;
                    const size_t n = (size_t)part->width;
                    assert_memory_equal(part->radiance + 3 * from, whole->radiance + 3 * at,
                                        3 * n * sizeof(float));
                    assert_memory_equal(part->depth + from, whole->depth + at, n * sizeof(float));
                }
                image_destroy(part);
            }
        image_destroy(whole);
    }
    hall_clear(&h);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(parts_are_pieces_of_the_whole) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
