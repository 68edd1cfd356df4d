/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/direct.h -- what point and spot lights send to the patches they see: I cos / d^2. */
#ifndef RADIOSITY_DIRECT_H
#define RADIOSITY_DIRECT_H

#include "radiosity/links.h"
#include "radiosity/room.h"

typedef struct {
    uint32_t samples;  /* visibility rays per patch and light; 0: 64 */
    uint32_t seed;
    unsigned threads;
    bool     balance;  /* scale so that what arrives and escapes is what was sent, exactly */
    const bool *only;      /* [room->light_count]  false: left out; NULL: all. A light's rays are
                              its own, whatever others are cast */
} DirectOptions;

typedef struct {
    double *irradiance;         /* [patches * ROOM_BANDS]  mean over the patch's visible area */
    Rgb     flux;               /* sent out by all lights */
    Rgb     escaped;            /* of it, what meets no surface in use, by rays from the lights */
    double  balance_error;      /* |arrived + escaped - flux| / flux before scaling, luminance */
    uint64_t rays;
} Direct;

/* links gives the visible areas. No lights: all zero.
 * owns   direct->irradiance is the caller's, freed with array_free. */
bool direct_create(const Room *room, const Links *links, const DirectOptions *options,
                   Direct *direct, const Monitor *monitor, Error *err);

#endif
