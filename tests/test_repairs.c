/* SPDX-License-Identifier: BSD-3-Clause */
/* Repairs while connecting: windings, plates, doubles; random soups lose no face. */
#include "tests/repair_case.h"

static uint32_t draw(uint32_t *seed, uint32_t n)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)(*seed >> 8) * n >> 24);
}

/* Signed volume enclosed by the triangles. */
static double volume_of(const Surfaces *s)
{
    double sum = 0;
    for (uint32_t i = 0; i < s->triangle_count; i++) {
        const uint32_t *c = s->corner + 3 * (size_t)i;
        sum += vec3_dot(s->position[c[0]], vec3_cross(s->position[c[1]], s->position[c[2]])) / 6;
    }
    return sum;
}

/* --- cubes ------------------------------------------------------------------------------------ */

/* A cube of edge 1 whose faces are grids of nu x nv cells; bit flips[face cell] turns a cell. */
typedef struct {
    uint32_t seed;
    unsigned divisions;  /* at most */
    double   turned;     /* share of cells turned */
    bool     inward;
    bool     triangles;
    double   area[2];    /* of cells left and turned */
    uint32_t cells;
} Cube;

static void cube_face(Polygons *soup, Cube *die, Vec3 origin, Vec3 u, Vec3 v)
{
    const uint32_t nu = 1 + draw(&die->seed, die->divisions);
    const uint32_t nv = 1 + draw(&die->seed, die->divisions);
    for (uint32_t j = 0; j < nv; j++)
        for (uint32_t i = 0; i < nu; i++) {
            Vec3 p[4];
            for (uint32_t k = 0; k < 4; k++) {
                const double a = (double)(i + (k == 1 || k == 2)) / nu;
                const double b = (double)(j + (k >= 2)) / nv;
                p[k] = vec3_mad(vec3_mad(origin, a, u), b, v);
            }
            const bool turn = draw(&die->seed, 1000) < 1000 * die->turned;
            die->area[turn] += 1.0 / (nu * nv);
            die->cells++;
            if (turn != die->inward) {
                const Vec3 t = p[1];
                p[1] = p[3];
                p[3] = t;
            }
            if (die->triangles) {
                soup_polygon(soup, (Vec3[]){ p[0], p[1], p[2] }, 3, 0, 0);
                soup_polygon(soup, (Vec3[]){ p[0], p[2], p[3] }, 3, 0, 0);
            } else {
                soup_polygon(soup, p, 4, 0, 0);
            }
        }
}

static void cube_make(Polygons *soup, Cube *die, Vec3 at, double size)
{
    const Vec3 x = { size, 0, 0 }, y = { 0, size, 0 }, z = { 0, 0, size };
    cube_face(soup, die, at, y, x);
    cube_face(soup, die, vec3_add(at, z), x, y);
    cube_face(soup, die, at, x, z);
    cube_face(soup, die, vec3_add(at, y), z, x);
    cube_face(soup, die, at, z, y);
    cube_face(soup, die, vec3_add(at, x), y, z);
}

static void test_cubes(void **state)
{
    (void)state;
    for (uint32_t round = 0; round < 200; round++) {
        Case c = { 0 };
        Cube die = { .seed = round, .divisions = 1 + round % 7, .inward = round % 2 != 0,
                      .triangles = round % 3 == 0,
                      .turned = round < 40 ? 0 : round < 80 ? 1 : 0.1 * (round % 11) };
        soup_start(&c.soup);
        const double size = round % 5 == 0 ? 1 : 3.7;
        cube_make(&c.soup, &die, vec3(round * 0.37, -1, 5), size);
        case_run(&c);
        assert_int_equal(c.s->count, die.cells);
        assert_int_equal(c.s->part_count, 1);
        assert_int_equal(c.s->part_closed[0], 1);
        assert_true(c.s->closed);
        assert_true(fabs(area_of(c.s) - 6 * size * size) < 1e-9 * size * size);
        /* All agree: consistent ones as they are, else as most, else outwards. */
        const bool consistent = die.area[0] == 0 || die.area[1] == 0;
        const double most = fmax(die.area[0], die.area[1]);
        const double volume = volume_of(c.s), all = size * size * size;
        assert_true(fabs(fabs(volume) - all) < 1e-9 * all);
        const bool inside = (die.area[1] > die.area[0]) != die.inward;
        if (consistent || most > 4.01)
            assert_int_equal(volume < 0, inside);
        if (!consistent && most < 3.99)
            assert_true(volume > 0);
        assert_int_equal(c.s->repairs.flipped == 0, consistent);
        assert_int_equal(c.defects.found[DEFECT_WINDING], c.s->repairs.flipped);
        assert_int_equal(c.defects.repaired[DEFECT_WINDING], c.s->repairs.flipped);
        for (uint32_t i = 0; i < c.s->count; i++)
            assert_int_equal(c.s->surface[i].kind, SURFACE_QUAD);
        case_clear(&c);
    }
}

/* Nine open faces of ten agree: the tenth is turned; without repair it is listed only. */
static void test_open_sheet(void **state)
{
    (void)state;
    for (int keep = 0; keep < 2; keep++) {
        Case c = { .options = { .keep_winding = keep != 0 } };
        soup_start(&c.soup);
        for (int i = 0; i < 10; i++) {
            const Vec3 a = { i, 0, 0 }, b = { i + 1, 0, 0 }, d = { i, 1, 0 }, e = { i + 1, 1, 0 };
            soup_polygon(&c.soup, i == 3 ? (Vec3[]){ a, d, e, b } : (Vec3[]){ a, b, e, d }, 4, 0,
                         0);
        }
        case_run(&c);
        assert_int_equal(c.s->repairs.flipped, !keep);
        assert_int_equal(c.defects.found[DEFECT_WINDING], 1);
        assert_int_equal(c.defects.repaired[DEFECT_WINDING], !keep);
        assert_int_equal(c.defects.item[0].face, 3);
        for (uint32_t i = 0; i < 10; i++) {
            SurfacePoint at;
            surfaces_point(c.s, i, 0.5, 0.5, &at);
            assert_true(at.normal.z == (keep && i == 3 ? -1 : 1));
        }
        case_clear(&c);
    }
}

/* Lamps let into a sheet keep their fronts when most of them are against it; one alone does not. */
static void test_lamps(void **state)
{
    (void)state;
    for (uint32_t turned = 0; turned < 8; turned++) {
        enum { N = 7 };
        Case c = { 0 };
        soup_start(&c.soup);
        c.soup.materials[1].emission = rgb(5, 5, 5);
        for (uint32_t i = 0; i < N; i++) {
            const Vec3 a = { i, 0, 0 }, b = { i + 1, 0, 0 }, d = { i, 1, 0 }, e = { i + 1, 1, 0 };
            const bool lamp = i % 2 != 0, turn = lamp && (turned >> i / 2 & 1) != 0;
            soup_polygon(&c.soup, turn ? (Vec3[]){ a, d, e, b } : (Vec3[]){ a, b, e, d }, 4, lamp,
                         0);
        }
        case_run(&c);
        const uint32_t against = (turned & 1) + (turned >> 1 & 1) + (turned >> 2 & 1);
        const bool stay = against >= 2;
        assert_int_equal(c.defects.found[DEFECT_WINDING], against);
        assert_int_equal(c.s->repairs.flipped, stay ? 0 : against);
        for (uint32_t i = 0; i < N; i++) {
            SurfacePoint at;
            surfaces_point(c.s, i, 0.5, 0.5, &at);
            const bool turn = i % 2 != 0 && (turned >> i / 2 & 1) != 0;
            assert_true(at.normal.z == (turn && stay ? -1 : 1));
        }
        case_clear(&c);
    }
}

/* A plate of two faces in a sheet of such: turned, both sides keep what they are made of. */
static void test_plates_keep_sides(void **state)
{
    (void)state;
    Case c = { 0 };
    soup_start(&c.soup);
    for (int i = 0; i < 4; i++) {
        const Vec3 up[4] = { { i, 0, 0 }, { i + 1, 0, 0 }, { i + 1, 1, 0 }, { i, 1, 0 } };
        const Vec3 down[4] = { up[0], up[3], up[2], up[1] };
        /* material 0 above, 1 below; told in one order or the other */
        soup_polygon(&c.soup, i % 2 ? down : up, 4, i % 2, 0);
        soup_polygon(&c.soup, i % 2 ? up : down, 4, !(i % 2), 0);
    }
    case_run(&c);
    assert_int_equal(c.s->count, 4);
    assert_int_equal(c.s->repairs.flipped, 0);
    assert_int_equal(c.defects.found[DEFECT_WINDING], 0);
    assert_int_equal(c.defects.found[DEFECT_BACK_TO_BACK], 4);
    assert_true(c.s->closed);
    for (uint32_t i = 0; i < 4; i++) {
        SurfacePoint at;
        surfaces_point(c.s, i, 0.5, 0.5, &at);
        assert_true(at.normal.z == 1);
        assert_int_equal(surfaces_material(c.s, i, 0), 0);
        assert_int_equal(surfaces_material(c.s, i, 1), 1);
        assert_int_equal(c.s->surface[i].face, 2 * i + (i % 2));
        assert_int_equal(c.s->surface[i].back, 2 * i + !(i % 2));
    }
    case_clear(&c);
}

/* Solids that share an edge or a face, one of them wound inwards: neither turns the other. */
static void test_solids_in_touch(void **state)
{
    (void)state;
    static const struct {
        Vec3     at;
        uint32_t shared;  /* edges of more than two */
        bool     face;    /* a face in common */
    } cases[] = { { { 1, 1, 0 }, 1, false }, { { 1, 0, 0 }, 4, true } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int inward = 0; inward < 4; inward++) {
            Case c = { 0 };
            Cube one = { .divisions = 1, .inward = (inward & 1) != 0 };
            Cube two = { .divisions = 1, .inward = (inward & 2) != 0 };
            soup_start(&c.soup);
            cube_make(&c.soup, &one, vec3(0, 0, 0), 1);
            cube_make(&c.soup, &two, cases[i].at, 1);
            case_run(&c);
            assert_int_equal(c.defects.found[DEFECT_NONMANIFOLD], cases[i].shared);
            assert_int_equal(c.s->repairs.flipped, 0);
            /* Of a face in common the second is the back of the first when they are opposite. */
            const bool plate = cases[i].face && (inward == 0 || inward == 3);
            const bool gone = cases[i].face && !plate;
            assert_int_equal(c.s->closed, !gone); /* then one of them lacks its face */
            assert_int_equal(c.s->count, 12 - cases[i].face);
            assert_int_equal(c.defects.found[DEFECT_BACK_TO_BACK], plate);
            assert_int_equal(c.defects.found[DEFECT_DUPLICATE], gone);
            /* Every face points where it did. */
            for (uint32_t k = 0; k < c.s->count; k++) {
                const uint32_t face = c.s->surface[k].face;
                const Vec3 middle = vec3_add(face < 6 ? vec3(0, 0, 0) : cases[i].at,
                                             vec3(0.5, 0.5, 0.5));
                SurfacePoint at;
                surfaces_point(c.s, k, 0.5, 0.5, &at);
                const bool in = vec3_dot(at.normal, vec3_sub(at.point, middle)) < 0;
                assert_int_equal(in, face < 6 ? one.inward : two.inward);
            }
            case_clear(&c);
        }
}

/* A Moebius strip, wound by chance: said, and not turned. */
static void test_moebius(void **state)
{
    (void)state;
    enum { N = 12 };
    Case c = { 0 };
    soup_start(&c.soup);
    for (int i = 0; i < N; i++) {
        Vec3 p[4];
        for (int k = 0; k < 2; k++) {
            const double a = 2 * M_PI * ((i + k) % N) / N;
            const double half = i + k == N ? -0.4 : 0.4;
            for (int side = 0; side < 2; side++) {
                const double w = side == 0 ? -half : half;
                p[side == k ? k : 3 - k] = vec3((2 + w * cos(a / 2)) * cos(a),
                                                (2 + w * cos(a / 2)) * sin(a), w * sin(a / 2));
            }
        }
        const Vec3 outline[4] = { p[0], p[2], p[1], p[3] };
        soup_polygon(&c.soup, outline, 4, 0, 0);
    }
    case_run(&c);
    assert_int_equal(c.s->vertex_count, 2 * N);
    assert_int_equal(c.s->part_count, 1);
    assert_int_equal(c.defects.found[DEFECT_UNORIENTABLE], 1);
    assert_int_equal(c.s->repairs.flipped, 0);
    assert_false(c.s->closed);
    case_clear(&c);
}

/* --- doubled ---------------------------------------------------------------------------------- */

/* A rectangle as two triangles on one told with the other diagonal. */
static void test_other_diagonal(void **state)
{
    (void)state;
    const Vec3 a = { 0, 0, 0 }, b = { 2, 0, 0 }, c = { 2, 1, 0 }, d = { 0, 1, 0 };
    for (int variant = 0; variant < 8; variant++) {
        const bool back = (variant & 1) != 0, quad = (variant & 2) != 0, keep = (variant & 4) != 0;
        Case t = { .options = { .keep_duplicates = keep } };
        soup_start(&t.soup);
        if (quad) {
            soup_polygon(&t.soup, (Vec3[]){ a, b, c, d }, 4, 0, 0);
        } else {
            soup_polygon(&t.soup, (Vec3[]){ a, b, c }, 3, 0, 0);
            soup_polygon(&t.soup, (Vec3[]){ a, c, d }, 3, 0, 0);
        }
        soup_polygon(&t.soup, back ? (Vec3[]){ b, a, d } : (Vec3[]){ a, b, d }, 3, 1, 1);
        soup_polygon(&t.soup, back ? (Vec3[]){ c, b, d } : (Vec3[]){ b, c, d }, 3, 1, 1);
        case_run(&t);
        const DefectKind kind = back ? DEFECT_BACK_TO_BACK : DEFECT_DUPLICATE;
        assert_int_equal(t.defects.found[kind], 2);
        assert_int_equal(t.defects.repaired[kind], keep ? 0 : 2);
        assert_int_equal(t.defects.found[DEFECT_BACK_TO_BACK] + t.defects.found[DEFECT_DUPLICATE],
                         2);
        assert_int_equal(t.s->repairs.duplicate, keep || back ? 0 : 2);
        assert_true(fabs(area_of(t.s) - (keep ? 4 : 2)) < 1e-15);
        if (!keep) {
            assert_int_equal(t.s->count, 1);
            assert_int_equal(surfaces_material(t.s, 0, 0), 0);
            assert_int_equal(surfaces_material(t.s, 0, 1), back ? 1 : 0);
            assert_int_equal(t.s->closed, back);
        }
        case_clear(&t);
    }
}

/* Faces on each other that are wound alike: as two quads, as triangles on a quad, and as triangles
 * on such with the other diagonal. */
static void lay(Polygons *soup, int form, bool upper, uint32_t material)
{
    const Vec3 a = { 0, 0, 0 }, b = { 2, 0, 0 }, c = { 2, 1, 0 }, d = { 0, 1, 0 };
    if (form == 0 || (form == 1 && !upper)) {
        soup_polygon(soup, (Vec3[]){ a, b, c, d }, 4, material, 0);
    } else if (form == 2 && upper) {
        soup_polygon(soup, (Vec3[]){ a, b, d }, 3, material, 0);
        soup_polygon(soup, (Vec3[]){ b, c, d }, 3, material, 0);
    } else {
        soup_polygon(soup, (Vec3[]){ a, b, c }, 3, material, 0);
        soup_polygon(soup, (Vec3[]){ a, c, d }, 3, material, 0);
    }
}

/* Of two materials in one place the one that gives light stays, else the first; it is told. */
static void test_other_material(void **state)
{
    (void)state;
    for (int variant = 0; variant < 3 * 3; variant++) {
        const int form = variant / 3, lit = variant % 3 - 1; /* -1: neither gives light */
        Case t = { 0 };
        soup_start(&t.soup);
        if (lit >= 0)
            t.soup.materials[lit].emission = rgb(1, 1, 1);
        lay(&t.soup, form, false, 0);
        lay(&t.soup, form, true, 1);
        case_run(&t);
        const uint32_t stays = lit == 1 ? 1 : 0;
        const uint64_t gone = form == 0 || (form == 1 && stays == 1) ? 1 : 2;
        assert_true(fabs(area_of(t.s) - 2) < 1e-15);
        for (uint32_t i = 0; i < t.s->count; i++) {
            assert_int_equal(surfaces_material(t.s, i, 0), stays);
            assert_int_equal(surfaces_material(t.s, i, 1), stays);
        }
        assert_in_range(t.defects.found[DEFECT_MATERIAL], gone, 2);
        assert_int_equal(t.defects.found[DEFECT_DUPLICATE], t.defects.found[DEFECT_MATERIAL]);
        assert_int_equal(t.defects.repaired[DEFECT_MATERIAL], t.defects.found[DEFECT_MATERIAL]);
        for (size_t k = 0; k < t.defects.count; k++) {
            assert_int_equal(t.soup.material[t.defects.item[k].face], !stays);
            assert_int_equal(t.soup.material[t.defects.item[k].other], stays);
        }
        case_clear(&t);
    }
}

/* A third one with light on two without; then a fourth without. */
static void test_many_materials(void **state)
{
    (void)state;
    Case t = { 0 };
    soup_start(&t.soup);
    t.soup.materials[1].emission = rgb(1, 1, 1);
    static const uint32_t material[4] = { 0, 0, 1, 0 };
    for (int k = 0; k < 4; k++)
        lay(&t.soup, 0, false, material[k]);
    case_run(&t);
    assert_int_equal(t.s->count, 1);
    assert_int_equal(surfaces_material(t.s, 0, 0), 1);
    assert_int_equal(t.s->surface[0].face, 2);
    assert_int_equal(t.defects.found[DEFECT_DUPLICATE], 3);
    assert_int_equal(t.defects.found[DEFECT_MATERIAL], 2);
    case_clear(&t);
}

/* --- random soups ----------------------------------------------------------------------------- */

/* Triangles and polygons between points of a small lattice: all kinds of defects, many of each. */
static void soup_random(Polygons *soup, uint32_t seed, uint32_t faces)
{
    soup_start(soup);
    for (uint32_t f = 0; f < faces; f++) {
        uint32_t own = seed * 977u + f * 7919u;
        draw(&own, 2);
        Vec3 p[6];
        const uint32_t n = 3 + (draw(&own, 4) == 0 ? draw(&own, 4) : draw(&own, 2));
        const uint32_t axis = draw(&own, 4);
        for (uint32_t k = 0; k < n; k++) {
            double x[3] = { draw(&own, 3), draw(&own, 3), draw(&own, 3) };
            if (axis < 3)
                x[axis] = seed % 3;
            p[k] = vec3(x[0], x[1], x[2]);
        }
        if (draw(&own, 60) == 0)
            p[1].y = draw(&own, 2) ? NAN : INFINITY;
        soup_polygon(soup, p, n, draw(&own, 2), draw(&own, 2));
    }
}

static void check_nothing_lost(const Case *c)
{
    const size_t count = c->soup.polygon_count;
    uint8_t *seen = calloc(count, 1);
    assert_non_null(seen);
    for (uint32_t i = 0; i < c->s->triangle_count; i++) {
        seen[c->s->triangle_face[i]] |= 1;
        if (c->s->triangle_back[i] != SURFACE_NONE)
            seen[c->s->triangle_back[i]] |= 1;
    }
    for (size_t i = 0; i < c->defects.count; i++) {
        const Defect *d = &c->defects.item[i];
        assert_true(d->face < count && (d->other < count || d->other == DEFECT_NO_FACE));
        if (d->kind == DEFECT_NONFINITE || d->kind == DEFECT_DEGENERATE
            || (d->kind == DEFECT_DUPLICATE && d->repaired))
            seen[d->face] |= 2;
    }
    for (size_t i = 0; i < count; i++)
        assert_int_not_equal(seen[i], 0);
    free(seen);
}

static void test_random_soups(void **state)
{
    (void)state;
    uint32_t stitched = 0, flipped = 0, duplicate = 0, nonmanifold = 0, backs = 0;
    for (uint32_t seed = 0; seed < 600; seed++) {
        Case c = { .options = { .keep_apart = seed % 2 == 1, .keep_duplicates = seed / 2 % 3 == 1,
                                .keep_junctions = seed / 4 % 4 == 1,
                                .keep_nonmanifold = seed / 8 % 4 == 1,
                                .keep_winding = seed / 16 % 4 == 1 } };
        soup_random(&c.soup, seed, 4 + seed / 10);
        case_run(&c);
        check_nothing_lost(&c);
        const Repairs *r = &c.s->repairs;
        assert_int_equal(r->refused, 0);
        assert_int_equal(r->stitched, c.defects.repaired[DEFECT_T_JUNCTION]);
        assert_int_equal(r->flipped, c.defects.repaired[DEFECT_WINDING]);
        if (c.options.keep_junctions)
            assert_int_equal(r->stitched, 0);
        if (c.options.keep_winding)
            assert_int_equal(r->flipped, 0);
        if (c.options.keep_duplicates)
            assert_int_equal(r->duplicate, 0);
        stitched += r->stitched;
        flipped += r->flipped;
        duplicate += r->duplicate;
        nonmanifold += r->nonmanifold;
        backs += (uint32_t)c.defects.found[DEFECT_BACK_TO_BACK];
        case_clear(&c);
    }
    assert_true(stitched > 100 && flipped > 100 && duplicate > 100 && nonmanifold > 100);
    assert_true(backs > 100);
}

/* The same faces in another order: as many repairs, parts and surfaces. */
static void test_order(void **state)
{
    (void)state;
    for (uint32_t seed = 0; seed < 60; seed++) {
        Case a = { 0 }, b = { 0 };
        Cube die = { .seed = seed, .divisions = 4, .turned = 0.2 };
        soup_start(&a.soup);
        cube_make(&a.soup, &die, vec3(0, 0, 0), 1);
        soup_start(&b.soup);
        const size_t n = a.soup.polygon_count;
        for (size_t i = 0; i < n; i++) {
            Vec3 p[4];
            const size_t from = (i * 31 + seed) % n; /* 31 is a prime above all divisors of n */
            for (size_t k = 0; k < 4; k++)
                p[k] = a.soup.position[a.soup.corner[a.soup.first[n % 31 == 0 ? i : from] + k]];
            soup_polygon(&b.soup, p, 4, 0, 0);
        }
        case_run(&a);
        case_run(&b);
        assert_memory_equal(&a.s->repairs, &b.s->repairs, sizeof a.s->repairs);
        assert_int_equal(a.s->count, b.s->count);
        assert_int_equal(a.s->part_count, b.s->part_count);
        assert_int_equal(a.s->closed, b.s->closed);
        assert_true(fabs(volume_of(a.s) - volume_of(b.s)) < 1e-12);
        case_clear(&a);
        case_clear(&b);
    }
}

static void test_no_memory(void **state)
{
    (void)state;
    Polygons soup;
    Cube die = { .seed = 5, .divisions = 3, .turned = 0.3 };
    soup_start(&soup);
    cube_make(&soup, &die, vec3(0, 0, 0), 1);
    cube_make(&soup, &die, vec3(0, 0, 0), 1);
    const long before = array_live();
    for (long n = 0;; n++) {
        Error err = { 0 };
        Defects defects = { 0 };
        array_fail_after(n);
        Surfaces *s = surfaces_repair(&soup, NULL, &defects, NULL, &err);
        array_fail_after(-1);
        defects_clear(&defects);
        if (s != NULL) {
            assert_true(s->repairs.stitched > 0 && n > 30);
            surfaces_destroy(s);
            break;
        }
        assert_int_equal(err.code, ERROR_MEMORY);
        assert_int_equal(array_live(), before);
    }
    assert_int_equal(array_live(), before);
    polygons_clear(&soup);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cubes),
        cmocka_unit_test(test_open_sheet),
        cmocka_unit_test(test_lamps),
        cmocka_unit_test(test_plates_keep_sides),
        cmocka_unit_test(test_solids_in_touch),
        cmocka_unit_test(test_moebius),
        cmocka_unit_test(test_other_diagonal),
        cmocka_unit_test(test_other_material),
        cmocka_unit_test(test_many_materials),
        cmocka_unit_test(test_random_soups),
        cmocka_unit_test(test_order),
        cmocka_unit_test(test_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
