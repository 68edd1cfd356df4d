/* SPDX-License-Identifier: BSD-3-Clause */
/* Mean value coordinates by half angles, and means over polygons. */
#include "math/mean_value.h"

#include <assert.h>

#include "math/tolerance.h"

Vec3 polygon_area(const IndexPolygon *polygon)
{
    const Vec3 first = polygon->position[polygon->corner[0]];
    Vec3 sum = { 0, 0, 0 };
    for (uint32_t k = 1; k + 1 < polygon->count; k++)
        sum = vec3_add(sum, vec3_cross(vec3_sub(polygon->position[polygon->corner[k]], first),
                                       vec3_sub(polygon->position[polygon->corner[k + 1]], first)));
    return vec3_scale(sum, 0.5);
}

/* From the point to corner k, within the plane. */
static Vec3 spoke(const IndexPolygon *polygon, uint32_t k, Vec3 normal, Vec3 point)
{
    const Vec3 d = vec3_sub(polygon->position[polygon->corner[k]], point);
    return vec3_mad(d, -vec3_dot(d, normal), normal);
}

static void clear(const IndexPolygon *polygon, double *weight, double value)
{
    for (uint32_t k = 0; k < polygon->count; k++)
        weight[k] = value;
}

/* Product of lengths and scalar product cancel where the point lies on the edge; six products and
 * a root leave this much of the first. */
static bool on_edge(double lengths, double dot)
{
    return lengths + dot <= 8 * DBL_EPSILON * lengths;
}

void mean_value_weights(const IndexPolygon *polygon, Vec3 normal, Vec3 point, double *weight)
{
    const uint32_t n = polygon->count;
    assert(n >= 3);
    clear(polygon, weight, 0);
    Vec3 from = spoke(polygon, 0, normal, point);
    double length = vec3_length(from), sum = 0;
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t next = k + 1 < n ? k + 1 : 0;
        const Vec3 to = spoke(polygon, next, normal, point);
        const double far = vec3_length(to), lengths = length * far, dot = vec3_dot(from, to);
        if (on_edge(lengths, dot)) { /* or at one of its ends */
            clear(polygon, weight, 0);
            const double along = length + far > 0 ? length / (length + far) : 0;
            weight[k] = 1 - along;
            weight[next] = along;
            return;
        }
        const double half_tangent = vec3_dot(vec3_cross(from, to), normal) / (lengths + dot);
        weight[k] += half_tangent / length;
        weight[next] += half_tangent / far;
        from = to;
        length = far;
    }
    for (uint32_t k = 0; k < n; k++)
        sum += weight[k];
    if (!(fabs(sum) > 0) || !isfinite(sum)) {
        clear(polygon, weight, 1.0 / n);
        return;
    }
    for (uint32_t k = 0; k < n; k++)
        weight[k] /= sum;
}

void mean_value_average(const IndexPolygon *polygon, double *weight)
{
    const uint32_t n = polygon->count;
    const Vec3 whole = polygon_area(polygon);
    const double area = vec3_length(whole);
    if (!(area > 0)) {
        clear(polygon, weight, 1.0 / n);
        return;
    }
    const Vec3 normal = vec3_scale(whole, 1 / area);
    Vec3 middle = { 0, 0, 0 };
    for (uint32_t k = 0; k < n; k++)
        middle = vec3_mad(middle, 1.0 / n, polygon->position[polygon->corner[k]]);
    mean_value_weights(polygon, normal, middle, weight);
    /* Every triangle has a third of its part at the middle, and so the middle a third of all. */
    for (uint32_t k = 0; k < n; k++)
        weight[k] /= 3;
    Vec3 from = spoke(polygon, 0, normal, middle);
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t next = k + 1 < n ? k + 1 : 0;
        const Vec3 to = spoke(polygon, next, normal, middle);
        const double part = vec3_dot(vec3_cross(from, to), normal) / (2 * area);
        weight[k] += part / 3;
        weight[next] += part / 3;
        from = to;
    }
}
