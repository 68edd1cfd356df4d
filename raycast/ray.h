/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/ray.h -- rays and hits. */
#ifndef RAYCAST_RAY_H
#define RAYCAST_RAY_H

#include <stdint.h>

#include "math/vec3.h"

#define RAY_MISS UINT32_MAX

typedef struct {
    float ox, oy, oz;  /* origin */
    float t_min;       /* only hits with t_min < t < t_max count; 0 <= t_min */
    float dx, dy, dz;  /* direction, any length but 0 */
    float t_max;       /* may be INFINITY */
} Ray;

typedef struct {
    float    t;         /* the point hit is origin + t * direction */
    float    u, v;      /* triangle: weights of corners 1 and 2; shape: its parameters */
    uint32_t primitive; /* triangles first, then shapes; RAY_MISS: nothing was hit */
} Hit;

/* A ray from p (on a surface with unit normal n on the side the ray leaves) along d, moved off the
 * surface by `offset` (ray_offset in math/tolerance.h). */
static inline Ray ray_leaving(Vec3 p, Vec3 n, double offset, Vec3 d, float t_max)
{
    return (Ray){ .ox = (float)(p.x + offset * n.x), .oy = (float)(p.y + offset * n.y),
                  .oz = (float)(p.z + offset * n.z), .t_min = 0,
                  .dx = (float)d.x, .dy = (float)d.y, .dz = (float)d.z, .t_max = t_max };
}

/* A ray between two surface points, both moved off their surfaces; hits count strictly between. */
static inline Ray ray_between(Vec3 p, Vec3 np, Vec3 q, Vec3 nq, double offset)
{
    const Vec3 a = vec3_mad(p, offset, np), b = vec3_mad(q, offset, nq);
    const Ray r = { .ox = (float)a.x, .oy = (float)a.y, .oz = (float)a.z, .t_min = 0, .t_max = 1,
                    .dx = (float)(b.x - a.x), .dy = (float)(b.y - a.y), .dz = (float)(b.z - a.z) };
    return r;
}

#endif
