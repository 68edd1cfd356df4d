/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/four.h -- rows of links times four bands at once, in single precision; this folder
 * only. */
#ifndef RADIOSITY_FOUR_H
#define RADIOSITY_FOUR_H

#include "math/tolerance.h"
#include "radiosity/links.h"

/* Up to four bands of a patch, side by side. */
typedef float Four __attribute__((vector_size(16)));
enum { FOUR = 4 };

/* A row times what patches have; four sums, so that none waits for the one before. */
static inline Four four_gather(const LinksRow *row, const Four *from)
{
    Four sum[4] = { { 0 } };
    uint64_t k = 0;
    for (; k + 4 <= row->count; k += 4)
        for (int s = 0; s < 4; s++)
            sum[s] += row->form_factor[k + (uint64_t)s] * from[row->source[k + (uint64_t)s]];
    for (; k < row->count; k++)
        sum[0] += row->form_factor[k] * from[row->source[k]];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* Bound on the error of that, relative to the sum of magnitudes, for rows of `longest` links: each
 * product goes through its own rounding, those of at most a quarter of the row and three more,
 * the two that join the sums, and four of what is made of it (orthogonal, kept as float). */
static inline double four_rounding(uint64_t longest)
{
    return (double)rounding_bound_float((int)(longest / 4) + 1 + 3 + 2 + 4);
}

#endif
