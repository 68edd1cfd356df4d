/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/still.h -- the view as numbers: what the window draws, before exposure and curve. */
#ifndef VIEWER_STILL_H
#define VIEWER_STILL_H

#include "viewer/gl.h"
#include "viewer/snapshot.h"

/* One ray through the middle of each pixel; faces seen from behind are passed, as in the window.
 * Radiance is that of diffuse surfaces, from values at vertices or, with SHADING_PATCHES, of
 * patches. Where direct light is not known, all that is reflected is in `indirect`; irradiance that
 * is not known stays 0.
 * owns   the caller frees with image_destroy. fails  NULL; ERROR_MEMORY. */
Image *still_take(const Snapshot *snapshot, const GlView *view, Error *err);

#endif
