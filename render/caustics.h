/* SPDX-License-Identifier: BSD-3-Clause */
/* render/caustics.h -- what curved mirrors, bent glass and mirrors in turn throw of lamps: photons.
 *
 * Lamps are so small that hemisphere rays seldom find them by way of a mirror, and those that do
 * are specks. So rays go the other way: from lamps and lights, by mirrors and glass, to where they
 * meet what is diffuse, and stay there as photons; light at a point is read off those around it.
 * Left out is what lamp rays find: straight light, and that of images in flat mirrors (images.h).
 * Units    as of irradiance elsewhere: inside a body of index n over n^2 (radiosity/mirrors.h).
 * Method   photon map [jensen96]: the nearest photons, weighed by Epanechnikov's kernel.
 * Threads  making: same bytes for any number; reading: from any.
 */
#ifndef RENDER_CAUSTICS_H
#define RENDER_CAUSTICS_H

#include "base/monitor.h"
#include "render/gather.h"
#include "render/lamps.h"

typedef struct Caustics Caustics;

typedef struct {
    uint32_t photons; /* rays from lamps, > 0 */
    uint32_t seed;
    unsigned threads;
} CausticsWish;

/* Adds the rays cast to *rays.
 * owns   the caller frees with caustics_destroy.
 * fails  NULL; ERROR_MEMORY, ERROR_STOPPED. NULL without an error: too little or too much of the
 *        light is thrown for photons to tell it better than hemisphere rays do. */
Caustics *caustics_create(const Gatherer *gatherer, const CausticsWish *wish, uint64_t *rays,
                          const Monitor *monitor, Error *err);
/* Frees; NULL is allowed. Always returns NULL. */
Caustics *caustics_destroy(Caustics *caustics);

/* Irradiance at a point, and from how far around. groups: gets that of each light group added, as
 * of render/split.h; NULL: does not. */
typedef struct {
    Rgb    irradiance;
    double radius;
} CausticsLight;
CausticsLight caustics_find(const Caustics *caustics, const Receiver *at, Rgb *groups);

#endif
