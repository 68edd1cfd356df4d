/* SPDX-License-Identifier: BSD-3-Clause */
/* No light where none can come: outside a closed box with a lamp in it, in a dark room beside a
 * bright one. Exactly none, with walls of any thickness and patches of any size. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "inspect/imprint.h"
#include "tests/room_maker.h"

static const Vec3 ORIGIN = { 0, 0, 0 };

/* An odd turn about an odd axis, so that nothing lies along an axis or has round coordinates. */
typedef struct {
    Vec3 x, y, z, move;
} Turn;

static const Turn STRAIGHT = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 0, 0, 0 } };

static Turn odd_turn(Vec3 move)
{
    const double a = 0.3217, b = 1.1031;
    const Vec3 x = { cos(a), sin(a), 0 };
    const Vec3 y = { -sin(a) * cos(b), cos(a) * cos(b), sin(b) };
    return (Turn){ x, y, vec3_cross(x, y), move };
}

static Vec3 turned(const Turn *t, Vec3 p)
{
    return vec3_mad(vec3_mad(vec3_mad(t->move, p.x, t->x), p.y, t->y), p.z, t->z);
}

static Vec3 turned_back(const Turn *t, Vec3 p)
{
    const Vec3 q = vec3_sub(p, t->move);
    return vec3(vec3_dot(q, t->x), vec3_dot(q, t->y), vec3_dot(q, t->z));
}

/* Surfaces of the imprinted soup, as the program makes them. */
static void connect(TestRoom *r, const Turn *turn)
{
    Error err = { 0 };
    Imprint imprint;
    for (size_t i = 0; i < r->soup.vertex_count; i++)
        r->soup.position[i] = turned(turn, r->soup.position[i]);
    assert_true(imprint_create(&r->soup, NULL, &imprint, NULL, &err));
    assert_true(polygons_check(&imprint.soup));
    r->surfaces = surfaces_create(&imprint.soup, NULL, &err);
    assert_non_null(r->surfaces);
    imprint_finish(&imprint, r->surfaces);
    assert_true(surfaces_check(r->surfaces));
    imprint_clear(&imprint);
    room_trace(r);
}

/* Solves and counts: patches for which `dark` holds at the point just off their centre, how many of
 * them get light, and how much light the others get at least somewhere. */
typedef struct {
    uint32_t dark, lit;     /* patches that must be dark, and those of them that are not */
    double   most, leak;    /* greatest irradiance elsewhere, and where there should be none */
    uint32_t vertices;      /* of dark patches that have a value */
} Leak;

typedef bool (*IsDark)(const void *context, Vec3 p);

static Leak solve_leak(TestRoom *r, const Turn *turn, double size, Vec3 eye, IsDark is_dark,
                       const void *context)
{
    Error err = { 0 };
    Leak leak = { 0 };
    const Vec3 at = turned(turn, eye);
    if (r->patches == NULL)
        room_finish(r, size, &(SidesOptions){ .eye = &at, .eye_count = 1 }, NULL, 0, NULL);
    else
        room_divide(r, size);
    assert_true(patches_check(r->patches, r->surfaces));
    /* Few rays: where no way is, a single one that finds it is a leak, and all patches cast. */
    Links *links = room_links(r, 16, CLOSURE_BOTH);
    double *emission, *reflectance;
    room_problem(r, &emission, &reflectance);
    const SolveProblem problem = { ROOM_BANDS, emission, reflectance, NULL };
    Solution *s = solve(links, &problem, &(SolveOptions){ .tolerance = 1e-5 }, NULL, &err);
    const size_t values = (size_t)r->patches->vertex_count * ROOM_BANDS;
    double *vertex = array_create(values, sizeof *vertex, "vertices", &err);
    assert_non_null(s);
    assert_true(vertex_radiosity(r->patches, links->area, ROOM_BANDS, s->radiosity, vertex, &err));
    const Patches *p = r->patches;
    for (uint32_t i = 0; i < p->count; i++) {
        const double light = s->irradiance[ROOM_BANDS * (size_t)i];
        const Vec3 off = vec3_mad(p->centre[i], 1e-4, p->normal[i]);
        if (!is_dark(context, turned_back(turn, off))) {
            leak.most = fmax(leak.most, light);
            continue;
        }
        leak.dark++;
        leak.lit += light > 0;
        leak.leak = fmax(leak.leak, light);
        for (uint32_t f = p->face_of[i]; f < p->face_count && p->face_patch[f] == i; f++)
            for (uint32_t k = p->first_corner[f]; k < p->first_corner[f + 1]; k++)
                leak.vertices += vertex[ROOM_BANDS * (size_t)p->corner[k]] > 0;
    }
    array_free(vertex);
    array_free(emission);
    array_free(reflectance);
    solution_destroy(s);
    links_destroy(links);
    return leak;
}

/* --- a box with a lamp in it ------------------------------------------------------------------ */

typedef enum { HOOD, HOOD_SUNK, SHELL, SLABS, BOX_KINDS } BoxKind;

typedef struct {
    Vec3 lo, hi; /* outside of the box */
} Outside;

static bool is_outside(const void *context, Vec3 p)
{
    const Outside *o = context;
    return p.x < o->lo.x || p.y < o->lo.y || p.x > o->hi.x || p.y > o->hi.y || p.z > o->hi.z;
}

static void add_slabs(TestRoom *r, Vec3 lo, Vec3 hi, double t, uint32_t wall)
{
    const Vec3 a = lo, b = hi;
    room_box(r, a, vec3(b.x, a.y + t, b.z - t), BOX_ALL, false, wall, "s0");
    room_box(r, vec3(a.x, b.y - t, a.z), vec3(b.x, b.y, b.z - t), BOX_ALL, false, wall, "s1");
    room_box(r, vec3(a.x, a.y + t, a.z), vec3(a.x + t, b.y - t, b.z - t), BOX_ALL, false, wall,
             "s2");
    room_box(r, vec3(b.x - t, a.y + t, a.z), vec3(b.x, b.y - t, b.z - t), BOX_ALL, false, wall,
             "s3");
    room_box(r, vec3(a.x, a.y, b.z - t), b, BOX_ALL, false, wall, "s4");
}

static Outside lamp_box(TestRoom *r, BoxKind kind, double t)
{
    const uint32_t wall = room_material(r, 0.7, 0), lamp = room_material(r, 0, 1000);
    const Vec3 lo = { 1.1, 1.37, 0 }, hi = { 2.03, 2.21, 0.9 };
    const double sunk = kind == HOOD_SUNK ? -0.013 : 0;
    const Vec3 in = { lo.x + t, lo.y + t, sunk }, top = { hi.x - t, hi.y - t, hi.z - t };
    room_box(r, ORIGIN, vec3(4, 3, 2.5), BOX_ALL, true, wall, "");
    if (kind == SLABS) {
        add_slabs(r, lo, hi, t, wall);
    } else {
        const int faces = kind == SHELL ? BOX_ALL : BOX_ALL - BOX_Z0;
        const double bottom = kind == SHELL ? t : sunk;
        room_box(r, vec3(lo.x, lo.y, sunk), hi, faces, false, wall, "o-");
        room_box(r, vec3(in.x, in.y, bottom), top, faces, true, wall, "i-");
    }
    room_quad(r, vec3(1.4, 1.6, 0.7), vec3(0, 0.3, 0), vec3(0.3, 0, 0), lamp, "lamp");
    return (Outside){ lo, hi };
}

/* Patches of each size in turn; the sides in use do not depend on it. */
static const double SIZES[2] = { 0.4, 1 };

static void check_box(BoxKind kind, double thickness, const Turn *turn)
{
    TestRoom r = { 0 };
    const Outside outside = lamp_box(&r, kind, thickness);
    connect(&r, turn);
    for (int k = 0; k < 2; k++) {
        const Leak leak = solve_leak(&r, turn, SIZES[k], vec3(0.3, 0.4, 1.5), is_outside,
                                     &outside);
        assert_true(leak.dark > 10);
        assert_true(leak.most > 10);
        if (leak.lit > 0 || leak.vertices > 0)
            fail_msg("box %d, wall %g, patches %g: %u of %u patches lit, up to %g; %u vertices",
                     kind, thickness, SIZES[k], leak.lit, leak.dark, leak.leak, leak.vertices);
    }
    room_clear(&r);
}

static void test_box(void **state)
{
    (void)state;
    const Turn odd = odd_turn(vec3(0.7, -2.1, 0.3));
    for (int kind = 0; kind < BOX_KINDS; kind++) {
        check_box(kind, 0.001, kind % 2 ? &STRAIGHT : &odd);
        check_box(kind, 0.1, kind % 2 ? &odd : &STRAIGHT);
    }
}

/* --- two rooms -------------------------------------------------------------------------------- */

static bool is_dark_room(const void *context, Vec3 p)
{
    (void)context;
    return p.x > 2;
}

/* One floor and one ceiling for both, a wall between them of no thickness or some, a table board
 * right through it. */
static void two_rooms(TestRoom *r, double thickness, bool board)
{
    const uint32_t wall = room_material(r, 0.7, 0), lamp = room_material(r, 0, 1000);
    room_box(r, ORIGIN, vec3(4, 3, 2.5), BOX_ALL, true, wall, "");
    if (thickness > 0)
        room_box(r, vec3(2 - thickness, 0, 0), vec3(2, 3, 2.5),
                 BOX_X0 + BOX_X1, false, wall, "w-");
    else
        room_quad(r, vec3(2, 0, 0), vec3(0, 3, 0), vec3(0, 0, 2.5), wall, "w-x0");
    if (board)
        room_box(r, vec3(1.3, 1.1, 0.7), vec3(2.6, 1.9, 0.75), BOX_ALL, false, wall, "b-");
    room_quad(r, vec3(0.7, 0.7, 2.3), vec3(0, 0.5, 0), vec3(0.5, 0, 0), lamp, "lamp");
}

static void check_rooms(double thickness, bool board, const Turn *turn)
{
    TestRoom r = { 0 };
    two_rooms(&r, thickness, board);
    connect(&r, turn);
    for (int k = 0; k < 2; k++) {
        const Leak leak = solve_leak(&r, turn, SIZES[k], vec3(3, 0.4, 1.5), is_dark_room, NULL);
        assert_true(leak.dark > 10);
        assert_true(leak.most > 10);
        if (leak.lit > 0 || leak.vertices > 0)
            fail_msg("wall %g, patches %g, board %d, turned %d: %u of %u patches lit, up to %g; "
                     "%u vertices", thickness, SIZES[k], board, turn != &STRAIGHT, leak.lit,
                     leak.dark, leak.leak, leak.vertices);
    }
    room_clear(&r);
}

static void test_rooms(void **state)
{
    (void)state;
    static const double thickness[] = { 0, 0.001, 0.1 };
    const Turn odd = odd_turn(vec3(0.7, -2.1, 0.3));
    for (int k = 0; k < 12; k++)
        check_rooms(thickness[k / 4], k & 2, k & 1 ? &odd : &STRAIGHT);
}

/* --- windings --------------------------------------------------------------------------------- */

enum { GROUPS = 32, SEEDS = 6 };

/* A room, a box that stands on its floor, a board through one of its walls, a lamp a hair below
 * the ceiling; bit k of `flip` turns face k round. */
static void flipped_room(TestRoom *r, uint32_t flip)
{
    const uint32_t wall = room_material(r, 0.6, 0);
    room_box(r, ORIGIN, vec3(2, 1.7, 1.5), BOX_ALL, true, wall, "");
    room_box(r, vec3(0.4, 0.5, 0), vec3(0.9, 0.9, 0.7), BOX_ALL, false, wall, "b-");
    room_box(r, vec3(1.4, 0.6, 0.5), vec3(2.1, 1, 0.55), BOX_ALL, false, wall, "s-");
    room_quad(r, vec3(0.9, 0.8, 1.499), vec3(0, 0.3, 0), vec3(0.3, 0, 0),
              room_material(r, 0, 100), "lamp");
    for (uint32_t k = 0; k < r->soup.polygon_count; k++)
        for (int i = 0; i < 2 && ((flip >> k) & 1); i++) {
            uint32_t *a = &r->soup.corner[r->soup.first[k]] + i, *b = a + 3 - 2 * i;
            const uint32_t swap = *a;
            *a = *b;
            *b = swap;
        }
}

/* Light that each group gets in all. */
static void group_light(uint32_t flip, uint32_t seed, double light[GROUPS])
{
    TestRoom r = { 0 };
    Error err = { 0 };
    const Vec3 eye = { 0.1, 0.1, 1 };
    flipped_room(&r, flip);
    connect(&r, &STRAIGHT);
    room_finish(&r, 0.25, &(SidesOptions){ .eye = &eye, .eye_count = 1 }, NULL, 0, NULL);
    const LinksOptions options = { .rays = 64, .seed = seed };
    Links *raw = links_create(&r.room, &options, NULL, &err);
    assert_non_null(raw);
    Links *links = links_close(raw, r.patches, CLOSURE_BOTH, 0, NULL, &err);
    assert_non_null(links);
    double *emission, *reflectance;
    room_problem(&r, &emission, &reflectance);
    const SolveProblem problem = { ROOM_BANDS, emission, reflectance, NULL };
    Solution *s = solve(links, &problem, &(SolveOptions){ .tolerance = 1e-6 }, NULL, &err);
    assert_non_null(s);
    assert_true(r.soup.group_count <= GROUPS);
    memset(light, 0, GROUPS * sizeof *light);
    for (uint32_t i = 0; i < r.patches->count; i++)
        light[r.patches->group[i]] += links->area[i] * s->irradiance[ROOM_BANDS * (size_t)i];
    array_free(emission);
    array_free(reflectance);
    solution_destroy(s);
    links_destroy(raw);
    links_destroy(links);
    room_clear(&r);
}

/* The same light whichever way faces are wound: no further from the mean of several seeds than
 * chance takes one seed. */
static void test_windings(void **state)
{
    (void)state;
    double mean[GROUPS] = { 0 }, spread[GROUPS] = { 0 }, light[SEEDS][GROUPS], all = 0;
    for (uint32_t k = 0; k < SEEDS; k++)
        group_light(0, k, light[k]);
    for (int g = 0; g < GROUPS; g++) {
        for (int k = 0; k < SEEDS; k++)
            mean[g] += light[k][g] / SEEDS;
        for (int k = 0; k < SEEDS; k++)
            spread[g] += pow(light[k][g] - mean[g], 2) / (SEEDS - 1);
        all += mean[g];
    }
    assert_true(all > 1);
    static const uint32_t flips[] = { 0x7FFFF, 0x2B5C9, 0x5A3D6, 0x40000 };
    for (size_t k = 0; k < sizeof flips / sizeof *flips; k++) {
        double flipped[GROUPS], off = 0, noise = 0;
        group_light(flips[k], 0, flipped);
        for (int g = 0; g < GROUPS; g++) {
            off += pow(flipped[g] - mean[g], 2);
            noise += spread[g];
        }
        /* Over these groups chance is within 3 deviations 997 times of 1000. */
        if (off > 9 * noise)
            fail_msg("faces %x turned: %g of the light elsewhere, noise %g", flips[k],
                     sqrt(off) / all, sqrt(noise) / all);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_box),
        cmocka_unit_test(test_rooms),
        cmocka_unit_test(test_windings),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
