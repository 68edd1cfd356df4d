/* SPDX-License-Identifier: BSD-3-Clause */
/* render/eye.h -- samples of pixels: from the eye, by mirrors and glass, to receiving points.
 *
 * A sample's choices come from scrambled Sobol' sequences, one for each kind of choice, that run on
 * through all samples with one seed. Samples are traced up to WAVE_POINTS at a time.
 */
#ifndef RENDER_EYE_H
#define RENDER_EYE_H

#include "render/gather.h"
#include "render/internal.h"
#include "render/records.h"
#include "render/wave.h"

/* Sums over samples. */
typedef struct {
    Rgb    radiance, direct, indirect, albedo, irradiance;
    double deviation; /* of the radiance's luminance, from noise of records: all samples share it */
} Pixel;

typedef struct {
    int      x, y;        /* pixel */
    uint32_t index, seed; /* which sample of which sequences */
    uint32_t group;       /* samples of one pixel, whose lamp samples share a control;
                             < WAVE_POINTS */
    Pixel   *pixel;       /* where it is added */
} EyeSample;

/* One ray of a sample on its way. */
typedef struct {
    Ray      ray;
    Rgb      weight;
    uint32_t sample;
} EyeRay;

/* A point that receives light for a sample. */
typedef struct {
    WavePoint point;
    Rgb       throughput, albedo; /* throughput: weight * albedo / pi */
    Recorded  recorded;
    bool      known;              /* `recorded` holds */
    uint32_t  sample;
} EyePoint;

/* What a thread needs to trace samples. */
typedef struct {
    const Gatherer      *gatherer;
    const RenderOptions *options; /* defaults filled in */
    const CameraRays    *camera;
    const FilterTable   *filter;
    Guides   guides;
    Wave     wave;
    EyeRay   eye[WAVE_POINTS];
    EyePoint point[WAVE_POINTS];
    Ray      ray[WAVE_POINTS];
    Hit      hit[WAVE_POINTS];
} Eye;

/* The ray through a point of the picture; false: nothing is shown there. */
bool eye_ray(const CameraRays *camera, double x, double y, const float *lens, Ray *ray);

/* Traces samples, count <= WAVE_POINTS, and adds each to its pixel. */
void eye_gather(Eye *eye, const EyeSample *sample, uint32_t count);

#endif
