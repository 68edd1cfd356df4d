/* SPDX-License-Identifier: BSD-3-Clause */
/* render/records_fill.h -- records of indirect light for what a camera sees. */
#ifndef RENDER_RECORDS_FILL_H
#define RENDER_RECORDS_FILL_H

#include "base/monitor.h"
#include "render/caustics.h"
#include "render/gather.h"
#include "render/internal.h"
#include "render/records.h"

typedef struct {
    int      width, height;  /* of the picture */
    uint32_t rays;           /* hemisphere rays of a record, twice as many of one
                                far from the others, half of crowded ones; 0: 1024 */
    bool     clear;          /* light passes through glass */
    uint32_t seed;
    unsigned threads;
    const Caustics *caustics; /* light that is not theirs; NULL: none */
} RecordsWish;

/* Adds records until those of the view are near enough to each other, coarse grids of pixels first,
 * and fits slopes. Rays cast are added to *rays. Same records for any number of threads.
 * fails  false; ERROR_MEMORY, ERROR_STOPPED. */
bool records_fill(Records *records, const Gatherer *gatherer, const CameraRays *camera,
                  const RecordsWish *wish, uint64_t *rays, const Monitor *monitor, Error *err);

/* How far off light is that is read from records: root mean square, at some hundred pixels of a
 * grid over the view that records serve, of the luminance that they reflect of it; against gathers
 * there that share no ray with the records. Noise of records is in it. Noise of these gathers is
 * not, but makes it uncertain: 0 where it is less than they can tell.
 * fails  false; ERROR_MEMORY, ERROR_STOPPED. */
bool records_check(const Records *records, const Gatherer *gatherer, const CameraRays *camera,
                   const RecordsWish *wish, double *error, uint64_t *rays, const Monitor *monitor,
                   Error *err);

#endif
