/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/beam.h -- a team of rays from one origin, to the nearest hit.
 *
 * Nodes meet the beam as a whole, triangles meet it and then the rays in float (facets.h). What
 * float is sure of waits: the triangle that a ray meets first and between which depths. Only at the
 * end are the hits computed, all of a packet at once, with the operations of probe.h. Where float
 * is not sure - near an edge, two triangles at one depth - what waits and what comes are decided
 * in the packet as everywhere else.
 */
#ifndef RAYCAST_BEAM_H
#define RAYCAST_BEAM_H

#include "raycast/facets.h"
#include "raycast/team.h"

typedef struct {
    Floats   shear[2], size;      /* size: of the direction along the major axis */
    Floats   from, to;            /* depths between which the nearest hit so far lies */
    Words    place;               /* of the triangle that waits */
    unsigned waiting, exact;      /* lanes whose hit waits; whose hit is in the packet */
    bool     ready;               /* the packet is filled in */
} BeamPacket;

/* Rays that spread further than this, in shears from the middle, share little of a tree; and where
 * so many nodes and leaves lie in the way of a beam that few rays can reach each, the team starts
 * again without it. */
#define BEAM_HALF_MAX 0.125f
#define BEAM_STEPS 512u

/* A group's triangles against the shears of several packets at once, four lanes each. */
#define BEAM_AT_ONCE (LANES / 4)
#define BEAM_PARTS (TEAM / BEAM_AT_ONCE)

typedef struct {
    Beam       beam;
    Range      range; /* of rays with directions of size 1 along the major axis */
    float      reach;  /* a face that looks away: how far behind it another may win, in depth */
    float      t_min;  /* the depth beyond which all rays have begun */
    Floats     middle[2][BEAM_PARTS], half[2][BEAM_PARTS]; /* of the packets' shears */
    BeamPacket packet[TEAM];
} BeamTeam;

/* Whether all rays start in one place. */
LANES_INLINE bool beam_takes(const Team *t)
{
    const unsigned all = (unsigned)((UINT64_C(1) << LANES) - 1);
    const Ray *first = t->bundle[0].ray[0];
    const float o[3] = { first->ox, first->oy, first->oz };
    unsigned same = all;
    for (unsigned i = 0; i < TEAM; i++)
        for (int k = 0; k < 3; k++)
            same &= floats_equal(t->bundle[i].field[k], floats_all(o[k]));
    return same == all;
}

/* The range of one origin, widened as probe.h says, and of shears; one over a shear may be off by
 * three roundings and is lifted as there. */
LANES_INLINE void beam_range(BeamTeam *w, const Bvh *bvh, const float origin[3],
                             const float from[2], const float to[2], unsigned octant)
{
    const int z = w->beam.axis[2];
    float reach[3], sum = 0;
    for (int k = 0; k < 3; k++) {
        const float a = fabsf(bvh->lo[k] - origin[k]), b = fabsf(bvh->hi[k] - origin[k]);
        reach[k] = a > b ? a : b;
    }
    for (int i = 0; i < 3; i++) {
        const int k = w->beam.axis[i];
        const float margin = PROBE_MARGIN * (fabsf(origin[k]) + reach[k] + reach[z]);
        const bool negative = octant >> k & 1;
        sum += margin;
        w->beam.origin[i] = origin[k];
        w->range.near_origin[k] = negative ? origin[k] - margin : origin[k] + margin;
        w->range.far_origin[k] = negative ? origin[k] + margin : origin[k] - margin;
        const float low = i == 2 ? w->beam.forward : from[i] * w->beam.forward;
        const float high = i == 2 ? w->beam.forward : to[i] * w->beam.forward;
        const float small = fmaxf(fminf(fabsf(low), fabsf(high)), PROBE_SMALLEST_SLOPE);
        const float large = fmaxf(fmaxf(fabsf(low), fabsf(high)), PROBE_SMALLEST_SLOPE);
        const float least = (1 - FACETS_SLACK / 2) / large, most = (1 + FACETS_SLACK / 2) / small;
        w->range.inverse_from[k] = negative ? -most : least;
        w->range.inverse_to[k] = negative ? -least : most;
    }
    w->reach = BEST_GRADIENT * sum * (1 + FACETS_SLACK);
}

static inline float sse_least(__m128 a)
{
    a = _mm_min_ps(a, _mm_movehl_ps(a, a));
    return _mm_cvtss_f32(_mm_min_ss(a, _mm_shuffle_ps(a, a, 1)));
}

/* Between which values the shears along axis[k] lie, of each packet and of all. No shear is larger
 * than a little over 1, so what is added covers the rounding of middle and half. */
LANES_INLINE void beam_shears(BeamTeam *w, int k, float *from, float *to)
{
    const BeamPacket *p = w->packet;
    const __m128 less = _mm_set1_ps(0.5f), more = _mm_set1_ps(4 * PROBE_ROUNDING);
    const __m128 low = floats_four(p[0].shear[k], p[1].shear[k], p[2].shear[k], p[3].shear[k],
                                   false);
    const __m128 high = floats_four(p[0].shear[k], p[1].shear[k], p[2].shear[k], p[3].shear[k],
                                    true);
    const __m128 middle = _mm_mul_ps(less, _mm_add_ps(low, high));
    const __m128 half = _mm_fmadd_ps(less, _mm_sub_ps(high, low), more);
    for (unsigned part = 0; part < BEAM_PARTS; part++) {
        w->middle[k][part] = floats_stretch(middle, (int)(part * BEAM_AT_ONCE));
        w->half[k][part] = floats_stretch(half, (int)(part * BEAM_AT_ONCE));
    }
    *from = sse_least(low);
    *to = -sse_least(_mm_xor_ps(high, _mm_set1_ps(-0.0f)));
    w->beam.middle[k] = 0.5f * (*from + *to);
    w->beam.half[k] = 0.5f * (*to - *from) + 4 * PROBE_ROUNDING;
}

LANES_INLINE void beam_init(BeamTeam *w, const Team *t, const Bvh *bvh)
{
    const Packet *kind = &t->packet[0];
    const int *axis = kind->axis;
    Floats begin = floats_all(INFINITY), begun = floats_all(0);
    w->beam.forward = kind->backward ? -1 : 1;
    for (unsigned i = 0; i < TEAM; i++) {
        BeamPacket *p = &w->packet[i];
        const Floats *field = t->bundle[i].field;
        p->size = floats_abs(field[4 + axis[2]]);
        const Floats inverse = floats_sign_of(floats_all(1) / p->size, field[4 + axis[2]]);
        for (int k = 0; k < 2; k++)
            p->shear[k] = field[4 + axis[k]] * inverse;
        const Floats from = field[3] * p->size, to = field[7] * p->size;
        begin = floats_min(begin, from);
        begun = floats_max(begun, from);
        p->from = to * floats_all(1 - FACETS_SLACK);
        p->to = to * floats_all(1 + FACETS_SLACK);
        p->waiting = p->exact = 0;
        p->ready = false;
    }
    const Ray *first = t->bundle[0].ray[0];
    const float origin[3] = { first->ox, first->oy, first->oz };
    float from[2], to[2];
    for (int k = 0; k < 3; k++)
        w->beam.axis[k] = axis[k];
    for (int k = 0; k < 2; k++)
        beam_shears(w, k, &from[k], &to[k]);
    w->beam.t_min = w->range.t_min_least = floats_least(begin) * (1 - FACETS_SLACK);
    w->t_min = floats_most(begun) * (1 + FACETS_SLACK);
    beam_range(w, bvh, origin, from, to, kind->octant);
}

LANES_INLINE void beam_limit(BeamTeam *w)
{
    Floats most = w->packet[0].to;
    for (unsigned i = 1; i < TEAM; i++)
        most = floats_max(most, w->packet[i].to);
    w->beam.limit = floats_most(most);
}

/* Forgets what the packet knows of `lanes`. */
LANES_INLINE void beam_forget(Packet *p, const Bundle *b, unsigned lanes)
{
    const Floats none = floats_all(0), end = b->field[7];
    p->t = floats_pick(lanes, end, p->t);
    p->facing_t = floats_pick(lanes, end, p->facing_t);
    p->limit = floats_pick(lanes, end, p->limit);
    p->u = floats_pick(lanes, none, p->u);
    p->v = floats_pick(lanes, none, p->v);
    p->facing_u = floats_pick(lanes, none, p->facing_u);
    p->facing_v = floats_pick(lanes, none, p->facing_v);
    p->key = words_pick(lanes, words_all(0), p->key);
    p->facing_key = words_pick(lanes, words_all(0), p->facing_key);
    p->place = words_pick(lanes, words_all(BEST_NOWHERE), p->place);
    p->facing_place = words_pick(lanes, words_all(BEST_NOWHERE), p->facing_place);
    p->front &= ~lanes;
    p->back &= ~lanes;
}

/* Lanes of `lanes` whose triangle that waits is the one of the first of them; *place: which. */
LANES_INLINE unsigned beam_alike(const BeamPacket *w, unsigned lanes, uint32_t *place)
{
    *place = ((const uint32_t *)(const void *)&w->place)[__builtin_ctz(lanes)];
    return lanes & words_equal(w->place, words_all(*place));
}

/* The triangle at `place` may be hit by `lanes`, and float is not sure which hit is the nearest. */
static __attribute__((noinline)) void beam_decide(BeamTeam *w, Team *t, unsigned i, const Bvh *bvh,
                                                  uint32_t place, unsigned lanes)
{
    BeamPacket *own = &w->packet[i];
    Packet *p = &t->packet[i];
    if (!own->ready)
        packet_init(p, bvh, &t->bundle[i]);
    else if ((lanes & ~own->exact) != 0)
        beam_forget(p, &t->bundle[i], lanes & ~own->exact);
    own->ready = true;
    for (unsigned left = lanes & own->waiting, alike; left != 0; left &= ~alike) {
        uint32_t at;
        alike = beam_alike(own, left, &at);
        packet_triangle(p, &bvh->group[at / GROUP_WIDTH], at % GROUP_WIDTH, at & ~(GROUP_WIDTH - 1),
                        alike, false);
    }
    packet_triangle(p, &bvh->group[place / GROUP_WIDTH], place % GROUP_WIDTH,
                    place & ~(GROUP_WIDTH - 1), lanes, false);
    own->waiting &= ~lanes;
    own->exact |= lanes;
    own->from = floats_pick(lanes, p->t * own->size * floats_all(1 - FACETS_SLACK), own->from);
    own->to = floats_pick(lanes, p->limit * own->size * floats_all(1 + FACETS_SLACK), own->to);
}

/* Which packets may hit which triangles: bit 4 i + j for packet i and triangle j. */
LANES_INLINE unsigned beam_pairs(const BeamTeam *w, const Facets *f)
{
    unsigned pairs = 0;
    for (unsigned part = 0; part < BEAM_PARTS; part++) {
        const Floats unsure = floats_repeat(f->unsure);
        unsigned positive = 0, negative = 0;
        for (int k = 0; k < 3; k++) {
            const Floats a = floats_repeat(f->a[k]), b = floats_repeat(f->b[k]);
            const Floats c = floats_repeat(f->c[k]);
            const Floats edge = floats_fused(b, w->middle[0][part],
                                             floats_fused(c, w->middle[1][part], a));
            const Floats width = floats_fused(
                floats_abs(b), w->half[0][part],
                floats_fused(floats_abs(c), w->half[1][part], unsure));
            positive |= floats_less(width, edge);
            negative |= floats_less(edge, -width);
        }
        pairs |= (~(positive & negative) & ((1u << (LANES - 1)) * 2 - 1)) << part * LANES;
    }
    return pairs & f->left * 0x1111u;
}

/* One triangle of `f` against the rays of the packets in `packets`, bit 4 i for packet i; whether
 * any of them took it. */
LANES_INLINE bool beam_triangle(BeamTeam *w, Team *t, const Bvh *bvh, const Facets *f, unsigned j,
                                uint32_t place, unsigned packets)
{
    const float from = ((const float *)&f->from)[j], to = ((const float *)&f->to)[j];
    const float size = ((const float *)&f->unsure)[j];
    const Floats unsure = floats_all(size), other = floats_all(-size);
    Floats a[3], b[3], c[3];
    for (int k = 0; k < 3; k++) {
        a[k] = floats_all(((const float *)&f->a[k])[j]);
        b[k] = floats_all(((const float *)&f->b[k])[j]);
        c[k] = floats_all(((const float *)&f->c[k])[j]);
    }
    bool changed = false;
    for (; packets != 0; packets &= packets - 1) {
        const unsigned i = (unsigned)__builtin_ctz(packets) / 4;
        BeamPacket *p = &w->packet[i];
        Floats e[3];
        for (int k = 0; k < 3; k++)
            e[k] = floats_fused(b[k], p->shear[0], floats_fused(c[k], p->shear[1], a[k]));
        const Floats least = floats_min(floats_min(e[0], e[1]), e[2]);
        const Floats most = floats_max(floats_max(e[0], e[1]), e[2]);
        const unsigned out = floats_less(least, other) & floats_less(unsure, most);
        const unsigned lanes = ~out & floats_less_equal(floats_all(from), p->to);
        if (lanes == 0)
            continue;
        const unsigned positive = floats_less(unsure, least);
        const unsigned sure = positive | floats_less(most, other);
        /* From one place all rays see the same side. */
        const bool back = (positive == 0) == (w->beam.forward > 0);
        const float end = back ? to + w->reach : to;
        unsigned take = 0;
        if (from > w->t_min)
            take = lanes & sure & floats_less(floats_all(end), p->from);
        if (take != 0) {
            p->from = floats_pick(take, floats_all(from), p->from);
            p->to = floats_pick(take, floats_all(end), p->to);
            p->place = words_pick(take, words_all(place + j), p->place);
            p->waiting |= take;
            p->exact &= ~take;
        }
        if ((lanes & ~take) != 0)
            beam_decide(w, t, i, bvh, place + j, lanes & ~take);
        changed = true;
    }
    return changed;
}

LANES_INLINE void beam_leaf(BeamTeam *w, Team *t, const Bvh *bvh, uint32_t leaf)
{
    const uint32_t begin = child_group(leaf), end = begin + child_group_count(leaf);
    for (uint32_t g = begin; g < end; g++) {
        Facets f;
        facets_fill(&f, &w->beam, &bvh->group[g]);
        if (f.left == 0)
            continue;
        const unsigned pairs = beam_pairs(w, &f);
        bool changed = false;
        for (unsigned left = f.left; left != 0; left &= left - 1) {
            const unsigned j = (unsigned)__builtin_ctz(left);
            changed |= beam_triangle(w, t, bvh, &f, j, g * GROUP_WIDTH, pairs >> j & 0x1111);
        }
        if (changed)
            beam_limit(w);
    }
}

/* --- the answers ----------------------------------------------------------------------------- */

/* The corners of the triangles that wait, lane by lane, as the rays see them. */
LANES_INLINE void beam_seen(const BeamTeam *w, const BeamPacket *own, const Bvh *bvh, Seen *s,
                            Words *primitive)
{
    Floats at[3][3];
    for (int c = 0; c < 3; c++)
        at[c][0] = at[c][1] = at[c][2] = floats_all(0);
    *primitive = words_all(RAY_MISS);
    for (unsigned left = own->waiting, alike; left != 0; left &= ~alike) {
        uint32_t place;
        alike = beam_alike(own, left, &place);
        const TriangleGroup *group = &bvh->group[place / GROUP_WIDTH];
        const uint32_t j = place % GROUP_WIDTH;
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++)
                at[c][k] = floats_pick(alike, floats_all(group->vertex[c][w->beam.axis[k]][j]),
                                       at[c][k]);
        *primitive = words_pick(alike, words_all(group->primitive[j]), *primitive);
    }
    for (int c = 0; c < 3; c++) {
        s->z[c] = at[c][2] - floats_all(w->beam.origin[2]);
        s->x[c] = (at[c][0] - floats_all(w->beam.origin[0])) - own->shear[0] * s->z[c];
        s->y[c] = (at[c][1] - floats_all(w->beam.origin[1])) - own->shear[1] * s->z[c];
    }
}

LANES_INLINE void beam_answers(const BeamTeam *w, Team *t, unsigned i, const Bvh *bvh, Hit *hit,
                               const uint32_t *order)
{
    const unsigned all = (unsigned)((UINT64_C(1) << LANES) - 1);
    const BeamPacket *own = &w->packet[i];
    const Bundle *b = &t->bundle[i];
    const unsigned lanes = all & ~own->exact;
    if (lanes != 0) {
        Seen s;
        Solved at;
        Words primitive;
        Doubles inverse_z[2];
        float *out[LANES];
        const Floats zero = floats_all(0);
        beam_seen(w, own, bvh, &s, &primitive);
        for (int half = 0; half < 2; half++)
            inverse_z[half] = doubles_all(1) / doubles_of(b->field[4 + w->beam.axis[2]], half);
        packet_solve(&at, &s, inverse_z, own->waiting);
        for (unsigned k = 0; k < LANES; k++)
            out[k] = (float *)(void *)&hit[order != NULL ? order[k] : k];
        floats_scatter(out, lanes,
                       floats_pick(own->waiting, at.t, b->field[7]),
                       floats_pick(own->waiting, at.u + zero, zero),
                       floats_pick(own->waiting, at.v + zero, zero), floats_bits(primitive));
    }
    if (own->exact != 0)
        packet_answers(&t->packet[i], bvh, b, own->exact, hit, order);
}

/* False: given up, too much lies in the way. */
LANES_INLINE bool beam_walk(BeamTeam *w, Team *t, const Bvh *bvh)
{
    float near[BVH_STACK];
    uint32_t child[BVH_STACK], top = 1, steps = 0;
    const unsigned octant = t->packet[0].octant;
    child[0] = 0;
    near[0] = w->beam.t_min;
    beam_limit(w);
    while (top > 0) {
        top--;
        if (near[top] > w->beam.limit)
            continue;
        if (++steps > BEAM_STEPS)
            return false;
        if (child_is_leaf(child[top])) {
            beam_leaf(w, t, bvh, child[top]);
            continue;
        }
        const Node *node = &bvh->node[child[top]];
        _Alignas(32) float at[NODE_WIDTH];
        unsigned slots = range_slots(&w->range, octant, node, w->beam.limit, at);
        for (; slots != 0; slots &= slots - 1) {
            const unsigned s = (unsigned)__builtin_ctz(slots) ^ octant;
            near[top] = at[s];
            child[top++] = node->child[s];
        }
    }
    return true;
}

/* False: nothing was done. */
static __attribute__((noinline)) bool beam_some(Team *t, const Bvh *bvh, Hit *hit,
                                                const uint32_t *order)
{
    BeamTeam w;
    beam_init(&w, t, bvh);
    if (!(w.beam.half[0] <= BEAM_HALF_MAX && w.beam.half[1] <= BEAM_HALF_MAX)
        || !beam_walk(&w, t, bvh))
        return false;
    for (unsigned i = 0; i < TEAM; i++)
        beam_answers(&w, t, i, bvh, order != NULL ? hit : hit + (size_t)i * LANES,
                     order != NULL ? order + (size_t)i * LANES : NULL);
    return true;
}

#endif
