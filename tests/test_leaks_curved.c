/* SPDX-License-Identifier: BSD-3-Clause */
/* No light where none can come, with curved walls: out of tubes and balls, past what stands through
 * a floor or a wall. Exactly none, with patches of any size. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "inspect/imprint.h"
#include "tests/room_maker.h"

static const double SIZES[] = { 4, 0.6 };

static void add_shape(TestRoom *r, ShapeKind kind, double ratio, const Affine *map,
                      uint32_t material)
{
    Error err = { 0 };
    Shape shape;
    uint32_t group = 0;
    assert_true(polygons_add_group(&r->soup, "curved", &group, &err));
    assert_true(shape_init(&shape, kind, ratio, map, &err));
    assert_true(polygons_add_shape(&r->soup, &shape, material, group, &err));
}

static Affine scaled(double x, double y, double z, Vec3 centre)
{
    return (Affine){ { x, 0, 0 }, { 0, y, 0 }, { 0, 0, z }, centre };
}

/* The whole way of the program. */
static void make_room(TestRoom *r, double size, Vec3 eye)
{
    Error err = { 0 };
    Imprint imprint;
    assert_true(imprint_create(&r->soup, NULL, &imprint, NULL, &err));
    r->surfaces = surfaces_create(&imprint.soup, NULL, &err);
    assert_non_null(r->surfaces);
    imprint_finish(&imprint, r->surfaces);
    assert_true(imprint_curved(r->surfaces, NULL, &err));
    imprint_clear(&imprint);
    room_trace(r);
    room_finish(r, size, &(SidesOptions){ .eye = &eye, .eye_count = 1 }, NULL, 0, NULL);
    assert_true(patches_check(r->patches, r->surfaces));
}

static Links *refine(TestRoom *r, Links *links)
{
    Error err = { 0 };
    const LinksOptions options = { .rays = 64 };
    uint8_t *split = array_create(r->patches->count, 1, "patches", &err);
    uint32_t *parent;
    assert_non_null(split);
    for (uint32_t i = 0; i < r->patches->count; i++)
        split[i] = r->patches->part_of != NULL && r->patches->part_of[i] != PATCH_NONE;
    Patches *finer = patches_split(r->patches, r->surfaces, split, &parent, &err);
    assert_non_null(finer);
    patches_destroy(r->patches);
    r->room.patches = r->patches = finer;
    assert_true(patches_check(finer, r->surfaces));
    Links *result = links_refine(links, &r->room, parent, &options, NULL, &err);
    assert_non_null(result);
    links_destroy(links);
    array_free(parent);
    array_free(split);
    return result;
}

typedef bool (*IsDark)(Vec3 p);

/* How much light gets to patches and their vertices where `dark` holds just off them. */
static void check_dark(TestRoom *r, const Links *links, IsDark is_dark)
{
    Error err = { 0 };
    const Patches *p = r->patches;
    double *emission, *reflectance, lit = 0;
    uint32_t dark = 0;
    room_problem(r, &emission, &reflectance);
    const SolveProblem problem = { ROOM_BANDS, emission, reflectance, NULL };
    Solution *s = solve(links, &problem, &(SolveOptions){ .tolerance = 1e-5 }, NULL, &err);
    double *vertex = array_create((size_t)p->vertex_count * ROOM_BANDS, sizeof *vertex, "vertices",
                                  &err);
    assert_non_null(s);
    assert_true(vertex_radiosity(p, links->area, ROOM_BANDS, s->radiosity, vertex, &err));
    for (uint32_t i = 0; i < p->count; i++) {
        const double light = s->irradiance[ROOM_BANDS * (size_t)i];
        if (!is_dark(vec3_mad(p->centre[i], 1e-4, p->normal[i]))) {
            lit = fmax(lit, light);
            continue;
        }
        dark++;
        assert_true(light == 0);
        const uint32_t face = p->face_of[i];
        for (uint32_t k = p->first_corner[face]; k < p->first_corner[face + 1]; k++)
            assert_true(vertex[ROOM_BANDS * (size_t)p->corner[k]] == 0);
    }
    assert_true(dark > 0 && lit > 0);
    array_free(vertex);
    array_free(emission);
    array_free(reflectance);
    solution_destroy(s);
}

typedef void (*Build)(TestRoom *r, uint32_t wall, uint32_t lamp);

static void check_scene(Build build, Vec3 eye, IsDark is_dark)
{
    for (size_t k = 0; k < sizeof SIZES / sizeof *SIZES; k++) {
        TestRoom r = { 0 };
        const uint32_t wall = room_material(&r, 0.7, 0), lamp = room_material(&r, 0, 500);
        build(&r, wall, lamp);
        make_room(&r, SIZES[k], eye);
        Links *links = room_links(&r, 64, CLOSURE_BOTH);
        check_dark(&r, links, is_dark);
        links = refine(&r, links);
        check_dark(&r, links, is_dark);
        links_destroy(links);
        room_clear(&r);
    }
}

static void add_lamp(TestRoom *r, Vec3 at, uint32_t lamp)
{
    room_quad(r, vec3_sub(at, vec3(0.1, 0.1, 0)), vec3(0, 0.2, 0), vec3(0.2, 0, 0), lamp, "lamp");
}

/* --- a lamp in a tube with a lid, on a floor -------------------------------------------------- */

static void build_coat(TestRoom *r, uint32_t wall, uint32_t lamp)
{
    const Affine coat = scaled(0.43, 0.43, 0.9, vec3(2.03, 1.57, 0));
    const Affine lid = scaled(0.43, 0.43, 1, vec3(2.03, 1.57, 0.9));
    room_box(r, vec3(0, 0, 0), vec3(4, 3, 2.5), BOX_ALL, true, wall, "");
    add_shape(r, SHAPE_FRUSTUM, 1, &coat, wall);
    add_shape(r, SHAPE_DISC, 0, &lid, wall);
    add_lamp(r, vec3(2.03, 1.57, 0.7), lamp);
}

static bool out_of_coat(Vec3 p) { return hypot(p.x - 2.03, p.y - 1.57) > 0.43 || p.z > 0.9; }

static void test_coat(void **state)
{
    (void)state;
    check_scene(build_coat, vec3(0.3, 0.3, 1.5), out_of_coat);
}

/* --- a ball half sunk in the wall of a dark room ---------------------------------------------- */

static void build_ball(TestRoom *r, uint32_t wall, uint32_t lamp)
{
    const Affine ball = scaled(0.5, 0.3, 0.6, vec3(2.07, 1.4, 1.2));
    room_box(r, vec3(0, 0, 0), vec3(4, 3, 2.5), BOX_ALL, true, wall, "");
    room_quad(r, vec3(2, 0, 0), vec3(0, 3, 0), vec3(0, 0, 2.5), wall, "wall");
    add_shape(r, SHAPE_SPHERE, 0, &ball, wall);
    add_lamp(r, vec3(1, 1.5, 2.2), lamp);
}

static bool right_of_wall(Vec3 p) { return p.x > 2; }

static void test_ball(void **state)
{
    (void)state;
    check_scene(build_ball, vec3(3.5, 0.3, 1.5), right_of_wall);
}

/* --- a cone that stands through a floor, askew ------------------------------------------------ */

static void build_cone(TestRoom *r, uint32_t wall, uint32_t lamp)
{
    const Affine cone = { { 0.6, 0, 0.1 }, { 0, 0.6, 0 }, { 0.2, 0.1, 1.9 }, { 2.1, 1.4, -0.8 } };
    room_box(r, vec3(0, 0, -2), vec3(4, 3, 2), BOX_ALL, true, wall, "");
    room_quad(r, vec3(0, 0, 0), vec3(4, 0, 0), vec3(0, 3, 0), wall, "floor");
    add_shape(r, SHAPE_FRUSTUM, 0, &cone, wall);
    add_lamp(r, vec3(1, 1, 1.8), lamp);
}

/* The cone is open below, and so is dark inside as well, as far as it reaches. */
static bool below_floor(Vec3 p) { return p.z < 0; }

static void test_cone(void **state)
{
    (void)state;
    check_scene(build_cone, vec3(0.3, 0.3, -1), below_floor);
}

/* --- a tube through the side of another, lit one ---------------------------------------------- */

static void build_tubes(TestRoom *r, uint32_t wall, uint32_t lamp)
{
    const Affine along = { { 0, 0.5, 0 }, { 0, 0, 0.5 }, { 2.4, 0, 0 }, { 0.6, 1.5, 1.2 } };
    const Affine ends[2] = { { { 0, 0, 0.5 }, { 0, 0.5, 0 }, { 1, 0, 0 }, { 0.6, 1.5, 1.2 } },
                             { { 0, 0.5, 0 }, { 0, 0, 0.5 }, { 1, 0, 0 }, { 3, 1.5, 1.2 } } };
    const Affine across = scaled(0.3, 0.3, 1.9, vec3(2.1, 1.5, 0.3));
    room_box(r, vec3(0, 0, 0), vec3(4, 3, 2.5), BOX_ALL, true, wall, "");
    add_shape(r, SHAPE_FRUSTUM, 1, &along, wall);
    add_shape(r, SHAPE_DISC, 0, &ends[0], wall);
    add_shape(r, SHAPE_DISC, 0, &ends[1], wall);
    add_shape(r, SHAPE_FRUSTUM, 1, &across, wall);
    add_lamp(r, vec3(1, 1.5, 1.3), lamp);
}

static bool out_of_tube(Vec3 p)
{
    return hypot(p.y - 1.5, p.z - 1.2) > 0.5 || p.x < 0.6 || p.x > 3
        || hypot(p.x - 2.1, p.y - 1.5) < 0.3;
}

static void test_tubes(void **state)
{
    (void)state;
    check_scene(build_tubes, vec3(0.3, 0.3, 0.3), out_of_tube);
}

/* --- a ring on a floor, shut by a disc, with a lamp in it ------------------------------------- */

static void build_ring(TestRoom *r, uint32_t wall, uint32_t lamp)
{
    const Affine ring = scaled(0.6, 0.6, 0.6, vec3(2.1, 1.4, 0.05));
    const Affine lid = scaled(0.6, 0.6, 1, vec3(2.1, 1.4, 0.15));
    room_box(r, vec3(0, 0, 0), vec3(4, 3, 2), BOX_ALL, true, wall, "");
    add_shape(r, SHAPE_TORUS, 1.0 / 3, &ring, wall);
    add_shape(r, SHAPE_DISC, 0, &lid, wall);
    add_lamp(r, vec3(2.1, 1.4, 0.1), lamp);
}

static bool out_of_ring(Vec3 p) { return hypot(p.x - 2.1, p.y - 1.4) > 0.6 || p.z > 0.15; }

static void test_ring(void **state)
{
    (void)state;
    check_scene(build_ring, vec3(0.3, 0.3, 1.5), out_of_ring);
}

/* --- a log that just lies on the floor, a wall on it, between a bright and a dark room ------- */

static void build_log(TestRoom *r, uint32_t wall, uint32_t lamp)
{
    const Affine log = { { 0, 0, 0.4 }, { 0.4, 0, 0 }, { 0, 3, 0 }, { 2.13, 0, 0.4 } };
    room_box(r, vec3(0, 0, 0), vec3(4, 3, 2.5), BOX_ALL, true, wall, "");
    add_shape(r, SHAPE_FRUSTUM, 1, &log, wall);
    room_quad(r, vec3(2.13, 0, 0.5), vec3(0, 3, 0), vec3(0, 0, 2), wall, "wall");
    add_lamp(r, vec3(1, 1.45, 1.25), lamp);
}

static bool beyond_log(Vec3 p)
{
    return p.x > 2.13 && p.y > 0 && p.y < 3 && hypot(p.x - 2.13, p.z - 0.4) > 0.4;
}

static void test_log(void **state)
{
    (void)state;
    check_scene(build_log, vec3(3.8, 0.2, 2.3), beyond_log);
}

/* --- a ring that just lies on the floor, a disc on it, with a lamp in it --------------------- */

static void build_lying_ring(TestRoom *r, uint32_t wall, uint32_t lamp)
{
    const Affine ring = scaled(0.7, 0.7, 0.7, vec3(2.05, 1.45, 0.3));
    const Affine lid = scaled(0.7, 0.7, 1, vec3(2.05, 1.45, 0.6));
    room_box(r, vec3(0, 0, 0), vec3(4, 3, 2.5), BOX_ALL, true, wall, "");
    add_shape(r, SHAPE_TORUS, 3.0 / 7, &ring, wall);
    add_shape(r, SHAPE_DISC, 0, &lid, wall);
    add_lamp(r, vec3(2.05, 1.45, 0.25), lamp);
}

static bool out_of_lying_ring(Vec3 p)
{
    const double off = hypot(p.x - 2.05, p.y - 1.45);
    return (off > 0.7 || p.z > 0.6) && hypot(off - 0.7, p.z - 0.3) > 0.3;
}

static void test_lying_ring(void **state)
{
    (void)state;
    check_scene(build_lying_ring, vec3(0.2, 0.2, 2.3), out_of_lying_ring);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_coat),  cmocka_unit_test(test_ball), cmocka_unit_test(test_cone),
        cmocka_unit_test(test_tubes), cmocka_unit_test(test_ring), cmocka_unit_test(test_log),
        cmocka_unit_test(test_lying_ring),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
