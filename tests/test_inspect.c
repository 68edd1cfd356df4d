/* SPDX-License-Identifier: BSD-3-Clause */
/* Faces through each other and on each other, parts inside solids: meshes with known defects. */
#include "math/tolerance.h"
#include "tests/inspect_tools.h"

static void move_soup(Polygons *soup, size_t first, const Affine *map)
{
    for (size_t i = first; i < soup->vertex_count; i++)
        soup->position[i] = affine_point(map, soup->position[i]);
}

/* A turn about no axis of the scene, and a shift. */
static const Affine turned = { { 0.36, 0.48, -0.8 }, { -0.8, 0.6, 0 }, { 0.48, 0.64, 0.6 },
                               { 3.1, -2.2, 5.7 } };

static uint64_t crossings_of(Polygons *soup, uint64_t *overlaps)
{
    Inspected i;
    inspect_soup(&i, soup, NULL, NULL);
    const uint64_t count = i.defects.found[DEFECT_INTERSECTION];
    if (overlaps != NULL)
        *overlaps = i.defects.found[DEFECT_OVERLAP];
    assert_int_equal(i.found.hurried, 0);
    inspected_clear(&i);
    return count;
}

/* Each of three faces of one cube crosses two faces of the other. */
static void two_cubes(void **state)
{
    (void)state;
    for (int k = 0; k < 8; k++) {
        Polygons  soup;
        Inspected i;
        const Vec3 shift = vec3(k & 1 ? 0.5 : -0.25, k & 2 ? 0.3 : -0.75, k & 4 ? 0.6 : -0.4);
        soup_start(&soup);
        soup_block(&soup, cube, 0, 0);
        soup_box(&soup, shift, vec3_add(shift, vec3(1, 1, 1)), 0, 0);
        move_soup(&soup, 0, &turned);
        inspect_soup(&i, &soup, NULL, NULL);
        assert_int_equal(i.defects.found[DEFECT_INTERSECTION], 6);
        assert_int_equal(i.defects.repaired[DEFECT_INTERSECTION], 0);
        assert_int_equal(i.defects.found[DEFECT_OVERLAP], 0);
        for (size_t n = 0; n < 6; n++) {
            const Defect *d = inspected_defect(&i, DEFECT_INTERSECTION, n);
            assert_true(d->face < 6 && d->other >= 6 && d->other < 12);
            assert_true(d->measure > 0.05 && d->measure < 0.6);
            assert_true(n == 0 ||
                        d->measure <= inspected_defect(&i, DEFECT_INTERSECTION, n - 1)->measure);
        }
        inspected_clear(&i);
    }
}

/* A bar through one face of a cube, and right through it. */
static void bar_through_cube(void **state)
{
    (void)state;
    for (int through = 0; through < 2; through++) {
        Polygons soup;
        soup_start(&soup);
        soup_block(&soup, cube, 0, 0);
        soup_box(&soup, vec3(through ? -0.5 : 0.5, 0.4, 0.4), vec3(1.5, 0.6, 0.6), 0, 0);
        assert_int_equal(crossings_of(&soup, NULL), through ? 8 : 4);
    }
}

/* A box on a floor touches it; one sunk into it passes through, as deep as it is sunk. */
static void box_on_a_floor(void **state)
{
    (void)state;
    static const struct {
        double   sunk;
        uint64_t pairs;
    } cases[] = { { 0, 0 }, { -0.1, 0 }, { 1e-3, 4 }, { 0.2, 4 }, { 1e-7, 0 } };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        for (int away = 0; away < 2; away++) {
            Polygons  soup;
            Inspected i;
            const double z = -cases[k].sunk;
            soup_start(&soup);
            soup_polygon(&soup, (Vec3[]){ { -2, -2, 0 }, { 2, -2, 0 }, { 2, 2, 0 }, { -2, 2, 0 } },
                         4, 0, 0);
            soup_box(&soup, vec3(-0.4, -0.3, z), vec3(0.5, 0.6, z + 1), 0, 0);
            if (away)
                move_soup(&soup, 0, &turned);
            inspect_soup(&i, &soup, NULL, NULL);
            assert_int_equal(i.defects.found[DEFECT_INTERSECTION], cases[k].pairs);
            assert_int_equal(i.defects.found[DEFECT_OVERLAP], 0);
            if (cases[k].pairs > 0)
                assert_true(near(inspected_defect(&i, DEFECT_INTERSECTION, 0)->measure,
                                 cases[k].sunk, 1e-6));
            inspected_clear(&i);
        }
}

/* Walls that end at a wall, at an edge, or at a corner touch; one that goes on passes through. */
static void walls_that_meet(void **state)
{
    (void)state;
    static const struct {
        Vec3     o, a, b;
        uint64_t pairs;
    } cases[] = {
        { { 0, 1, 0 }, { 1, 0, 0 }, { 0, 0, 1 }, 0 },      /* ends on the middle of the wall */
        { { -0.5, 1, 0 }, { 1, 0, 0 }, { 0, 0, 1 }, 1 },   /* goes on */
        { { 0, 2, 0.5 }, { 1, 0, 0 }, { 0, 0, 1 }, 0 },    /* ends at its end */
        { { -0.5, 2, 0.5 }, { 1, 0, 0 }, { 0, 0, 1 }, 0 }, /* passes along its end */
        { { -0.5, 1, 1 }, { 1, 0, 0 }, { 0, 0.1, 1 }, 0 }, /* stands on its upper edge */
        { { -0.5, 1, 0.9 }, { 1, 0, 0 }, { 0, 0.1, 1 }, 1 },
        { { 0, 0, 1 }, { 1, 0, 0 }, { 0, 1, 0.5 }, 0 },    /* shares a corner */
        { { 0, 1, 0.2 }, { 1, 0.3, 0 }, { 0.2, 0, 1 }, 0 }, /* touches with a corner */
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        for (int away = 0; away < 2; away++) {
            const Vec3 o = cases[k].o, a = cases[k].a, b = cases[k].b;
            Polygons   soup;
            soup_start(&soup);
            soup_polygon(&soup, (Vec3[]){ { 0, 0, 0 }, { 0, 2, 0 }, { 0, 2, 1 }, { 0, 0, 1 } }, 4,
                         0, 0);
            soup_polygon(&soup, (Vec3[]){ o, vec3_add(o, a), vec3_add(vec3_add(o, a), b),
                                          vec3_add(o, b) }, 4, 0, 0);
            if (away)
                move_soup(&soup, 0, &turned);
            assert_int_equal(crossings_of(&soup, NULL), cases[k].pairs);
        }
}

/* What shares a corner may cross elsewhere. */
static void crossing_from_a_shared_corner(void **state)
{
    (void)state;
    for (int apart = 0; apart < 2; apart++) {
        const double y = apart ? 3 : 0;
        Polygons soup;
        soup_start(&soup);
        soup_polygon(&soup, (Vec3[]){ { 0, 0, 0 }, { 2, -1, 0 }, { 2, 1, 0 } }, 3, 0, 0);
        soup_polygon(&soup, (Vec3[]){ { 0, 0, 0 }, { 1, y, -1 }, { 1, y, 1 } }, 3, 0, 0);
        assert_int_equal(crossings_of(&soup, NULL), apart ? 0 : 1);
    }
}

/* --- in one plane ----------------------------------------------------------------------------- */

static void posters(void **state)
{
    (void)state;
    /* A square 0.5 wide on a wall of 2 x 2, on its border, beside it, and back to back with it. */
    static const struct {
        double   x, z;
        bool     turned_round;
        uint64_t overlaps;
        double   common;  /* radius of a circle in the common piece */
    } cases[] = { { 0.7, 0, false, 1, 0.25 }, { 1.75, 0, false, 1, 0.25 * 0.5 / 0.75 },
                  { 2, 0, false, 0, 0 },      { 0.7, 0, true, 0, 0 },
                  { 0.7, 1e-3, false, 0, 0 } };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const double x = cases[k].x, z = cases[k].z;
        Vec3 p[4] = { { x, 0.2, z }, { x + 0.5, 0.2, z }, { x + 0.5, 0.7, z }, { x, 0.7, z } };
        if (cases[k].turned_round) {
            const Vec3 second = p[1];
            p[1] = p[3];
            p[3] = second;
        }
        Polygons soup;
        uint64_t overlaps;
        soup_start(&soup);
        soup_polygon(&soup, (Vec3[]){ { 0, 0, 0 }, { 2, 0, 0 }, { 2, 2, 0 }, { 0, 2, 0 } }, 4, 0,
                     0);
        soup_polygon(&soup, p, 4, 0, 0);
        move_soup(&soup, 0, &turned);
        assert_int_equal(crossings_of(&soup, &overlaps), 0);
        assert_int_equal(overlaps, cases[k].overlaps);
    }
}

/* Where sight is known it decides: what is used from one side only may lie on what is used from
 * the other. */
static void posters_in_sight(void **state)
{
    (void)state;
    static const struct {
        uint8_t  sides[3];
        uint64_t overlaps;
    } cases[] = { { { 1, 1, 0 }, 1 }, { { 1, 2, 0 }, 0 }, { { 2, 3, 1 }, 1 }, { { 1, 0, 1 }, 0 } };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        Polygons  soup;
        Inspected i;
        soup_start(&soup);
        soup_polygon(&soup, (Vec3[]){ { 0, 0, 0 }, { 2, 0, 0 }, { 2, 2, 0 }, { 0, 2, 0 } }, 4, 0,
                     0);
        soup_polygon(&soup, (Vec3[]){ { 1, 1, 0 }, { 1.5, 1, 0 }, { 1.5, 1.5, 0 }, { 1, 1.5, 0 } },
                     4, 0, 0);
        soup_polygon(&soup, (Vec3[]){ { 9, 0, 0 }, { 9, 1, 0 }, { 9, 0, 1 } }, 3, 0, 0);
        inspect_soup(&i, &soup, NULL, cases[k].sides);
        assert_int_equal(i.defects.found[DEFECT_OVERLAP], cases[k].overlaps);
        inspected_clear(&i);
    }
}

/* A sheet folded flat onto itself lies on itself; folded back a little, it does not. */
static void folded_sheet(void **state)
{
    (void)state;
    for (int flat = 0; flat < 2; flat++) {
        Polygons soup;
        uint64_t overlaps;
        const double z = flat ? 0 : 0.1;
        soup_start(&soup);
        soup_polygon(&soup, (Vec3[]){ { 0, 0, 0 }, { 2, 0, 0 }, { 1, 1, 0 } }, 3, 0, 0);
        soup_polygon(&soup, (Vec3[]){ { 0, 0, 0 }, { 2, 0, 0 }, { 1, 0.5, z } }, 3, 0, 0);
        assert_int_equal(crossings_of(&soup, &overlaps), 0);
        assert_true(overlaps <= 1);
    }
}

/* --- against every pair ----------------------------------------------------------------------- */

static double volume(Vec3 a, Vec3 b, Vec3 c, Vec3 d)
{
    return vec3_dot(vec3_sub(b, a), vec3_cross(vec3_sub(c, a), vec3_sub(d, a)));
}

static bool segment_cuts(Vec3 p, Vec3 q, const Vec3 t[3])
{
    if (volume(t[0], t[1], t[2], p) * volume(t[0], t[1], t[2], q) >= 0)
        return false;
    const double a = volume(p, q, t[0], t[1]), b = volume(p, q, t[1], t[2]);
    const double c = volume(p, q, t[2], t[0]);
    return (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0);
}

static bool triangles_cut(const Vec3 a[3], const Vec3 b[3])
{
    for (int k = 0; k < 3; k++)
        if (segment_cuts(a[k], a[(k + 1) % 3], b) || segment_cuts(b[k], b[(k + 1) % 3], a))
            return true;
    return false;
}

static double random_unit(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (*state >> 8) * 0x1p-24;
}

static void random_triangles(void **state)
{
    (void)state;
    enum { N = 400 };
    static Vec3 p[N][3];
    Polygons    soup;
    uint32_t    seed = 7;
    uint64_t    expected = 0;
    soup_start(&soup);
    for (int i = 0; i < N; i++) {
        const double size = 0.1 + (i % 7 == 0) * 0.9;
        Vec3         o = vec3(random_unit(&seed), random_unit(&seed), random_unit(&seed));
        for (int k = 0; k < 3; k++)
            p[i][k] = vec3_add(o, vec3(size * random_unit(&seed), size * random_unit(&seed),
                                       size * random_unit(&seed)));
        soup_polygon(&soup, p[i], 3, 0, 0);
        for (int j = 0; j < i; j++)
            expected += triangles_cut(p[i], p[j]);
    }
    assert_true(expected > 100);
    assert_int_equal(crossings_of(&soup, NULL), expected);
}

/* Thousands of triangles that all pass through one point: cut short, and told. */
static void heap_of_triangles(void **state)
{
    (void)state;
    enum { N = 3000 };
    Polygons  soup;
    Inspected i;
    uint32_t  seed = 1;
    soup_start(&soup);
    for (int k = 0; k < N; k++) {
        const Vec3 d = vec3_unit(vec3(random_unit(&seed) - 0.5, random_unit(&seed) - 0.5,
                                      random_unit(&seed) - 0.5));
        Vec3 s, t;
        vec3_frame(d, &s, &t);
        soup_polygon(&soup, (Vec3[]){ s, vec3_mad(vec3_scale(s, -0.5), 0.87, t),
                                      vec3_mad(vec3_scale(s, -0.5), -0.87, t) }, 3, 0, 0);
    }
    inspect_soup(&i, &soup, NULL, NULL);
    assert_true(i.found.hurried > N / 2);
    assert_true(i.defects.found[DEFECT_INTERSECTION] > N);
    assert_true(i.defects.found[DEFECT_INTERSECTION] <= 16 * N);
    inspected_clear(&i);
}

/* Each allocation fails in turn: told, and nothing is left behind. */
static void memory_runs_out(void **state)
{
    (void)state;
    Polygons   soup;
    Inspection found;
    long       allowed = 0;
    soup_start(&soup);
    soup_block(&soup, cube, 5, 1);
    soup_box(&soup, vec3(0.5, 0.5, 0.5), vec3(1.5, 1.5, 1.5), 0, 0);
    soup_box(&soup, vec3(0.6, 0.6, 0.6), vec3(0.7, 0.7, 0.7), 0, 0);
    Surfaces  *s = connect(&soup);
    const long before = array_live();
    for (bool done = false; !done; allowed++) {
        Error   err = { 0 };
        Defects list = { 0 };
        array_fail_after(allowed);
        done = inspect(s, &(InspectOptions){ .threads = 1 }, &list, &found, NULL, &err);
        array_fail_after(-1);
        assert_int_equal(err.code, done ? ERROR_NONE : ERROR_MEMORY);
        defects_clear(&list);
        if (done)
            inspection_clear(&found);
        assert_int_equal(array_live(), before);
    }
    assert_true(allowed > 20);
    surfaces_destroy(s);
    polygons_clear(&soup);
}

/* The same list for any number of threads. */
static void any_number_of_threads(void **state)
{
    (void)state;
    enum { N = 2000 };
    Polygons   soup;
    Error      err = { 0 };
    uint32_t   seed = 5;
    Defects    list[2] = { { 0 }, { 0 } };
    Inspection found;
    soup_start(&soup);
    for (int k = 0; k < N; k++) {
        Vec3 p[3];
        for (int c = 0; c < 3; c++)
            p[c] = vec3((k % 100 + 2 * random_unit(&seed)) / 100, random_unit(&seed),
                        random_unit(&seed));
        soup_polygon(&soup, p, 3, 0, 0);
    }
    Surfaces *s = connect(&soup);
    for (unsigned t = 0; t < 2; t++) {
        const InspectOptions options = { .threads = t == 0 ? 1 : 5 };
        assert_true(inspect(s, &options, &list[t], &found, NULL, &err));
        inspection_clear(&found);
    }
    assert_true(list[0].found[DEFECT_INTERSECTION] > N);
    assert_int_equal(list[0].count, list[1].count);
    for (size_t i = 0; i < list[0].count; i++) {
        const Defect *a = &list[0].item[i], *b = &list[1].item[i];
        assert_int_equal(a->kind, b->kind);
        assert_int_equal(a->face, b->face);
        assert_int_equal(a->other, b->other);
        assert_true(a->measure == b->measure && a->at.x == b->at.x);
    }
    for (int t = 0; t < 2; t++)
        defects_clear(&list[t]);
    surfaces_destroy(s);
    polygons_clear(&soup);
}

/* --- parts ------------------------------------------------------------------------------------ */

/* A cube in a cube on a wide floor. Without sight, fronts tell solids from rooms. */
static void cube_in_cube(void **state)
{
    (void)state;
    for (int room = 0; room < 2; room++)
        for (int inside = 0; inside < 2; inside++) {
            Polygons  soup;
            Inspected i;
            const double x = inside ? 0.3 : 1.3;
            Vec3 p[8];
            for (int k = 0; k < 8; k++)
                p[k] = cube[room ? (k + 4) % 8 : k];
            soup_start(&soup);
            soup_polygon(&soup, (Vec3[]){ { -4, -4, -1 }, { 4, -4, -1 }, { 4, 4, -1 },
                                          { -4, 4, -1 } }, 4, 0, 0);
            soup_block(&soup, p, 0, 0);
            soup_box(&soup, vec3(x, 0.3, 0.3), vec3(x + 0.4, 0.7, 0.7), 0, 0);
            move_soup(&soup, 0, &turned);
            inspect_soup(&i, &soup, NULL, NULL);
            assert_int_equal(i.surfaces->part_count, 3);
            assert_int_equal(i.defects.found[DEFECT_INSIDE_SOLID], inside && !room);
            assert_int_equal(i.found.closed_parts, 2);
            assert_int_equal(i.defects.found[DEFECT_INTERSECTION], 0);
            if (i.defects.found[DEFECT_INSIDE_SOLID] > 0) {
                const Defect *d = inspected_defect(&i, DEFECT_INSIDE_SOLID, 0);
                assert_true(d->face >= 7 && d->other >= 1 && d->other < 7);
                /* Its box is turned: at least the diagonal, at most three edges. */
                assert_true(d->measure > 0.4 * sqrt(3) - 1e-12 && d->measure < 0.4 * 3);
            }
            inspected_clear(&i);
        }
}

/* With sight: what light reaches is not buried, and what light is inside of is no solid. */
static void cube_in_cube_in_sight(void **state)
{
    (void)state;
    static const struct {
        uint8_t  outer, inner;
        uint64_t buried;
    } cases[] = { { 1, 0, 1 }, { 1, 1, 0 }, { 3, 0, 0 }, { 2, 0, 0 } };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        Polygons  soup;
        Inspected i;
        uint8_t   sides[12];
        memset(sides, cases[k].outer, 6);
        memset(sides + 6, cases[k].inner, 6);
        soup_start(&soup);
        soup_block(&soup, cube, 0, 0);
        soup_box(&soup, vec3(0.3, 0.3, 0.3), vec3(0.4, 0.7, 0.7), 0, 0);
        inspect_soup(&i, &soup, NULL, sides);
        assert_int_equal(i.defects.found[DEFECT_INSIDE_SOLID], cases[k].buried);
        assert_int_equal(i.found.hidden, cases[k].inner == 0 ? 6 : 0);
        inspected_clear(&i);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_cubes),         cmocka_unit_test(bar_through_cube),
        cmocka_unit_test(box_on_a_floor),    cmocka_unit_test(walls_that_meet),
        cmocka_unit_test(crossing_from_a_shared_corner),
        cmocka_unit_test(posters),           cmocka_unit_test(posters_in_sight),
        cmocka_unit_test(folded_sheet),      cmocka_unit_test(random_triangles),
        cmocka_unit_test(heap_of_triangles), cmocka_unit_test(any_number_of_threads),
        cmocka_unit_test(memory_runs_out),   cmocka_unit_test(cube_in_cube),
        cmocka_unit_test(cube_in_cube_in_sight),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
