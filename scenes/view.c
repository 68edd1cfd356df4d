/* SPDX-License-Identifier: BSD-3-Clause */
/* A view of a scene without camera: through its open side, else from inside, else from outside. */
#include "scenes/view.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>

#include "math/tolerance.h"
#include "scenes/view_rays.h"

/* Rays per edge of a face of the box. */
#define FACE_GRID 24

/* Whole angle of a view through an open side: that of the camera before the Cornell box. */
static const double open_fov = 39.3;
/* Of a view from outside. */
static const double outside_fov = 45;

/* A ray goes deep when it passes this share of the box: furniture may stand near the opening. */
static const double deep_share = 0.3;
/* An open side lets at least so many rays deep in, and so many in each quarter of it. */
static const double open_share = 0.5, open_quarter_share = 0.2;
/* From behind an open side, so many rays to the other four sides meet something. */
static const double walled_share = 0.9;
/* Room around the opening in the picture. */
static const double margin = 1.04;

/* --- the box ---------------------------------------------------------------------------------- */

Vec3 viewbox_axis(int axis, double sign)
{
    return vec3(axis == 0 ? sign : 0, axis == 1 ? sign : 0, axis == 2 ? sign : 0);
}

static int longest_axis(Vec3 v)
{
    const double x = fabs(v.x), y = fabs(v.y), z = fabs(v.z);
    return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

ViewBox viewbox_make(const Bvh *bvh, Vec3 lo, Vec3 hi, Vec3 up)
{
    assert(bvh != NULL && vec3_finite(lo) && vec3_finite(hi));
    const int axis = longest_axis(up);
    const Vec3 far = vec3_max(vec3_max(lo, hi), vec3_scale(vec3_min(lo, hi), -1));

    return (ViewBox){ .bvh = bvh, .lo = lo, .hi = hi, .up = axis, .a = (axis + 1) % 3,
                      .b = (axis + 2) % 3, .sense = vec3_axis(up, axis) < 0 ? -1 : 1,
                      .diagonal = vec3_length(vec3_sub(hi, lo)),
                      .offset = ray_offset(fmax(far.x, fmax(far.y, far.z))) };
}

Vec3 viewbox_point(const ViewBox *box, double a, double b, double up)
{
    const double share[3] = { a, b, box->sense > 0 ? up : 1 - up };
    double p[3];

    p[box->a] = share[0];
    p[box->b] = share[1];
    p[box->up] = share[2];
    return vec3(box->lo.x + p[0] * (box->hi.x - box->lo.x),
                box->lo.y + p[1] * (box->hi.y - box->lo.y),
                box->lo.z + p[2] * (box->hi.z - box->lo.z));
}

double viewbox_extent(const ViewBox *box, int axis)
{
    return vec3_axis(box->hi, axis) - vec3_axis(box->lo, axis);
}

static Ray sight_ray(Vec3 p, Vec3 d)
{
    return (Ray){ .ox = (float)p.x, .oy = (float)p.y, .oz = (float)p.z, .t_min = 0,
                  .dx = (float)d.x, .dy = (float)d.y, .dz = (float)d.z, .t_max = INFINITY };
}

double viewbox_look(const ViewBox *box, Vec3 p, Vec3 d, bool *front)
{
    Hit hit;
    const Ray ray = sight_ray(p, d);

    *front = true;
    if (!bvh_nearest(box->bvh, &ray, &hit))
        return INFINITY;
    if (box->surfaces != NULL)
        *front = vec3_dot(surfaces_normal(box->surfaces, hit.primitive, (double)hit.u,
                                          (double)hit.v), d) < 0;
    return (double)hit.t;
}

double viewbox_sight(const ViewBox *box, Vec3 p, Vec3 d)
{
    Hit hit;
    const Ray ray = sight_ray(p, d);
    return bvh_nearest(box->bvh, &ray, &hit) ? (double)hit.t : INFINITY;
}

/* --- an open side ----------------------------------------------------------------------------- */

/* A level side of the box: axis and which end of it. */
typedef struct {
    int    axis, other;     /* `other`: the second level axis */
    double sign;            /* +1: the side at hi */
} Side;

/* Point of the side at shares (s, h) of its width and height, `depth` shares into the box. */
static Vec3 side_point(const ViewBox *box, Side side, double s, double h, double depth)
{
    const double d = side.sign > 0 ? 1 - depth : depth;
    return side.axis == box->a ? viewbox_point(box, d, s, h) : viewbox_point(box, s, d, h);
}

/* Of the four directions across the side's own, the share that ends at something. */
static double walled(const ViewBox *box, Side side, Vec3 p)
{
    const Vec3 across[4] = { viewbox_axis(side.other, 1), viewbox_axis(side.other, -1),
                             viewbox_axis(box->up, 1), viewbox_axis(box->up, -1) };
    double met = 0;

    for (int i = 0; i < 4; i++)
        met += isfinite(viewbox_sight(box, p, across[i])) ? 0.25 : 0;
    return met;
}

/* How open a side is: the share of rays that go deep, or 0 when it is no opening of a room. */
static double side_openness(const ViewBox *box, Side side)
{
    const double extent = viewbox_extent(box, side.axis);
    const double start = -box->offset / fmax(extent, box->offset); /* just outside */
    const Vec3 inward = viewbox_axis(side.axis, -side.sign);
    double deep[2][2] = { { 0, 0 }, { 0, 0 } }, all = 0, behind = 0;
    const double each = 1.0 / (FACE_GRID * FACE_GRID);

    for (int j = 0; j < FACE_GRID; j++)
        for (int i = 0; i < FACE_GRID; i++) {
            const double s = (i + 0.5) / FACE_GRID, h = (j + 0.5) / FACE_GRID;
            const double sight = viewbox_sight(box, side_point(box, side, s, h, start), inward);
            if (!(sight > deep_share * extent) || !isfinite(sight))
                continue;
            all += each;
            deep[2 * j / FACE_GRID][2 * i / FACE_GRID] += 4 * each;
            behind += each * walled(box, side, side_point(box, side, s, h, deep_share / 2));
        }
    const double least = fmin(fmin(deep[0][0], deep[0][1]), fmin(deep[1][0], deep[1][1]));
    return all >= open_share && least >= open_quarter_share && behind >= walled_share * all ? all
                                                                                            : 0;
}

static bool open_side_find(const ViewBox *box, Side *found)
{
    double best = 0;

    for (int i = 0; i < 4; i++) {
        const Side side = { i < 2 ? box->a : box->b, i < 2 ? box->b : box->a, i % 2 ? -1 : 1 };
        const double openness = side_openness(box, side);
        if (openness > best) {
            best = openness;
            *found = side;
        }
    }
    return best > 0;
}

/* Before the middle of the side, so far that all of it fits a square picture. */
static void view_through(const ViewBox *box, Side side, Camera *camera)
{
    const double size = fmax(viewbox_extent(box, side.other), viewbox_extent(box, box->up));
    const double back = margin * size / 2 / tan(open_fov / 2 * M_PI / 180);
    const Vec3 middle = side_point(box, side, 0.5, 0.5, 0);

    camera->eye = vec3_mad(middle, back, viewbox_axis(side.axis, side.sign));
    camera->target = side_point(box, side, 0.5, 0.5, 0.5);
    camera->vertical_fov = open_fov;
}

/* --- from outside ----------------------------------------------------------------------------- */

/* Slantwise from above, so far that the ball around the box fits the picture. */
static void view_outside(const ViewBox *box, Camera *camera)
{
    const Vec3 middle = vec3_lerp(box->lo, box->hi, 0.5);
    const double radius = fmax(box->diagonal / 2, box->offset);
    Vec3 slant = vec3_add(viewbox_axis(box->a, 0.6), viewbox_axis(box->b, 1));

    slant = vec3_unit(vec3_add(slant, viewbox_axis(box->up, 0.6 * box->sense)));
    camera->eye = vec3_mad(middle, radius / sin(outside_fov / 2 * M_PI / 180), slant);
    camera->target = middle;
    camera->vertical_fov = outside_fov;
}

void view_choose(const ViewBox *box, Camera *camera)
{
    assert(box != NULL && camera != NULL);
    Side side = { box->a, box->b, 1 };

    *camera = (Camera){ .up = viewbox_axis(box->up, box->sense) };
    snprintf(camera->name, sizeof camera->name, "default");
    if (open_side_find(box, &side))
        view_through(box, side, camera);
    else if (!view_inside(box, camera))
        view_outside(box, camera);
    /* A flat scene seen edge-on from its own plane, or one without size: any view will do. */
    if (!(vec3_length(vec3_sub(camera->target, camera->eye)) > 0))
        camera->target = vec3_add(camera->eye, viewbox_axis(box->b, 1));
    assert(vec3_finite(camera->eye) && vec3_finite(camera->target));
}

void view_of_surfaces(const Scene *scene, const Surfaces *surfaces, const Bvh *bvh,
                      Camera *camera)
{
    assert(scene != NULL && surfaces != NULL && bvh != NULL && camera != NULL);
    ViewBox box = viewbox_make(bvh, surfaces->lo, surfaces->hi, scene->up);
    box.surfaces = surfaces;
    view_choose(&box, camera);
}

void view_of_triangles(const Bvh *bvh, Vec3 lo, Vec3 hi, Vec3 up, Camera *camera)
{
    assert(bvh != NULL && camera != NULL);
    const ViewBox box = viewbox_make(bvh, lo, hi, up);
    view_choose(&box, camera);
}
