/* SPDX-License-Identifier: BSD-3-Clause */
/* The default view and the ceiling lamp, in rooms whose answer is plain to see. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "scenes/ceiling_light.h"
#include "scenes/view.h"

typedef struct {
    Scene    *scene;
    Surfaces *surfaces;
    Bvh      *bvh;
} House;

/* Sides of a box that are left out: bit 2 * axis + (1: the far one). */
#define OPEN(axis, far) (1u << (2 * (axis) + (far)))

static double *axis_of(Vec3 *v, int axis) { return axis == 0 ? &v->x : axis == 1 ? &v->y : &v->z; }

/* The box lo..hi, fronts inwards or outwards, without the sides in `open`. */
static void box_add(House *h, Vec3 lo, Vec3 hi, bool inwards, unsigned open)
{
    Polygons *soup = &h->scene->polygons;
    Error err = { 0 };
    uint32_t group = 0, corner[4];

    if (soup->material_count == 0) {
        const Material grey = material_default();
        uint32_t index;
        assert_true(polygons_add_material(soup, &grey, &index, &err));
    }
    assert_true(polygons_add_group(soup, "box", &group, &err));
    for (int side = 0; side < 6; side++) {
        const int axis = side / 2, a = (axis + 1) % 3, b = (axis + 2) % 3;
        const bool turned = (side % 2 == 1) == inwards;
        if (open & (1u << side))
            continue;
        for (int k = 0; k < 4; k++) {
            Vec3 p = side % 2 ? hi : lo;
            const int at = turned ? 3 - k : k;
            *axis_of(&p, a) = at == 1 || at == 2 ? vec3_axis(hi, a) : vec3_axis(lo, a);
            *axis_of(&p, b) = at >= 2 ? vec3_axis(hi, b) : vec3_axis(lo, b);
            assert_true(polygons_add_vertex(soup, p, &corner[k], &err));
        }
        assert_true(polygons_add_polygon(soup, corner, 4, 0, group, &err));
    }
}

static House house_start(Vec3 up)
{
    Error err = { 0 };
    House h = { .scene = scene_create("house", &err) };
    assert_non_null(h.scene);
    h.scene->up = up;
    return h;
}

static void house_connect(House *h)
{
    Error err = { 0 };
    h->surfaces = surfaces_create(&h->scene->polygons, NULL, &err);
    assert_non_null(h->surfaces);
    const Surfaces *s = h->surfaces;
    const Primitives p = { s->position, s->corner, s->shape, s->vertex_count, s->triangle_count,
                           s->shape_count };
    h->bvh = bvh_create(&p, 1, &err);
    assert_non_null(h->bvh);
}

static void house_end(House *h)
{
    bvh_destroy(h->bvh);
    surfaces_destroy(h->surfaces);
    scene_destroy(h->scene);
    assert_int_equal(array_live(), 0);
}

static bool inside(Vec3 p, Vec3 lo, Vec3 hi)
{
    return p.x > lo.x && p.y > lo.y && p.z > lo.z && p.x < hi.x && p.y < hi.y && p.z < hi.z;
}

/* Whether p falls into a square picture of the camera. */
static bool seen(const Camera *c, Vec3 p)
{
    const Vec3 ahead = vec3_unit(vec3_sub(c->target, c->eye)), d = vec3_sub(p, c->eye);
    const Vec3 right = vec3_unit(vec3_cross(ahead, c->up)), up = vec3_cross(right, ahead);
    const double reach = vec3_dot(d, ahead) * tan(c->vertical_fov / 2 * M_PI / 180);
    return reach > 0 && fabs(vec3_dot(d, right)) <= reach && fabs(vec3_dot(d, up)) <= reach;
}

/* --- views ----------------------------------------------------------------------------------- */

/* A box open to one level side, whichever way is up: the eye stands before that side, all four
 * corners of the opening are in the picture, and it fills more than nine tenths of it. */
static void open_boxes_are_seen_whole(void **state)
{
    (void)state;
    const Vec3 lo = vec3(-1, 2, 5), hi = vec3(2, 4, 9);
    for (int up = 0; up < 3; up++)
        for (int turn = 1; turn <= 2; turn++)
            for (int far = 0; far < 2; far++)
                for (int sense = -1; sense <= 1; sense += 2) {
                    const int axis = (up + turn) % 3;
                    Vec3 high = vec3(0, 0, 0);
                    *axis_of(&high, up) = sense;
                    House h = house_start(high);
                    box_add(&h, lo, hi, true, OPEN(axis, far));
                    box_add(&h, vec3(0, 2.5, 6), vec3(0.5, 3, 6.5), false, 0);
                    house_connect(&h);
                    Camera c;
                    view_of_surfaces(h.scene, h.surfaces, h.bvh, &c);
                    const double edge = vec3_axis(far ? hi : lo, axis);
                    assert_true((vec3_axis(c.eye, axis) - edge) * (far ? 1 : -1) > 0);
                    assert_true(vec3_dot(c.up, high) > 0.99);
                    for (int k = 0; k < 4; k++) {
                        Vec3 p = vec3(k & 1 ? hi.x : lo.x, k & 2 ? hi.y : lo.y,
                                      (k & 1) ^ (k >> 1) ? hi.z : lo.z);
                        *axis_of(&p, axis) = edge;
                        assert_true(seen(&c, p));
                    }
                    const double w = fmax(vec3_axis(hi, up) - vec3_axis(lo, up),
                                          vec3_axis(hi, 3 - up - axis) -
                                              vec3_axis(lo, 3 - up - axis));
                    const double half = fabs(vec3_axis(c.eye, axis) - edge)
                                        * tan(c.vertical_fov / 2 * M_PI / 180);
                    assert_true(w / 2 > 0.9 * half);
                    house_end(&h);
                }
}

/* A closed room: the eye stands in it, away from its walls, upright and looking level. */
static void closed_rooms_are_seen_from_inside(void **state)
{
    (void)state;
    const Vec3 lo = vec3(10, 0, -3), hi = vec3(16, 2.7, 1);
    for (int inwards = 0; inwards < 2; inwards++) {
        House h = house_start(vec3(0, 1, 0));
        box_add(&h, lo, hi, inwards, 0);
        house_connect(&h);
        Camera c;
        view_of_surfaces(h.scene, h.surfaces, h.bvh, &c);
        assert_true(inside(c.eye, vec3(10.2, 1, -2.8), vec3(15.8, 2, 0.8)));
        assert_true(fabs(c.target.y - c.eye.y) < 1e-9);
        house_end(&h);
    }
}

/* A room in a house with thick walls and a higher hollow below its floor, which sees only backs. */
static void hollows_are_no_rooms(void **state)
{
    (void)state;
    const Vec3 lo = vec3(0.5, 4.2, 0.5), hi = vec3(7.5, 6.8, 5.5);
    House h = house_start(vec3(0, 1, 0));
    box_add(&h, vec3(0, 0, 0), vec3(8, 7, 6), false, 0);
    box_add(&h, lo, hi, true, 0);
    house_connect(&h);
    Camera c;
    view_of_surfaces(h.scene, h.surfaces, h.bvh, &c);
    assert_true(inside(c.eye, lo, hi));
    house_end(&h);
}

/* A single body in the open is seen from outside, whole. */
static void bodies_without_room_are_seen_whole(void **state)
{
    (void)state;
    House h = house_start(vec3(0, 0, 1));
    box_add(&h, vec3(0, 0, 0), vec3(4, 4, 0.5), false, OPEN(2, 1) | OPEN(0, 0) | OPEN(1, 1));
    house_connect(&h);
    Camera c;
    view_of_surfaces(h.scene, h.surfaces, h.bvh, &c);
    for (int k = 0; k < 8; k++)
        assert_true(seen(&c, vec3(k & 1 ? 4 : 0, k & 2 ? 4 : 0, k & 4 ? 0.5 : 0)));
    assert_true(c.eye.z > 0.5);
    house_end(&h);
}

/* --- the lamp -------------------------------------------------------------------------------- */

static Vec3 lamp_normal(const Polygons *p, double *area)
{
    const uint32_t *corner = &p->corner[p->first[p->polygon_count - 1]];
    const Vec3 n = vec3_cross(vec3_sub(p->position[corner[1]], p->position[corner[0]]),
                              vec3_sub(p->position[corner[2]], p->position[corner[1]]));
    *area = vec3_length(n);
    return vec3_unit(n);
}

/* Room of 8 x 5 floor and 3 height: a lamp of 5/4 square, 0.03 below the middle of the ceiling,
 * facing down; half its flux pi L A over the floor's 40 is 500. */
static void lamp_check(const House *h, int up, double sense, Vec3 middle)
{
    const Polygons *p = &h->scene->polygons;
    const size_t lamp = p->polygon_count - 1;
    double area;
    const Vec3 n = lamp_normal(p, &area);
    Vec3 centre = vec3(0, 0, 0);

    assert_string_equal(p->group_name[p->group[lamp]], "ceiling-light");
    assert_string_equal(p->materials[p->material[lamp]].name, "ceiling-light");
    for (int k = 0; k < 4; k++)
        centre = vec3_mad(centre, 0.25, p->position[p->corner[p->first[lamp] + (size_t)k]]);
    const double float_rounding = 1e-5; /* of hits at distances up to 8, with a margin */
    assert_true(vec3_axis(n, up) * sense < -0.999);
    assert_true(fabs(area - 25.0 / 16) < float_rounding * 8);
    assert_true(vec3_length(vec3_sub(centre, middle)) < float_rounding);
    const double flux = M_PI * p->materials[p->material[lamp]].emission.g * area;
    assert_true(fabs(flux * 0.5 / 40 - 500) < 500 * float_rounding);
}

static void lamps_hang_in_the_middle(void **state)
{
    (void)state;
    for (int up = 0; up < 3; up++)
        for (int sense = -1; sense <= 1; sense += 2)
            for (int open = 0; open < 2; open++) {
                Error err = { 0 };
                Vec3 hi = vec3(0, 0, 0), high = vec3(0, 0, 0), middle;
                *axis_of(&hi, up) = 3;
                *axis_of(&hi, (up + 1) % 3) = 8;
                *axis_of(&hi, (up + 2) % 3) = 5;
                *axis_of(&high, up) = sense;
                House h = house_start(high);
                box_add(&h, vec3(0, 0, 0), hi, true, open ? OPEN((up + 1) % 3, 1) : 0);
                house_connect(&h);
                assert_true(ceiling_light_hang(h.scene, h.surfaces, h.bvh, &err));
                middle = vec3_scale(hi, 0.5);
                *axis_of(&middle, up) = sense > 0 ? 2.97 : 0.03;
                lamp_check(&h, up, sense, middle);
                assert_true(scene_check(h.scene));
                assert_true(scene_has_light(h.scene));
                house_end(&h);
            }
}

/* Two rooms side by side: the lamp hangs where the file's camera stands. */
static void lamps_hang_where_the_camera_is(void **state)
{
    (void)state;
    Error err = { 0 };
    const Camera camera = { .eye = { 21, 1, 1 }, .target = { 22, 1, 1 }, .up = { 0, 1, 0 },
                            .vertical_fov = 60 };
    House h = house_start(vec3(0, 1, 0));
    box_add(&h, vec3(0, 0, 0), vec3(12, 4, 12), true, 0);
    box_add(&h, vec3(20, 0, 0), vec3(28, 3, 5), true, 0);
    assert_true(scene_add_camera(h.scene, &camera, &err));
    house_connect(&h);
    assert_true(ceiling_light_hang(h.scene, h.surfaces, h.bvh, &err));
    lamp_check(&h, 1, 1, vec3(24, 2.97, 2.5));
    house_end(&h);
}

/* A floor alone has no ceiling and no height: the lamp can only be refused or lie in the box. */
static void flat_scenes_are_no_crash(void **state)
{
    (void)state;
    Error err = { 0 };
    House h = house_start(vec3(0, 1, 0));
    box_add(&h, vec3(0, 0, 0), vec3(1, 1, 1), true,
            OPEN(0, 0) | OPEN(0, 1) | OPEN(1, 1) | OPEN(2, 0) | OPEN(2, 1));
    house_connect(&h);
    Camera c;
    view_of_surfaces(h.scene, h.surfaces, h.bvh, &c);
    assert_true(vec3_finite(c.eye) && vec3_length(vec3_sub(c.eye, c.target)) > 0);
    assert_int_equal(ceiling_light_hang(h.scene, h.surfaces, h.bvh, &err), !error_is_set(&err));
    house_end(&h);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(open_boxes_are_seen_whole),
        cmocka_unit_test(closed_rooms_are_seen_from_inside),
        cmocka_unit_test(hollows_are_no_rooms),
        cmocka_unit_test(bodies_without_room_are_seen_whole),
        cmocka_unit_test(lamps_hang_in_the_middle),
        cmocka_unit_test(lamps_hang_where_the_camera_is),
        cmocka_unit_test(flat_scenes_are_no_crash),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
