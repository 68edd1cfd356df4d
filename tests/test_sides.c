/* SPDX-License-Identifier: BSD-3-Clause */
/* Sides in sight: what light or eye can reach takes part, whatever the winding; nothing else
 * does. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "tests/room_maker.h"

static const Vec3 ORIGIN = { 0, 0, 0 }, UNIT = { 1, 1, 1 };
enum { FRONT = 1, BACK = 2, BOTH = 3 };

static void find(TestRoom *r, const SidesOptions *options, const Light *lights, size_t count,
                 const Monitor *monitor)
{
    Error err = { 0 };
    room_connect(r);
    assert_true(sides_find(r->surfaces, r->bvh, r->soup.materials, lights, count, options,
                           r->sides, r->emitting, &r->report, monitor, &err));
}

static int sides_of(const TestRoom *r, const char *group)
{
    return r->sides[room_surface(r, group)];
}

static int emitting_of(const TestRoom *r, const char *group)
{
    return r->emitting[room_surface(r, group)];
}

/* A room with outward normals: the backs take part, as the lamp's light meets those. */
static void test_outward_room(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    room_box(&r, ORIGIN, UNIT, BOX_ALL, false, room_material(&r, 0.5, 0), "");
    room_quad(&r, vec3(0.4, 0.4, 0.9), vec3(0, 0.2, 0), vec3(0.2, 0, 0), room_material(&r, 0, 1),
              "lamp");
    find(&r, &(SidesOptions){ 0 }, NULL, 0, NULL);
    assert_int_equal(r.report.back, 6);
    assert_int_equal(sides_of(&r, "lamp"), BOTH);
    assert_int_equal(emitting_of(&r, "lamp"), FRONT);
    assert_int_equal(r.report.lamps_turned, 0);
    room_clear(&r);
}

/* An eye alone, and a point light alone, start sight as a lamp does. */
static void test_eye_and_light(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        TestRoom r = { 0 };
        const Vec3 eye = { 0.2, 0.7, 0.3 };
        const Light light = { .kind = LIGHT_POINT, .position = eye, .intensity = { 1, 1, 1 } };
        room_box(&r, ORIGIN, UNIT, BOX_ALL, true, room_material(&r, 0.5, 0), "");
        const SidesOptions o = { .eye = &eye, .eye_count = k == 0 };
        find(&r, &o, &light, k == 1, NULL);
        assert_int_equal(r.report.front, 6);
        room_clear(&r);
    }
}

static void test_nothing_to_see_by(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    room_box(&r, ORIGIN, UNIT, BOX_ALL, true, room_material(&r, 0.5, 0), "");
    find(&r, &(SidesOptions){ 0 }, NULL, 0, NULL);
    assert_int_equal(r.report.both, 6);
    room_clear(&r);
}

/* A closed cupboard with a shelf, flush with the floor: nothing of its inside, and not its bottom,
 * although the inside looks at a floor that takes part elsewhere. */
static void test_cupboard(void **state)
{
    (void)state;
    for (int bottom = 0; bottom < 3; bottom++) {
        TestRoom r = { 0 };
        const uint32_t wall = room_material(&r, 0.5, 0);
        const double z = bottom == 2 ? -0.05 : 0; /* 2: sunk into the floor */
        room_box(&r, ORIGIN, UNIT, BOX_ALL - BOX_Z1, true, wall, "");
        room_box(&r, ORIGIN, UNIT, BOX_Z1, true, room_material(&r, 0.5, 1), "");
        room_box(&r, vec3(0.2, 0.3, z), vec3(0.6, 0.55, 0.7),
                 bottom ? BOX_ALL : BOX_ALL - BOX_Z0, false, wall, "c-");
        room_quad(&r, vec3(0.2, 0.3, 0.3), vec3(0.4, 0, 0), vec3(0, 0.25, 0), wall, "shelf");
        find(&r, &(SidesOptions){ 0 }, NULL, 0, NULL);
        static const char *const outside[] = { "c-x0", "c-x1", "c-y0", "c-y1", "c-z1" };
        for (int k = 0; k < 5; k++)
            assert_int_equal(sides_of(&r, outside[k]), FRONT);
        assert_int_equal(sides_of(&r, "shelf"), 0);
        assert_int_equal(sides_of(&r, "z0"), FRONT);
        if (bottom)
            assert_int_equal(sides_of(&r, "c-z0"), 0);
        room_clear(&r);
    }
}

/* Open towards y0, the eye before it: insides only. */
static void test_open_front(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    const uint32_t wall = room_material(&r, 0.5, 0);
    room_box(&r, ORIGIN, UNIT, BOX_ALL - BOX_Y0, true, wall, "");
    room_quad(&r, vec3(0.4, 0.4, 0.999), vec3(0, 0.2, 0), vec3(0.2, 0, 0),
              room_material(&r, 0, 1), "lamp");
    room_box(&r, vec3(0.2, 0.2, 0), vec3(0.5, 0.5, 0.4), BOX_ALL, false, wall, "b-");
    const Vec3 eye = { 0.5, -2, 0.5 };
    find(&r, &(SidesOptions){ .eye = &eye, .eye_count = 1 }, NULL, 0, NULL);
    static const char *const inside[] = { "x0", "x1", "y1", "z0", "z1", "b-x0", "b-x1", "b-y0",
                                          "b-y1", "b-z1" };
    for (int k = 0; k < 10; k++)
        assert_int_equal(sides_of(&r, inside[k]), FRONT);
    assert_int_equal(sides_of(&r, "b-z0"), 0);
    room_clear(&r);
}

/* Through two doors and round two corners, with a small thing at the end. */
static void test_deep(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    const uint32_t wall = room_material(&r, 0.5, 0);
    room_box(&r, ORIGIN, vec3(3, 1, 1), BOX_ALL - BOX_X0, true, wall, "");
    room_quad(&r, ORIGIN, vec3(0, 1, 0), vec3(0, 0, 1), room_material(&r, 0, 1), "lamp");
    room_quad(&r, vec3(1, 0, 0), vec3(0, 0.8, 0), vec3(0, 0, 1), wall, "wall1");
    room_quad(&r, vec3(2, 0.2, 0), vec3(0, 0.8, 0), vec3(0, 0, 1), wall, "wall2");
    room_box(&r, vec3(2.9, 0.9, 0.1), vec3(2.901, 0.901, 0.101), BOX_ALL, false, wall, "dot-");
    find(&r, &(SidesOptions){ 0 }, NULL, 0, NULL);
    assert_int_equal(sides_of(&r, "wall1"), BOTH);
    assert_int_equal(sides_of(&r, "wall2"), BOTH);
    static const char *const dot[] = { "dot-x0", "dot-x1", "dot-y0", "dot-y1", "dot-z0", "dot-z1" };
    for (int k = 0; k < 6; k++)
        assert_int_equal(sides_of(&r, dot[k]), FRONT);
    room_clear(&r);
}

/* --- lamps ------------------------------------------------------------------------------------ */

typedef struct {
    int  count;
    char code[64], where[64];
} Warnings;

static void note(void *user, const char *code, const char *where, const char *text)
{
    Warnings *w = user;
    (void)text;
    w->count++;
    snprintf(w->code, sizeof w->code, "%s", code);
    snprintf(w->where, sizeof w->where, "%s", where);
}

/* A lamp under the ceiling, `gap` below, wound to face it or the room. */
static void lamp_room(TestRoom *r, double gap, bool up, uint32_t *lamp)
{
    room_box(r, ORIGIN, UNIT, BOX_ALL, true, room_material(r, 0.5, 0), "");
    *lamp = room_material(r, 0, 1);
    const Vec3 o = { 0.4, 0.4, 1 - gap }, x = { 0.2, 0, 0 }, y = { 0, 0.2, 0 };
    room_quad(r, o, up ? x : y, up ? y : x, *lamp, "lamp");
}

static void test_lamp_turned(void **state)
{
    (void)state;
    static const struct {
        double   gap;
        bool     up;
        EmitSide emit;
        int      expected;
        bool     turned;
    } cases[] = {
        { 0.001, true, EMIT_AUTO, BACK, true },    /* faces the ceiling a hair away */
        { 0.001, false, EMIT_AUTO, FRONT, false }, /* as it should */
        { 0.2, true, EMIT_AUTO, FRONT, false },    /* an uplight */
        { 0.001, true, EMIT_FRONT, FRONT, false }, /* told to */
        { 0.001, false, EMIT_BACK, BACK, false },
        { 0.2, false, EMIT_BOTH, BOTH, false },
        { 0, false, EMIT_AUTO, FRONT, false },     /* in the plane of the ceiling */
        { 0, true, EMIT_AUTO, BACK, true },        /* and facing the world above it */
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        TestRoom r = { 0 };
        uint32_t lamp;
        Warnings warnings = { 0 };
        const Monitor monitor = { .user = &warnings, .warn = note };
        lamp_room(&r, cases[k].gap, cases[k].up, &lamp);
        find(&r, &(SidesOptions){ .emit = cases[k].emit }, NULL, 0, &monitor);
        assert_int_equal(emitting_of(&r, "lamp"), cases[k].expected);
        assert_int_equal(r.report.lamps_turned, cases[k].turned);
        assert_int_equal(warnings.count, cases[k].turned);
        if (cases[k].turned)
            assert_string_equal(warnings.code, "lamp-turned");
        assert_int_equal(sides_of(&r, "z0"), FRONT);
        assert_int_equal(sides_of(&r, "z1"), FRONT);
        room_clear(&r);
    }
}

/* The lamp fills a hole in the ceiling, made of four strips. */
static void test_lamp_in_hole(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    const uint32_t wall = room_material(&r, 0.5, 0);
    room_box(&r, ORIGIN, UNIT, BOX_ALL - BOX_Z1, true, wall, "");
    const Vec3 y = { 0, 1, 0 };
    room_quad(&r, vec3(0, 0, 1), y, vec3(0.4, 0, 0), wall, "strip0");
    room_quad(&r, vec3(0.6, 0, 1), y, vec3(0.4, 0, 0), wall, "strip1");
    room_quad(&r, vec3(0.4, 0, 1), vec3(0, 0.4, 0), vec3(0.2, 0, 0), wall, "strip2");
    room_quad(&r, vec3(0.4, 0.6, 1), vec3(0, 0.4, 0), vec3(0.2, 0, 0), wall, "strip3");
    room_quad(&r, vec3(0.4, 0.4, 1), vec3(0, 0.2, 0), vec3(0.2, 0, 0), room_material(&r, 0, 1),
              "lamp");
    find(&r, &(SidesOptions){ 0 }, NULL, 0, NULL);
    assert_int_equal(r.report.front, 10);
    assert_int_equal(emitting_of(&r, "lamp"), FRONT);
    room_clear(&r);
}

/* A flat box as lamp, close under the ceiling: its top faces a wall, but the lamp as a whole does
 * not, and nothing shines into the box. */
static void test_box_lamp(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    room_box(&r, ORIGIN, UNIT, BOX_ALL, true, room_material(&r, 0.5, 0), "");
    room_box(&r, vec3(0.3, 0.3, 0.97), vec3(0.7, 0.7, 0.999), BOX_ALL, false,
             room_material(&r, 0, 1), "lamp-");
    find(&r, &(SidesOptions){ 0 }, NULL, 0, NULL);
    static const char *const lamp[] = { "lamp-x0", "lamp-x1", "lamp-y0", "lamp-y1", "lamp-z0",
                                        "lamp-z1" };
    for (int k = 0; k < 6; k++) {
        assert_int_equal(emitting_of(&r, lamp[k]), FRONT);
        assert_int_equal(sides_of(&r, lamp[k]), FRONT);
    }
    room_clear(&r);
}

/* A lamp that shines away from all else is turned, but not when an eye looks at it, nor a lamp all
 * round, whose back sees only itself. */
static void test_lamp_outside(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++) {
        TestRoom r = { 0 };
        const Vec3 eye = { 0.5, 0.5, k == 1 ? 9 : 1.5 };
        const uint32_t lamp = room_material(&r, 0, 1);
        room_quad(&r, vec3(-9, -9, 0), vec3(20, 0, 0), vec3(0, 20, 0), room_material(&r, 0.5, 0),
                  "ground");
        if (k < 2)
            room_quad(&r, vec3(0, 0, 3), vec3(1, 0, 0), vec3(0, 1, 0), lamp, "lamp");
        else
            room_box(&r, vec3(0, 0, 3), vec3(1, 1, 4), BOX_ALL, false, lamp, "lamp-");
        find(&r, &(SidesOptions){ .eye = &eye, .eye_count = 1 }, NULL, 0, NULL);
        assert_int_equal(emitting_of(&r, k < 2 ? "lamp" : "lamp-z1"), k == 0 ? BACK : FRONT);
        room_clear(&r);
    }
}

/* Light that stays in its lamp is let out, while its back has the room before it: a box wound
 * inward, one without a top under the ceiling, one of two materials; and a lamp that shines into
 * its own case. */
static void test_lamp_inward(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        TestRoom r = { 0 };
        Warnings warnings = { 0 };
        const Monitor monitor = { .user = &warnings, .warn = note };
        const Vec3 lo = { 1.5, 1.5, 2.6 }, hi = { 2.5, 2.5, k == 1 ? 3 : 2.9 };
        const uint32_t wall = room_material(&r, 0.5, 0), lamp = room_material(&r, 0, 1);
        const int rest = BOX_ALL - BOX_Z0 - (k == 1 ? BOX_Z1 : 0);
        room_box(&r, ORIGIN, vec3(4, 4, 3), BOX_ALL, true, wall, "");
        room_box(&r, lo, hi, BOX_Z0, true, lamp, "lamp-");
        room_box(&r, lo, hi, rest, k < 3, k == 3 ? wall : k == 2 ? room_material(&r, 0, 2) : lamp,
                 k == 3 ? "case-" : "lamp-");
        find(&r, &(SidesOptions){ 0 }, NULL, 0, &monitor);
        assert_int_equal(emitting_of(&r, "lamp-z0"), BACK);
        assert_int_equal(sides_of(&r, "lamp-z0"), BACK);
        assert_int_equal(r.report.lamps_turned, k == 3 ? 1 : k == 1 ? 5 : 6);
        assert_int_equal(warnings.count, 1);
        assert_string_equal(warnings.code, "lamp-turned");
        assert_int_equal(sides_of(&r, "z0"), FRONT);
        room_clear(&r);
    }
}

/* Rooms whose walls shine stay as they are: nothing is behind them, or an eye is in them. */
static void test_furnaces(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        TestRoom r = { 0 };
        Warnings warnings = { 0 };
        const Monitor monitor = { .user = &warnings, .warn = note };
        const Vec3 eye = { 0.5, 0.5, 0.5 };
        const uint32_t wall = room_material(&r, 0.5, 0), lamp = room_material(&r, 0.5, 1);
        room_box(&r, ORIGIN, UNIT, k == 3 ? BOX_Z1 : BOX_ALL, true, lamp, "lamp-");
        if (k == 1) /* a thing inside */
            room_box(&r, vec3(0.4, 0.4, 0.4), vec3(0.6, 0.6, 0.6), BOX_ALL, false, wall, "");
        if (k == 2) /* a world outside */
            room_quad(&r, vec3(-50, -50, -1), vec3(99, 0, 0), vec3(0, 99, 0), wall, "ground");
        if (k == 3) { /* shining ceilings of two rooms, one upon the other */
            room_box(&r, ORIGIN, UNIT, BOX_ALL - BOX_Z1, true, wall, "");
            room_box(&r, vec3(0, 0, 1), vec3(1, 1, 2), BOX_ALL - BOX_Z0, true, wall, "upper-");
        }
        const SidesOptions o = { .eye = &eye, .eye_count = k == 2 };
        find(&r, &o, NULL, 0, &monitor);
        assert_int_equal(emitting_of(&r, "lamp-z1"), FRONT);
        assert_int_equal(r.report.lamps_turned, 0);
        assert_int_equal(warnings.count, k == 2);
        if (k == 2)
            assert_string_equal(warnings.code, "dark-scene");
        room_clear(&r);
    }
}

/* Faces of a box lamp wound by chance: its light gets out all the same, all of it by one side. */
static void test_lamp_flips(void **state)
{
    (void)state;
    static const int flips[8] = { 1, 6, 11, 21, 31, 44, 52, 63 }; /* faces wound inward */
    for (int k = 0; k < 8; k++) {
        TestRoom r = { 0 };
        const Vec3 lo = { 1.5, 1.5, 2.4 }, hi = { 2.5, 2.5, 2.7 };
        const uint32_t lamp = room_material(&r, 0, 1);
        room_box(&r, ORIGIN, vec3(4, 4, 3), BOX_ALL, true, room_material(&r, 0.5, 0), "");
        room_box(&r, lo, hi, flips[k], true, lamp, "lamp-");
        room_box(&r, lo, hi, BOX_ALL - flips[k], false, lamp, "lamp-");
        find(&r, &(SidesOptions){ 0 }, NULL, 0, NULL);
        for (uint32_t i = 0; i < r.surfaces->count; i++) {
            SurfacePoint at;
            if (r.emitting[i] == 0) {
                assert_int_not_equal(r.sides[i], 0);
                continue;
            }
            surfaces_point(r.surfaces, i, 0.3, 0.3, &at);
            const Vec3 out = vec3_sub(at.point, vec3_lerp(lo, hi, 0.5));
            assert_int_equal(r.emitting[i], vec3_dot(at.normal, out) > 0 ? FRONT : BACK);
        }
        room_clear(&r);
    }
}

/* The same with windings left as they are in the file: each face is decided by itself. */
static void test_lamp_flips_left(void **state)
{
    (void)state;
    static const int flips[3] = { 1, 6, 21 };
    for (int k = 0; k < 3; k++) {
        TestRoom r = { 0 };
        Error err = { 0 };
        const Vec3 lo = { 1.5, 1.5, 2.4 }, hi = { 2.5, 2.5, 2.7 };
        const uint32_t lamp = room_material(&r, 0, 1);
        room_box(&r, ORIGIN, vec3(4, 4, 3), BOX_ALL, true, room_material(&r, 0.5, 0), "");
        room_box(&r, lo, hi, flips[k], true, lamp, "in-");
        room_box(&r, lo, hi, BOX_ALL - flips[k], false, lamp, "out-");
        r.surfaces = surfaces_repair(&r.soup, &(SurfaceOptions){ .keep_winding = true }, NULL,
                                     NULL, &err);
        assert_non_null(r.surfaces);
        room_trace(&r);
        assert_true(sides_find(r.surfaces, r.bvh, r.soup.materials, NULL, 0, &(SidesOptions){ 0 },
                               r.sides, r.emitting, &r.report, NULL, &err));
        for (uint32_t i = 0; i < r.surfaces->count; i++) {
            const char *group = r.soup.group_name[r.surfaces->surface[i].group];
            if (strchr(group, '-') != NULL)
                assert_int_equal(r.emitting[i], group[0] == 'i' ? BACK : FRONT);
        }
        room_clear(&r);
    }
}

/* A luminaire as large as half the ceiling, all of it wound inward: it is one all the same. But a
 * room with a luminous ceiling is none, though all there is stands outside. */
static void test_large_luminaire(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        TestRoom r = { 0 };
        const uint32_t wall = room_material(&r, 0.5, 0), lamp = room_material(&r, 0.5, 1);
        const Vec3 lo = { 0.5, 0.5, 2.2 }, hi = { 3.5, 3.5, 2.6 };
        room_box(&r, ORIGIN, vec3(4, 4, 3), BOX_ALL, true, wall, "");
        if (k == 0) {
            room_box(&r, lo, hi, BOX_Z0, true, lamp, "lamp-");
            room_box(&r, lo, hi, BOX_ALL - BOX_Z0, true, wall, "case-");
        } else {
            room_box(&r, vec3(0.5, 0.5, 0.5), hi, BOX_Z1, true, lamp, "lamp-");
            room_box(&r, vec3(0.5, 0.5, 0.5), hi, BOX_ALL - BOX_Z1, true, wall, "case-");
        }
        find(&r, &(SidesOptions){ 0 }, NULL, 0, NULL);
        assert_int_equal(emitting_of(&r, k == 0 ? "lamp-z0" : "lamp-z1"), k == 0 ? BACK : FRONT);
        assert_int_equal(sides_of(&r, "z0"), k == 0 ? FRONT : 0);
        room_clear(&r);
    }
}

/* A light shut in a cupboard of a hall. */
static void test_dark_scene(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        TestRoom r = { 0 };
        Warnings warnings = { 0 };
        const Monitor monitor = { .user = &warnings, .warn = note };
        const uint32_t wall = room_material(&r, 0.5, 0);
        const Vec3 eye = { 8, 8, 8 };
        const Light light = { .kind = LIGHT_POINT, .position = { 1.5, 1.5, k == 0 ? 1.5 : 5 },
                              .intensity = { 1, 1, 1 } };
        room_box(&r, ORIGIN, vec3(10, 10, 10), BOX_ALL, true, wall, "");
        room_box(&r, UNIT, vec3(2, 2, 2), BOX_ALL, false, wall, "c-");
        find(&r, &(SidesOptions){ .eye = &eye, .eye_count = 1 }, &light, 1, &monitor);
        assert_int_equal(warnings.count, k == 0);
        if (k == 0)
            assert_string_equal(warnings.code, "dark-scene");
        room_clear(&r);
    }
}

static void test_emits_both(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    uint32_t lamp;
    lamp_room(&r, 0.2, false, &lamp);
    r.soup.materials[lamp].emits_both = true;
    find(&r, &(SidesOptions){ 0 }, NULL, 0, NULL);
    assert_int_equal(emitting_of(&r, "lamp"), BOTH);
    room_clear(&r);
}

/* A plate of two faces back to back, one of which shines: into its own half of the room only. */
static void test_double_plate(void **state)
{
    (void)state;
    for (int order = 0; order < 2; order++) {
        TestRoom r = { 0 };
        const uint32_t wall = room_material(&r, 0.5, 0), lamp = room_material(&r, 0, 1);
        const Vec3 o = { 0.4, 0.4, 0.5 }, x = { 0.2, 0, 0 }, y = { 0, 0.2, 0 };
        room_box(&r, ORIGIN, UNIT, BOX_ALL, true, wall, "");
        room_quad(&r, o, x, y, order ? lamp : wall, "plate");
        room_quad(&r, o, y, x, order ? wall : lamp, "other");
        find(&r, &(SidesOptions){ 0 }, NULL, 0, NULL);
        assert_int_equal(r.surfaces->count, 7);
        assert_int_equal(sides_of(&r, "plate"), BOTH);
        assert_int_equal(emitting_of(&r, "plate"), order ? FRONT : BACK);
        room_clear(&r);
    }
}

/* --- promises --------------------------------------------------------------------------------- */

static void test_threads(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    uint32_t lamp;
    lamp_room(&r, 0.1, false, &lamp);
    for (int k = 0; k < 50; k++) /* small things all over */
        room_box(&r, vec3(0.02 * k, 0.3, 0.01 * k), vec3(0.02 * k + 0.01, 0.31, 0.01 * k + 0.01),
                 BOX_ALL, false, 0, "bit-");
    find(&r, &(SidesOptions){ .threads = 1 }, NULL, 0, NULL);
    uint8_t first[1024];
    assert_true(r.surfaces->count <= sizeof first);
    memcpy(first, r.sides, r.surfaces->count);
    SidesReport report;
    Error err = { 0 };
    assert_true(sides_find(r.surfaces, r.bvh, r.soup.materials, NULL, 0,
                           &(SidesOptions){ .threads = 3 }, r.sides, r.emitting, &report, NULL,
                           &err));
    assert_memory_equal(first, r.sides, r.surfaces->count);
    room_clear(&r);
}

static void test_memory(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    uint32_t lamp;
    lamp_room(&r, 0.1, false, &lamp);
    room_connect(&r);
    const long before = array_live();
    bool found = false;
    for (long n = 0; n < 100 && !found; n++) {
        Error err = { 0 };
        array_fail_after(n);
        found = sides_find(r.surfaces, r.bvh, r.soup.materials, NULL, 0, &(SidesOptions){ 0 },
                           r.sides, r.emitting, &r.report, NULL, &err);
        array_fail_after(-1);
        assert_int_equal(err.code, found ? ERROR_NONE : ERROR_MEMORY);
        assert_int_equal(array_live(), before);
    }
    assert_true(found);
    room_clear(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_outward_room),   cmocka_unit_test(test_eye_and_light),
        cmocka_unit_test(test_nothing_to_see_by), cmocka_unit_test(test_cupboard),
        cmocka_unit_test(test_open_front),     cmocka_unit_test(test_deep),
        cmocka_unit_test(test_lamp_turned),    cmocka_unit_test(test_lamp_in_hole),
        cmocka_unit_test(test_box_lamp),       cmocka_unit_test(test_emits_both),
        cmocka_unit_test(test_double_plate),   cmocka_unit_test(test_threads),
        cmocka_unit_test(test_memory),         cmocka_unit_test(test_lamp_outside),
        cmocka_unit_test(test_lamp_inward),    cmocka_unit_test(test_furnaces),
        cmocka_unit_test(test_lamp_flips),     cmocka_unit_test(test_dark_scene),
        cmocka_unit_test(test_lamp_flips_left), cmocka_unit_test(test_large_luminaire),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
