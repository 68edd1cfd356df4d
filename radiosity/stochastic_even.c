/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/stochastic_even.c -- noise of single patches evened out over those around them that
 * light cannot tell apart from them. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "base/parallel.h"
#include "raycast/ray.h"
#include "radiosity/stochastic_internal.h"

/* Normals weigh as much as places this many times the room's diagonal apart: other walls, and bent
 * surfaces, are parted first. */
static const double NORMAL_SCALE = 2;

/* Halves of a node are joined when the normals of two of their patches are within about 25 degrees,
 * and each sees the other from above, lifted by this share of their distance. */
static const double JOIN_COSINE = 0.9, LIFT = 0.25;

/* A node with this many rays is known well enough (1 %): it is joined with no other. */
static const double ENOUGH_RAYS = 10000;

/* Differences up to this many standard deviations, squared, are taken for noise. */
static const double NOISE = 6;

enum { JOIN_CHUNK = 8192 };

typedef struct {
    const Room *room;
    EvenTree   *tree;
    Vec3        diagonal;   /* of the room */
    float      *key;        /* [count]  of the axis a node is parted along */
    uint32_t  (*pair)[2];   /* [count]  patches that stand for the halves of a node */
} TreeMaker;

static Vec3 feature(const TreeMaker *m, uint32_t patch, bool normal)
{
    const Patches *p = m->room->patches;
    return normal ? vec3_scale(p->normal[patch], NORMAL_SCALE * vec3_length(m->diagonal))
                  : p->centre[patch];
}

static double component(Vec3 v, unsigned axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/* The widest of six axes, 0..2 places, 3..5 normals. */
static unsigned widest_axis(const TreeMaker *m, uint32_t begin, uint32_t end)
{
    double low[6], high[6];
    unsigned best = 0;
    for (unsigned a = 0; a < 6; a++)
        low[a] = INFINITY, high[a] = -INFINITY;
    for (uint32_t k = begin; k < end; k++)
        for (unsigned half = 0; half < 2; half++) {
            const Vec3 v = feature(m, m->tree->order[k], half == 1);
            for (unsigned a = 0; a < 3; a++) {
                low[3 * half + a] = fmin(low[3 * half + a], component(v, a));
                high[3 * half + a] = fmax(high[3 * half + a], component(v, a));
            }
        }
    for (unsigned a = 1; a < 6; a++)
        if (high[a] - low[a] > high[best] - low[best])
            best = a;
    return best;
}

static bool before(const TreeMaker *m, uint32_t a, uint32_t b)
{
    return m->key[a] < m->key[b] || (m->key[a] <= m->key[b] && a < b);
}

/* Puts the smaller half, by key and then number, first [hoare61]. */
static void part_half(const TreeMaker *m, uint32_t begin, uint32_t end, uint32_t middle)
{
    uint32_t *o = m->tree->order;
    int64_t low = begin, high = (int64_t)end - 1;
    while (low < high) {
        const uint32_t pivot = o[low + (high - low) / 2];
        int64_t i = low, j = high;
        while (i <= j) {
            while (before(m, o[i], pivot))
                i++;
            while (before(m, pivot, o[j]))
                j--;
            if (i <= j) {
                const uint32_t swap = o[i];
                o[i++] = o[j];
                o[j--] = swap;
            }
        }
        if (middle <= j)
            high = j;
        else if (middle >= i)
            low = i;
        else
            return;
    }
}

static void part(const TreeMaker *m, uint32_t begin, uint32_t end)
{
    if (end - begin < 2)
        return;
    const uint32_t middle = begin + (end - begin) / 2;
    const unsigned axis = widest_axis(m, begin, end);
    for (uint32_t k = begin; k < end; k++)
        m->key[m->tree->order[k]] =
            (float)component(feature(m, m->tree->order[k], axis >= 3), axis % 3);
    part_half(m, begin, end, middle);
    m->pair[middle][0] = m->tree->order[begin + (middle - begin) / 2];
    m->pair[middle][1] = m->tree->order[middle + (end - middle) / 2];
    part(m, begin, middle);
    part(m, middle, end);
}

/* From above the one to above the other, over three legs. */
static bool sees(const Room *room, uint32_t a, uint32_t b)
{
    const Patches *p = room->patches;
    const double lift = LIFT * vec3_length(vec3_sub(p->centre[b], p->centre[a]));
    const Vec3 from = vec3_mad(p->centre[a], room->offset, p->normal[a]);
    const Vec3 to = vec3_mad(p->centre[b], room->offset, p->normal[b]);
    const Vec3 corner[4] = { from, vec3_mad(from, lift, p->normal[a]),
                             vec3_mad(to, lift, p->normal[b]), to };
    for (unsigned k = 0; k < 3; k++) {
        const Ray ray = ray_between(corner[k], vec3(0, 0, 0), corner[k + 1], vec3(0, 0, 0), 0);
        if (bvh_blocked(room->bvh, &ray))
            return false;
    }
    return true;
}

static void join_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const TreeMaker *m = context;
    const Patches *p = m->room->patches;
    (void)worker;
    for (uint32_t k = begin; k < end; k++) {
        const uint32_t a = m->pair[k][0], b = m->pair[k][1];
        m->tree->joined[k] = a != b && vec3_dot(p->normal[a], p->normal[b]) > JOIN_COSINE &&
                             sees(m->room, a, b);
    }
}

bool even_tree_create(const Room *room, const double *area, unsigned threads, EvenTree *tree,
                      Error *err)
{
    static const char what[] = "groups of patches";
    const Patches *p = room->patches;
    *tree = (EvenTree){ .count = 0 };
    TreeMaker m = { .room = room, .tree = tree };
    tree->order = array_create(p->count, sizeof *tree->order, what, err);
    tree->joined = array_create(p->count, sizeof *tree->joined, what, err);
    m.key = array_create(p->count, sizeof *m.key, what, err);
    m.pair = array_create(p->count, sizeof *m.pair, what, err);
    if (!error_is_set(err)) {
        Vec3 low = p->centre[0], high = low;
        for (uint32_t i = 0; i < p->count; i++) {
            low = vec3_min(low, p->centre[i]);
            high = vec3_max(high, p->centre[i]);
            if (area[i] > 0)
                tree->order[tree->count++] = i;
        }
        m.diagonal = vec3_sub(high, low);
        part(&m, 0, tree->count);
        parallel_for(tree->count, JOIN_CHUNK, threads, join_chunk, &m, NULL, NULL);
    }
    array_free(m.key);
    array_free(m.pair);
    if (error_is_set(err))
        even_tree_clear(tree);
    return !error_is_set(err);
}

void even_tree_clear(EvenTree *tree)
{
    array_free(tree->order);
    array_free(tree->joined);
    *tree = (EvenTree){ .count = 0 };
}

/* --- use -------------------------------------------------------------------------------------- */

typedef struct {
    const EvenTree *tree;
    const double   *area;
    double          quantum;  /* 0: see noise */
    const float    *noise;    /* [count]  variance of power */
    double         *const *half;
    uint32_t        groups;
} Evening;

/* Of one node: patches that nothing reached do not count, they may be dark for good. */
typedef struct {
    double area, power, noise;
    bool   even;      /* differences within are noise */
} EvenNode;

static double total(const Evening *e, uint32_t patch)
{
    double sum = 0;
    for (unsigned h = 0; h < 2; h++)
        for (unsigned b = 0; b < ROOM_BANDS; b++)
            sum += e->half[h][(size_t)patch * ROOM_BANDS + b];
    return sum;
}

/* Gives a node's patches their shares of its power. */
static void settle(Evening *e, uint32_t begin, uint32_t end, const EvenNode *node)
{
    double sum[2][ROOM_BANDS] = { { 0 } };
    if (!node->even || !(node->area > 0))
        return;
    e->groups++;
    for (uint32_t k = begin; k < end; k++)
        for (unsigned at = 0; at < 2 * ROOM_BANDS; at++)
            sum[at / ROOM_BANDS][at % ROOM_BANDS] +=
                e->half[at / ROOM_BANDS][(size_t)e->tree->order[k] * ROOM_BANDS + at % ROOM_BANDS];
    for (uint32_t k = begin; k < end; k++) {
        const uint32_t i = e->tree->order[k];
        if (!(total(e, i) > 0))
            continue;
        for (unsigned at = 0; at < 2 * ROOM_BANDS; at++)
            e->half[at / ROOM_BANDS][(size_t)i * ROOM_BANDS + at % ROOM_BANDS] =
                sum[at / ROOM_BANDS][at % ROOM_BANDS] * e->area[i] / node->area;
    }
}

/* Whether the halves differ by no more than noise. */
static bool alike(const Evening *e, const EvenNode *a, const EvenNode *b)
{
    if (!(a->area > 0 && b->area > 0))
        return true;
    const double power = a->power + b->power;
    if (e->noise != NULL ? power * power > ENOUGH_RAYS * (a->noise + b->noise)
                         : power > ENOUGH_RAYS * e->quantum)
        return false;
    const double off = a->power / a->area - b->power / b->area;
    /* The mean of both, not what each has: noise of the smaller would be taken for small. */
    const double mean = power / (a->area + b->area);
    if (e->noise != NULL)
        return off * off <= NOISE * (a->noise / (a->area * a->area) +
                                     b->noise / (b->area * b->area));
    return off * off <= NOISE * e->quantum * mean * (1 / a->area + 1 / b->area);
}

static EvenNode even_out(Evening *e, uint32_t begin, uint32_t end)
{
    if (end - begin == 1) {
        const uint32_t i = e->tree->order[begin];
        const double power = total(e, i);
        return (EvenNode){ .area = power > 0 ? e->area[i] : 0, .power = power,
                           .noise = e->noise != NULL && power > 0 ? e->noise[i] : 0,
                           .even = true };
    }
    const uint32_t middle = begin + (end - begin) / 2;
    const EvenNode a = even_out(e, begin, middle), b = even_out(e, middle, end);
    const EvenNode node = { a.area + b.area, a.power + b.power, a.noise + b.noise,
                            a.even && b.even && e->tree->joined[middle] && alike(e, &a, &b) };
    if (!node.even) {
        settle(e, begin, middle, &a);
        settle(e, middle, end, &b);
    }
    return node;
}

uint32_t even_tree_apply(const EvenTree *tree, const double *area, double quantum,
                         const float *noise, double *half[2])
{
    Evening e = { .tree = tree, .area = area, .quantum = quantum, .noise = noise, .half = half };
    assert(quantum > 0 || noise != NULL);
    if (tree->count > 0) {
        const EvenNode all = even_out(&e, 0, tree->count);
        settle(&e, 0, tree->count, &all);
    }
    return e.groups;
}
