/* SPDX-License-Identifier: BSD-3-Clause */
/* Triangles cut by planes: a reference whose box a plane cuts is put on both sides, with the part
 * of its box that the triangle needs there [stich09]. The parts' boxes together hold all of what
 * the box held of the triangle, so a ray that meets it meets one of them (probe.h). */
#include <assert.h>
#include <float.h>
#include <string.h>

#include "raycast/pairs.h"
#include "raycast/probe.h"

/* A point of an edge is computed in float by five operations, each off by half an ulp of the larger
 * end at most: with both ends' sum this is three times that. */
#define CHOP_ROUNDING (16 * PROBE_ROUNDING)

typedef struct {
    Float4 corner[3];
} Corners;

static Corners corners_of(const Primitives *in, uint32_t triangle)
{
    Corners c;
    for (int i = 0; i < 3; i++) {
        const Vec3 p = in->position[in->corner[3 * (size_t)triangle + (size_t)i]];
        c.corner[i] = (Float4){ (float)p.x, (float)p.y, (float)p.z, 0 };
    }
    return c;
}

static inline Float4 float4_abs(Float4 a)
{
    const Int4 mask = { INT32_MAX, INT32_MAX, INT32_MAX, INT32_MAX };
    return (Float4)((Int4)a & mask);
}

static bool box_is_empty(Box box)
{
    return !(box.lo[0] <= box.hi[0] && box.lo[1] <= box.hi[1] && box.lo[2] <= box.hi[2]);
}

static Box box_common(Box a, Box b)
{
    return (Box){ float4_max(a.lo, b.lo), float4_min(a.hi, b.hi) };
}

/* Boxes around what a triangle has on either side of a plane, within `piece`; an empty one where it
 * has nothing. */
static void triangle_chop(const Corners *t, Box piece, int axis, float plane, Box side[2])
{
    side[0] = side[1] = box_empty();
    for (int i = 0; i < 3; i++) {
        const Float4 a = t->corner[i], b = t->corner[i == 2 ? 0 : i + 1];
        if (a[axis] <= plane)
            side[0] = box_point(side[0], a);
        if (a[axis] >= plane)
            side[1] = box_point(side[1], a);
        if (!((a[axis] < plane && b[axis] > plane) || (a[axis] > plane && b[axis] < plane)))
            continue;
        const float at = (plane - a[axis]) / (b[axis] - a[axis]);
        const Float4 p = a + (b - a) * at;
        const Float4 off = (float4_abs(a) + float4_abs(b)) * CHOP_ROUNDING + FLT_MIN;
        for (int s = 0; s < 2; s++)
            side[s] = box_point(box_point(side[s], p - off), p + off);
    }
    side[0].hi[axis] = fminf(side[0].hi[axis], plane);
    side[1].lo[axis] = fmaxf(side[1].lo[axis], plane);
    side[0] = box_common(side[0], piece);
    side[1] = box_common(side[1], piece);
}

/* --- bins ------------------------------------------------------------------------------------ */

ChopMap chop_map(Box box)
{
    ChopMap map = { .lo = box.lo };
    const Float4 extent = box.hi - box.lo;
    for (int k = 0; k < 3; k++) {
        const float scale = CHOP_BINS / extent[k];
        map.step[k] = extent[k] / CHOP_BINS;
        map.scale[k] = extent[k] > 0 && isfinite(scale) ? scale : 0;
    }
    return map;
}

void chops_clear(ChopBins *bins)
{
    memset(bins, 0, sizeof *bins);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < CHOP_BINS; i++)
            bins->box[k][i] = box_empty();
}

void chops_join(ChopBins *bins, const ChopBins *other)
{
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < CHOP_BINS; i++) {
            bins->box[k][i] = box_join(bins->box[k][i], other->box[k][i]);
            bins->enter[k][i] += other->enter[k][i];
            bins->leave[k][i] += other->leave[k][i];
        }
}

static inline int chop_bin(const ChopMap *map, int axis, float x)
{
    const int bin = (int)((x - map->lo[axis]) * map->scale[axis]);
    return bin < 0 ? 0 : bin < CHOP_BINS ? bin : CHOP_BINS - 1;
}

static inline float chop_plane(const ChopMap *map, int axis, int bin)
{
    return map->lo[axis] + map->step[axis] * (float)bin;
}

/* Pieces from bin to bin. */
static void chops_add(ChopBins *bins, const ChopMap *map, int axis, int first, int last,
                      const Corners *t, Box piece)
{
    bins->enter[axis][first]++;
    bins->leave[axis][last]++;
    for (int i = first; i < last; i++) {
        Box side[2];
        triangle_chop(t, piece, axis, chop_plane(map, axis, i + 1), side);
        if (!box_is_empty(side[0]))
            bins->box[axis][i] = box_join(bins->box[axis][i], side[0]);
        piece = side[1];
        if (box_is_empty(piece))
            return;
    }
    bins->box[axis][last] = box_join(bins->box[axis][last], piece);
}

void chops_fill(ChopBins *bins, const ChopMap *map, const Primitives *in, const Ref *ref,
                uint32_t count)
{
    chops_clear(bins);
    for (uint32_t i = 0; i < count; i++) {
        const Ref *r = &ref[i];
        const Box box = ref_box(r);
        const bool whole = r->primitive >= in->triangle_count;
        Corners t;
        bool read = false;
        for (int k = 0; k < 3; k++) {
            if (!(map->scale[k] > 0))
                continue;
            const float middle = 0.5f * (r->lo[k] + r->hi[k]);
            const int first = chop_bin(map, k, whole ? middle : r->lo[k]);
            const int last = whole ? first : chop_bin(map, k, r->hi[k]);
            if (first < last && !read) {
                t = corners_of(in, r->primitive);
                read = true;
            }
            chops_add(bins, map, k, first, last, &t, box);
        }
    }
}

static Chop cheapest_on_axis(const ChopBins *bins, const ChopMap *map, int axis)
{
    Box right[CHOP_BINS], left = box_empty();
    uint32_t leave[CHOP_BINS], enter = 0, sum = 0;
    Chop best = { .axis = SPLIT_NONE, .cost = INFINITY };
    right[CHOP_BINS - 1] = bins->box[axis][CHOP_BINS - 1];
    for (int i = CHOP_BINS - 1; i > 0; i--) {
        leave[i] = sum += bins->leave[axis][i];
        right[i] = i == CHOP_BINS - 1 ? right[i] : box_join(right[i + 1], bins->box[axis][i]);
    }
    for (int i = 1; i < CHOP_BINS; i++) {
        left = box_join(left, bins->box[axis][i - 1]);
        enter += bins->enter[axis][i - 1];
        if (enter == 0 || leave[i] == 0)
            continue;
        const float cost = box_area(left) * groups_of(enter) + box_area(right[i])
                                                                   * groups_of(leave[i]);
        if (cost < best.cost)
            best = (Chop){ .axis = axis, .plane = chop_plane(map, axis, i), .cost = cost,
                           .count = { enter, leave[i] }, .box = { left, right[i] } };
    }
    return best;
}

Chop chops_cheapest(const ChopBins *bins, const ChopMap *map)
{
    Chop best = { .axis = SPLIT_NONE, .cost = INFINITY };
    for (int k = 0; k < 3; k++) {
        if (!(map->scale[k] > 0))
            continue;
        const Chop chop = cheapest_on_axis(bins, map, k);
        if (chop.cost < best.cost)
            best = chop;
    }
    return best;
}

/* --- the cut --------------------------------------------------------------------------------- */

/* One that the plane cuts goes to one side alone where that costs less [stich09]. */
static uint32_t cut_side(const Chop *chop, const Ref *ref, const Box side[2])
{
    if (box_is_empty(side[0]))
        return CHOP_RIGHT;
    if (box_is_empty(side[1]))
        return CHOP_LEFT;
    const Box box = ref_box(ref);
    const float left = (float)chop->count[0], right = (float)chop->count[1];
    const float area[2] = { box_area(chop->box[0]), box_area(chop->box[1]) };
    const float both = area[0] * left + area[1] * right;
    const float to_left = box_area(box_join(chop->box[0], box)) * left + area[1] * (right - 1);
    const float to_right = area[0] * (left - 1) + box_area(box_join(chop->box[1], box)) * right;
    if (both < to_left && both < to_right)
        return CHOP_BOTH;
    return to_left <= to_right ? CHOP_LEFT : CHOP_RIGHT;
}

void chop_sides(const Chop *chop, const Primitives *in, Ref *ref, uint32_t count,
                uint32_t sides[2])
{
    const int k = chop->axis;
    for (uint32_t i = 0; i < count; i++) {
        Ref *r = &ref[i];
        uint32_t side;
        if (r->primitive >= in->triangle_count)
            side = 0.5f * (r->lo[k] + r->hi[k]) < chop->plane ? CHOP_LEFT : CHOP_RIGHT;
        else if (r->hi[k] <= chop->plane)
            side = CHOP_LEFT;
        else if (r->lo[k] >= chop->plane)
            side = CHOP_RIGHT;
        else {
            Box part[2];
            const Corners t = corners_of(in, r->primitive);
            triangle_chop(&t, ref_box(r), k, chop->plane, part);
            side = cut_side(chop, r, part);
        }
        r->unused = side;
        sides[0] += side != CHOP_RIGHT;
        sides[1] += side != CHOP_LEFT;
    }
}

static void side_take(Ref **to, const Ref *ref, Box part, Box *box, Box *centre)
{
    Ref *r = (*to)++;
    memcpy(r->lo, &part.lo, sizeof r->lo);
    memcpy(r->hi, &part.hi, sizeof r->hi);
    r->primitive = ref->primitive;
    r->unused = 0;
    *box = box_join(*box, part);
    *centre = box_point(*centre, box_centre(part));
}

void chop_scatter(const Chop *chop, const Primitives *in, const Ref *ref, uint32_t count,
                  Ref *left, Ref *right, Box box[2], Box centre[2])
{
    Ref *to[2] = { left, right };
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t side = ref[i].unused;
        Box part[2] = { ref_box(&ref[i]), ref_box(&ref[i]) };
        if (side == CHOP_BOTH) {
            const Corners t = corners_of(in, ref[i].primitive);
            triangle_chop(&t, part[0], chop->axis, chop->plane, part);
        }
        for (uint32_t s = 0; s < 2; s++)
            if (side == s || side == CHOP_BOTH)
                side_take(&to[s], &ref[i], part[s], &box[s], &centre[s]);
    }
}
