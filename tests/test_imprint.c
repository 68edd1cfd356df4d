/* SPDX-License-Identifier: BSD-3-Clause */
/* Faces cut along the lines where others stand on them: known pieces, no area lost, whatever is
 * not concerned left as it was. */
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

/* Sums of a few hundred terms, each rounded. */
static bool is_near(double a, double b)
{
    return fabs(a - b) <= rounding_bound(1000) * fabs(b);
}

static Imprint imprinted(const TestRoom *r, uint32_t most)
{
    Error err = { 0 };
    Imprint im;
    assert_true(imprint_create(&r->soup, &(ImprintOptions){ .most = most }, &im, NULL, &err));
    assert_true(polygons_check(&im.soup));
    assert_int_equal(im.original, r->soup.polygon_count);
    assert_int_equal(im.soup.polygon_count, im.soup.origin_first + im.pieces);
    assert_in_range(im.soup.origin_first, 1, im.original);
    for (size_t i = 0; i < im.soup.origin_first; i++)
        assert_in_range(im.face[i], i == 0 ? 0 : im.face[i - 1] + 1, im.original - 1);
    return im;
}

static double polygon_size(const Polygons *soup, size_t i)
{
    Vec3 sum = { 0 };
    const Vec3 o = soup->position[soup->corner[soup->first[i]]];
    for (uint32_t k = soup->first[i] + 1; k + 1 < soup->first[i + 1]; k++)
        sum = vec3_add(sum, vec3_cross(vec3_sub(soup->position[soup->corner[k]], o),
                                       vec3_sub(soup->position[soup->corner[k + 1]], o)));
    return vec3_length(sum) / 2;
}

/* Pieces of a face of the original, and their area in all. */
static uint32_t pieces_of(const Imprint *im, uint32_t face, double *area)
{
    uint32_t count = 0;
    *area = 0;
    for (size_t i = 0; i < im->soup.polygon_count; i++)
        if (im->face[i] == face) {
            *area += polygon_size(&im->soup, i);
            count++;
        }
    return count;
}

/* Nothing is cut where faces meet at their borders only, or not at all. */
static void test_untouched(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    const uint32_t wall = room_material(&r, 0.5, 0);
    room_box(&r, ORIGIN, vec3(4, 3, 2), BOX_ALL, true, wall, "");
    room_box(&r, vec3(1, 1, 0.5), vec3(2, 2, 1), BOX_ALL, false, wall, "b-"); /* in the air */
    Imprint im = imprinted(&r, 0);
    assert_int_equal(im.pieces, 0);
    assert_int_equal(im.cut, 0);
    assert_int_equal(im.soup.vertex_count, r.soup.vertex_count);
    imprint_clear(&im);
    room_clear(&r);
}

/* A box on the floor cuts it into nine: its four lines go on to the walls. */
static void test_box_on_floor(void **state)
{
    (void)state;
    static const double sunk[] = { 0, -0.1 };
    for (int k = 0; k < 2; k++) {
        TestRoom r = { 0 };
        const uint32_t wall = room_material(&r, 0.5, 0);
        room_quad(&r, ORIGIN, vec3(4, 0, 0), vec3(0, 3, 0), wall, "floor");
        room_box(&r, vec3(1, 1, sunk[k]), vec3(2, 2, 1), BOX_ALL - BOX_Z0, false, wall, "b-");
        Imprint im = imprinted(&r, 0);
        double area;
        assert_int_equal(pieces_of(&im, 0, &area), 9);
        assert_true(is_near(area, 12));
        /* Sunk, the box's sides are cut by the floor; else not. */
        for (uint32_t side = 1; side < 5; side++) {
            assert_int_equal(pieces_of(&im, side, &area), k == 0 ? 1 : 2);
            assert_true(is_near(area, 1 - sunk[k]));
        }
        imprint_clear(&im);
        room_clear(&r);
    }
}

/* A wall that ends in the middle: the edges under it are marked, those beyond are not, and surfaces
 * are no neighbours across the former. */
static void test_wall_end(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    Error err = { 0 };
    const uint32_t wall = room_material(&r, 0.5, 0);
    room_quad(&r, ORIGIN, vec3(4, 0, 0), vec3(0, 3, 0), wall, "floor");
    room_quad(&r, vec3(1, 0, 0), vec3(0, 2, 0), vec3(0, 0, 1), wall, "wall");
    Imprint im = imprinted(&r, 0);
    double area, marked = 0;
    assert_int_equal(pieces_of(&im, 0, &area), 4);
    assert_true(is_near(area, 12));
    for (size_t i = 0; i < im.soup.polygon_count; i++)
        for (uint32_t k = im.soup.first[i]; im.face[i] == 0 && k < im.soup.first[i + 1]; k++) {
            const uint32_t next = k + 1 < im.soup.first[i + 1] ? k + 1 : im.soup.first[i];
            if (im.soup.contact[k])
                marked += vec3_length(vec3_sub(im.soup.position[im.soup.corner[next]],
                                               im.soup.position[im.soup.corner[k]]));
        }
    assert_true(is_near(marked, 2 * 2)); /* from both sides */
    Surfaces *s = surfaces_create(&im.soup, NULL, &err);
    assert_non_null(s);
    imprint_finish(&im, s);
    assert_true(surfaces_check(s));
    uint32_t floors = 0, links = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        assert_true(s->surface[i].face < 2);
        floors += s->surface[i].face == 0;
        for (int k = 0; k < 4 && s->surface[i].face == 0; k++)
            links += s->surface[i].neighbour[k] != SURFACE_NONE;
    }
    assert_int_equal(floors, 4);
    assert_int_equal(links, 6); /* four pieces, three of their four borders, from both sides */
    surfaces_destroy(s);
    imprint_clear(&im);
    room_clear(&r);
}

/* A lamp in the plane of the ceiling, whichever way it is wound: the ceiling gives way to it. */
static void test_lamp_in_plane(void **state)
{
    (void)state;
    for (int up = 0; up < 2; up++) {
        TestRoom r = { 0 };
        const uint32_t wall = room_material(&r, 0.5, 0), lamp = room_material(&r, 0, 1);
        const Vec3 x = { 1, 0, 0 }, y = { 0, 1, 0 };
        room_quad(&r, vec3(0, 0, 2), vec3(0, 3, 0), vec3(4, 0, 0), wall, "ceiling");
        room_quad(&r, vec3(1, 1, 2), up ? x : y, up ? y : x, lamp, "lamp");
        Imprint im = imprinted(&r, 0);
        double area;
        assert_int_equal(pieces_of(&im, 0, &area), 8);
        assert_true(is_near(area, 11));
        assert_int_equal(pieces_of(&im, 1, &area), 1);
        assert_true(is_near(area, 1));
        assert_int_equal(im.covered, 1);
        assert_int_equal(im.overlapped, 0);
        imprint_clear(&im);
        room_clear(&r);
    }
}

/* A lamp that is a box against a wall, at its front or at its back: the wall stays whole, and the
 * side of the box that lies in it is left out, as nothing sees it. */
static void test_lamp_body(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        TestRoom r = { 0 };
        const uint32_t wall = room_material(&r, 0.5, 0), lamp = room_material(&r, 0, 1);
        const Vec3 x = { 4, 0, 0 }, y = { 0, 3, 0 };
        room_quad(&r, vec3(0, 0, 2), k & 1 ? x : y, k & 1 ? y : x, wall, "wall");
        const double z = k & 2 ? 2 : 1.5;
        room_box(&r, vec3(1, 1, z), vec3(2, 2, z + 0.5), BOX_ALL, false, lamp, "lamp-");
        Imprint im = imprinted(&r, 0);
        double area;
        pieces_of(&im, 0, &area);
        assert_true(is_near(area, 12));
        double lit = 0;
        for (uint32_t i = 1; i <= 6; i++) {
            pieces_of(&im, i, &area);
            lit += area;
        }
        assert_true(is_near(lit, 3)); /* four sides of 0.5 and the one that is free */
        assert_int_equal(im.soup.origin_first, 6);
        assert_int_equal(im.covered, 1);
        imprint_clear(&im);
        room_clear(&r);
    }
}

/* Lamps that are boxes at the ceiling of a room, below it or sunk into it with their bottoms in its
 * plane, whichever way lamp and room are wound: only the sunk one opens the ceiling. A room above
 * that one keeps the ceiling whole. */
static void test_lamp_body_in_room(void **state)
{
    (void)state;
    for (int k = 0; k < 16; k++) {
        TestRoom r = { 0 };
        const uint32_t wall = room_material(&r, 0.5, 0), lamp = room_material(&r, 0, 1);
        const bool sunk = k & 1, upstairs = k & 8;
        const double z = sunk ? 2 : 1.5;
        double ceiling, lit = 0, area;
        room_box(&r, ORIGIN, vec3(4, 3, 2), BOX_ALL, (k & 2) != 0, wall, "");
        room_box(&r, vec3(1, 1, z), vec3(2, 2, z + 0.5), BOX_ALL, (k & 4) != 0, lamp, "lamp-");
        if (upstairs)
            room_box(&r, vec3(0, 0, 2), vec3(4, 3, 4), BOX_ALL - BOX_Z0, true, wall, "up-");
        Imprint im = imprinted(&r, 0);
        pieces_of(&im, 5, &ceiling);
        for (uint32_t i = 6; i < 12; i++) {
            pieces_of(&im, i, &area);
            lit += area;
        }
        const bool opens = sunk && !upstairs;
        assert_true(is_near(ceiling, opens ? 11 : 12));
        assert_true(is_near(lit, opens ? 4 : 3));
        imprint_clear(&im);
        room_clear(&r);
    }
}

/* A bent sheet of which one half lies on the floor: its back is closed there, and open at the other
 * half; the two may share no patch. Likewise a wall that stands below the fold of one. */
static void test_bent_sheet(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++) {
        TestRoom r = { 0 };
        Error err = { 0 };
        const uint32_t wall = room_material(&r, 0.5, 0);
        const double z = k == 0 ? 0 : 0.3;
        const Vec3 bent[4] = { { 1, 1, z }, { 3, 1, z }, { 3, 3, z + 0.5 }, { 1, 3, z } };
        uint32_t corner[4], group;
        double area;
        room_quad(&r, ORIGIN, vec3(4, 0, 0), vec3(0, 4, 0), wall, "floor");
        for (int i = 0; i < 4; i++)
            assert_true(polygons_add_vertex(&r.soup, bent[i], &corner[i], &err));
        assert_true(polygons_add_group(&r.soup, "bent", &group, &err));
        assert_true(polygons_add_polygon(&r.soup, corner, 4, wall, group, &err));
        if (k == 1)
            room_quad(&r, vec3(3, 1, 0), vec3(-2, 2, 0), vec3(0, 0, z), wall, "below");
        Imprint im = imprinted(&r, 0);
        assert_int_equal(pieces_of(&im, 1, &area), k == 2 ? 1 : 2);
        pieces_of(&im, 0, &area);
        assert_true(is_near(area, k == 0 ? 16 - 2 : 16));
        imprint_clear(&im);
        room_clear(&r);
    }
}

/* A floor under others of the same area in all, and under one that equals it: one layer stays. */
static void test_covered_altogether(void **state)
{
    (void)state;
    for (int halves = 1; halves <= 2; halves++) {
        TestRoom r = { 0 };
        const uint32_t wall = room_material(&r, 0.5, 0);
        const double w = 4.0 / halves;
        double area, sum = 0;
        room_quad(&r, ORIGIN, vec3(4, 0, 0), vec3(0, 3, 0), wall, "floor");
        for (int i = 0; i < halves; i++)
            room_quad(&r, vec3(i * w, 0, 0), vec3(w, 0, 0), vec3(0, 3, 0), wall, "half");
        Imprint im = imprinted(&r, 0);
        for (uint32_t i = 0; i <= (uint32_t)halves; i++) {
            pieces_of(&im, i, &area);
            assert_true(i == 0 ? halves == 1 || area == 0 : halves == 2 || area == 0);
            sum += area;
        }
        assert_true(is_near(sum, 12));
        assert_int_equal(im.covered, 1);
        assert_int_equal(im.overlapped, 1);
        assert_int_equal(im.soup.polygon_count, halves);
        imprint_clear(&im);
        room_clear(&r);
    }
}

/* Decals in a floor, with few pieces and with many: what is left of the floor and the decals are
 * never less than the floor, and equal to it when nothing was left uncut. */
static void test_decals(void **state)
{
    (void)state;
    static const uint32_t most[] = { 4, 100, 400, 20000 };
    for (int k = 0; k < 4; k++) {
        TestRoom r = { 0 };
        const uint32_t wall = room_material(&r, 0.5, 0);
        const double w = 0.1;
        double area, cover = 0;
        room_quad(&r, ORIGIN, vec3(4, 0, 0), vec3(0, 4, 0), wall, "floor");
        for (int i = 0; i < 144; i++) {
            const double x = 0.05 + 0.33 * (i % 12) + 0.011 * (i / 12);
            const double y = 0.05 + 0.33 * (i / 12) + 0.013 * (i % 12);
            room_quad(&r, vec3(x, y, 0), vec3(w, 0, 0), vec3(0, w, 0), wall, "decal");
            cover += w * w;
        }
        Imprint im = imprinted(&r, most[k]);
        pieces_of(&im, 0, &area);
        assert_true(is_near(area + im.covered_area, 16));
        assert_true(im.covered_area <= cover * (1 + rounding_bound(1000)));
        if (k == 3)
            assert_true(is_near(im.covered_area, cover));
        for (uint32_t i = 1; i <= 144; i++) {
            pieces_of(&im, i, &area);
            assert_true(is_near(area, w * w));
        }
        imprint_clear(&im);
        room_clear(&r);
    }
}

/* A concave floor, a wall through a carpet, hundreds of legs: no area is lost, and pieces meet
 * corner to corner. */
static void test_many(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    Error err = { 0 };
    const uint32_t wall = room_material(&r, 0.5, 0);
    const Vec3 outline[6] = { { 0, 0, 0 }, { 6, 0, 0 }, { 6, 2, 0 }, { 3, 2, 0 }, { 3, 5, 0 },
                              { 0, 5, 0 } };
    uint32_t corner[6], group = 0;
    for (int k = 0; k < 6; k++)
        assert_true(polygons_add_vertex(&r.soup, outline[k], &corner[k], &err));
    assert_true(polygons_add_group(&r.soup, "floor", &group, &err));
    assert_true(polygons_add_polygon(&r.soup, corner, 6, wall, group, &err));
    for (int k = 0; k < 100; k++) {
        const double x = 0.2 + 0.26 * (k % 10), y = 0.3 + 0.41 * (k / 10) + 0.013 * (k % 10);
        room_box(&r, vec3(x, y, 0), vec3(x + 0.05, y + 0.07, 0.5), BOX_ALL - BOX_Z0, false, wall,
                 "leg-");
    }
    Imprint im = imprinted(&r, 0);
    double area;
    assert_true(pieces_of(&im, 0, &area) > 100);
    assert_true(is_near(area, 6 * 2 + 3 * 3));
    Surfaces *s = surfaces_create(&im.soup, NULL, &err);
    assert_non_null(s);
    imprint_finish(&im, s);
    assert_true(surfaces_check(s));
    assert_int_equal(s->repairs.stitched, 0);
    surfaces_destroy(s);
    const uint32_t all = im.pieces;
    imprint_clear(&im);
    im = imprinted(&r, 20); /* not that many: the face is cut as far as that goes */
    assert_true(im.pieces < all);
    pieces_of(&im, 0, &area);
    assert_true(is_near(area, 6 * 2 + 3 * 3));
    imprint_clear(&im);
    room_clear(&r);
}

/* A floor with a box on it and a poster, and one more floor below all of it. */
static void lay_floor(TestRoom *r)
{
    const uint32_t wall = room_material(r, 0.5, 0), other = room_material(r, 0.4, 0);
    room_quad(r, ORIGIN, vec3(4, 0, 0), vec3(0, 3, 0), wall, "floor");
    room_box(r, vec3(1, 1, 0), vec3(2, 2, 1), BOX_ALL - BOX_Z0, false, wall, "b-");
    room_quad(r, vec3(3, 1, 0), vec3(0.5, 0, 0), vec3(0, 0.5, 0), other, "poster");
    room_quad(r, vec3(3, 1, 0), vec3(0.25, 0, 0), vec3(0, 0.5, 0), other, "half");
    room_quad(r, vec3(3.25, 1, 0), vec3(0.25, 0, 0), vec3(0, 0.5, 0), other, "half");
    room_quad(r, ORIGIN, vec3(4, 0, 0), vec3(0, 3, 0), other, "again");
}

/* Each of the two things that are done can be left, and what is done is listed. */
static void test_switched_off(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        TestRoom r = { 0 };
        Defects found = { 0 };
        Error err = { 0 };
        Imprint im;
        double area, sum = 0;
        const bool whole = k & 1, covered = k & 2;
        lay_floor(&r);
        assert_true(imprint_create(&r.soup, &(ImprintOptions){ .keep_whole = whole,
                                                               .keep_covered = covered,
                                                               .defects = &found },
                                   &im, NULL, &err));
        const uint32_t floor = pieces_of(&im, 0, &area);
        assert_true(is_near(area, covered ? 12 : 12 - 0.25));
        assert_int_equal(floor > 1, !whole || !covered);
        for (uint32_t i = 6; i < 10; i++) {
            pieces_of(&im, i, &area);
            sum += area;
        }
        assert_true(is_near(sum, covered ? 12 + 2 * 0.25 : 0.25));
        assert_int_equal(found.found[DEFECT_COVERED], covered ? 0 : 1); /* "again" is a duplicate */
        assert_int_equal(found.found[DEFECT_COVERED_PART], covered ? 0 : 1);
        assert_int_equal(im.covered, covered ? 0 : 3);
        assert_int_equal(im.replaced, covered ? 0 : 1);
        /* The box cuts both floors, which are the same; its own faces are touched at borders. */
        assert_int_equal(found.found[DEFECT_CUT], covered && !whole ? 3 : 0);
        for (size_t i = 0; i < found.count; i++) {
            const Defect *d = &found.item[i];
            assert_true(d->repaired);
            if (d->kind == DEFECT_COVERED_PART)
                assert_true(d->face == 0 && is_near(d->measure, 0.25) && d->at.x > 3);
            if (d->kind == DEFECT_COVERED)
                assert_true(d->face == 6 && is_near(d->measure, 0.25));
        }
        defects_clear(&found);
        imprint_clear(&im);
        room_clear(&r);
    }
}

/* A rug in the floor's plane of a closed room, wound up and down, in rooms wound inwards and
 * outwards: the rug stays, to be seen, and the floor gives way. */
static void test_rug(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        TestRoom r = { 0 };
        const bool inward = k & 1, up = k & 2;
        const uint32_t wall = room_material(&r, 0.7, 0), dark = room_material(&r, 0.05, 0);
        double area, all = 0;
        room_box(&r, ORIGIN, vec3(4, 4, 3), BOX_ALL, inward, wall, "room-");
        room_quad(&r, vec3(1, 1, 0), up ? vec3(2, 0, 0) : vec3(0, 2, 0),
                  up ? vec3(0, 2, 0) : vec3(2, 0, 0), dark, "rug");
        Imprint im = imprinted(&r, 0);
        assert_int_equal(pieces_of(&im, 6, &area), 1);
        assert_true(is_near(area, 4));
        for (uint32_t i = 0; i < 6; i++) {
            pieces_of(&im, i, &area);
            all += area;
        }
        assert_true(is_near(all, 80 - 4));
        assert_int_equal(im.covered, 1);
        assert_int_equal(im.overlapped, 1);
        imprint_clear(&im);
        room_clear(&r);
    }
}

/* An open bin on the floor, whichever way either is wound: its bottom stays where the two look the
 * same way, or it would not be seen from within; a box that is closed leaves the floor alone. A
 * floor wound downwards has the bin at its back: each keeps its own side. */
static void test_bin(void **state)
{
    (void)state;
    for (int k = 0; k < 8; k++) {
        TestRoom r = { 0 };
        const bool inward = k & 1, bin_inward = k & 2, lid = k & 4;
        const uint32_t wall = room_material(&r, 0.7, 0), dark = room_material(&r, 0.05, 0);
        double area, room = 0, bin = 0;
        room_box(&r, ORIGIN, vec3(4, 4, 3), BOX_ALL, inward, wall, "room-");
        room_box(&r, vec3(1, 1, 0), vec3(3, 3, 1), lid ? BOX_ALL : BOX_ALL - BOX_Z1, bin_inward,
                 dark, "bin-");
        Imprint im = imprinted(&r, 0);
        for (uint32_t i = 0; i < im.original; i++) {
            pieces_of(&im, i, &area);
            *(i < 6 ? &room : &bin) += area;
        }
        const bool same_way = inward == bin_inward;
        const bool gives_way = same_way || (inward && !lid);
        assert_true(is_near(room, gives_way ? 80 - 4 : 80));
        assert_true(is_near(bin, lid ? 16 : 12));
        assert_int_equal(im.covered, gives_way);
        imprint_clear(&im);
        room_clear(&r);
    }
}

/* A lamp and a dark sheet with the same corners, opposite ways: a plate, in whichever order. The
 * same lamp exactly on a ceiling is none: the ceiling gives way. */
static void test_lit_plate(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        TestRoom r = { 0 };
        const bool lamp_first = k & 1, ceiling = k & 2;
        const uint32_t wall = room_material(&r, 0.7, 0), lamp = room_material(&r, 0.5, 10);
        const Vec3 at = ceiling ? vec3(0, 0, 3) : vec3(1, 1, 2);
        const double side = ceiling ? 4 : 1;
        const Vec3 u = vec3(side, 0, 0), v = vec3(0, side, 0);
        double area[2];
        room_box(&r, ORIGIN, vec3(4, 4, 3), ceiling ? BOX_ALL - BOX_Z1 : BOX_ALL, true, wall, "");
        const uint32_t first = (uint32_t)r.soup.polygon_count;
        room_quad(&r, at, u, v, lamp_first ? lamp : wall, "one");
        room_quad(&r, at, v, u, lamp_first ? wall : lamp, "two");
        Imprint im = imprinted(&r, 0);
        pieces_of(&im, first, &area[0]);
        pieces_of(&im, first + 1, &area[1]);
        assert_true(is_near(area[lamp_first ? 0 : 1], side * side));
        assert_true(is_near(area[lamp_first ? 1 : 0], ceiling ? 0 : side * side));
        assert_int_equal(im.replaced, ceiling);
        imprint_clear(&im);
        room_clear(&r);
    }
}

static void test_memory(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    const uint32_t wall = room_material(&r, 0.5, 0);
    room_box(&r, ORIGIN, vec3(4, 3, 2), BOX_ALL, true, wall, "");
    room_box(&r, vec3(1, 1, 0), vec3(2, 2, 1), BOX_ALL - BOX_Z0, false, wall, "b-");
    const long before = array_live();
    bool made = false;
    for (long n = 0; n < 500 && !made; n++) {
        Error err = { 0 };
        Imprint im;
        array_fail_after(n);
        made = imprint_create(&r.soup, NULL, &im, NULL, &err);
        array_fail_after(-1);
        assert_int_equal(err.code, made ? ERROR_NONE : ERROR_MEMORY);
        if (made)
            imprint_clear(&im);
        assert_int_equal(array_live(), before);
    }
    assert_true(made);
    room_clear(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_untouched), cmocka_unit_test(test_box_on_floor),
        cmocka_unit_test(test_wall_end),  cmocka_unit_test(test_lamp_in_plane),
        cmocka_unit_test(test_lamp_body), cmocka_unit_test(test_lamp_body_in_room),
        cmocka_unit_test(test_bent_sheet), cmocka_unit_test(test_covered_altogether),
        cmocka_unit_test(test_rug),      cmocka_unit_test(test_bin),
        cmocka_unit_test(test_lit_plate),
        cmocka_unit_test(test_decals),   cmocka_unit_test(test_switched_off),
        cmocka_unit_test(test_many),      cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
