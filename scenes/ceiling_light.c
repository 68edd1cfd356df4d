/* SPDX-License-Identifier: BSD-3-Clause */
/* A lamp under the ceiling, its place found by rays, its strength by the lumen method. */
#include "scenes/ceiling_light.h"

#include <assert.h>
#include <math.h>

#include "scenes/view_rays.h"

/* Points along each level axis of the room from which the ceiling is looked for. */
#define GRID 9
/* Steps of looking for the end of a ceiling. */
#define STEPS 64

/* What an office is lit with on the average [en12464-1]. */
static const double wanted_lux = 500;
/* Lumen method: the share of a lamp's light that reaches the work plane of a common room. */
static const double utilisation = 0.5;
/* Side of the lamp as a share of the room's lesser width; its distance from the ceiling as a share
 * of the room's height. */
static const double lamp_share = 0.25, drop_share = 0.01;
/* Widths are taken so many room heights below the ceiling. */
static const double beside_ceiling = 0.1;

/* The room as rays find it. */
typedef struct {
    double a0, a1, b0, b1;   /* level extent, along the box's axes a and b */
    double floor, ceiling;   /* along up, which counts upward */
} Room;

static double along_up(const ViewBox *box, Vec3 p) { return box->sense * vec3_axis(p, box->up); }

/* Whether p lies in the box, between a floor and a ceiling. */
static bool roofed(const ViewBox *box, Vec3 p, double *below, double *above)
{
    const Vec3 up = viewbox_axis(box->up, box->sense);
    const Vec3 inside = vec3_min(vec3_max(p, box->lo), box->hi);

    if (vec3_length(vec3_sub(inside, p)) > 0)
        return false;
    *below = viewbox_sight(box, p, vec3_scale(up, -1));
    *above = viewbox_sight(box, p, up);
    return isfinite(*below) && isfinite(*above);
}

/* Of a grid of points all over the box, the one under a ceiling that is nearest to its middle. */
static bool middle_find(const ViewBox *box, Vec3 *middle, double *below, double *above)
{
    double best = INFINITY, d, u;

    for (int k = 0; k < GRID; k++)
        for (int j = 0; j < GRID; j++)
            for (int i = 0; i < GRID; i++) {
                const Vec3 share = vec3((i + 0.5) / GRID, (j + 0.5) / GRID, (k + 0.5) / GRID);
                const Vec3 p = viewbox_point(box, share.x, share.y, share.z);
                const double off = vec3_length(vec3_sub(share, vec3(0.5, 0.5, 0.5)));
                if (off >= best || !roofed(box, p, &d, &u) ||
                    d + u < viewbox_extent(box, box->up) / GRID)
                    continue;
                best = off;
                *middle = p;
                *below = d;
                *above = u;
            }
    return isfinite(best);
}

/* A point of the room that a viewer sees: where the first camera stands, or the default one. */
static bool start_find(const ViewBox *box, const Scene *scene, Vec3 *p, double *below,
                       double *above)
{
    Camera camera;

    if (scene->camera_count > 0) {
        *p = scene->cameras[0].eye;
        if (roofed(box, *p, below, above))
            return true;
    }
    view_choose(box, &camera);
    *p = camera.eye;
    return roofed(box, *p, below, above) || middle_find(box, p, below, above);
}

/* How far the room reaches from p along the unit vector d: to the next wall, but not past the end
 * of the ceiling (`above` p; INFINITY: there is none), as a window may reach up to it, nor past
 * the box. Beams and lamps may hang lower. */
static double reach(const ViewBox *box, Vec3 p, Vec3 d, double above, double height)
{
    const Vec3 up = viewbox_axis(box->up, box->sense);
    const Vec3 room = vec3_min(vec3_max(vec3_mad(p, box->diagonal, d), box->lo), box->hi);
    const double wall = fmin(viewbox_sight(box, p, d), fabs(vec3_dot(vec3_sub(room, p), d)));

    for (int i = 1; i < STEPS && isfinite(above); i++) {
        const double along = wall * i / STEPS;
        if (viewbox_sight(box, vec3_mad(p, along, d), up) > above + height / 2)
            return along;
    }
    return wall;
}

/* The room's two ends along a level axis. */
static void width_find(const ViewBox *box, Vec3 p, int axis, double above, double height,
                       double *lo, double *hi)
{
    *lo = vec3_axis(p, axis) - reach(box, p, viewbox_axis(axis, -1), above, height);
    *hi = vec3_axis(p, axis) + reach(box, p, viewbox_axis(axis, 1), above, height);
}

static double middle(double a, double b) { return (a + b) / 2; }

/* Widths are taken near the ceiling, where no furniture stands and where the lamp will hang; a
 * second time from the middle that the first look found. */
static Room room_find(const ViewBox *box, const Scene *scene)
{
    const double ends[2] = { along_up(box, box->lo), along_up(box, box->hi) };
    Room room = { .floor = fmin(ends[0], ends[1]), .ceiling = fmax(ends[0], ends[1]) };
    Vec3 p = vec3_lerp(box->lo, box->hi, 0.5);
    double below = 0, above = 0;
    bool covered = start_find(box, scene, &p, &below, &above);

    for (int look = 0; look < 2; look++) {
        if (covered) {
            room.floor = along_up(box, p) - below;
            room.ceiling = along_up(box, p) + above;
            p = vec3_mad(p, above - beside_ceiling * (above + below),
                         viewbox_axis(box->up, box->sense));
        }
        const double height = room.ceiling - room.floor;
        const double roof = covered ? beside_ceiling * height : INFINITY;
        width_find(box, p, box->a, roof, height, &room.a0, &room.a1);
        width_find(box, p, box->b, roof, height, &room.b0, &room.b1);
        const Vec3 a = viewbox_axis(box->a, middle(room.a0, room.a1) - vec3_axis(p, box->a));
        const Vec3 b = viewbox_axis(box->b, middle(room.b0, room.b1) - vec3_axis(p, box->b));
        p = vec3_add(p, vec3_add(a, b));
        covered = covered && roofed(box, p, &below, &above);
    }
    return room;
}

/* Radiance of a diffuse lamp: flux = pi L A_lamp; the floor gets flux * utilisation / A_floor. */
static double lamp_radiance(double lamp_area, double floor_area)
{
    return wanted_lux * floor_area / (utilisation * M_PI * lamp_area);
}

static bool lamp_add(Scene *scene, const ViewBox *box, const Room *room, double side, Error *err)
{
    const double half = side / 2, a = middle(room->a0, room->a1), b = middle(room->b0, room->b1);
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

static bool light_hang(Scene *scene, const ViewBox *box, Error *err)
{
    const Room room = room_find(box, scene);
    const double side = lamp_share * fmin(room.a1 - room.a0, room.b1 - room.b0);

    if (!(side > 0) || !isfinite(side))
        return error_at(err, ERROR_INPUT, scene->file, 0,
                        "is flat: there is no room to hang a ceiling light in");
    return lamp_add(scene, box, &room, side, err);
}

bool ceiling_light_hang(Scene *scene, const Surfaces *surfaces, const Bvh *bvh, Error *err)
{
    assert(scene != NULL && surfaces != NULL && bvh != NULL && err != NULL);
    if (error_is_set(err))
        return false;
    ViewBox box = viewbox_make(bvh, surfaces->lo, surfaces->hi, scene->up);
    box.surfaces = surfaces;
    return light_hang(scene, &box, err);
}
