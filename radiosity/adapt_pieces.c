/* SPDX-License-Identifier: BSD-3-Clause */
/* Patches as sources for points that are near for their size: in flat pieces, each with its own
 * light, seen exactly. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "math/sight.h"
#include "radiosity/adapt_internal.h"

/* The face's own corners, without T-vertices; 0: it has others than a cell's. */
static int own_corners(const Patches *p, uint32_t face, uint32_t corner[4])
{
    int n = 0;
    for (uint32_t k = p->first_corner[face]; k < p->first_corner[face + 1]; k++) {
        if (p->corner_along[k] != floor(p->corner_along[k]))
            continue;
        if (n == 4)
            return 0;
        corner[n++] = p->corner[k];
    }
    return n >= 3 ? n : 0;
}

/* How much of corner i is in the middle of quarter k. */
static double quarter_weight(int corners, int k, int i)
{
    if (corners == 3)
        return k == 3 ? 1.0 / 3 : i == k ? 2.0 / 3 : 1.0 / 6;
    return i == k ? 9.0 / 16 : (i - k) % 2 != 0 ? 3.0 / 16 : 1.0 / 16;
}

/* Quarter k has corner k; that in the middle of a triangle, number 3, none. */
static AdaptPiece quarter(const Patches *p, const double *reflected, const uint32_t *corner,
                          int corners, int k)
{
    AdaptPiece piece = { .corners = corners };
    Vec3   middle[4] = { { 0, 0, 0 } }, centre = { 0, 0, 0 };
    double light = 0;
    for (int i = 0; i < corners; i++) {
        const Vec3 at = p->position[corner[i]];
        middle[i] = vec3_lerp(at, p->position[corner[(i + 1) % corners]], 0.5);
        centre = vec3_mad(centre, 1.0 / corners, at);
        light += quarter_weight(corners, k, i) * reflected[corner[i]];
    }
    piece.reflected = fmax(light, 0);
    if (k == corners) {
        memcpy(piece.corner, middle, 3 * sizeof *middle);
        return piece;
    }
    piece.corner[0] = p->position[corner[k]];
    piece.corner[1] = middle[k];
    if (corners == 4)
        piece.corner[2] = centre;
    piece.corner[corners - 1] = middle[(k + corners - 1) % corners];
    return piece;
}

/* What vertices say at a point of a patch. */
static double value_at(const Room *room, const double *vertex_value, uint32_t patch,
                       const PatchPoint *at)
{
    uint32_t vertex[PATCH_WEIGHTS];
    double weight[PATCH_WEIGHTS], sum = 0;
    const int n = patches_interpolate(room->patches, room->surfaces, at->surface,
                                      room->patches->side[patch], at->s, at->t, vertex, weight);
    for (int k = 0; k < n; k++)
        sum += weight[k] * vertex_value[vertex[k]];
    return sum;
}

/* A square of a quarter of the patch's area at its place (a, b). */
static AdaptPiece square(const Room *room, const double *reflected, uint32_t patch, double a,
                         double b)
{
    AdaptPiece piece = { .corners = 4 };
    PatchPoint at;
    Vec3 s, t;
    patches_point(room->patches, room->surfaces, patch, a, b, &at);
    vec3_frame(at.point.normal, &s, &t);
    const double half = sqrt(room->patches->area[patch] / ADAPT_PIECES) / 2;
    for (int i = 0; i < 4; i++)
        piece.corner[i] = vec3_mad(vec3_mad(at.point.point, i == 1 || i == 2 ? half : -half, s),
                                   i >= 2 ? half : -half, t);
    piece.reflected = fmax(value_at(room, reflected, patch, &at), 0);
    return piece;
}

void adapt_pieces(const Room *room, const double *reflected, uint32_t patch, AdaptPiece *piece)
{
    static_assert(ADAPT_PIECES == 4, "quarters");
    const Patches *p = room->patches;
    const bool merged = p->first_piece[patch + 1] > p->first_piece[patch];
    uint32_t corner[4];
    const int corners = merged ? 0 : own_corners(p, p->face_of[patch], corner);
    for (int k = 0; k < ADAPT_PIECES; k++)
        piece[k] = corners > 0 ? quarter(p, reflected, corner, corners, k)
                               : square(room, reflected, patch, k % 2 / 2.0 + 0.25,
                                        k / 2 / 2.0 + 0.25);
}

/* Share of the view from a point over a surface with unit normal n; whole is the piece. */
static double seen(const ConvexPolygon *whole, Vec3 front, Vec3 point, Vec3 n)
{
    size_t below = 0;
    if (!(vec3_dot(front, vec3_sub(point, whole->corner[0])) > 0))
        return 0;
    for (size_t i = 0; i < whole->count; i++)
        below += vec3_dot(vec3_sub(whole->corner[i], point), n) < 0;
    if (below == 0)
        return sight_factor(point, n, whole);
    if (below == whole->count)
        return 0;
    ConvexPolygon part = *whole;
    return convex_polygon_cut(&part, n, vec3_dot(n, point)) ? sight_factor(point, n, &part) : 0;
}

void adapt_pieces_seen(const AdaptPiece *piece, const PatchPoint *at, uint32_t count,
                       float *kernel, float *lit)
{
    ConvexPolygon whole;
    for (int k = 0; k < ADAPT_PIECES; k++) {
        const Vec3 *c = piece[k].corner;
        whole.count = (size_t)piece[k].corners;
        memcpy(whole.corner, c, whole.count * sizeof *c);
        const Vec3 front = vec3_cross(vec3_sub(c[1], c[0]),
                                      vec3_sub(c[piece[k].corners - 1], c[0]));
        for (uint32_t i = 0; i < count; i++) {
            const double part = seen(&whole, front, at[i].point.point, at[i].point.normal);
            kernel[i] += (float)part;
            lit[i] += (float)(part * piece[k].reflected);
        }
    }
}
