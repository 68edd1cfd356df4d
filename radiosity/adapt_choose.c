/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/adapt_choose.c -- which patches to divide, the worst first. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "radiosity/adapt.h"

typedef struct {
    double   gain;
    uint32_t patch;
} Candidate;

static int by_gain(const void *a, const void *b)
{
    const Candidate *x = a, *y = b;
    if (x->gain != y->gain)
        return x->gain > y->gain ? -1 : 1;
    return x->patch < y->patch ? -1 : x->patch > y->patch;
}

/* A cell gives way to four, a merged patch of two pieces to two. */
static uint32_t more_patches(const Patches *patches, uint32_t i)
{
    const uint32_t pieces = patches->first_piece[i + 1] - patches->first_piece[i];
    return pieces > 0 && pieces < 4 ? pieces - 1 : 3;
}

bool adapt_choose(const Room *room, const double *error, uint32_t wanted, double worth,
                  uint8_t *split, uint32_t *chosen, Error *err)
{
    assert(room != NULL && error != NULL && split != NULL && chosen != NULL);
    const Patches *patches = room->patches;
    Candidate *list = array_create(patches->count, sizeof *list, "patches to divide", err);
    uint32_t count = 0;
    double total = 0;
    *chosen = 0;
    if (list == NULL)
        return false;
    memset(split, 0, patches->count);
    for (uint32_t i = 0; i < patches->count; i++) {
        const double gain = error[i] * error[i] * patches->area[i];
        total += gain;
        if (gain > 0)
            list[count++] = (Candidate){ gain, i };
    }
    qsort(list, count, sizeof *list, by_gain);
    uint32_t reached = patches->count;
    for (uint32_t k = 0; k < count; k++) {
        const uint32_t more = more_patches(patches, list[k].patch);
        if (list[k].gain < worth * total / patches->count || reached + more > wanted)
            break;
        reached += more;
        split[list[k].patch] = 1;
        ++*chosen;
    }
    array_free(list);
    return true;
}
