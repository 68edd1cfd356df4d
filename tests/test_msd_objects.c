/* SPDX-License-Identifier: BSD-3-Clause */
/* MSD's objects: how many faces, what area, and what volume they enclose.
 *
 * The volume is the surface integral of p . n / 3 (divergence theorem): it has the right value only
 * when the faces close the solid and all look outward, under mirroring maps too. */
#include "tests/msd_tools.h"

#include <math.h>

typedef struct {
    const char *text;
    size_t      polygons, shapes;
    double      area;    /* < 0: no closed form at hand */
    double      volume;  /* about the origin; 0 for a face whose plane holds the origin */
} Solid;

#define PI 3.14159265358979324

/* Closed forms of school geometry; ellipsoid of revolution with half axes 1, 1, 2:
 * area 2 pi (1 + 2 asin(e) / e), e^2 = 3/4, asin(e) = pi/3. */
static const Solid solids[] = {
    { "TRIANGLE 1 (0,0,3) (1,0,3) (0,2,3)", 1, 0, 1, 1 },
    { "QUADRANGLE 1 (0,0,3) (1,0,3) (1,2,3) (0,2,3)", 1, 0, 2, 2 },
    { "PARALLEL 1 (0,0,3) (2,0,3) (1,3,3)", 1, 0, 6, 6 },
    { "BOX 1 (7,8,9) <1,2,3>", 6, 0, 88, 48 },
    { "TETRAHEDRON 1 (0,0,0) (1,0,0) (0,2,0) (0,0,3)", 4, 0, 1 + 1.5 + 3 + 3.5, 1 },
    { "TETRAHEDRON 1 (0,0,0) (0,2,0) (1,0,0) (0,0,3)", 4, 0, 9, 1 },
    { "TETRAHEDRON 1 (0,0,3) (0,2,0) (1,0,0) (0,0,0)", 4, 0, 9, 1 },
    { "SPHERE 1 (1,2,3) 2", 0, 1, 16 * PI, 32 * PI / 3 },
    { "ELLIPSOID 1 (1,2,3) <1,1,2>", 0, 1, 2 * PI + 8 * PI * PI / (3 * 1.7320508075688772),
      8 * PI / 3 },
    { "ELLIPSOID 1 (1,2,3) <3,1,2>", 0, 1, -1, 8 * PI },
    { "DISC 1 (0,0,3) (0,0,9) 2", 0, 1, 4 * PI, 4 * PI },
    { "DISC 1 (0,0,3) (0,0,-9) 2", 0, 1, 4 * PI, -4 * PI },
    { "CONE 1 (0,0,0) (0,0,4) 3", 0, 2, PI * 3 * (3 + 5), 12 * PI },
    { "CONE 1 (1,2,3) (1,6,3) 3", 0, 2, 24 * PI, 12 * PI },
    { "CYLINDER_COAT 1 (0,0,0) (0,0,5) <2>", 0, 1, 20 * PI, 40 * PI / 3 },
    { "CYLINDER_COAT 1 (0,0,0) (0,0,4) <3, 0>", 0, 1, 15 * PI, 12 * PI },
    { "CYLINDER_COAT 1 (0,0,4) (0,0,0) <0, 3>", 0, 1, 15 * PI, 12 * PI },
    { "GEN_CYLINDER 1 (1,2,3) (1,2,8) <2>", 0, 3, 20 * PI + 8 * PI, 20 * PI },
    { "GEN_CYLINDER 1 (0,0,1) (0,4,1) <5, 2>", 0, 3, PI * (7 * 5 + 25 + 4), PI * 4 / 3 * 39 },
    { "GEN_CYLINDER 1 (0,0,1) (0,4,1) <2, 5>", 0, 3, PI * (7 * 5 + 25 + 4), PI * 4 / 3 * 39 },
    { "GEN_CYLINDER 1 (0,0,1) (0,4,1) <0, 3>", 0, 2, 24 * PI, 12 * PI },
    { "TORUS 1 (1,2,3) <3, 1>", 0, 1, 12 * PI * PI, 6 * PI * PI },
    /* maps: areas of similarities, volumes times |determinant| */
    { "SCALE(2,2,2) BOX 1 (7,8,9) <1,2,3>", 6, 0, 4 * 88, 8 * 48 },
    { "SCALE(-1,1,1) BOX 1 (7,8,9) <1,2,3>", 6, 0, 88, 48 },
    { "ROT_Y(33) * SCALE(1,-1,1) * TRANS(4,5,6) BOX 1 (0,0,0) <1,2,3>", 6, 0, 88, 48 },
    { "SCALE(1,1,-2) TETRAHEDRON 1 (0,0,0) (1,0,0) (0,2,0) (0,0,3)", 4, 0, -1, 2 },
    { "SCALE(1,1,-1) SPHERE 1 (1,2,3) 2", 0, 1, 16 * PI, 32 * PI / 3 },
    { "SCALE(3,-1,2) SPHERE 1 (0,0,0) 1", 0, 1, -1, 8 * PI },
    { "SCALE(-1,-1,-1) CONE 1 (0,0,0) (0,0,4) 3", 0, 2, 24 * PI, 12 * PI },
    { "MATRIX4X3(1,0,0, 0.5,1,0, 0.25,0.5,-2, 1,1,1) GEN_CYLINDER 1 (0,0,1) (0,4,1) <5, 2>", 0, 3,
      -1, 2 * PI * 4 / 3 * 39 },
    { "SCALE(1,-1,1) TORUS 1 (1,2,3) <3, 1>", 0, 1, 12 * PI * PI, 6 * PI * PI },
    { "SCALE(1,1,-1) TRIANGLE 1 (0,0,-3) (1,0,-3) (0,2,-3)", 1, 0, 1, -1 },
    { "SCALE(1,1,-1) DISC 1 (0,0,-3) (0,0,1) 2", 0, 1, 4 * PI, -4 * PI },
};

static void polygons_measure(const Polygons *p, double *area, double *volume)
{
    for (size_t i = 0; i < p->polygon_count; i++) {
        const uint32_t *c = p->corner + p->first[i];
        const uint32_t  n = p->first[i + 1] - p->first[i];
        for (uint32_t k = 1; k + 1 < n; k++) {
            const Vec3 a = p->position[c[0]], b = p->position[c[k]], d = p->position[c[k + 1]];
            const Vec3 cross = vec3_cross(vec3_sub(b, a), vec3_sub(d, a));
            *area += vec3_length(cross) / 2;
            *volume += vec3_dot(a, cross) / 6;
        }
    }
}

/* Gauss' rule with three points on each of CELLS x CELLS cells: the error of smooth periodic
 * integrands is far below 1e-9 of the value. */
static void shape_measure(const Shape *shape, double *area, double *volume)
{
    enum { CELLS = 64 };
    static const double at[3] = { 0.11270166537925831, 0.5, 0.88729833462074169 };
    static const double weight[3] = { 5.0 / 18, 8.0 / 18, 5.0 / 18 };

    for (int i = 0; i < 3 * CELLS; i++)
        for (int j = 0; j < 3 * CELLS; j++) {
            const double u = (i / 3 + at[i % 3]) / CELLS, v = (j / 3 + at[j % 3]) / CELLS;
            const double da = weight[i % 3] * weight[j % 3] / (CELLS * CELLS) *
                              shape_density(shape, u, v);
            *area += da;
            *volume += da / 3 * vec3_dot(shape_point(shape, u, v), shape_normal(shape, u, v));
        }
}

static void solids_have_areas_and_volumes(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof solids / sizeof solids[0]; i++) {
        const Solid *solid = &solids[i];
        char         text[300];
        double       area = 0, volume = 0;
        snprintf(text, sizeof text, WHITE "%s", solid->text);
        Scene          *scene = msd_scene(text);
        const Polygons *p = &scene->polygons;
        assert_int_equal(p->polygon_count, solid->polygons);
        assert_int_equal(p->shape_count, solid->shapes);
        polygons_measure(p, &area, &volume);
        for (size_t k = 0; k < p->shape_count; k++)
            shape_measure(&p->shape[k].shape, &area, &volume);
        if (solid->area >= 0)
            assert_near(area, solid->area, 1e-9 * solid->area, solid->text);
        assert_near(volume, solid->volume, 1e-9 * fabs(solid->volume), solid->text);
        scene_destroy(scene);
    }
}

/* All faces of one object are one group and one material. */
static void an_object_is_one_group(void **state)
{
    (void)state;
    Scene *scene = msd_scene(WHITE "GEN_CYLINDER 1 (0,0,0) (0,0,1) <1> BOX 1 (0,0,0) <1,1,1>");
    const Polygons *p = &scene->polygons;
    assert_int_equal(p->group_count, 2);
    for (size_t i = 0; i < 3; i++)
        assert_string_equal(p->group_name[p->shape[i].group], "gen_cylinder-1");
    for (size_t i = 0; i < 6; i++)
        assert_string_equal(p->group_name[p->group[i]], "box-1");
    assert_int_equal(p->vertex_count, 8);
    scene_destroy(scene);
}

static void corners_stand_where_they_are_put(void **state)
{
    (void)state;
    Scene *scene = msd_scene(WHITE
        "TRIANGLE 1 (1,2,3) (4,5,6) (7,8,10)\n"
        "QUADRANGLE 1 (0,0,0) (1,0,0) (1,1,0) (0,1,0)\n"
        "PARALLEL 1 (1,1,1) (3,1,1) (1,4,1)\n"
        "SCALE(1,1,-1) QUADRANGLE 1 (0,0,0) (1,0,0) (1,1,0) (0,1,0)\n");
    assert_point(corner_of(scene, 0, 2), 7, 8, 10, 0, "triangle");
    assert_point(corner_of(scene, 1, 1), 1, 0, 0, 0, "quadrangle");
    assert_point(corner_of(scene, 2, 2), 3, 4, 1, 0, "parallel: the corner not given");
    assert_point(corner_of(scene, 2, 3), 1, 4, 1, 0, "parallel");
    assert_point(corner_of(scene, 3, 0), 0, 1, 0, 0, "mirrored: turned round");
    scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solids_have_areas_and_volumes),
        cmocka_unit_test(an_object_is_one_group),
        cmocka_unit_test(corners_stand_where_they_are_put),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
