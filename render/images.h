/* SPDX-License-Identifier: BSD-3-Clause */
/* render/images.h -- lamps and lights in flat mirrors: what they throw by way of these is aimed at.
 *
 * A flat mirror shows a point the lamps as its image behind the mirror sees them through it as a
 * window. So lamps are sampled for the image of the point, as sharply as for the point itself, and
 * two rays tell whether the light passes: to the mirror, and on to the lamp. Hemisphere rays that
 * find the same way weigh in by multiple importance sampling, as they do for lamps met straight;
 * point lights they do not meet at all.
 * Only for the few flat mirrors that are large; light of lamps by curved and small mirrors, by two
 * mirrors, and by glass that bends it comes by hemisphere rays alone.
 * Threads  never changes once made.
 */
#ifndef RENDER_IMAGES_H
#define RENDER_IMAGES_H

#include "render/lamps.h"

/* Planes of mirrors that count at most: each costs a lamp ray and more for every lamp ray. */
enum { IMAGES_MOST = 8 };

typedef struct {
    Vec3   normal; /* unit, to the side that mirrors */
    double height; /* of the plane along it */
    double area;   /* of the mirrors on it */
} ImagePlane;

typedef struct {
    ImagePlane plane[IMAGES_MOST];
    uint32_t   count;
    uint8_t   *of_side; /* [2 * surfaces->count]  2 * surface + side -> plane + 1; 0: none.
                           NULL: no planes */
} Images;

/* smooth: as of render/normals.h; triangles that it bends are no flat mirrors.
 * fails  false; ERROR_MEMORY. */
bool images_init(Images *images, const Room *room, const float *smooth, Error *err);
void images_clear(Images *images);

/* The plane of a surface's side, or IMAGES_MOST: none. */
uint32_t images_of(const Images *images, uint32_t surface, unsigned side);

/* The image of a receiver in a plane. false: it does not lie before it. */
bool images_receiver(const Room *room, const ImagePlane *plane, const Receiver *at,
                     Receiver *image);

/* What of a lamp sample, made for the image of `at` in a plane, reaches `at` by way of mirrors on
 * it: their colour, 0 where something is in the way. clear: light passes panes behind the mirror.
 * *rays counts those cast. */
Rgb images_pass(const Images *images, const Room *room, uint32_t plane, const Receiver *at,
                const LampSample *sample, bool clear, uint64_t *rays);

#endif
