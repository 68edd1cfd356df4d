/* SPDX-License-Identifier: BSD-3-Clause */
/* render/split.h -- light of each lamp group apart, by the same rays that gather all of it.
 *
 * Light adds up: where a ray reads the solution it reads that of each group as well, and what a
 * lamp sends straight is its group's. Choices of rays, shadows, controls and weights are those of
 * the whole, so the groups' sums are the whole but for rounding.
 */
#ifndef RENDER_SPLIT_H
#define RENDER_SPLIT_H

#include "render/wave.h"

struct Split {
    uint32_t count;       /* groups; number `count` is the rest: background, lamps of no group */
    bool     rest;        /* there are such lamps */
    uint32_t first_light; /* group of the first point light */
    const char *const *name; /* [count + 1]  the caller's */
    float    *vertex;     /* [(vertex * count + group) * 3]  reflected radiosity */
    uint32_t *of_side;    /* [2 * surfaces->count]  2 * surface + side -> group of its emission */
};

void split_destroy(Split *split);

/* Adds weight * the reflected radiosity of each group at a ray's end to sum [count]. */
void split_radiosity(const Gatherer *gatherer, const WaveEnd *end, Rgb weight, Rgb *sum);
/* Adds a lamp sample of which `arrives`, corrected by b times its control (wave.c): weight *
 * (arrives + b (control - value)). */
void split_sample(const Gatherer *gatherer, const Receiver *at, const LampSample *sample,
                  Rgb arrives, double b, Rgb weight, Rgb *sum);
static inline uint32_t split_emission(const Split *split, uint32_t surface, unsigned side)
{
    return split->of_side[2 * (size_t)surface + side];
}

#endif
