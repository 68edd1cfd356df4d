/* SPDX-License-Identifier: BSD-3-Clause */
/* Normals that a file gives the corners of its polygons, and between them. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "math/mean_value.h"
#include "mesh/internal.h"
#include "mesh/polygons.h"

/* The floats of a polygon's corners; 0 where nothing has been said. NULL: no memory. */
static float *corners_room(Polygons *soup, uint32_t polygon, Error *err)
{
    const size_t end = soup->first[polygon + 1];
    if (error_is_set(err) ||
        !array_reserve((void **)&soup->normal, &soup->normal_capacity, 3 * end,
                       sizeof *soup->normal, "normals", err))
        return NULL;
    for (size_t i = 3 * soup->normal_count; i < 3 * end; i++)
        soup->normal[i] = 0;
    soup->normal_count = end > soup->normal_count ? end : soup->normal_count;
    return soup->normal + 3 * (size_t)soup->first[polygon];
}

bool polygons_set_normals(Polygons *soup, uint32_t polygon, const Vec3 *normal, Error *err)
{
    assert(soup != NULL && normal != NULL && err != NULL && polygon < soup->polygon_count);
    const uint32_t count = soup->first[polygon + 1] - soup->first[polygon];
    float *out = corners_room(soup, polygon, err);
    for (uint32_t k = 0; out != NULL && k < count; k++) {
        const Vec3   n = normal[k];
        const double length = vec3_length(n);
        const bool   good = length > 0 && isfinite(length);
        out[3 * k] = good ? (float)(n.x / length) : 0;
        out[3 * k + 1] = good ? (float)(n.y / length) : 0;
        out[3 * k + 2] = good ? (float)(n.z / length) : 0;
    }
    return out != NULL;
}

bool polygons_copy_normals(Polygons *soup, uint32_t polygon, const Polygons *from, uint32_t other,
                           Error *err)
{
    assert(polygon < soup->polygon_count && other < from->polygon_count);
    const size_t begin = from->first[other], count = from->first[other + 1] - begin;
    assert(soup->first[polygon + 1] - soup->first[polygon] == count);
    if (begin + count > from->normal_count)
        return true;
    float *out = corners_room(soup, polygon, err);
    if (out != NULL)
        memcpy(out, from->normal + 3 * begin, 3 * count * sizeof *out);
    return out != NULL;
}

static Vec3 normal_of(const Polygons *soup, size_t corner)
{
    const float *n = soup->normal + 3 * corner;
    return vec3(n[0], n[1], n[2]);
}

bool polygons_normal_at(const Polygons *soup, uint32_t polygon, Vec3 point, Vec3 *normal)
{
    assert(soup != NULL && normal != NULL && polygon < soup->polygon_count);
    const size_t   begin = soup->first[polygon];
    const uint32_t count = soup->first[polygon + 1] - soup->first[polygon];
    if (begin + count > soup->normal_count || count > POLYGON_SHADED_MOST)
        return false;
    const IndexPolygon of = { soup->position, soup->corner + begin, count };
    double weight[POLYGON_SHADED_MOST];
    Vec3   sum = { 0, 0, 0 };
    for (uint32_t k = 0; k < count; k++)
        if (!(vec3_length(normal_of(soup, begin + k)) > 0))
            return false;
    mean_value_weights(&of, vec3_unit(polygon_area(&of)), point, weight);
    for (uint32_t k = 0; k < count; k++)
        sum = vec3_mad(sum, weight[k], normal_of(soup, begin + k));
    if (!(vec3_length(sum) > 0) || !vec3_finite(sum))
        return false;
    *normal = vec3_unit(sum);
    return true;
}

/* Components in float are off by half an ulp each, the length by as much. */
static const double LENGTH_SLACK = 1e-6;

bool polygons_normals_check(const Polygons *soup)
{
    const size_t corners = soup->polygon_count > 0 ? soup->first[soup->polygon_count] : 0;
    if (soup->normal_count > corners || (soup->normal_count > 0 && soup->normal == NULL))
        return false;
    for (size_t i = 0; i < soup->normal_count; i++) {
        const double length = vec3_length(normal_of(soup, i));
        if (length != 0 && !(fabs(length - 1) <= LENGTH_SLACK))
            return false;
    }
    return true;
}
