/* SPDX-License-Identifier: BSD-3-Clause */
/* Cells that curved surfaces part: where their parts lie, how large they are, that none reaches
 * over to another side, also after they are divided. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

#include "base/array.h"
#include "inspect/imprint.h"
#include "mesh/slicers.h"
#include "tests/soup_tools.h"

static const Affine UPRIGHT = { { 0.43, 0, 0 }, { 0, 0.43, 0 }, { 0, 0, 0.9 }, { 2.03, 1.57, 0 } };
static const double RADIUS = 0.43;

typedef struct {
    Polygons  soup;
    Surfaces *surfaces;
    Patches  *patches;
} Parted;

static void parted_make(Parted *m, const PatchOptions *options)
{
    Error err = { 0 };
    m->surfaces = surfaces_create(&m->soup, NULL, &err);
    assert_non_null(m->surfaces);
    assert_true(imprint_curved(m->surfaces, NULL, &err));
    assert_true(surfaces_check(m->surfaces));
    m->patches = patches_create(m->surfaces, options, NULL, &err);
    assert_non_null(m->patches);
    assert_true(patches_check(m->patches, m->surfaces));
}

static void parted_clear(Parted *m)
{
    patches_destroy(m->patches);
    surfaces_destroy(m->surfaces);
    polygons_clear(&m->soup);
    *m = (Parted){ 0 };
}

static void add_floor(Polygons *soup)
{
    soup_polygon(soup, (Vec3[]){ { 0, 0, 0 }, { 4, 0, 0 }, { 4, 3, 0 }, { 0, 3, 0 } }, 4, 0, 0);
}

/* A coat on a floor of 4 x 3. */
static void make_coat(Parted *m, double size)
{
    soup_start(&m->soup);
    add_floor(&m->soup);
    soup_shape(&m->soup, SHAPE_FRUSTUM, 1, &UPRIGHT);
    parted_make(m, &(PatchOptions){ .size = size });
}

static double from_axis(Vec3 p) { return hypot(p.x - UPRIGHT.t.x, p.y - UPRIGHT.t.y); }

/* 1: inside the coat, 2: outside, 3: some of both; of points all over a patch. */
static unsigned places_of(const Parted *m, uint32_t patch)
{
    unsigned in = 0;
    for (uint32_t k = 0; k < 64; k++) {
        PatchPoint at;
        patches_point(m->patches, m->surfaces, patch, (k % 8 + 0.37) / 8, (k / 8 + 0.61) / 8, &at);
        assert_int_equal(patches_at(m->patches, m->surfaces, at.surface, m->patches->side[patch],
                                    at.s, at.t), patch);
        in |= from_axis(at.point.point) < RADIUS ? 1 : 2;
    }
    return in;
}

/* Areas on either side of the coat's foot against the circle's; no patch has places on both. Areas
 * are measured on squares of 1/64 of a cell (mesh/patches_part_cell.c says 1e-4 of a cell each). */
static void check_floor(const Parted *m, double size)
{
    const Patches *p = m->patches;
    for (unsigned side = 0; side < 2; side++) {
        double area[3] = { 0 };
        for (uint32_t i = 0; i < p->count; i++)
            if (p->surface[i] == 0 && p->side[i] == side) {
                const unsigned in = places_of(m, i);
                assert_true(in == 1 || in == 2);
                area[in] += p->area[i];
            }
        const double circle = M_PI * RADIUS * RADIUS, cells = 2 * M_PI * RADIUS / size + 4;
        const double slack = 3e-4 * size * size * sqrt(cells);
        assert_true(fabs(area[1] - circle) < slack);
        assert_true(fabs(area[1] + area[2] - 12) < 1e-12);
    }
}

static void test_coat(void **state)
{
    (void)state;
    static const double sizes[] = { 4, 1, 0.5, 0.25, 0.1 };
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        Parted m = { 0 };
        make_coat(&m, sizes[k]);
        assert_true(m.patches->parted_count > 0);
        check_floor(&m, sizes[k]);
        parted_clear(&m);
    }
}

/* A vertex is shared only by patches on one side of the coat, so that no value goes through. */
static void test_vertices(void **state)
{
    (void)state;
    /* With 0.43 cells' corners lie on the circle, on its axes. */
    static const double sizes[] = { 1, 0.43, 0.2 };
    for (size_t k = 0; k < 3; k++) {
        Parted m = { 0 };
        Error err = { 0 };
        make_coat(&m, sizes[k]);
        const Patches *p = m.patches;
        uint8_t *in = array_create(p->vertex_count, 1, "vertices", &err);
        assert_non_null(in);
        for (uint32_t i = 0; i < p->count; i++) {
            if (p->surface[i] != 0)
                continue;
            const uint32_t face = p->face_of[i];
            for (uint32_t c = p->first_corner[face]; c < p->first_corner[face + 1]; c++)
                in[p->corner[c]] |= (uint8_t)places_of(&m, i);
        }
        for (uint32_t v = 0; v < p->vertex_count; v++)
            assert_true(in[v] < 3);
        /* What is interpolated on one side comes from its own vertices. */
        for (uint32_t n = 0; n < 5000; n++) {
            uint32_t vertex[PATCH_WEIGHTS];
            double weight[PATCH_WEIGHTS];
            SurfacePoint at;
            const double s = fmod(n * 0.7548776662466927, 1), t = fmod(n * 0.569840290998053, 1);
            surfaces_point(m.surfaces, 0, s, t, &at);
            const int count = patches_interpolate(p, m.surfaces, 0, 0, s, t, vertex, weight);
            double sum = 0;
            for (int j = 0; j < count; j++) {
                sum += weight[j];
                assert_true(weight[j] == 0
                            || in[vertex[j]] == (from_axis(at.point) < RADIUS ? 1 : 2));
            }
            assert_true(count > 0 && fabs(sum - 1) < 1e-12);
        }
        array_free(in);
        parted_clear(&m);
    }
}

/* Divided again and again where it is parted: parents in order, each the one that a patch's places
 * lie in, and none forgotten. */
static void test_divided(void **state)
{
    (void)state;
    Parted m = { 0 };
    Error err = { 0 };
    make_coat(&m, 1);
    for (unsigned pass = 0; pass < 4; pass++) {
        uint8_t *split = array_create(m.patches->count, 1, "patches", &err);
        uint32_t *parent;
        assert_non_null(split);
        for (uint32_t i = 0; i < m.patches->count; i++)
            split[i] = m.patches->part_of[i] != PATCH_NONE && (i + pass) % 3 != 0;
        Patches *finer = patches_split(m.patches, m.surfaces, split, &parent, &err);
        assert_non_null(finer);
        assert_true(finer->count > m.patches->count);
        assert_true(patches_check(finer, m.surfaces));
        assert_int_equal(parent[0], 0);
        assert_int_equal(parent[finer->count - 1], m.patches->count - 1);
        for (uint32_t i = 0; i < finer->count; i++) {
            PatchPoint at;
            assert_true(i == 0 || parent[i] - parent[i - 1] < 2);
            patches_point(finer, m.surfaces, i, 0.5, 0.5, &at);
            assert_int_equal(patches_at(m.patches, m.surfaces, at.surface, finer->side[i], at.s,
                                        at.t), parent[i]);
        }
        patches_destroy(m.patches);
        m.patches = finer;
        check_floor(&m, 1);
        array_free(split);
        array_free(parent);
    }
    parted_clear(&m);
}

/* A pipe that lies half sunk across a floor, wider cells than it: what is left of it and what is
 * right of it are never one patch, and neither is what is inside. */
static void test_pipe(void **state)
{
    (void)state;
    const Affine lying = { { 0, 0.05, 0 }, { 0, 0, 0.05 }, { 4, 0, 0 }, { 0, 1.43, 0 } };
    Parted m = { 0 };
    soup_start(&m.soup);
    add_floor(&m.soup);
    soup_shape(&m.soup, SHAPE_FRUSTUM, 1, &lying);
    parted_make(&m, &(PatchOptions){ .size = 1 });
    const Patches *p = m.patches;
    double area[3] = { 0 };
    for (uint32_t i = 0; i < p->count; i++) {
        unsigned where = 0;
        for (uint32_t k = 0; k < 64 && p->surface[i] == 0; k++) {
            PatchPoint at;
            patches_point(p, m.surfaces, i, (k % 8 + 0.37) / 8, (k / 8 + 0.61) / 8, &at);
            const double off = at.point.point.y - 1.43;
            where |= off < -0.05 ? 1 : off > 0.05 ? 4 : 2;
        }
        assert_true(where == 0 || where == 1 || where == 2 || where == 4);
        if (where != 0 && p->side[i] == 0)
            area[where / 2] += p->area[i];
    }
    assert_true(fabs(area[0] - 4 * 1.38) < 1e-3 && fabs(area[1] - 4 * 0.1) < 1e-3);
    assert_true(fabs(area[2] - 4 * 1.52) < 1e-3);
    parted_clear(&m);
}

/* A ball half through a wall: a hemisphere of its own on either side; and what lies flush in a face
 * parts nothing. */
static void test_ball(void **state)
{
    (void)state;
    const Affine ball = { { 0.5, 0, 0 }, { 0, 0.5, 0 }, { 0, 0, 0.5 }, { 1.5, 1.5, 0 } };
    const Affine disc = { { 0.2, 0, 0 }, { 0, 0.2, 0 }, { 0, 0, 0.2 }, { 3, 2, 0 } };
    Parted m = { 0 };
    soup_start(&m.soup);
    add_floor(&m.soup);
    soup_shape(&m.soup, SHAPE_SPHERE, 0, &ball);
    soup_shape(&m.soup, SHAPE_DISC, 0, &disc);
    parted_make(&m, &(PatchOptions){ .size = 0.6 });
    const Patches *p = m.patches;
    const double hemisphere = 2 * M_PI * 0.25;
    double above = 0, below = 0, disc_area = 0;
    for (uint32_t i = 0; i < p->count; i++) {
        const bool up = p->centre[i].z > 0;
        if (p->side[i] != 0)
            continue;
        if (p->surface[i] == m.surfaces->shape_surface[1])
            disc_area += p->area[i];
        if (p->surface[i] != m.surfaces->shape_surface[0])
            continue;
        for (uint32_t k = 0; k < 16; k++) {
            PatchPoint at;
            patches_point(p, m.surfaces, i, (k % 4 + 0.5) / 4, (k / 4 + 0.5) / 4, &at);
            assert_true((at.point.point.z > 0) == up);
        }
        *(up ? &above : &below) += p->area[i];
    }
    assert_true(fabs(above - hemisphere) < 1e-3 * hemisphere);
    assert_true(fabs(below - hemisphere) < 1e-3 * hemisphere);
    assert_true(fabs(disc_area - M_PI * 0.04) < 1e-12);
    parted_clear(&m);
}

/* --- distances -------------------------------------------------------------------------------- */

static double chance(uint32_t k, uint32_t of)
{
    return fmod((k + 1) * (0.6180339887498949 + 0.1234567 * of), 1);
}

/* Positive off the front, negative behind it, never more than the distance, never changing faster
 * than the way. */
static void test_sides(void **state)
{
    (void)state;
    static const double ratio[] = { 0, 0, 0.4, 0.3 };
    const Affine odd = { { 1.3, 0.2, 0 }, { -0.3, 0.7, 0.1 }, { 0.2, 0.4, 2.1 }, { 3, -2, 1 } };
    for (int kind = SHAPE_SPHERE; kind <= SHAPE_TORUS; kind++) {
        Error err = { 0 };
        Shape shape;
        Slicer slicer[1 + SLICER_SPLITS];
        assert_true(shape_init(&shape, (ShapeKind)kind, ratio[kind], &odd, &err));
        const Surfaces s = { .shape = &shape, .shape_count = 1, .largest_coordinate = 5 };
        assert_true(slicer_shape(&s, 0, slicer) >= 1);
        for (uint32_t k = 0; k < 2000; k++) {
            const Vec3 p = shape_point(&shape, chance(k, 0), chance(k, 1));
            const Vec3 n = shape_normal(&shape, chance(k, 0), chance(k, 1));
            const double d = 1e-3;
            assert_true(fabs(slicer_side(&s, &slicer[0], p)) < 1e-13);
            assert_true(slicer_side(&s, &slicer[0], vec3_mad(p, d, n)) > 0);
            assert_true(slicer_side(&s, &slicer[0], vec3_mad(p, -d, n)) < 0);
            assert_true(fabs(slicer_side(&s, &slicer[0], vec3_mad(p, d, n))) <= d);
            const Vec3 a = vec3(8 * chance(k, 2) - 1, 8 * chance(k, 3) - 6, 8 * chance(k, 4) - 3);
            const Vec3 b = vec3_mad(a, 0.5, vec3(chance(k, 5) - 0.5, chance(k, 6) - 0.5,
                                                 chance(k, 7) - 0.5));
            for (uint32_t c = 0; c <= slicer[0].splits; c++)
                assert_true(fabs(slicer_side(&s, &slicer[c], a) - slicer_side(&s, &slicer[c], b))
                            <= vec3_length(vec3_sub(a, b)) * (1 + 1e-12));
        }
    }
}

/* Against the longest image of many unit vectors. */
static void test_stretch(void **state)
{
    (void)state;
    const Affine map[] = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 9, 9, 9 } },
                           { { 3, 0, 0 }, { 0, 2, 0 }, { 0, 0, 3 }, { 0, 0, 0 } },
                           { { 1, 2, 3 }, { -2, 0.5, 1 }, { 0, 0, 1e-6 }, { 0, 0, 0 } },
                           { { 1, 1e-9, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 0, 0, 0 } } };
    for (size_t m = 0; m < sizeof map / sizeof *map; m++) {
        double most = 0;
        const double stretch = affine_stretch(&map[m]);
        for (uint32_t k = 0; k < 100000; k++) {
            const double z = 2 * chance(k, 0) - 1, r = sqrt(1 - z * z), a = 2 * M_PI * chance(k, 3);
            most = fmax(most, vec3_length(affine_vector(&map[m], vec3(r * cos(a), r * sin(a), z))));
        }
        assert_true(most <= stretch && most > 0.999 * stretch);
    }
}

static void test_no_memory(void **state)
{
    (void)state;
    const long before = array_live();
    Parted m = { 0 };
    make_coat(&m, 1);
    bool made = false;
    for (long n = 0; !made; n++) {
        Error err = { 0 };
        uint8_t split[512] = { 1, 1, 1, 1, 1, 1, 1, 1, 1 };
        uint32_t *parent = NULL;
        assert_true(m.patches->count < sizeof split);
        array_fail_after(n);
        Surfaces *s = surfaces_create(&m.soup, NULL, &err);
        const bool met = s != NULL && imprint_curved(s, NULL, &err);
        Patches *p = met ? patches_create(s, &(PatchOptions){ .size = 1 }, NULL, &err) : NULL;
        Patches *finer = p != NULL ? patches_split(p, s, split, &parent, &err) : NULL;
        array_fail_after(-1);
        made = finer != NULL;
        assert_true(made || err.code == ERROR_MEMORY);
        array_free(parent);
        patches_destroy(finer);
        patches_destroy(p);
        surfaces_destroy(s);
    }
    parted_clear(&m);
    assert_int_equal(array_live(), before);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_coat),    cmocka_unit_test(test_vertices),
        cmocka_unit_test(test_divided), cmocka_unit_test(test_pipe),
        cmocka_unit_test(test_ball),    cmocka_unit_test(test_sides),
        cmocka_unit_test(test_stretch), cmocka_unit_test(test_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
