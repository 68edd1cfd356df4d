/* SPDX-License-Identifier: BSD-3-Clause */
/* A tree of photons, and light off those nearest to a point. */
#include <assert.h>
#include <math.h>

#include "render/caustics_internal.h"

/* Photons that light is read off: noise of about 1 / sqrt(NEAREST) where all light is thrown. */
enum { NEAREST = 96 };
/* Photons of other ways of a surface do not count: this is 45 degrees. */
static const double SAME_WAY = 0.70710678118654752;

/* --- the tree -------------------------------------------------------------------------------- */

static void swap(Photon *a, Photon *b)
{
    const Photon c = *a;
    *a = *b;
    *b = c;
}

/* Moves the k-th along an axis of photon[lo..hi-1] to its place, lower ones before it. */
static void select_middle(Photon *photon, uint32_t lo, uint32_t hi, uint32_t k, unsigned axis)
{
    while (hi - lo > 1) {
        const float pivot = photon[lo + (hi - lo) / 2].at[axis];
        uint32_t    i = lo, j = hi - 1;
        for (;;) {
            while (photon[i].at[axis] < pivot)
                i++;
            while (photon[j].at[axis] > pivot)
                j--;
            if (i >= j)
                break;
            swap(&photon[i++], &photon[j--]);
        }
        /* Below i nothing is above the pivot, from i on nothing below it, but for i == j. */
        const uint32_t cut = i == j && photon[i].at[axis] <= pivot ? i + 1 : i;
        if (cut == lo || cut == hi)
            break; /* all are the pivot but what is in place */
        if (k < cut)
            hi = cut;
        else
            lo = cut;
    }
}

static unsigned widest(const Photon *photon, uint32_t lo, uint32_t hi)
{
    float    low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY,
                                                                    -INFINITY };
    unsigned axis = 0;
    for (uint32_t i = lo; i < hi; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = fminf(low[k], photon[i].at[k]);
            high[k] = fmaxf(high[k], photon[i].at[k]);
        }
    for (unsigned k = 1; k < 3; k++)
        if (high[k] - low[k] > high[axis] - low[axis])
            axis = k;
    return axis;
}

static void sort_range(Caustics *c, uint32_t lo, uint32_t hi)
{
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        const unsigned axis = widest(c->photon, lo, hi);
        select_middle(c->photon, lo, hi, middle, axis);
        c->axis[middle] = (uint8_t)axis;
        sort_range(c, lo, middle);
        lo = middle + 1;
    }
}

void caustics_sort(Caustics *caustics)
{
    assert(caustics->photon != NULL && caustics->axis != NULL);
    sort_range(caustics, 0, caustics->count);
}

/* --- the nearest ----------------------------------------------------------------------------- */

/* A heap: the farthest comes first. */
typedef struct {
    const Caustics *caustics;
    float    at[3], face[3];
    float    within; /* square of a distance */
    float    square[NEAREST];
    uint32_t photon[NEAREST], count;
} Search;

static void sift_down(Search *s, uint32_t i, float square, uint32_t photon)
{
    for (;;) {
        uint32_t child = 2 * i + 1;
        if (child >= s->count)
            break;
        if (child + 1 < s->count && s->square[child + 1] > s->square[child])
            child++;
        if (s->square[child] <= square)
            break;
        s->square[i] = s->square[child];
        s->photon[i] = s->photon[child];
        i = child;
    }
    s->square[i] = square;
    s->photon[i] = photon;
}

static void take(Search *s, uint32_t photon, float square)
{
    if (s->count == NEAREST) {
        sift_down(s, 0, square, photon);
        s->within = s->square[0];
        return;
    }
    uint32_t i = s->count++;
    for (; i > 0 && s->square[(i - 1) / 2] < square; i = (i - 1) / 2) {
        s->square[i] = s->square[(i - 1) / 2];
        s->photon[i] = s->photon[(i - 1) / 2];
    }
    s->square[i] = square;
    s->photon[i] = photon;
    if (s->count == NEAREST)
        s->within = s->square[0];
}

static void consider(Search *s, uint32_t k)
{
    const Photon *p = &s->caustics->photon[k];
    const float x = p->at[0] - s->at[0], y = p->at[1] - s->at[1], z = p->at[2] - s->at[2];
    const float square = x * x + y * y + z * z;
    if (square < s->within &&
        p->face[0] * s->face[0] + p->face[1] * s->face[1] + p->face[2] * s->face[2] >
            (float)SAME_WAY)
        take(s, k, square);
}

static void search_range(Search *s, uint32_t lo, uint32_t hi)
{
    while (lo < hi) {
        const uint32_t middle = lo + (hi - lo) / 2;
        const unsigned axis = s->caustics->axis[middle];
        const float    beyond = s->at[axis] - s->caustics->photon[middle].at[axis];
        if (beyond < 0)
            search_range(s, lo, middle);
        else
            search_range(s, middle + 1, hi);
        consider(s, middle);
        if (!(beyond * beyond < s->within))
            return;
        if (beyond < 0)
            lo = middle + 1;
        else
            hi = middle;
    }
}

CausticsLight caustics_find(const Caustics *caustics, const Receiver *at, Rgb *groups)
{
    Search s = { .caustics = caustics, .within = (float)(caustics->reach * caustics->reach),
                 .at = { (float)at->point.x, (float)at->point.y, (float)at->point.z },
                 .face = { (float)at->face.x, (float)at->face.y, (float)at->face.z } };
    search_range(&s, 0, caustics->count);
    /* The farthest of all makes the circle, and counts nothing. */
    CausticsLight light = { .radius = sqrt((double)s.within) };
    const double  square = s.within, factor = 2 / (M_PI * square);
    assert(square > 0 || s.count == NEAREST);
    for (uint32_t i = 0; i < s.count && square > 0; i++) {
        const Photon *p = &caustics->photon[s.photon[i]];
        const Rgb     e = rgb_scale(rgb((double)p->flux[0], (double)p->flux[1],
                                        (double)p->flux[2]),
                                    factor * (1 - (double)s.square[i] / square));
        light.irradiance = rgb_add(light.irradiance, e);
        if (groups != NULL)
            groups[p->group] = rgb_add(groups[p->group], e);
    }
    return light;
}
