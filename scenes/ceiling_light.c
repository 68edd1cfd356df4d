/* SPDX-License-Identifier: BSD-3-Clause */
/* A lamp under the ceiling, its place found by rays, its strength by the lumen method. */
#include "scenes/ceiling_light.h"

#include <assert.h>
#include <math.h>

#include "scenes/view_rays.h"

/* Points along each level axis of the room from which the ceiling is looked for. */
#define GRID 9

/* What an office is lit with on the average [en12464-1]. */
static const double wanted_lux = 500;
/* Lumen method: the share of a lamp's light that reaches the work plane of a common room. */
static const double utilisation = 0.5;
/* Side of the lamp as a share of the room's lesser width; its distance from the ceiling as a share
 * of the room's height. */
static const double lamp_share = 0.25, drop_share = 0.01;

/* The room as rays find it. */
typedef struct {
    double a0, a1, b0, b1;   /* level extent, along the box's axes a and b */
    double floor, ceiling;   /* along up, which counts upward */
} Room;

static double along_up(const ViewBox *box, Vec3 p) { return box->sense * vec3_axis(p, box->up); }

/* A place under a ceiling: the lamp's middle. Of the points of the grid under a ceiling, the one
 * nearest to the middle of the box; the grid is walked at several heights, lowest first, so that
 * the main room is meant, not the loft. */
static bool middle_find(const ViewBox *box, Vec3 *middle, double *below, double *above)
{
    const Vec3 up = viewbox_axis(box->up, box->sense), down = vec3_scale(up, -1);
    double best = INFINITY;

    for (int k = 0; k < GRID; k++)
        for (int j = 0; j < GRID; j++)
            for (int i = 0; i < GRID; i++) {
                const double a = (i + 0.5) / GRID, b = (j + 0.5) / GRID, h = (k + 0.5) / GRID;
                const double off = (a - 0.5) * (a - 0.5) + (b - 0.5) * (b - 0.5)
                                   + (h - 0.5) * (h - 0.5) / 4;
                if (off >= best)
                    continue;
                const Vec3 p = viewbox_point(box, a, b, h);
                const double d = viewbox_sight(box, p, down), u = viewbox_sight(box, p, up);
                if (!isfinite(d) || !isfinite(u) ||
                    d + u < viewbox_extent(box, box->up) / GRID)
                    continue;
                best = off;
                *middle = p;
                *below = d;
                *above = u;
            }
    return isfinite(best);
}

/* How far the room reaches from p along an axis, both ways, no further than the box. */
static void reach(const ViewBox *box, Vec3 p, int axis, double *lo, double *hi)
{
    const double at = vec3_axis(p, axis);

    *lo = fmax(at - viewbox_sight(box, p, viewbox_axis(axis, -1)), vec3_axis(box->lo, axis));
    *hi = fmin(at + viewbox_sight(box, p, viewbox_axis(axis, 1)), vec3_axis(box->hi, axis));
}

static Room room_find(const ViewBox *box)
{
    const Vec3 up = viewbox_axis(box->up, box->sense);
    const double ends[2] = { along_up(box, box->lo), along_up(box, box->hi) };
    Room room = { .floor = fmin(ends[0], ends[1]), .ceiling = fmax(ends[0], ends[1]) };
    Vec3 p = vec3_lerp(box->lo, box->hi, 0.5);
    double below = 0, above = 0;

    if (middle_find(box, &p, &below, &above)) {
        room.floor = along_up(box, p) - below;
        room.ceiling = along_up(box, p) + above;
        /* Widths near the ceiling, where no furniture stands; lamps hang there free of it. */
        p = vec3_mad(p, above - 0.1 * (above + below), up);
    }
    reach(box, p, box->a, &room.a0, &room.a1);
    reach(box, p, box->b, &room.b0, &room.b1);
    return room;
}

/* Radiance of a diffuse lamp: flux = pi L A_lamp, and the floor gets flux * utilisation / A_floor. */
static double lamp_radiance(double lamp_area, double floor_area)
{
    return wanted_lux * floor_area / (utilisation * M_PI * lamp_area);
}

static bool lamp_add(Scene *scene, const ViewBox *box, const Room *room, double side, Error *err)
{
    const double half = side / 2, a = (room->a0 + room->a1) / 2, b = (room->b0 + room->b1) / 2;
    const double floor_area = (room->a1 - room->a0) * (room->b1 - room->b0);
    const double level = room->ceiling - drop_share * (room->ceiling - room->floor);
    const double l = lamp_radiance(side * side, floor_area);
    Material lamp = material_default();
    uint32_t corner[4], material, group;

    lamp.name = (char[]){ "ceiling-light" };
    lamp.reflectance = rgb(0, 0, 0);
    lamp.emission = rgb(l, l, l);
    /* (a, b, up) is right-handed when up points along its axis: seen from below, the front, the
     * corners run a, then against b. */
    for (int i = 0; i < 4; i++) {
        double p[3];
        const double turn = box->sense;
        p[box->a] = a + (i == 1 || i == 2 ? half : -half);
        p[box->b] = b + turn * (i >= 2 ? -half : half);
        p[box->up] = box->sense * level;
        if (!polygons_add_vertex(&scene->polygons, vec3(p[0], p[1], p[2]), &corner[i], err))
            return false;
    }
    return polygons_add_material(&scene->polygons, &lamp, &material, err) &&
           polygons_add_group(&scene->polygons, "ceiling-light", &group, err) &&
           polygons_add_polygon(&scene->polygons, corner, 4, material, group, err);
}

bool ceiling_light_add(Scene *scene, const Bvh *bvh, Vec3 lo, Vec3 hi, Error *err)
{
    assert(scene != NULL && bvh != NULL && err != NULL);
    if (error_is_set(err))
        return false;
    const ViewBox box = viewbox_make(bvh, lo, hi, scene->up);
    const Room room = room_find(&box);
    const double side = lamp_share * fmin(room.a1 - room.a0, room.b1 - room.b0);

    if (!(side > 0) || !isfinite(side))
        return error_at(err, ERROR_INPUT, scene->file, 0,
                        "is flat: there is no room to hang a ceiling light in");
    return lamp_add(scene, &box, &room, side, err);
}
