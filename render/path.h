/* SPDX-License-Identifier: BSD-3-Clause */
/* render/path.h -- an unbiased path tracer: the project's own reference.
 *
 * It shares with the gather the rays, the materials and the camera, and nothing else: no patches,
 * no factors, no solution, no lamps' closed forms. What both agree on is right for two reasons.
 *
 * Method   paths from the eye; at each diffuse or glossy place one shadow ray to a lamp or light
 *          and one ray on, combined by the balance heuristic [veach95]; mirrors and bodies of glass
 *          by chance of Fresnel's shares; panes are crossed straight by shadow rays too. Roulette
 *          ends paths, nothing limits their length and nothing is clamped.
 * Left out light of point lights and spots by way of mirrors and of bodies of glass: no path from
 *          the eye meets a point (areas that emit are met). The background lights nothing, as
 *          elsewhere: only the eye sees it, by way of mirrors, glass and gloss too.
 * Samples  scrambled Sobol' points, scrambled anew for each batch, so that batches tell the error.
 * Threads  same bytes for any number.
 */
#ifndef RENDER_PATH_H
#define RENDER_PATH_H

#include "base/monitor.h"
#include "radiosity/room.h"
#include "render/copies.h"
#include "render/image.h"
#include "scenes/scene.h"

typedef struct {
    int      width, height; /* of the whole picture */
    uint32_t samples;      /* paths per pixel; 0: 64. With `error`: no more than these */
    double   error;        /* > 0: until the picture's relative standard error is below */
    bool     diffuse_only; /* leave mirrors, glass and gloss out */
    Rgb      background;
    uint32_t seed;
    unsigned threads;
    const RoomCopies *copies;  /* of the same room: what else stands in it; NULL: nothing */
    PixelFilter filter;
    int      crop[4];      /* left, top, right, bottom of the part to make; all 0: the whole */
} PathOptions;

typedef struct {
    uint64_t rays;
    double   seconds;
    double   samples;      /* paths per pixel made, the mean */
    double   rough;        /* share of the pixels that were not reached before it was stopped, and
                              that blocks of pixels share a path */
    double   error;        /* root mean square of the pixels' standard errors over the picture's
                              mean luminance; NAN where fewer than two batches were made */
} PathReport;

/* room->patches may be NULL; everything else of it is needed. The image has its layers radiance,
 * direct, indirect, albedo, normal, depth and deviation filled.
 * fails  NULL; ERROR_MEMORY. Stopped by the monitor: the image with the paths made so far, where
 *        there are none made in about a second, and *err ERROR_STOPPED. */
Image *render_path(const Room *room, const Camera *camera, const PathOptions *options,
                   PathReport *report, const Monitor *monitor, Error *err);

#endif
