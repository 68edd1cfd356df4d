/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/view_rays.h -- looking about in a scene whose size is not known; this folder only. */
#ifndef SCENES_VIEW_RAYS_H
#define SCENES_VIEW_RAYS_H

#include "mesh/surfaces.h"
#include "raycast/bvh.h"
#include "scenes/scene.h"

/* The box around a scene, stood upright: axis `up` of it points up, `a` and `b` are level. */
typedef struct {
    const Bvh *bvh;
    const Surfaces *surfaces; /* of bvh; NULL: fronts and backs are not known */
    Vec3       lo, hi;
    int        up, a, b;    /* axes 0, 1, 2 */
    double     sense;       /* +1: up is the positive direction of its axis, -1: the negative */
    double     diagonal;
    double     offset;      /* rays from surfaces start this far off them */
} ViewBox;

ViewBox viewbox_make(const Bvh *bvh, Vec3 lo, Vec3 hi, Vec3 up);
/* Unit vector along an axis. */
Vec3    viewbox_axis(int axis, double sign);
/* Point at the shares (a, b, up) of the box, each in [0, 1]; up counts upward. */
Vec3    viewbox_point(const ViewBox *box, double a, double b, double up);
double  viewbox_extent(const ViewBox *box, int axis);
/* How far one sees from p along the unit vector d; INFINITY when nothing is there. */
double  viewbox_sight(const ViewBox *box, Vec3 p, Vec3 d);
/* The same, and whether it is a front that one sees (true when that is not known). */
double  viewbox_look(const ViewBox *box, Vec3 p, Vec3 d, bool *front);

/* The view of view_of_surfaces. */
void view_choose(const ViewBox *box, Camera *camera);
/* A place inside a room with a view of its far end; false when there is no enclosed place. */
bool view_inside(const ViewBox *box, Camera *camera);

#endif
