/* SPDX-License-Identifier: BSD-3-Clause */
/* The path tracer's lamps: a lamp by chance, a point of it uniform in area. */
#include <assert.h>
#include <float.h>

#include "base/array.h"
#include "math/sampling.h"
#include "render/path_internal.h"

/* --- the list -------------------------------------------------------------------------------- */

static double strength(Rgb light)
{
    const double y = rgb_luminance(light);
    return y > 0 ? y : rgb_max(light);
}

static const Material *material_of(const Room *room, uint32_t surface, unsigned side)
{
    return &room->materials[surfaces_material(room->surfaces, surface, side)];
}

static Vec3 corner_of(const Surfaces *s, uint32_t triangle, unsigned k)
{
    return s->position[s->corner[3 * (size_t)triangle + k]];
}

static unsigned triangles_of(const Surface *surface)
{
    return surface->kind == SURFACE_QUAD ? 2 : surface->kind == SURFACE_TRIANGLE ? 1 : 0;
}

static double triangle_area(const Surfaces *s, uint32_t triangle)
{
    const Vec3 a = corner_of(s, triangle, 0);
    return vec3_length(vec3_cross(vec3_sub(corner_of(s, triangle, 1), a),
                                  vec3_sub(corner_of(s, triangle, 2), a))) / 2;
}

/* The way that a triangle, or two that lie in a plane, faces. */
static void set_axis(PathLamp *lamp, const Surfaces *s, const Surface *surface)
{
    const Vec3 normal = surfaces_normal(s, surface->primitive, 0, 0);
    lamp->flat = triangles_of(surface) == 1;
    lamp->axis = lamp->side == 0 ? normal : vec3_scale(normal, -1);
    if (triangles_of(surface) == 2) {
        const Vec3 other = surfaces_normal(s, surface->primitive + 1, 0, 0);
        lamp->flat = vec3_length(vec3_sub(normal, other)) <= 4 * FLT_EPSILON;
    }
}

static PathLamp surface_lamp(const Room *room, uint32_t index, unsigned side)
{
    const Surfaces *s = room->surfaces;
    const Surface  *surface = &s->surface[index];
    PathLamp lamp = { .surface = index, .side = side, .triangles = triangles_of(surface),
                      .emission = material_of(room, index, side)->emission };
    Vec3     lo, hi;
    if (surface->kind == SURFACE_SHAPE) {
        shape_bounds(&s->shape[surface->primitive - s->triangle_count], &lo, &hi);
        lamp.area = surface->area;
    } else {
        lo = hi = corner_of(s, surface->primitive, 0);
        for (unsigned k = 0; k < 3 * triangles_of(surface); k++) {
            const Vec3 p = corner_of(s, surface->primitive + k / 3, k % 3);
            lo = vec3_min(lo, p);
            hi = vec3_max(hi, p);
        }
        for (unsigned k = 0; k < triangles_of(surface); k++)
            lamp.area += triangle_area(s, surface->primitive + k);
        lamp.share = triangle_area(s, surface->primitive) / lamp.area;
        for (unsigned k = 0; k < 2 + lamp.triangles; k++)
            lamp.corner[k] = corner_of(s, surface->primitive + k / 3, k < 3 ? k : 2);
        set_axis(&lamp, s, surface);
    }
    lamp.centre = vec3_lerp(lo, hi, 0.5);
    lamp.radius = vec3_length(vec3_sub(hi, lo)) / 2;
    lamp.power = M_PI * lamp.area * strength(lamp.emission);
    return lamp;
}

static bool has_power(const Room *room, uint32_t surface, unsigned side)
{
    return (room->emitting[surface] >> side & 1) != 0 &&
           strength(material_of(room, surface, side)->emission) > 0;
}

static bool lists_create(PathLamps *lamps, size_t count, Error *err)
{
    const size_t sides = 2 * (size_t)lamps->room->surfaces->count;
    if (count >= UINT32_MAX)
        return error_set(err, ERROR_INPUT, "more than %u lamps", UINT32_MAX - 1);
    lamps->lamp = array_create(count, sizeof *lamps->lamp, "lamps", err);
    lamps->of_side = array_create(sides, sizeof *lamps->of_side, "lamps", err);
    if (error_is_set(err))
        return false;
    for (size_t i = 0; i < sides; i++)
        lamps->of_side[i] = UINT32_MAX;
    return true;
}

static bool make_tree(PathLamps *lamps, Error *err)
{
    TreeLamp *item = array_create(lamps->count, sizeof *item, "lamps", err);
    if (item == NULL)
        return false;
    for (uint32_t i = 0; i < lamps->count; i++) {
        const PathLamp *lamp = &lamps->lamp[i];
        item[i] = (TreeLamp){ .centre = lamp->centre, .radius = lamp->radius, .around = true };
        item[i].strength = lamp->light != NULL ? strength(lamp->light->intensity)
                                               : lamp->power / M_PI;
        if (lamp->flat) {
            item[i].around = false;
            item[i].axis = lamp->axis;
        }
    }
    const bool ok = lamp_tree_init(&lamps->tree, item, lamps->count, err);
    array_free(item);
    return ok;
}

bool path_lamps_init(PathLamps *lamps, const Room *room, Error *err)
{
    const uint32_t surfaces = room->surfaces->count;
    assert(surfaces < UINT32_MAX / 2 && room->emitting != NULL);
    size_t         count = room->light_count;
    *lamps = (PathLamps){ .room = room };
    for (uint32_t i = 0; i < 2 * surfaces; i++)
        count += has_power(room, i % surfaces, i / surfaces);
    if (!lists_create(lamps, count, err))
        return false;
    for (uint32_t i = 0; i < 2 * surfaces; i++) {
        if (!has_power(room, i % surfaces, i / surfaces))
            continue;
        lamps->of_side[i] = lamps->count;
        lamps->lamp[lamps->count++] = surface_lamp(room, i % surfaces, i / surfaces);
    }
    for (size_t i = 0; i < room->light_count; i++)
        if (strength(light_flux(&room->lights[i])) > 0)
            lamps->lamp[lamps->count++] =
                (PathLamp){ .light = &room->lights[i], .centre = room->lights[i].position,
                            .power = strength(light_flux(&room->lights[i])) };
    return lamps->count <= PATH_WEIGHED || make_tree(lamps, err);
}

void path_lamps_clear(PathLamps *lamps)
{
    array_free(lamps->lamp);
    lamp_tree_clear(&lamps->tree);
    array_free(lamps->of_side);
    *lamps = (PathLamps){ 0 };
}

/* --- the choice ------------------------------------------------------------------------------ */

/* What a lamp may send to a place, roughly: 0 only where it lies below the horizon whole. */
static double weight_of(const PathLamp *lamp, const PathPlace *from)
{
    const Vec3   d = vec3_sub(lamp->centre, from->point);
    const double distance = vec3_length(d), height = vec3_dot(d, from->normal) + lamp->radius;
    if (!(height > 0))
        return 0;
    if (lamp->light != NULL) {
        const Vec3 away = vec3_scale(d, -1 / distance);
        return strength(lamp->light->intensity) * light_share(lamp->light, away) * height /
               (distance * distance * distance);
    }
    const double reach = fmax(distance, lamp->radius);
    return lamp->power * fmin(height / reach, 1) / (reach * reach);
}

/* Shares of few lamps, running, at a place: those of their weights. false: none sends anything. */
static bool shares_at(const PathLamps *lamps, const PathPlace *from, double own[PATH_WEIGHED + 1])
{
    assert(lamps->count <= PATH_WEIGHED);
    own[0] = 0;
    for (uint32_t i = 0; i < lamps->count; i++)
        own[i + 1] = own[i] + weight_of(&lamps->lamp[i], from);
    const double all = own[lamps->count];
    if (!(all > 0) || !isfinite(all))
        return false;
    for (uint32_t i = 1; i <= lamps->count; i++)
        own[i] = i < lamps->count ? own[i] / all : 1;
    return true;
}

/* The lamp k with below[k] <= a < below[k + 1]. */
static uint32_t lamp_at(const double *below, uint32_t count, double a)
{
    uint32_t low = 0, high = count;
    assert(count > 0 && below[0] == 0 && below[count] == 1);
    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        *(a < below[middle] ? &high : &low) = middle;
    }
    return low;
}

/* Chooses a lamp by a in [0,1); *chance is 0 where none is found. */
static uint32_t choose(const PathLamps *lamps, const PathPlace *from, double a, double *chance)
{
    double own[PATH_WEIGHED + 1];
    *chance = 0;
    if (lamps->count > PATH_WEIGHED) {
        const uint32_t k = lamp_tree_choose(&lamps->tree, from->point, from->normal, &a, chance);
        if (k == LAMP_TREE_NONE)
            *chance = 0;
        return k;
    }
    if (lamps->count == 0 || !shares_at(lamps, from, own))
        return 0;
    const uint32_t k = lamp_at(own, lamps->count, a);
    *chance = own[k + 1] - own[k];
    return k;
}

static double chance_of(const PathLamps *lamps, const PathPlace *from, uint32_t k)
{
    double own[PATH_WEIGHED + 1];
    if (lamps->count > PATH_WEIGHED)
        return lamp_tree_chance(&lamps->tree, from->point, from->normal, k);
    return shares_at(lamps, from, own) ? own[k + 1] - own[k] : 0;
}

/* A point of a surface and the area that it stands for: 1 / density. */
static double surface_sample(const Surfaces *s, const PathLamp *lamp, double a, double b,
                             Vec3 *point, Vec3 *normal)
{
    double u, v, area = lamp->area;
    if (lamp->triangles == 0) {
        const Shape *shape = &s->shape[s->surface[lamp->surface].primitive - s->triangle_count];
        shape_all_at(shape, a, b, point, normal, &area);
    } else {
        const bool second = lamp->triangles == 2 && a >= lamp->share;
        const Vec3 p = lamp->corner[0], q = lamp->corner[second ? 2 : 1];
        const Vec3 r = lamp->corner[second ? 3 : 2];
        a = second ? (a - lamp->share) / (1 - lamp->share) : a / lamp->share;
        sampling_triangle(fmin(a, 1), b, &u, &v);
        *point = vec3_add(vec3_scale(p, 1 - u - v),
                          vec3_add(vec3_scale(q, u), vec3_scale(r, v)));
        *normal = vec3_unit(vec3_cross(vec3_sub(q, p), vec3_sub(r, p)));
    }
    if (lamp->side == 1)
        *normal = vec3_scale(*normal, -1);
    return area;
}

bool path_lamps_aim(const PathLamps *lamps, const PathPlace *from, const float u[3], PathAim *aim)
{
    double         chance;
    const uint32_t k = choose(lamps, from, u[0], &chance);
    if (!(chance > 0))
        return false;
    const PathLamp *lamp = &lamps->lamp[k];
    *aim = (PathAim){ .point = lamp->centre };
    double area = 0;
    if (lamp->light == NULL)
        area = surface_sample(lamps->room->surfaces, lamp, u[1], u[2], &aim->point, &aim->normal);
    const Vec3   d = vec3_sub(aim->point, from->point);
    const double square = vec3_dot(d, d);
    if (!(square > 0))
        return false;
    aim->way = vec3_scale(d, 1 / sqrt(square));
    if (lamp->light != NULL) {
        const double share = light_share(lamp->light, vec3_scale(aim->way, -1));
        aim->light = rgb_scale(lamp->light->intensity, share / (square * chance));
        return rgb_max(aim->light) > 0;
    }
    const double cosine = -vec3_dot(aim->way, aim->normal);
    if (!(cosine > 0) || !(area > 0))
        return false;
    aim->density = chance * square / (cosine * area);
    aim->light = rgb_scale(lamp->emission, 1 / aim->density);
    return true;
}

double path_lamps_density(const PathLamps *lamps, const PathPlace *from, const RoomHit *hit)
{
    const Surfaces *s = lamps->room->surfaces;
    assert(hit->surface < s->count && hit->side < 2);
    const uint32_t  k = lamps->of_side[hit->side * (size_t)s->count + hit->surface];
    if (k == UINT32_MAX)
        return 0;
    const PathLamp *lamp = &lamps->lamp[k];
    const Surface  *surface = &s->surface[hit->surface];
    double          area = lamp->area;
    if (surface->kind == SURFACE_SHAPE)
        area = shape_density(&s->shape[surface->primitive - s->triangle_count], hit->s, hit->t);
    const Vec3   d = vec3_sub(hit->point, from->point);
    const double square = vec3_dot(d, d), cosine = -vec3_dot(d, hit->normal) / sqrt(square);
    return cosine > 0 && area > 0 ? chance_of(lamps, from, k) * square / (cosine * area) : 0;
}
