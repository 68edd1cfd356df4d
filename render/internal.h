/* SPDX-License-Identifier: BSD-3-Clause */
/* render/internal.h -- what the files of this folder share. */
#ifndef RENDER_INTERNAL_H
#define RENDER_INTERNAL_H

#include "math/vec3.h"
#include "render/image.h"
#include "scenes/scene.h"

/* Largest side of a picture that is read or written: 2^15 keeps byte strides far inside 31 bits. */
enum { IMAGE_SIDE_MAX = 32768 };

/* --- tonemap.c ------------------------------------------------------------------------------- */

/* Display-linear 0..1 for scene-linear v >= 0 (exposed: 0.18 is mid grey). See tonemap.c. */
double tonemap_curve(double v);
/* sRGB transfer of a display-linear value, 0..1. */
double tonemap_srgb(double v);
/* A row of 8-bit pixels out of `width` linear ones; y places the dither pattern. */
void tonemap_row(const float *radiance, int width, int y, double exposure, uint8_t *out);

/* --- camera_rays.c --------------------------------------------------------------------------- */

/* A pinhole camera over a picture: direction = corner + x right + y down, x and y in pixels. */
typedef struct {
    Vec3 eye, corner, right, down;
} CameraRays;

/* A view whose eye and target coincide, or whose up lies along it, gets some valid frame. */
void camera_rays_init(CameraRays *rays, const Camera *camera, int width, int height);
/* Unit direction through (x, y) in pixels, (0, 0) being the upper left corner of the picture. */
Vec3 camera_rays_direction(const CameraRays *rays, double x, double y);

#endif
