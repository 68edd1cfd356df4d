/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/packet_many.h -- many rays in teams, packets or alone, and what they ask of sort.h. */
#ifndef RAYCAST_PACKET_MANY_H
#define RAYCAST_PACKET_MANY_H

#include <string.h>

#include "raycast/beam.h"

/* --- many rays ------------------------------------------------------------------------------- */

/* Lanes like lane `first`: the same major axis and signs; sets those in *p. */
LANES_INLINE unsigned packet_kind(Packet *p, const Bundle *b, unsigned lanes)
{
    const unsigned first = (unsigned)__builtin_ctz(lanes);
    const Floats d[3] = { b->field[4], b->field[5],
                          b->field[6] };
    p->octant = 0;
    unsigned alike = lanes;
    for (unsigned k = 0; k < 3; k++) {
        const unsigned negative = floats_signs(d[k]);
        p->octant |= (negative >> first & 1) << k;
        alike &= negative >> first & 1 ? negative : ~negative;
    }
    /* As probe_init chooses the axis. */
    const Floats x = floats_abs(d[0]), y = floats_abs(d[1]), z = floats_abs(d[2]);
    const unsigned yx = floats_less(y, x), zx = floats_less(z, x), zy = floats_less(z, y);
    const unsigned on[3] = { yx & zx, ~yx & zy, ~((yx & zx) | (~yx & zy)) };
    const int axis = on[0] >> first & 1 ? 0 : on[1] >> first & 1 ? 1 : 2;
    p->axis[2] = axis;
    p->axis[0] = axis == 2 ? 0 : axis + 1;
    p->axis[1] = p->axis[0] == 2 ? 0 : p->axis[0] + 1;
    p->backward = p->octant >> axis & 1;
    return alike & on[axis];
}

/* Returns the lanes that probe_init can take and that have a range at all. */
LANES_INLINE unsigned bundle_fill(Bundle *b, const Ray *ray, size_t count)
{
    for (unsigned i = 0; i < LANES; i++)
        b->ray[i] = &ray[i < count ? i : 0];
    floats_fields((const float *const *)(const void *)b->ray, b->field);
    const Floats length = floats_abs(b->field[4]) + floats_abs(b->field[5])
                          + floats_abs(b->field[6]);
    const Floats reach = floats_abs(b->field[0]) + floats_abs(b->field[1])
                         + floats_abs(b->field[2]);
    const unsigned good = floats_less_equal(floats_all(PROBE_LENGTH_MIN), length)
                          & floats_less_equal(length, floats_all(PROBE_LENGTH_MAX))
                          & floats_less_equal(reach, floats_all(PROBE_COORDINATE_MAX))
                          & floats_less_equal(b->field[3], b->field[7]);
    return count < LANES ? good & ((1u << count) - 1) : good;
}

LANES_INLINE void packet_told(Packet *p, const Bvh *bvh, const Bundle *b, unsigned lanes,
                              Hit *hit, bool *blocked, const uint32_t *order)
{
    if (hit != NULL) {
        packet_answers(p, bvh, b, lanes, hit, order);
        return;
    }
    for (; lanes != 0; lanes &= lanes - 1) {
        const unsigned i = (unsigned)__builtin_ctz(lanes);
        blocked[order != NULL ? order[i] : i] = p->blocked >> i & 1;
    }
}

/* The next up to LANES rays; `order` NULL: one after the other. Returns how many subtrees were
 * walked by one ray alone. */
LANES_INLINE unsigned packet_some(const Bvh *bvh, const Ray *ray, const uint32_t *order,
                                  size_t count, int few, Hit *hit, bool *blocked)
{
    Bundle b;
    Packet p;
    unsigned alone = 0;
    const unsigned all = count < LANES ? (1u << count) - 1 : (unsigned)((UINT64_C(1) << LANES) - 1);
    const unsigned good = bundle_fill(&b, ray, count);
    for (unsigned left = good; left != 0;) {
        const unsigned lanes = packet_kind(&p, &b, left);
        left &= ~lanes;
        packet_init(&p, bvh, &b);
        p.few = few;
        packets_range(&p, &lanes, 1, &p.range);
        packet_walk(&p, bvh, &b, lanes, 0, &p.t_min, hit == NULL);
        alone += p.alone;
        packet_told(&p, bvh, &b, lanes, hit, blocked, order);
    }
    for (unsigned odd = all & ~good; odd != 0; odd &= odd - 1) {
        const unsigned i = (unsigned)__builtin_ctz(odd);
        const uint32_t at = order != NULL ? order[i] : i;
        Hit one;
        const bool found = nearest_one(bvh, &ray[i], hit != NULL ? &hit[at] : &one);
        if (hit == NULL)
            blocked[at] = found;
    }
    return alone;
}

/* TEAM * LANES rays when they are all of one kind; false: nothing was done. */
LANES_INLINE bool team_some(const Bvh *bvh, const Ray *ray, const uint32_t *order, int few,
                            Hit *hit, bool *blocked, unsigned *alone)
{
    const unsigned all = (unsigned)((UINT64_C(1) << LANES) - 1);
    Team t;
    for (unsigned i = 0; i < TEAM; i++) {
        Packet *p = &t.packet[i];
        if (bundle_fill(&t.bundle[i], ray + (size_t)i * LANES, LANES) != all
            || packet_kind(p, &t.bundle[i], all) != all
            || p->octant != t.packet[0].octant || p->axis[2] != t.packet[0].axis[2])
            return false;
        t.lanes[i] = all;
    }
    if (hit != NULL && bvh->shape_count == 0 && beam_takes(&t) && beam_some(&t, bvh, hit, order))
        return true;
    for (unsigned i = 0; i < TEAM; i++) {
        packet_init(&t.packet[i], bvh, &t.bundle[i]);
        t.packet[i].few = few;
    }
    packets_range(t.packet, t.lanes, TEAM, &t.range);
    team_walk(&t, bvh, hit == NULL);
    for (unsigned i = 0; i < TEAM; i++) {
        const size_t at = order != NULL ? 0 : (size_t)i * LANES;
        packet_told(&t.packet[i], bvh, &t.bundle[i], all, hit != NULL ? hit + at : NULL,
                    hit != NULL ? NULL : blocked + at,
                    order != NULL ? order + (size_t)i * LANES : NULL);
        *alone += t.packet[i].alone;
    }
    return true;
}

/* --- teams, packets or rays alone ------------------------------------------------------------ */

/* Rays begin..end-1 in teams and packets; subtrees walked alone. */
LANES_INLINE unsigned packet_run(const Bvh *bvh, const Ray *ray, const uint32_t *order,
                                 size_t begin, size_t end, int few, Hit *hit, bool *blocked)
{
    /* Segments between any points have less in common than the rays of a tile or a beam. */
    const bool teams = hit != NULL || order == NULL;
    unsigned alone = 0;
    for (size_t i = begin, step; i < end; i += step) {
        step = TEAM * LANES;
        const size_t at = order != NULL ? 0 : i;
        const uint32_t *places = order != NULL ? order + i : NULL;
        Hit *hits = hit != NULL ? hit + at : NULL;
        bool *seen = hit != NULL ? NULL : blocked + at;
        if (teams && end - i >= step && team_some(bvh, ray + i, places, few, hits, seen, &alone))
            continue;
        step = LANES;
        alone += packet_some(bvh, ray + i, places, end - i, few, hits, seen);
    }
    return alone;
}

/* Rays are tried together at the start of each stretch. A subtree walked alone costs a ray about
 * what it would cost without the packet; from one and a half of them the packet is in vain. Sorted
 * rays go in herds well before that. */
#define STRETCH 4096u
#define STRETCH_TRIAL 256u
#define STRETCH_ALONE (STRETCH_TRIAL * 3 / 2)
#define HERD_ALONE (STRETCH_TRIAL / 2)

LANES_INLINE void packets_trace(const Bvh *bvh, const Ray *ray, const uint32_t *order,
                                size_t count, Hit *hit, bool *blocked)
{
    for (size_t i = 0; i < count; i += STRETCH) {
        const size_t end = count - i < STRETCH ? count : i + STRETCH;
        const size_t trial = end - i < STRETCH_TRIAL ? end : i + STRETCH_TRIAL;
        const unsigned alone = packet_run(bvh, ray, order, i, trial, PACKET_ALONE_TRIAL, hit,
                                          blocked);
        if (trial == end)
            continue;
        if (alone <= (hit != NULL && order != NULL ? HERD_ALONE : STRETCH_ALONE))
            packet_run(bvh, ray, order, trial, end, PACKET_ALONE, hit, blocked);
        else if (hit != NULL && order != NULL)
            herds_nearest(bvh, ray + trial, order + trial, end - trial, hit);
        else if (order != NULL)
            stream_trace(bvh, ray + trial, order + trial, end - trial, NULL, blocked);
        else
            stream_trace(bvh, ray + trial, NULL, end - trial, hit != NULL ? hit + trial : NULL,
                         hit != NULL ? NULL : blocked + trial);
    }
}

static void packets_nearest(const Bvh *bvh, const Ray *ray, const uint32_t *order, size_t count,
                            Hit *hit)
{
    packets_trace(bvh, ray, order, count, hit, NULL);
}

/* Sorted segments are tried once. In a tree of a node or two packets have less to do than crowds;
 * where the tree does not fit into a cache, rays in turns wait less. */
#define SEGMENTS_ALONE (STRETCH_TRIAL / 4)
#define CROWD_TREE ((size_t)32 << 20)

static void packets_blocked(const Bvh *bvh, const Ray *ray, const uint32_t *order, size_t count,
                            bool *blocked)
{
    const size_t trial = count < STRETCH_TRIAL ? count : STRETCH_TRIAL;
    if (order == NULL || bvh->bytes >= CROWD_TREE) {
        packets_trace(bvh, ray, order, count, NULL, blocked);
    } else if (packet_run(bvh, ray, order, 0, trial, PACKET_ALONE_TRIAL, NULL, blocked)
               <= SEGMENTS_ALONE) {
        packet_run(bvh, ray, order, trial, count, PACKET_ALONE, NULL, blocked);
    } else {
        crowds_blocked(bvh, ray + trial, order + trial, count - trial, blocked);
    }
}

/* --- sorting --------------------------------------------------------------------------------- */

/* Keys of LANES rays at ray[0], ray[1] ...: kind above, cell below (sort.h). */
LANES_INLINE void keys_some(const Cells *cells, const float *const row[LANES], uint32_t key[LANES])
{
    Floats f[8];
    floats_fields(row, f);
    const Floats x = floats_abs(f[4]), y = floats_abs(f[5]), z = floats_abs(f[6]);
    const unsigned yx = floats_less(y, x), zx = floats_less(z, x), zy = floats_less(z, y);
    const unsigned on_x = yx & zx, on_y = ~yx & zy;
    const Floats major = floats_pick(on_x, x, floats_pick(on_y, y, z));
    const Floats first = floats_pick(on_x, y, floats_pick(on_y, z, x));
    const Floats second = floats_pick(on_x, z, floats_pick(on_y, x, y));
    const Floats scale = floats_all(cells->scale[0]) / major;
    const Words most = words_all((1u << CELL_LEVELS) - 1), least = words_all(0);
    const Words axis = words_pick(on_x, least, words_pick(on_y, words_all(8), words_all(16)));
    Words kind = words_or(axis, words_sign(f[4]));
    kind = words_or(kind, words_left(words_sign(f[5]), 1));
    kind = words_or(kind, words_left(words_sign(f[6]), 2));
    Words all = words_left(kind, cells->bits);
    for (int k = 0; k < CELL_DIMENSIONS; k++) {
        const Floats at = k == 0   ? first * scale
                          : k == 1 ? second * scale
                                   : (f[k - 2] - floats_all(cells->lo[k - 2]))
                                         * floats_all(cells->scale[k]);
        /* NaN too ends somewhere. */
        const Words place = words_max(words_min(words_of(at), most), least);
        all = words_or(all, words_lookup(cells->spread[k], place));
    }
    words_store(key, all);
}

static void packets_keys(const Cells *cells, const Ray *ray, size_t count, uint32_t *key)
{
    for (size_t i = 0; i < count; i += LANES) {
        const float *row[LANES];
        _Alignas(64) uint32_t some[LANES];
        const size_t n = count - i < LANES ? count - i : LANES;
        for (size_t j = 0; j < LANES; j++)
            row[j] = (const float *)&ray[i + (j < n ? j : 0)];
        keys_some(cells, row, some);
        memcpy(key + i, some, n * sizeof *some);
    }
}

#endif
