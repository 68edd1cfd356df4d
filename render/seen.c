/* SPDX-License-Identifier: BSD-3-Clause */
/* render/seen.c -- rays of a camera that only ask which patch they meet. */
#include "render/seen.h"

#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "render/internal.h"

/* Rays in all: a patch that takes up 1/1000 of the picture is known to 6 %. */
enum { GRID_CELLS = 1 << 18 };

typedef struct {
    Ray  *ray;  /* [columns] */
    Hit  *hit;  /* [columns] */
} Line;

/* Rays through the middles of one line of cells. */
static void seen_line(const Room *room, const CameraRays *camera, double y, double step,
                      uint32_t columns, double weight, Line *line, double *seen)
{
    uint32_t rays = 0;
    for (uint32_t k = 0; k < columns; k++) {
        Vec3 origin, direction;
        if (!camera_rays_at(camera, (k + 0.5) * step, y, NULL, &origin, &direction))
            continue;
        line->ray[rays++] = ray_leaving(origin, direction, 0, direction, INFINITY);
    }
    bvh_nearest_beam(room->bvh, line->ray, line->hit, rays);
    for (uint32_t k = 0; k < rays; k++) {
        const Ray *ray = &line->ray[k];
        RoomHit hit;
        if (line->hit[k].primitive == RAY_MISS)
            continue;
        room_hit(room, &line->hit[k], vec3(ray->dx, ray->dy, ray->dz), &hit);
        if (hit.patch != PATCH_NONE)
            seen[hit.patch] += weight;
    }
}

bool seen_add(const Room *room, const Camera *camera, int width, int height, double weight,
              double *seen, Error *err)
{
    assert(width > 0 && height > 0 && room->patches != NULL);
    const double step = sqrt((double)width * height / GRID_CELLS);
    const uint32_t columns = (uint32_t)fmax(1, round(width / step));
    const uint32_t rows = (uint32_t)fmax(1, round(height / step));
    Line line = { .ray = array_create(columns, sizeof *line.ray, "what is seen", err) };
    CameraRays rays;
    line.hit = array_create(columns, sizeof *line.hit, "what is seen", err);
    camera_rays_init(&rays, camera, width, height);
    for (uint32_t k = 0; k < rows && !error_is_set(err); k++)
        seen_line(room, &rays, (k + 0.5) * height / rows, (double)width / columns, columns,
                  weight / ((double)rows * columns), &line, seen);
    array_free(line.ray);
    array_free(line.hit);
    return !error_is_set(err);
}
