/* SPDX-License-Identifier: BSD-3-Clause */
/* Small polygon soups for tests of the mesh. */
#ifndef TESTS_SOUP_TOOLS_H
#define TESTS_SOUP_TOOLS_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/array.h"
#include "mesh/patches.h"

/* Two materials, groups "a" and "b". */
static inline void soup_start(Polygons *soup)
{
    Error err = { 0 };
    const Material material = material_default();
    uint32_t index;
    *soup = (Polygons){ 0 };
    for (int i = 0; i < 2; i++)
        assert_true(polygons_add_material(soup, &material, &index, &err));
    assert_true(polygons_add_group(soup, "a", &index, &err));
    assert_true(polygons_add_group(soup, "b", &index, &err));
}

/* A polygon with vertices of its own. */
static inline void soup_polygon(Polygons *soup, const Vec3 *p, size_t n, uint32_t material,
                                uint32_t group)
{
    Error err = { 0 };
    uint32_t *corner = malloc(n * sizeof *corner);
    assert_non_null(corner);
    for (size_t i = 0; i < n; i++)
        assert_true(polygons_add_vertex(soup, p[i], &corner[i], &err));
    assert_true(polygons_add_polygon(soup, corner, n, material, group, &err));
    free(corner);
}

static inline void soup_shape(Polygons *soup, ShapeKind kind, double ratio, const Affine *map)
{
    Error err = { 0 };
    Shape shape;
    assert_true(shape_init(&shape, kind, ratio, map, &err));
    assert_true(polygons_add_shape(soup, &shape, 0, 0, &err));
}

/* A hexahedron with the corners p, wound outwards; bit f of `cut`: face f as two triangles, of
 * `skip`: not there. Corners off a parallelepiped make trapezoids and bent quads. */
static inline void soup_block(Polygons *soup, const Vec3 p[8], unsigned cut, unsigned skip)
{
    static const int face[6][4] = { { 0, 3, 2, 1 }, { 4, 5, 6, 7 }, { 0, 1, 5, 4 },
                                    { 1, 2, 6, 5 }, { 2, 3, 7, 6 }, { 3, 0, 4, 7 } };
    for (int f = 0; f < 6; f++) {
        const Vec3 a = p[face[f][0]], b = p[face[f][1]], c = p[face[f][2]], d = p[face[f][3]];
        if (skip >> f & 1)
            continue;
        if (cut >> f & 1) {
            soup_polygon(soup, (Vec3[]){ a, b, c }, 3, 0, 0);
            soup_polygon(soup, (Vec3[]){ c, d, a }, 3, 0, 0);
        } else {
            soup_polygon(soup, (Vec3[]){ a, b, c, d }, 4, 0, 0);
        }
    }
}

static inline void soup_box(Polygons *soup, Vec3 lo, Vec3 hi, unsigned cut, unsigned skip)
{
    const Vec3 p[8] = { { lo.x, lo.y, lo.z }, { hi.x, lo.y, lo.z }, { hi.x, hi.y, lo.z },
                        { lo.x, hi.y, lo.z }, { lo.x, lo.y, hi.z }, { hi.x, lo.y, hi.z },
                        { hi.x, hi.y, hi.z }, { lo.x, hi.y, hi.z } };
    soup_block(soup, p, cut, skip);
}

static inline Surfaces *connect(const Polygons *soup)
{
    Error err = { 0 };
    Surfaces *s = surfaces_create(soup, NULL, &err);
    assert_int_equal(err.code, ERROR_NONE);
    assert_non_null(s);
    assert_true(surfaces_check(s));
    return s;
}

static inline double area_of(const Surfaces *s)
{
    double area = 0;
    for (uint32_t i = 0; i < s->count; i++)
        area += s->surface[i].area;
    return area;
}

typedef struct {
    Polygons  soup;
    Surfaces *surfaces;
    Patches  *patches;
} Mesh;

static inline void mesh_make(Mesh *m, const PatchOptions *options)
{
    Error err = { 0 };
    m->surfaces = surfaces_create(&m->soup, NULL, &err);
    assert_non_null(m->surfaces);
    m->patches = patches_create(m->surfaces, options, NULL, &err);
    assert_int_equal(err.code, ERROR_NONE);
    assert_true(surfaces_check(m->surfaces));
    assert_true(patches_check(m->patches, m->surfaces));
}

static inline void mesh_clear(Mesh *m)
{
    patches_destroy(m->patches);
    surfaces_destroy(m->surfaces);
    polygons_clear(&m->soup);
}

static const Vec3 cube[8] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 },
                              { 0, 0, 1 }, { 1, 0, 1 }, { 1, 1, 1 }, { 0, 1, 1 } };
static const Vec3 skew[8] = { { 0, 0, 0 }, { 3, 0, 0 }, { 1.5, 1, 0.2 }, { 0, 1, 0 },
                              { 0, 0, 1 }, { 1, 0, 1.1 }, { 1.3, 1.2, 1 }, { 0, 2.2, 1.4 } };

/* All kinds in one: a skewed block with cut faces, a triangle, shapes. */
static inline void mesh_of_everything(Mesh *m, double size)
{
    soup_start(&m->soup);
    soup_block(&m->soup, skew, 1u << 0 | 1u << 3, 0);
    soup_polygon(&m->soup, (Vec3[]){ { 5, 0, 0 }, { 9, 0, 1 }, { 5, 3, 0 } }, 3, 1, 0);
    const Affine stretched = { { 1, 0.2, 0 }, { 0, 2, 0 }, { 0, 0.3, 0.7 }, { 20, 0, 0 } };
    soup_shape(&m->soup, SHAPE_SPHERE, 1, &stretched);
    soup_shape(&m->soup, SHAPE_DISC, 1, &stretched);
    soup_shape(&m->soup, SHAPE_FRUSTUM, 0, &stretched);
    soup_shape(&m->soup, SHAPE_FRUSTUM, 0.5, &stretched);
    soup_shape(&m->soup, SHAPE_TORUS, 0.3, &stretched);
    const Affine mirrored = { { 1, 0.2, 0 }, { 0, 2, 0 }, { 0, 0.3, -0.7 }, { -20, 0, 0 } };
    soup_shape(&m->soup, SHAPE_SPHERE, 1, &mirrored);
    soup_shape(&m->soup, SHAPE_DISC, 1, &mirrored);
    soup_shape(&m->soup, SHAPE_FRUSTUM, 2, &mirrored);
    soup_shape(&m->soup, SHAPE_TORUS, 0.3, &mirrored);
    mesh_make(m, &(PatchOptions){ .size = size });
}

#endif
