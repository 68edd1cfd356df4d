/* SPDX-License-Identifier: BSD-3-Clause */
/* Connected parts, and those that lie inside a solid, where neither light nor eye gets.
 *
 * A solid is a closed part with matter in it: no side that looks inwards is in use. Where sight is
 * unknown, fronts tell: a solid's look out, a room's look in. Whether a point is inside is told by
 * the parity of the faces that rays from it pass, by majority of directions and points.
 */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "base/parallel.h"
#include "inspect/internal.h"

enum {
    CHUNK = 64,
    AROUND_MOST = 32,   /* solids around a part that are tried */
    PIERCE_MOST = 2048, /* boxes that a ray may pass: beyond, the part is given up */
    POINTS = 3,
    RAYS = 3
};

/* In no plane that modellers use, and none of them 0. */
static const Vec3 directions[RAYS] = { { 0.5403023059, 0.6274118743, 0.5607812397 },
                                       { -0.3817412693, 0.7390851332, 0.5550017981 },
                                       { 0.2718281829, -0.4142135624, 0.8686513571 } };

/* --- what parts there are --------------------------------------------------------------------- */

static Vec3 corner_position(const Surfaces *s, uint32_t triangle, unsigned k)
{
    return s->position[s->corner[3 * (size_t)triangle + k]];
}

/* Six times the signed volume of the tetrahedra from `origin` to a surface's triangles. */
static double surface_volume(const Surfaces *s, uint32_t i, Vec3 origin)
{
    const Surface *f = &s->surface[i];
    double         sum = 0;
    if (f->kind == SURFACE_SHAPE)
        return f->area; /* only its sign counts: fronts of curved faces look out */
    for (uint32_t k = f->primitive; k <= f->primitive + (f->kind == SURFACE_QUAD); k++) {
        const Vec3 a = vec3_sub(corner_position(s, k, 0), origin);
        const Vec3 b = vec3_sub(corner_position(s, k, 1), origin);
        sum += vec3_dot(a, vec3_cross(b, vec3_sub(corner_position(s, k, 2), origin)));
    }
    return sum;
}

static void surface_bounds(const Surfaces *s, uint32_t i, Vec3 *lo, Vec3 *hi)
{
    const Surface *f = &s->surface[i];
    if (f->kind == SURFACE_SHAPE) {
        shape_bounds(&s->shape[f->primitive - s->triangle_count], lo, hi);
        return;
    }
    *lo = *hi = corner_position(s, f->primitive, 0);
    const uint32_t last = f->primitive + (f->kind == SURFACE_QUAD);
    for (uint32_t k = f->primitive; k <= last; k++)
        for (unsigned c = 0; c < 3; c++) {
            *lo = vec3_min(*lo, corner_position(s, k, c));
            *hi = vec3_max(*hi, corner_position(s, k, c));
        }
}

static bool measure_parts(Inspector *in)
{
    const Surfaces *s = in->surfaces;
    Inspection     *out = in->out;
    out->part = array_create(s->part_count, sizeof *out->part, "parts", in->err);
    if (out->part == NULL)
        return false;
    out->parts = s->part_count;
    for (uint32_t i = 0; i < s->count; i++) {
        Part *part = &out->part[s->part[i]];
        Vec3  lo, hi;
        surface_bounds(s, i, &lo, &hi);
        if (part->surfaces++ == 0) {
            part->first = i;
            part->closed = s->part_closed[s->part[i]] != 0;
            part->lo = lo;
            part->hi = hi;
        }
        part->lo = vec3_min(part->lo, lo);
        part->hi = vec3_max(part->hi, hi);
        part->area += s->surface[i].area;
        part->seen = part->seen || in->options->sides == NULL || in->options->sides[i] != 0;
        if (part->closed)
            part->volume += surface_volume(s, i, out->part[s->part[i]].lo) / 6;
    }
    for (uint32_t p = 0; p < out->parts; p++)
        out->closed_parts += out->part[p].closed;
    return true;
}

/* --- which of them are solids ----------------------------------------------------------------- */

typedef struct {
    Inspector *in;
    uint8_t   *solid;       /* [parts] */
    uint32_t  *solid_part;  /* [solids.count]  part of an item of the tree */
    BoxTree    solids;
    uint32_t  *inside;      /* [parts]  the solid that a part lies in, or UINT32_MAX */
    uint8_t   *given_up;    /* [parts] */
} Burial;

/* A hull around the whole scene is the room, whichever way its fronts look. */
static bool holds_all(const Surfaces *s, const Part *part)
{
    const double t = inspect_tolerance(s->largest_coordinate);
    return part->lo.x <= s->lo.x + t && part->lo.y <= s->lo.y + t && part->lo.z <= s->lo.z + t &&
           part->hi.x >= s->hi.x - t && part->hi.y >= s->hi.y - t && part->hi.z >= s->hi.z - t;
}

static void find_solids(Burial *b)
{
    const Inspector *in = b->in;
    const Surfaces  *s = in->surfaces;
    for (uint32_t p = 0; p < in->out->parts; p++) {
        const Part *part = &in->out->part[p];
        b->solid[p] = part->closed && part->volume != 0 &&
                      (in->sighted || (part->volume > 0 && !holds_all(s, part)));
    }
    for (uint32_t i = 0; in->sighted && i < s->count; i++) {
        const unsigned inner = in->out->part[s->part[i]].volume > 0 ? 1 : 0;
        if ((in->options->sides[i] >> inner & 1) != 0)
            b->solid[s->part[i]] = 0;
    }
}

static bool sort_solids(Burial *b)
{
    const Inspection *out = b->in->out;
    uint32_t          count = 0;
    BoxEntry *entry = array_create(out->parts, sizeof *entry, "parts", b->in->err);
    b->solid_part = array_create(out->parts, sizeof *b->solid_part, "parts", b->in->err);
    for (uint32_t p = 0; entry != NULL && b->solid_part != NULL && p < out->parts; p++)
        if (b->solid[p]) {
            entry[count].box = box_around(out->part[p].lo, out->part[p].hi);
            b->solid_part[count++] = p;
        }
    return box_tree_create(&b->solids, entry, count, b->in->err);
}

/* --- inside or not ---------------------------------------------------------------------------- */

/* Whether a ray passes a triangle: from which side the line passes its edges [segura01]. */
static bool ray_passes(const Surfaces *s, uint32_t triangle, Vec3 origin, Vec3 d)
{
    const Vec3   a = vec3_sub(corner_position(s, triangle, 0), origin);
    const Vec3   b = vec3_sub(corner_position(s, triangle, 1), origin);
    const Vec3   c = vec3_sub(corner_position(s, triangle, 2), origin);
    const double u = vec3_dot(d, vec3_cross(a, b)), v = vec3_dot(d, vec3_cross(b, c));
    const double w = vec3_dot(d, vec3_cross(c, a));
    if (!((u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0)))
        return false;
    /* Volume of (a,b,c) over that of the direction: positive ahead. */
    return vec3_dot(a, vec3_cross(b, c)) / (u + v + w) > 0;
}

/* A shape of a closed kind, in its own space. */
static bool inside_shape(const Shape *shape, Vec3 p)
{
    const Vec3 q = affine_point(&shape->to_local, p);
    if (shape->kind == SHAPE_SPHERE)
        return vec3_dot(q, q) < 1;
    if (shape->kind != SHAPE_TORUS)
        return false;
    const double ring = sqrt(q.x * q.x + q.y * q.y) - 1;
    return ring * ring + q.z * q.z < shape->ratio * shape->ratio;
}

/* How far a ray from a point in the box goes until it has left it. */
static double way_out(const Part *part, Vec3 p, Vec3 d)
{
    const double x = ((d.x > 0 ? part->hi.x : part->lo.x) - p.x) / d.x;
    const double y = ((d.y > 0 ? part->hi.y : part->lo.y) - p.y) / d.y;
    const double z = ((d.z > 0 ? part->hi.z : part->lo.z) - p.z) / d.z;
    return fmax(fmin(x, fmin(y, z)), 0);
}

typedef enum { PLACE_OUTSIDE, PLACE_INSIDE, PLACE_UNKNOWN } Place;

static Place point_place(const Burial *b, uint32_t solid, Vec3 point)
{
    const Surfaces *s = b->in->surfaces;
    const Part     *part = &b->in->out->part[solid];
    const Surface  *first = &s->surface[part->first];
    uint32_t        near[PIERCE_MOST];
    int             inside = 0;
    if (first->kind == SURFACE_SHAPE)
        return inside_shape(&s->shape[first->primitive - s->triangle_count], point)
                   ? PLACE_INSIDE : PLACE_OUTSIDE;
    for (int k = 0; k < RAYS; k++) {
        const Vec3     d = directions[k];
        const uint32_t n = box_tree_pierce(&b->in->tree, point, d, way_out(part, point, d), near,
                                           PIERCE_MOST);
        unsigned       passed = 0;
        if (n > PIERCE_MOST)
            return PLACE_UNKNOWN;
        for (uint32_t i = 0; i < n; i++) {
            const uint32_t triangle = b->in->tree.entry[near[i]].item;
            passed += s->part[s->triangle_surface[triangle]] == solid &&
                      ray_passes(s, triangle, point, d);
        }
        inside += passed % 2 == 1;
    }
    return 2 * inside > RAYS ? PLACE_INSIDE : PLACE_OUTSIDE;
}

/* Where the part lies: inside when points of its first, middle and last surface do. */
static Place part_place(const Burial *b, const uint32_t *point, uint32_t solid)
{
    Place place = PLACE_INSIDE;
    for (int k = 0; k < POINTS && place == PLACE_INSIDE; k++) {
        SurfacePoint at;
        surfaces_point(b->in->surfaces, point[k], 1.0 / 3, 1.0 / 3, &at);
        place = point_place(b, solid, at.point);
    }
    return place;
}

static bool box_holds(const Part *outer, const Part *part)
{
    return outer->lo.x <= part->lo.x && outer->lo.y <= part->lo.y && outer->lo.z <= part->lo.z &&
           outer->hi.x >= part->hi.x && outer->hi.y >= part->hi.y && outer->hi.z >= part->hi.z;
}

typedef struct {
    Burial         *burial;
    const uint32_t *point;  /* [POINTS * parts]  surfaces */
} Digging;

static void dig_part(const Digging *digging, uint32_t p)
{
    Burial           *b = digging->burial;
    const Inspection *out = b->in->out;
    const Part       *part = &out->part[p];
    uint32_t          around[AROUND_MOST];
    b->inside[p] = UINT32_MAX;
    /* A hollow's own wall is no part of its own; what is seen is not buried. */
    if ((b->in->sighted && part->seen) || (part->closed && part->volume < 0))
        return;
    const Box box = box_around(part->lo, part->hi);
    uint32_t  n = box_tree_meet(&b->solids, &box, box_size(&box), around, AROUND_MOST);
    n = n > AROUND_MOST ? AROUND_MOST : n;
    Place place = PLACE_OUTSIDE;
    for (uint32_t i = 0; i < n && place == PLACE_OUTSIDE; i++) {
        const uint32_t solid = b->solid_part[b->solids.entry[around[i]].item];
        if (solid == p || !box_holds(&out->part[solid], part))
            continue;
        place = part_place(b, digging->point + (size_t)POINTS * p, solid);
        if (place == PLACE_INSIDE)
            b->inside[p] = solid;
    }
    b->given_up[p] = place == PLACE_UNKNOWN;
}

static void dig_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    (void)worker;
    for (uint32_t p = begin; p < end; p++)
        dig_part(context, p);
}

/* First, middle and last surface of each part. */
static uint32_t *choose_points(const Inspector *in)
{
    const Surfaces *s = in->surfaces;
    const uint32_t  parts = in->out->parts;
    uint32_t *point = array_create((size_t)POINTS * parts, sizeof *point, "parts", in->err);
    uint32_t *seen = array_create(parts, sizeof *seen, "parts", in->err);
    for (uint32_t i = 0; point != NULL && seen != NULL && i < s->count; i++) {
        const uint32_t p = s->part[i], n = seen[p]++, count = in->out->part[p].surfaces;
        for (uint32_t k = 0; k < POINTS; k++)
            if (n == (uint32_t)((uint64_t)k * (count - 1) / (POINTS - 1)))
                point[(size_t)POINTS * p + k] = i;
    }
    array_free(seen);
    return point;
}

static bool tell_buried(const Burial *b)
{
    const Inspector *in = b->in;
    for (uint32_t p = 0; p < in->out->parts; p++) {
        const Part *part = &in->out->part[p];
        in->out->unplaced += b->given_up[p];
        if (b->inside[p] == UINT32_MAX)
            continue;
        const Part  *solid = &in->out->part[b->inside[p]];
        const Defect defect = { .kind = DEFECT_INSIDE_SOLID,
                                .face = in->surfaces->surface[part->first].face,
                                .other = in->surfaces->surface[solid->first].face,
                                .at = vec3_lerp(part->lo, part->hi, 0.5),
                                .measure = vec3_length(vec3_sub(part->hi, part->lo)) };
        if (!defects_add(in->defects, &defect, in->err))
            return false;
    }
    return true;
}

static bool dig(Burial *b)
{
    const Inspector *in = b->in;
    const Progress   base = { .stage = "mesh", .done = 1, .energy_left = -1 };
    uint32_t        *point = choose_points(in);
    Digging          digging = { .burial = b, .point = point };
    bool             ok = !error_is_set(in->err);
    if (ok && !parallel_for(in->out->parts, CHUNK, in->options->threads, dig_chunk, &digging,
                            in->monitor, &base))
        ok = error_set(in->err, ERROR_STOPPED, "stopped while looking for buried parts");
    array_free(point);
    return ok && tell_buried(b);
}

bool inspect_parts(Inspector *in)
{
    assert(in->surfaces->part != NULL && in->surfaces->part_count > 0);
    if (!measure_parts(in))
        return false;
    Burial b = { .in = in };
    b.solid = array_create(in->out->parts, sizeof *b.solid, "parts", in->err);
    b.inside = array_create(in->out->parts, sizeof *b.inside, "parts", in->err);
    b.given_up = array_create(in->out->parts, sizeof *b.given_up, "parts", in->err);
    bool ok = !error_is_set(in->err);
    if (ok) {
        find_solids(&b);
        ok = sort_solids(&b) && (b.solids.count == 0 || dig(&b));
    }
    box_tree_clear(&b.solids);
    array_free(b.solid_part);
    array_free(b.solid);
    array_free(b.inside);
    array_free(b.given_up);
    return ok;
}
