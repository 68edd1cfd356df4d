/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/checkpoint_format.h -- the heads of the pieces of a checkpoint; this folder only. */
#ifndef RADIOSITY_CHECKPOINT_FORMAT_H
#define RADIOSITY_CHECKPOINT_FORMAT_H

#include <stdint.h>

#include "radiosity/checkpoint.h"

static const char CHECKPOINT_MAGIC[8] = "isoluxK1";

/* After it: for each pass its count and flags, links, chunks of rows, solution, parts. */
typedef struct {
    char     magic[8];
    uint64_t key;
    uint64_t part[CHECKPOINT_PARTS]; /* bytes */
    uint32_t passes;
    uint32_t links, solution;        /* 1: there are some */
    uint32_t rows;                   /* of the cast under way */
} CheckpointHead;

typedef struct {
    uint64_t nonzeros, rays, clamped;
    double   seconds;
    uint32_t count, lamps;
} LinksHead;

typedef struct {
    uint64_t finished;               /* 0: nothing follows */
    uint64_t links, cast, clamped;
} ChunkHead;

typedef struct {
    double   residual, unshot, error_bound, seconds;
    uint32_t count, bands, iterations, converged;
} SolutionHead;

#endif
