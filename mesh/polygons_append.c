/* SPDX-License-Identifier: BSD-3-Clause */
/* One soup put into another: mapped, renumbered, and never turned inside out. */
#include <assert.h>
#include <stdint.h>

#include "base/array.h"
#include "mesh/polygons.h"

static const uint32_t OWN = UINT32_MAX; /* the faces keep their own material or group */

typedef struct {
    Polygons       *soup;
    const Polygons *other;
    const Affine   *map;
    bool            mirrored;
    uint32_t        vertex_base;
    uint32_t        material_base, material;
    uint32_t        group, *group_of; /* [other->group_count] when groups are kept */
    uint32_t       *corners;          /* scratch for one polygon */
    Vec3           *normals;
    size_t          corner_capacity, normal_capacity;
    Error          *err;
} Append;

static bool materials_copy(Append *a)
{
    uint32_t index = 0;

    a->material_base = (uint32_t)a->soup->material_count;
    if (a->material != OWN)
        return true;
    for (size_t i = 0; i < a->other->material_count; i++)
        if (!polygons_add_material(a->soup, &a->other->materials[i], &index, a->err))
            return false;
    return true;
}

static bool groups_copy(Append *a)
{
    if (a->group != OWN)
        return true;
    a->group_of = array_create(a->other->group_count, sizeof *a->group_of, "groups", a->err);
    if (a->group_of == NULL)
        return false;
    for (size_t i = 0; i < a->other->group_count; i++)
        if (!polygons_add_group(a->soup, a->other->group_name[i], &a->group_of[i], a->err))
            return false;
    return true;
}

static uint32_t material_of(const Append *a, uint32_t material)
{
    return a->material != OWN ? a->material : a->material_base + material;
}

static uint32_t group_of(const Append *a, uint32_t group)
{
    return a->group != OWN ? a->group : a->group_of[group];
}

static bool vertices_copy(Append *a)
{
    uint32_t index = 0;

    a->vertex_base = (uint32_t)a->soup->vertex_count;
    for (size_t i = 0; i < a->other->vertex_count; i++)
        if (!polygons_add_vertex(a->soup, affine_point(a->map, a->other->position[i]), &index,
                                 a->err))
            return false;
    return true;
}

/* To the polygon just added. */
static bool normals_copy(Append *a, size_t begin, size_t count)
{
    if (begin + count > a->other->normal_count)
        return true;
    if (!array_reserve((void **)&a->normals, &a->normal_capacity, count, sizeof *a->normals,
                       "normals", a->err))
        return false;
    for (size_t k = 0; k < count; k++) {
        const float *own = a->other->normal + 3 * (begin + k);
        a->normals[a->mirrored ? count - 1 - k : k] =
            affine_cofactor(a->map, vec3(own[0], own[1], own[2]));
    }
    return polygons_set_normals(a->soup, (uint32_t)a->soup->polygon_count - 1, a->normals, a->err);
}

static bool polygons_copy(Append *a)
{
    const Polygons *other = a->other;

    for (size_t i = 0; i < other->polygon_count; i++) {
        const size_t begin = other->first[i], count = other->first[i + 1] - begin;
        if (!array_reserve((void **)&a->corners, &a->corner_capacity, count, sizeof *a->corners,
                           "polygon corners", a->err))
            return false;
        for (size_t k = 0; k < count; k++)
            a->corners[a->mirrored ? count - 1 - k : k] =
                a->vertex_base + other->corner[begin + k];
        if (!polygons_add_polygon(a->soup, a->corners, count, material_of(a, other->material[i]),
                                  group_of(a, other->group[i]), a->err) ||
            !normals_copy(a, begin, count))
            return false;
    }
    return true;
}

static bool shapes_copy(Append *a)
{
    for (size_t i = 0; i < a->other->shape_count; i++) {
        const ShapeFace *face = &a->other->shape[i];
        const Affine     to_world = affine_then(&face->shape.to_world, a->map);
        Shape            shape;
        if (!shape_init(&shape, face->shape.kind, face->shape.ratio, &to_world, a->err) ||
            !polygons_add_shape(a->soup, &shape, material_of(a, face->material),
                                group_of(a, face->group), a->err))
            return false;
    }
    return true;
}

bool polygons_append(Polygons *soup, const Polygons *other, const Affine *map, uint32_t material,
                     uint32_t group, Error *err)
{
    assert(soup != NULL && other != NULL && soup != other && map != NULL && err != NULL);
    assert(material == OWN || material < soup->material_count);
    assert(group == OWN || group < soup->group_count);
    Affine inverse;
    if (error_is_set(err))
        return false;
    if (!affine_invert(map, &inverse))
        return error_set(err, ERROR_INPUT, "a transformation that cannot be inverted");
    Append a = { .soup = soup, .other = other, .map = map, .material = material, .group = group,
                 .mirrored = affine_determinant(map) < 0, .err = err };
    const bool done = materials_copy(&a) && groups_copy(&a) && vertices_copy(&a) &&
                      polygons_copy(&a) && shapes_copy(&a);
    array_free(a.group_of);
    array_free(a.corners);
    array_free(a.normals);
    return done;
}
