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

/* Display-linear 0..1 for scene-linear v >= 0 (exposed: 0.18 is mid grey). See tonemap.c. The first
 * is TONE_SHOULDER. */
double tonemap_curve(double v);
double tonemap_by(ToneCurve curve, double v);
/* sRGB transfer of a display-linear value, 0..1. */
double tonemap_srgb(double v);
/* A row of 8-bit pixels out of `width` linear ones; y places the dither pattern. */
void tonemap_row(const float *radiance, int width, int y, const ImageTone *tone, uint8_t *out);

/* --- image_png.c ----------------------------------------------------------------------------- */

/* 8-bit sRGB pixels [3 * width * height] as they are. exposure NAN: not said in the file. */
bool png_write_pixels(const uint8_t *pixels, int width, int height, double exposure,
                      const ImageInfo *info, const char *path, Error *err);

/* --- camera_rays.c --------------------------------------------------------------------------- */

/* A camera over a picture. */
typedef struct {
    Projection projection;
    Vec3   eye, forward, right, up; /* unit, perpendicular to each other */
    double half_width, half_height; /* the picture's middle, in pixels */
    double rim;                     /* of a fisheye: the largest angle from the axis, radians */
    double pixel;                   /* size of one: on the plane at distance 1, in scene units, or
                                       in radians, by projection */
    double lens, focus;
} CameraRays;

/* A view whose eye and target coincide, or whose up lies along it, gets some valid frame. */
void camera_rays_init(CameraRays *rays, const Camera *camera, int width, int height);
/* The ray through (x, y) in pixels, (0, 0) being the upper left corner of the picture; lens: two
 * numbers in 0..1 that choose a point of the lens (NULL: its middle); direction is unit.
 * false: nothing is shown there (outside a fisheye's circle). */
bool camera_rays_at(const CameraRays *rays, double x, double y, const float *lens, Vec3 *origin,
                    Vec3 *direction);
/* Whether a lens blurs: only then do samples need numbers for it. */
static inline bool camera_rays_blur(const CameraRays *rays) { return rays->lens > 0; }
/* Goes on with the part of the picture whose upper left corner is pixel (x, y). */
void camera_rays_crop(CameraRays *rays, int x, int y);
/* About the width that a pixel covers at a distance from the eye. */
double camera_rays_footprint(const CameraRays *rays, double distance);

/* --- pixel_filter.c -------------------------------------------------------------------------- */

enum { FILTER_STEPS = 256 };
typedef struct {
    double quantile[FILTER_STEPS + 1]; /* of one axis, from the pixel's middle */
} FilterTable;

void filter_table_init(FilterTable *table, PixelFilter shape);
/* Place of a sample, from the pixel's upper left corner, for u in 0..1. */
void filter_table_offset(const FilterTable *table, const float u[2], double offset[2]);

#endif
