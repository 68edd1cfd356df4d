/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/seen.h -- what the window shows along a ray. */
#ifndef VIEWER_SEEN_H
#define VIEWER_SEEN_H

#include "viewer/shown_mesh.h"

/* The first patch along a unit direction that is lit on this side; faces seen from behind are
 * passed. PATCH_NONE: none. hit->primitive is its triangle, *at the place. Threads  any. */
uint32_t seen_along(const ShownMesh *mesh, Vec3 eye, Vec3 direction, Hit *hit, Vec3 *at);

#endif
