/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/best.h -- which of a ray's hits is the answer.
 *
 * Order    first is the hit of least t; at the same t one that faces the ray comes before one that
 *          does not, then the smaller primitive. When `first` does not face the ray, the hit in the
 *          same order that does is kept too, as `facing`.
 * Answer   `first`, or `facing` when it lies so near behind that rounding alone may have put it
 *          there: two faces in one place, cut into triangles in two ways. Both are minima over all
 *          hits, so the answer depends neither on the tree nor on the order of the tests. What lies
 *          further than `limit` changes nothing; as `first` only moves nearer, so does `limit`.
 * Rounding probe.h: a hit's plane is off by at most half of margin[k] along axis k, its float
 *          vertices included; two planes in one place by the whole. Along the ray that makes
 *          (m_z + |g_x| m_x + |g_y| m_y) / |d_z|, g the plane's gradient in the ray's frame:
 *          g_x = n_x d_z / (n . d). Beyond a gradient of BEST_GRADIENT, where rays graze at about a
 *          degree, faces in one place may be told apart wrongly.
 */
#ifndef RAYCAST_BEST_H
#define RAYCAST_BEST_H

#include <math.h>

#include "raycast/internal.h"

#define BEST_GRADIENT 64.0f
#define BEST_BACK (UINT32_C(1) << 31)
#define BEST_NOWHERE UINT32_MAX

typedef struct {
    float    t, u, v;
    uint32_t key;   /* primitive, and BEST_BACK when it does not face the ray; of no hit: 0 */
    uint32_t place; /* of a triangle: its lane among those of all groups; of no hit: BEST_NOWHERE */
} Candidate;

typedef struct {
    float     limit;  /* hits beyond do not count */
    Candidate first;  /* t is the ray's end while nothing was hit; so it is below */
    Candidate facing; /* kept while first does not face the ray */
} Best;

static inline Best best_none(float t_max)
{
    const Candidate none = { .t = t_max, .place = BEST_NOWHERE };
    return (Best){ .limit = t_max, .first = none, .facing = none };
}

static inline bool best_found(const Best *best) { return best->first.place != BEST_NOWHERE; }

/* With key 0, before anything is hit, nothing at the ray's very end counts. */
static inline bool candidate_before(float t, uint32_t key, const Candidate *other)
{
    return t < other->t || (t == other->t && key < other->key);
}

/* Takes a hit with t > t_min when it may be the answer; whether it did. `reach`: how far behind
 * another hit may be and yet in the same place, at most. */
static inline bool best_offer(Best *best, float reach, const Candidate *hit)
{
    Candidate *first = &best->first, *facing = &best->facing;
    if (candidate_before(hit->t, hit->key, first)) {
        /* While nothing was hit this copies nothing to nothing. */
        if ((hit->key & BEST_BACK) != 0 && (first->key & BEST_BACK) == 0)
            *facing = *first;
        *first = *hit;
    } else if ((hit->key & BEST_BACK) == 0 && (first->key & BEST_BACK) != 0
               && candidate_before(hit->t, hit->key, facing)) {
        *facing = *hit;
    } else {
        return false;
    }
    best->limit = first->t;
    if ((first->key & BEST_BACK) != 0) {
        const float end = first->t + reach;
        best->limit = end < facing->t ? end : facing->t;
    }
    return true;
}

/* Whether `facing` is there and may be in the place of `first`: then best_choose decides. */
static inline bool best_is_open(const Best *best)
{
    return (best->first.key & BEST_BACK) != 0 && best->facing.place != BEST_NOWHERE
           && best->facing.t <= best->limit;
}

/* Writes the answer; of a miss, t is the ray's end and u, v are 0. A weight of -0 becomes 0. */
static inline bool best_to_hit(const Best *best, const Candidate *chosen, Hit *hit)
{
    *hit = (Hit){ .t = chosen->t, .u = chosen->u + 0.0f, .v = chosen->v + 0.0f,
                  .primitive = best_found(best) ? chosen->key & ~BEST_BACK : RAY_MISS };
    return best_found(best);
}

#endif
