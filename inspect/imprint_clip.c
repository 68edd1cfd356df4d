/* SPDX-License-Identifier: BSD-3-Clause */
/* inspect/imprint_clip.c -- lines and points against a flat convex polygon; rows of polygons. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "inspect/imprint_internal.h"

/* Height of p above edge k, inwards. */
static double edge_height(const Vec3 *position, const uint32_t *corner, uint32_t count, Vec3 normal,
                          uint32_t k, Vec3 p)
{
    const Vec3 a = position[corner[k]], b = position[corner[(k + 1) % count]];
    const Vec3 in = vec3_unit(vec3_cross(normal, vec3_sub(b, a)));
    return vec3_dot(in, vec3_sub(p, a));
}

bool imprint_clip(const Vec3 *position, const uint32_t *corner, uint32_t count, Vec3 normal,
                  double tolerance, Vec3 end[2], bool *border)
{
    const Vec3 a = end[0], way = vec3_sub(end[1], end[0]);
    double from = 0, to = 1;
    *border = false;
    for (uint32_t k = 0; k < count; k++) {
        double height[2];
        for (int i = 0; i < 2; i++) {
            height[i] = edge_height(position, corner, count, normal, k, i == 0 ? a : end[1]);
            height[i] = fabs(height[i]) <= tolerance ? 0 : height[i];
        }
        if ((height[0] < 0 && height[1] <= 0) || (height[0] <= 0 && height[1] < 0))
            return false;
        *border = *border || (height[0] == 0 && height[1] == 0);
        if (height[0] < 0)
            from = fmax(from, height[0] / (height[0] - height[1]));
        else if (height[1] < 0)
            to = fmin(to, height[0] / (height[0] - height[1]));
    }
    if (!((to - from) * vec3_length(way) > tolerance))
        return false;
    end[0] = from > 0 ? vec3_mad(a, from, way) : a;
    end[1] = to < 1 ? vec3_mad(a, to, way) : end[1];
    return true;
}

bool imprint_inside(const Vec3 *position, const uint32_t *corner, uint32_t count, Vec3 normal,
                    double tolerance, Vec3 p)
{
    for (uint32_t k = 0; k < count; k++)
        if (edge_height(position, corner, count, normal, k, p) < -tolerance)
            return false;
    return true;
}

bool imprint_pieces_add(ImprintPieces *pieces, const uint32_t *corner, const uint8_t *contact,
                        uint32_t count, Error *err)
{
    static const char what[] = "pieces of faces";
    const uint32_t at = pieces->count > 0 ? pieces->first[pieces->count] : 0;
    assert(count >= 3);
    if (!array_reserve((void **)&pieces->first, &pieces->first_capacity,
                       (size_t)pieces->count + 2, sizeof *pieces->first, what, err)
        || !array_reserve((void **)&pieces->corner, &pieces->corner_capacity, (size_t)at + count,
                          sizeof *pieces->corner, what, err)
        || !array_reserve((void **)&pieces->contact, &pieces->contact_capacity, (size_t)at + count,
                          sizeof *pieces->contact, what, err))
        return false;
    memcpy(pieces->corner + at, corner, count * sizeof *corner);
    if (contact != NULL)
        memcpy(pieces->contact + at, contact, count);
    else
        memset(pieces->contact + at, 0, count);
    pieces->first[pieces->count] = at;
    pieces->first[++pieces->count] = at + count;
    return true;
}

void imprint_pieces_clear(ImprintPieces *pieces)
{
    array_free(pieces->first);
    array_free(pieces->corner);
    array_free(pieces->contact);
    *pieces = (ImprintPieces){ 0 };
}
