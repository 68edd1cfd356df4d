/* SPDX-License-Identifier: BSD-3-Clause */
/* render/guides.h -- the guides of a place: points side by side on one plane share one.
 *
 * Trained for the receiving points of a tile (or a free point), and for what those see close by,
 * where light is received once more. Points that fit none do without.
 */
#ifndef RENDER_GUIDES_H
#define RENDER_GUIDES_H

#include <stdint.h>

#include "render/guide.h"
#include "render/lamps.h"

enum { GUIDES_MAX = 8 };

/* Points nearly on one plane, facing nearly one way. */
typedef struct {
    Receiver first;   /* its first member */
    double   reach;   /* how far off its plane members may be */
    uint32_t members; /* of those it is trained for */
    bool     trained;
    Guide    guide;
} GuideCluster;

typedef struct {
    GuideCluster cluster[GUIDES_MAX];
    unsigned     count;
} Guides;

struct Wave;

/* Learns for `count` <= GUIDES_POINTS receivers, reach[i] being how far points that belong to
 * receiver i may lie off its plane; each will be given `rays` hemisphere rays. Replaces what was
 * there; uses the wave's scratch space. */
enum { GUIDES_POINTS = 256 };
void guides_train(Guides *guides, struct Wave *wave, const Receiver *at, const double *reach,
                  uint32_t count, uint32_t rays, uint32_t seed);

/* The guide for a point, or NULL. */
const Guide *guides_find(const Guides *guides, const Receiver *at);

#endif
