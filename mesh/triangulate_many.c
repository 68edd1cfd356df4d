/* SPDX-License-Identifier: BSD-3-Clause */
/* Ear clipping for outlines of very many corners, in n log n steps for all but contrived ones.
 *
 * Which corners lie in an ear is asked of a tree of boxes. Corners wait in a queue; one whose
 * neighbour was cut waits once more, so that about every other corner goes in a round and triangles
 * grow together. A corner that cannot be cut is looked at again when a neighbour was cut, or when
 * nobody waits any more: a blocking corner may be gone. Only then less is asked.
 */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "mesh/point_tree.h"
#include "mesh/triangulate_internal.h"

/* Tests per corner, boxes counted as well; a few hundred serve the worst of spiky outlines. */
enum { TESTS_PER_CORNER = 2000 };

enum {
    NEAR = 64,    /* corners among which a bad ear is looked for */
    FEW_OF = 16   /* a share of the corners that is not worth a look at all others */
};

enum { WAITS = 1, AGAIN = 2, GONE = 4 };

/* All corners being looked at. */
typedef struct {
    EarDemand least;    /* what is asked of them */
    uint32_t  left;     /* corners left when they began to wait */
    uint32_t  last;     /* after the ear cut last */
    bool      hopeless; /* even the least was too much for all of them */
} Sweep;

typedef struct {
    PointTree tree;
    Vec3     *place;     /* [count]  corners */
    uint8_t  *state;     /* [count] */
    uint32_t *queue;     /* [count]  ring buffer: each corner at most once */
    uint32_t  count, head, waiting;
} Crowd;

/* --- is an ear free? -------------------------------------------------------------------------- */

typedef struct {
    Clipper         *clip;
    const CutCorner *ear[3];
    double           x[3], y[3], c[3]; /* edge k: inside where x x + y y + c >= 0 */
    double           lo[2], hi[2];
    EarDemand        demand;
    bool             blocked;
} EarSearch;

/* Whether a box is not wholly outside one of the edges. */
static bool ear_meets_box(void *context, const PointBox *box)
{
    const EarSearch *s = context;
    const Vec3 lo = box->lo, hi = box->hi;
    s->clip->tests++;
    if (lo.x > s->hi[0] || hi.x < s->lo[0] || lo.y > s->hi[1] || hi.y < s->lo[1])
        return false;
    for (int k = 0; k < 3; k++)
        if (s->x[k] * (s->x[k] > 0 ? hi.x : lo.x) + s->y[k] * (s->y[k] > 0 ? hi.y : lo.y)
            + s->c[k] < 0)
            return false;
    return true;
}

static bool ear_meets_corner(void *context, uint32_t i)
{
    EarSearch *s = context;
    const CutCorner *w = &s->clip->ring[i];
    const Crowd *crowd = s->clip->search;
    s->clip->tests++;
    for (int k = 0; k < 3; k++)
        if (s->x[k] * w->x + s->y[k] * w->y + s->c[k] < 0)
            return true;
    if ((crowd->state[i] & GONE) || w == s->ear[0] || w == s->ear[1] || w == s->ear[2])
        return true;
    s->blocked = w->x >= s->lo[0] && w->x <= s->hi[0] && w->y >= s->lo[1] && w->y <= s->hi[1]
              && ear_blocked(s->clip, s->ear, w, s->demand);
    return !s->blocked;
}

static bool many_is_free(Clipper *clip, uint32_t i, EarDemand demand)
{
    const CutCorner *b = &clip->ring[i], *a = &clip->ring[b->previous];
    const CutCorner *c = &clip->ring[b->next];
    const Crowd *crowd = clip->search;
    const double t = clip->tolerance;
    EarSearch s = { .clip = clip, .ear = { a, b, c }, .demand = demand,
                    .lo = { fmin(a->x, fmin(b->x, c->x)) - t, fmin(a->y, fmin(b->y, c->y)) - t },
                    .hi = { fmax(a->x, fmax(b->x, c->x)) + t, fmax(a->y, fmax(b->y, c->y)) + t } };
    for (int k = 0; k < 3; k++) {
        const CutCorner *from = s.ear[k], *to = s.ear[(k + 1) % 3];
        s.x[k] = from->y - to->y;
        s.y[k] = to->x - from->x;
        /* Twice the tolerance: the box test rounds otherwise than the corner test. */
        s.c[k] = 2 * t * ear_distance(from, to) - s.x[k] * from->x - s.y[k] * from->y;
    }
    point_tree_visit(&crowd->tree, ear_meets_box, ear_meets_corner, &s);
    return !s.blocked;
}

/* --- the queue -------------------------------------------------------------------------------- */

static void crowd_wait(Crowd *crowd, uint32_t i)
{
    if (crowd->state[i] & WAITS)
        return;
    uint32_t at = crowd->head + crowd->waiting++;
    at -= at >= crowd->count ? crowd->count : 0;
    crowd->queue[at] = i;
    crowd->state[i] |= WAITS;
}

static uint32_t crowd_next(Crowd *crowd)
{
    const uint32_t i = crowd->queue[crowd->head];
    crowd->head = crowd->head + 1 == crowd->count ? 0 : crowd->head + 1;
    crowd->waiting--;
    crowd->state[i] &= (uint8_t)~WAITS;
    return i;
}

static void crowd_all_wait(Crowd *crowd, const Clipper *clip, uint32_t from)
{
    uint32_t i = from;
    for (uint32_t k = 0; k < clip->left; k++, i = clip->ring[i].next)
        crowd_wait(crowd, i);
}

/* Corners that were cut leave the tree when they are half of it. */
static void crowd_thin_out(Crowd *crowd, const Clipper *clip)
{
    if (clip->left >= crowd->tree.count / 2)
        return;
    uint32_t kept = 0;
    for (uint32_t k = 0; k < crowd->tree.count; k++)
        if (!(crowd->state[crowd->tree.point[k]] & GONE))
            crowd->tree.point[kept++] = crowd->tree.point[k];
    point_tree_shorten(&crowd->tree, kept);
}

static bool crowd_create(Crowd *crowd, const Clipper *clip, Error *err)
{
    const uint32_t n = clip->left;
    *crowd = (Crowd){ .count = n };
    crowd->place = array_create(n, sizeof *crowd->place, "polygon corners", err);
    crowd->state = array_create(n, sizeof *crowd->state, "polygon corners", err);
    crowd->queue = array_create(n, sizeof *crowd->queue, "polygon corners", err);
    if (error_is_set(err))
        return false;
    for (uint32_t i = 0; i < n; i++) {
        crowd->place[i] = vec3(clip->ring[i].x, clip->ring[i].y, 0);
        crowd->queue[i] = i; /* a list of all; the tree copies it */
    }
    return point_tree_create(&crowd->tree, crowd->place, crowd->queue, n, err);
}

static void crowd_clear(Crowd *crowd)
{
    point_tree_clear(&crowd->tree);
    array_free(crowd->place);
    array_free(crowd->state);
    array_free(crowd->queue);
}

/* --- clipping --------------------------------------------------------------------------------- */

/* The strictest terms, down to `least`, on which corner i may be cut, or EAR_NONE. */
static EarDemand many_terms(Clipper *clip, uint32_t i, EarDemand least)
{
    for (EarDemand demand = EAR_CLEAN; demand <= least; demand++)
        if ((demand >= EAR_FLAT || clip->tests <= clip->most)
            && ear_grade(clip, i, demand) >= 0)
            return demand;
    return EAR_NONE;
}

/* Corners beside one that was dropped stay where they wait: what is flat is dropped in one place
 * until the rest has a height, not everywhere. */
static void many_cut(Triangulation *cut, Clipper *clip, Crowd *crowd, uint32_t i, EarDemand terms)
{
    const uint32_t before = clip->ring[i].previous, after = clip->ring[i].next;
    ear_cut(cut, clip, i, terms != EAR_FLAT && terms != EAR_NONE);
    cut->crossing |= terms >= EAR_FORCED;
    crowd->state[i] |= GONE;
    crowd_wait(crowd, before);
    crowd_wait(crowd, after);
    if (terms < EAR_FLAT) {
        crowd->state[before] |= AGAIN;
        crowd->state[after] |= AGAIN;
    }
    crowd_thin_out(crowd, clip);
}

/* The next corner that is worth a look, or the ring's size when there is none. */
static uint32_t many_next(Crowd *crowd)
{
    while (crowd->waiting > 0) {
        const uint32_t i = crowd_next(crowd);
        if (!(crowd->state[i] & (AGAIN | GONE)))
            return i;
        if (!(crowd->state[i] & GONE)) {
            crowd->state[i] &= (uint8_t)~AGAIN;
            crowd_wait(crowd, i);
        }
    }
    return crowd->count;
}

/* Looks for an ear near corner `at`, asking less and less. */
static EarDemand many_near(Clipper *clip, uint32_t at, uint32_t *ear)
{
    for (EarDemand demand = EAR_TOUCHED; demand < EAR_NONE; demand++) {
        *ear = at;
        for (int k = 0; k < NEAR; k++, *ear = clip->ring[*ear].next)
            if (many_terms(clip, *ear, demand) != EAR_NONE)
                return demand;
    }
    return EAR_NONE;
}

static void sweep_cut(Triangulation *cut, Clipper *clip, Crowd *crowd, Sweep *sweep, uint32_t i,
                      EarDemand terms)
{
    sweep->last = clip->ring[i].next;
    many_cut(cut, clip, crowd, i, terms);
}

/* Nobody waits. All are looked at again when many have gone since they were; before that a bad ear
 * is cut where the last one was. Without one, terms are lowered for all; when nothing helps,
 * corners go as they come. */
static void many_stuck(Triangulation *cut, Clipper *clip, Crowd *crowd, Sweep *sweep)
{
    const uint32_t gone = sweep->left - clip->left;
    const bool few = gone > 0 && gone <= clip->left / FEW_OF;
    uint32_t ear = sweep->last;
    const EarDemand near = few ? many_near(clip, sweep->last, &ear) : EAR_NONE;
    if (near != EAR_NONE || (few && sweep->hopeless)) {
        sweep_cut(cut, clip, crowd, sweep, ear, near);
        return;
    }
    sweep->least = gone > 0 ? EAR_CLEAN : sweep->least + 1;
    sweep->hopeless = sweep->least == EAR_NONE;
    if (sweep->hopeless) {
        sweep_cut(cut, clip, crowd, sweep, sweep->last, EAR_NONE);
        sweep->least = EAR_CLEAN;
    } else {
        sweep->left = clip->left;
        crowd_all_wait(crowd, clip, sweep->last);
    }
}

static void many_clip(Triangulation *cut, Clipper *clip, Crowd *crowd, uint32_t *last)
{
    Sweep sweep = { .least = EAR_CLEAN, .left = clip->left };
    crowd_all_wait(crowd, clip, 0);
    while (clip->left > 3) {
        const uint32_t i = many_next(crowd);
        if (i == crowd->count) {
            many_stuck(cut, clip, crowd, &sweep);
            continue;
        }
        const EarDemand terms = many_terms(clip, i, sweep.least);
        if (terms == EAR_NONE)
            continue;
        if (terms < EAR_FORCED) /* else it is a guess, and so are all others */
            sweep.least = EAR_CLEAN;
        sweep_cut(cut, clip, crowd, &sweep, i, terms);
    }
    *last = sweep.last;
}

bool ears_clip_many(Triangulation *cut, Clipper *clip, uint32_t *last, Error *err)
{
    assert(cut != NULL && clip != NULL && last != NULL && err != NULL);
    Crowd crowd;
    if (crowd_create(&crowd, clip, err)) {
        clip->search = &crowd;
        clip->is_free = many_is_free;
        clip->most = (uint64_t)TESTS_PER_CORNER * clip->left;
        many_clip(cut, clip, &crowd, last);
    }
    crowd_clear(&crowd);
    return !error_is_set(err);
}
