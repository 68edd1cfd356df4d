/* SPDX-License-Identifier: BSD-3-Clause */
/* The polygon soup: arrays that grow, names found by hash, indices checked. */
#include "mesh/polygons.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"
#include "mesh/internal.h"

/* Indices are 32 bits wide, and UINT32_MAX stands for "none" in all that comes after. */
static const size_t ITEMS_MAX = UINT32_MAX;

static bool room_left(size_t count, size_t more, const char *what, Error *err)
{
    if (error_is_set(err))
        return false;
    if (more > ITEMS_MAX || count > ITEMS_MAX - more)
        return error_set(err, ERROR_INPUT, "more than %zu %s", ITEMS_MAX, what);
    return true;
}

bool polygons_add_vertex(Polygons *soup, Vec3 p, uint32_t *index, Error *err)
{
    assert(soup != NULL && index != NULL && err != NULL);
    if (!room_left(soup->vertex_count, 1, "vertices", err) ||
        !array_reserve((void **)&soup->position, &soup->vertex_capacity, soup->vertex_count + 1,
                       sizeof *soup->position, "vertices", err))
        return false;
    soup->position[soup->vertex_count] = p;
    *index = (uint32_t)soup->vertex_count++;
    return true;
}

/* Grows the three arrays that share one capacity; `first` has one element more than polygons. The
 * capacity is that of the smallest, so a failure half-way leaves all of them usable. */
static bool polygon_room(Polygons *soup, Error *err)
{
    const size_t needed = soup->polygon_count + 2;
    if (soup->first != NULL && needed <= soup->polygon_capacity)
        return true;
    const bool fresh = soup->first == NULL;
    size_t     a = soup->polygon_capacity, b = a, c = a;

    /* An array that is not there yet has no capacity, whatever its companions got. */
    a = soup->first == NULL ? 0 : a;
    b = soup->material == NULL ? 0 : b;
    c = soup->group == NULL ? 0 : c;
    if (!array_reserve((void **)&soup->first, &a, needed, sizeof *soup->first, "polygons", err))
        return false;
    if (fresh)
        soup->first[0] = 0;
    if (!array_reserve((void **)&soup->material, &b, needed, sizeof *soup->material, "polygons",
                       err) ||
        !array_reserve((void **)&soup->group, &c, needed, sizeof *soup->group, "polygons", err))
        return false;
    soup->polygon_capacity = a < b ? (a < c ? a : c) : (b < c ? b : c);
    return true;
}

bool polygons_add_polygon(Polygons *soup, const uint32_t *corners, size_t count, uint32_t material,
                          uint32_t group, Error *err)
{
    assert(soup != NULL && corners != NULL && err != NULL && count >= 3);
    assert(material < soup->material_count && group < soup->group_count);
    if (!room_left(soup->polygon_count, 1, "polygons", err))
        return false;
    const size_t used = soup->polygon_count > 0 ? soup->first[soup->polygon_count] : 0;
    if (!room_left(used, count, "polygon corners", err) || !polygon_room(soup, err) ||
        !array_reserve((void **)&soup->corner, &soup->corner_capacity, used + count,
                       sizeof *soup->corner, "polygon corners", err))
        return false;
    for (size_t i = 0; i < count; i++) {
        assert(corners[i] < soup->vertex_count);
        soup->corner[used + i] = corners[i];
    }
    soup->material[soup->polygon_count] = material;
    soup->group[soup->polygon_count] = group;
    soup->first[++soup->polygon_count] = (uint32_t)(used + count);
    return true;
}

bool polygons_add_shape(Polygons *soup, const Shape *shape, uint32_t material, uint32_t group,
                        Error *err)
{
    assert(soup != NULL && shape != NULL && err != NULL);
    assert(material < soup->material_count && group < soup->group_count);
    if (!room_left(soup->shape_count, 1, "curved faces", err) ||
        !array_reserve((void **)&soup->shape, &soup->shape_capacity, soup->shape_count + 1,
                       sizeof *soup->shape, "curved faces", err))
        return false;
    soup->shape[soup->shape_count++] = (ShapeFace){ material, group, *shape };
    return true;
}

bool polygons_add_material(Polygons *soup, const Material *material, uint32_t *index, Error *err)
{
    assert(soup != NULL && material != NULL && index != NULL && err != NULL);
    if (!room_left(soup->material_count, 1, "materials", err) ||
        !array_reserve((void **)&soup->materials, &soup->material_capacity,
                       soup->material_count + 1, sizeof *soup->materials, "materials", err))
        return false;
    char *name = array_string(material->name, err);
    if (name == NULL)
        return false;
    soup->materials[soup->material_count] = *material;
    soup->materials[soup->material_count].name = name;
    *index = (uint32_t)soup->material_count++;
    return true;
}

/* --- groups ---------------------------------------------------------------------------------- */

/* Slot where `name` is or would be: open addressing, linear probing. A slot holds index + 1. */
static size_t group_slot(const Polygons *soup, const char *name)
{
    const size_t mask = soup->group_slots - 1;
    size_t       slot = (size_t)file_hash(name, strlen(name), 0) & mask;

    while (soup->group_slot[slot] != 0 &&
           strcmp(soup->group_name[soup->group_slot[slot] - 1], name) != 0)
        slot = (slot + 1) & mask;
    return slot;
}

/* Brings the table up to date with group_name, which others may have filled, and leaves room for
 * one more name at a load of at most a half. */
static bool groups_hash(Polygons *soup, Error *err)
{
    size_t slots = soup->group_slots > 0 ? soup->group_slots : 16;

    while (slots < 2 * (soup->group_count + 1))
        slots *= 2;
    if (slots != soup->group_slots) {
        uint32_t *table = array_create(slots, sizeof *table, "group names", err);
        if (table == NULL)
            return false;
        array_free(soup->group_slot);
        soup->group_slot = table;
        soup->group_slots = slots;
        soup->group_hashed = 0;
    }
    for (; soup->group_hashed < soup->group_count; soup->group_hashed++) {
        const size_t slot = group_slot(soup, soup->group_name[soup->group_hashed]);
        if (soup->group_slot[slot] == 0)
            soup->group_slot[slot] = (uint32_t)soup->group_hashed + 1;
    }
    return true;
}

bool polygons_add_group(Polygons *soup, const char *name, uint32_t *index, Error *err)
{
    assert(soup != NULL && name != NULL && index != NULL && err != NULL);
    if (name[0] == 0)
        name = "default";
    if (!room_left(soup->group_count, 1, "groups", err) || !groups_hash(soup, err))
        return false;
    const size_t slot = group_slot(soup, name);
    if (soup->group_slot[slot] != 0) {
        *index = soup->group_slot[slot] - 1;
        return true;
    }
    if (!array_reserve((void **)&soup->group_name, &soup->group_capacity, soup->group_count + 1,
                       sizeof *soup->group_name, "group names", err))
        return false;
    char *copy = array_string(name, err);
    if (copy == NULL)
        return false;
    soup->group_name[soup->group_count] = copy;
    soup->group_slot[slot] = (uint32_t)++soup->group_count;
    soup->group_hashed = soup->group_count;
    *index = (uint32_t)soup->group_count - 1;
    return true;
}

/* --- the whole ------------------------------------------------------------------------------- */

Material material_default(void)
{
    return (Material){ .name = NULL, .reflectance = rgb(0.5, 0.5, 0.5), .ior = 1, .importance = 1 };
}

static void bounds_add(Vec3 p, Vec3 *lo, Vec3 *hi, bool *any)
{
    if (!vec3_finite(p))
        return;
    *lo = *any ? vec3_min(*lo, p) : p;
    *hi = *any ? vec3_max(*hi, p) : p;
    *any = true;
}

bool polygons_bounds(const Polygons *soup, Vec3 *lo, Vec3 *hi)
{
    assert(soup != NULL && lo != NULL && hi != NULL);
    const size_t corners = soup->polygon_count > 0 ? soup->first[soup->polygon_count] : 0;
    bool any = false;

    /* Only corners count: a file may hold points that no face uses. */
    for (size_t i = 0; i < corners; i++)
        bounds_add(soup->position[soup->corner[i]], lo, hi, &any);
    for (size_t i = 0; i < soup->shape_count; i++) {
        Vec3 a, b;
        shape_bounds(&soup->shape[i].shape, &a, &b);
        bounds_add(a, lo, hi, &any);
        bounds_add(b, lo, hi, &any);
    }
    return any;
}

static bool reflectance_good(Rgb c)
{
    return c.r >= 0 && c.r < 1 && c.g >= 0 && c.g < 1 && c.b >= 0 && c.b < 1;
}

static bool quantity_good(Rgb c)
{
    return c.r >= 0 && isfinite(c.r) && c.g >= 0 && isfinite(c.g) && c.b >= 0 && isfinite(c.b);
}

static bool material_good(const Material *m)
{
    return m->name != NULL && reflectance_good(m->reflectance) && quantity_good(m->emission) &&
           quantity_good(m->specular) && quantity_good(m->transmittance) &&
           quantity_good(m->scattered) && !isnan(m->exponent) && m->exponent >= 0 &&
           m->roughness >= 0 && m->roughness <= 1;
}

bool polygons_check(const Polygons *soup)
{
    assert(soup != NULL);
    for (size_t i = 0; i < soup->polygon_count; i++) {
        if (soup->first[i + 1] < soup->first[i] || soup->first[i + 1] - soup->first[i] < 3 ||
            soup->material[i] >= soup->material_count || soup->group[i] >= soup->group_count)
            return false;
        for (uint32_t k = soup->first[i]; k < soup->first[i + 1]; k++)
            if (soup->corner[k] >= soup->vertex_count)
                return false;
    }
    if ((soup->polygon_count > 0 && soup->first[0] != 0) || !polygons_normals_check(soup))
        return false;
    for (size_t i = 0; i < soup->shape_count; i++)
        if (soup->shape[i].material >= soup->material_count ||
            soup->shape[i].group >= soup->group_count)
            return false;
    for (size_t i = 0; i < soup->material_count; i++)
        if (!material_good(&soup->materials[i]))
            return false;
    for (size_t i = 0; i < soup->group_count; i++)
        if (soup->group_name[i] == NULL || soup->group_name[i][0] == 0)
            return false;
    return true;
}

void polygons_clear(Polygons *soup)
{
    assert(soup != NULL);
    for (size_t i = 0; i < soup->material_count; i++)
        array_free(soup->materials[i].name);
    for (size_t i = 0; i < soup->group_count; i++)
        array_free(soup->group_name[i]);
    array_free(soup->position);
    array_free(soup->first);
    array_free(soup->corner);
    array_free(soup->normal);
    array_free(soup->material);
    array_free(soup->group);
    array_free(soup->shape);
    array_free(soup->materials);
    array_free(soup->group_name);
    array_free(soup->group_slot);
    *soup = (Polygons){ 0 };
}
