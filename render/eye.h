/* SPDX-License-Identifier: BSD-3-Clause */
/* render/eye.h -- samples of pixels: from the eye, by mirrors and glass, to receiving points.
 *
 * A sample's choices come from scrambled Sobol' sequences, one for each kind of choice, that run on
 * through all samples with one seed. Samples are traced up to WAVE_POINTS at a time.
 */
#ifndef RENDER_EYE_H
#define RENDER_EYE_H

#include "render/gather.h"
#include "render/gloss.h"
#include "render/internal.h"
#include "render/records.h"
#include "render/wave.h"

/* Sums over samples. */
typedef struct {
    Rgb    radiance, direct, indirect, albedo, irradiance;
    double deviation; /* of the radiance's luminance, from noise of records: all samples share it */
    Rgb   *split;     /* [groups + 1]  the radiance by light groups; NULL: not asked for */
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
    unsigned bounce;    /* mirrors, glass and gloss passed */
    uint32_t fork;      /* tells the ways of one sample's rays apart; 0: there is one */
    bool     by_chance; /* one of two ways was, or roulette has let it go on: it takes no more */
    bool     blurred; /* by gloss on its way: what it meets is not seen sharp */
    double   density; /* > 0: gloss at `from` chose its direction so densely; lamps it meets are */
    Receiver from;    /* aimed at from there, too */
} EyeRay;

/* A glossy place that the eye sees. */
typedef struct {
    Receiver at;
    Gloss    gloss;
    Rgb      weight;  /* of what it sends to the eye, specular colour included */
    Pixel   *pixel;
} EyeGloss;

/* A point that receives light for a sample. */
typedef struct {
    WavePoint point;
    Rgb       throughput, albedo; /* throughput: weight * albedo / pi */
    Recorded  recorded;
    bool      known;              /* `recorded` holds */
    uint32_t  sample;
    unsigned  bounce;
} EyePoint;

/* Rays that a sample's may become at glass, where both ways are followed. */
enum { EYE_FORKS = 16 };

/* Pixels under way at once: two halves of each of a tile. */
enum { EYE_SUMS = 2 * 16 * 16 };

/* What a thread needs to trace samples. */
typedef struct {
    const Gatherer      *gatherer;
    const RenderOptions *options; /* defaults filled in */
    const CameraRays    *camera;
    const FilterTable   *filter;
    Rgb     *split;    /* [WAVE_POINTS * (groups + 1)]  scratch; NULL: no groups (render/split.h) */
    Rgb     *sums;     /* [EYE_SUMS * (groups + 1)]  of pixels; NULL likewise */
    Guides   guides;
    Wave     wave;
    EyeRay   eye[WAVE_POINTS], waiting[EYE_FORKS * WAVE_POINTS];
    EyePoint point[WAVE_POINTS];
    Ray      ray[WAVE_POINTS];
    Hit      hit[WAVE_POINTS];
} Eye;

/* Space for light groups, where the gatherer tells them apart. */
bool eye_split_create(Eye *eye, Error *err);
void eye_split_destroy(Eye *eye);
/* Sums number `slot` < EYE_SUMS, zeros, for a Pixel; NULL without groups. */
Rgb *eye_sums(const Eye *eye, uint32_t slot);

/* The ray through a point of the picture; false: nothing is shown there. */
bool eye_ray(const CameraRays *camera, double x, double y, const float *lens, Ray *ray);

/* Adds light of lamps and lights that the place sends straight on, by shadow rays that v in [0,1)^3
 * chooses, combined by multiple importance sampling with the ray on that u chooses. false: none. */
bool eye_gloss(Eye *eye, const EyeGloss *place, const float u[2], const float v[3], EyeRay *on);

/* Traces samples, count <= WAVE_POINTS, and adds each to its pixel. */
void eye_gather(Eye *eye, const EyeSample *sample, uint32_t count);

#endif
