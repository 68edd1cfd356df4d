/* SPDX-License-Identifier: BSD-3-Clause */
/* render/whitted.h -- recursive ray tracing [whitted80]: lights, hard shadows, mirrors, glass.
 *
 * What a point shows: its emission, the ambient light times its diffuse reflectance, of each light
 * its diffuse and glossy share unless something is in between, and by recursion what mirrors and
 * glass show. No light goes from surface to surface. A surface that emits lights others as a small
 * flat source in its middle would. Panes let light pass; bodies of glass throw shadows.
 * Threads  same bytes for any number.
 */
#ifndef RENDER_WHITTED_H
#define RENDER_WHITTED_H

#include "base/monitor.h"
#include "radiosity/room.h"
#include "render/image.h"
#include "scenes/scene.h"

typedef struct {
    int      width, height;
    uint32_t samples;      /* rays per pixel, the first of one through its centre; 0: 1 */
    uint32_t depth;        /* reflections and refractions that are followed; 0: 5 */
    Rgb      background, ambient; /* radiances */
    PixelFilter filter;    /* of more than one sample */
    int      crop[4];      /* left, top, right, bottom of the part to make; all 0: the whole */
    uint32_t seed;
    unsigned threads;
} WhittedOptions;

typedef struct {
    uint64_t rays;
    double   seconds;      /* of the frame alone */
    double   rough;        /* share of the pixels that were not reached before it was stopped, and
                              that have one ray, or share one with others */
} WhittedReport;

enum { WHITTED_DEPTH_MOST = 64 };

/* room->patches may be NULL. The image has its layers radiance and depth filled, others `empty`.
 * fails  NULL; ERROR_MEMORY. Stopped by the monitor: what there is, the rest made with a ray a
 *        pixel at most, and *err ERROR_STOPPED. */
Image *render_whitted(const Room *room, const Camera *camera, const WhittedOptions *options,
                      WhittedReport *report, const Monitor *monitor, Error *err);

#endif
