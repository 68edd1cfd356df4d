/* SPDX-License-Identifier: BSD-3-Clause */
/* How far points are outside of curved shapes, in the space of the unit form. */
#include <assert.h>
#include <stddef.h>

#include "math/internal.h"

double shape_outside(const Shape *shape, Vec3 p)
{
    assert(shape != NULL);
    const Vec3 q = affine_point(&shape->to_local, p);
    const double flat = sqrt(q.x * q.x + q.y * q.y);

    switch (shape->kind) {
    case SHAPE_SPHERE:
        return vec3_length(q) - 1;
    case SHAPE_DISC:
        return q.z;
    case SHAPE_FRUSTUM: {
        const double k = shape->ratio - 1;
        return (flat - (1 + k * q.z)) / sqrt(1 + k * k);
    }
    case SHAPE_TORUS:
        break;
    }
    const double off = flat - 1;
    return sqrt(off * off + q.z * q.z) - shape->ratio;
}

double shape_reach(const Shape *shape, double u0, double u1, double v0, double v1)
{
    enum { STEPS = 4 };
    /* The samples along the edge may miss its farthest point: on an arc of a quarter turn, by less
     * than 2 %. */
    static const double slack = 1.05;
    assert(shape != NULL && u0 <= u1 && v0 <= v1);
    const Vec3 centre = shape_local_point(shape, (u0 + u1) / 2, (v0 + v1) / 2);
    double reach = 0;

    /* All forms are round about z: the further round, the further off. */
    for (int k = 0; k <= STEPS; k++) {
        const double v = v0 + (v1 - v0) * k / STEPS;
        reach = fmax(reach, vec3_length(vec3_sub(shape_local_point(shape, u1, v), centre)));
    }
    return slack * reach * affine_stretch(&shape->to_world);
}
