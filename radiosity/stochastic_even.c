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
    tree->group = array_create(p->count, sizeof *tree->group, what, err);
    tree->place = p->centre;
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
    array_free(tree->group);
    *tree = (EvenTree){ .count = 0 };
}
