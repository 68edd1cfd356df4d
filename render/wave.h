/* SPDX-License-Identifier: BSD-3-Clause */
/* render/wave.h -- light at many receiving points at once: the core of the final gather.
 *
 * Points come in, irradiance comes out, split in what arrives straight from lamps and the rest.
 * Rays are cast in blocks, so that the tracer can take them in company.
 *
 * Direct   shadow rays to sampled lamp points. What a fully lit point gets is known in closed form
 *          (lamps.h): each sample's difference from it is taken off in the proportion in which the
 *          other samples of the block were lit, so that neither full light nor full shadow is
 *          noisy. The control's factor is made of other samples than the one it corrects, so it
 *          adds no bias but by their weak dependence as points of one net: for n of them at most
 *          1/(n - 1) of the covariance of light and shadow, below 0.1 % in half shadow. Lamps seen
 *          in flat mirrors are aimed at as well, without a control (images.h).
 * Indirect cosine rays, guided, read the solution where they end. An end nearer than about a patch
 *          becomes a receiving point itself, with a lamp sample and a ray of its own, by a chance
 *          that fades out with distance, so that no mesh and no seam shows.
 */
#ifndef RENDER_WAVE_H
#define RENDER_WAVE_H

#include "radiosity/room.h"
#include "render/caustics.h"
#include "render/gather.h"
#include "render/guides.h"
#include "render/images.h"
#include "render/lamps.h"
#include "render/specular.h"

enum {
    WAVE_POINTS = 64,   /* receiving points of a block */
    WAVE_RAYS = 256,    /* rays cast at once */
    WAVE_LEVELS = 3     /* receiving points, those they see close by, and once more */
};

typedef struct Split Split; /* render/split.h */

struct Gatherer {
    const Room *room;
    Split      *split;   /* light groups apart; NULL: not asked for */
    float      *vertex;  /* [3 * patches->vertex_count]  reflected radiosity */
    float      *normal;  /* [3 * surfaces->triangle_count]  unit, to the front */
    float      *smooth;  /* [9 * triangle_count]  as in normals.h; NULL: all is flat */
    float      *extent;  /* [patches->count]  edge of a patch */
    float      *widest[2]; /* [surfaces->count]  largest of those of a side; 0: not in use */
    Lamps       lamps;
    Images      images;
    bool        clear;   /* some material is an ideal mirror or lets light through */
};

/* A point that receives light, and what its irradiance counts in its root's result. */
typedef struct {
    Receiver at;
    Rgb      weight;
    uint32_t root;   /* index of the point that asked, < WAVE_POINTS */
    uint32_t index;  /* of its sample in its sequences */
    const Guide *guide; /* of its hemisphere rays; NULL: none */
    uint32_t seed;   /* of its own, mixed with the block's */
    uint32_t group;  /* points whose lamp samples share a control, < WAVE_POINTS; level 0 */
} WavePoint;

typedef struct {
    uint32_t gather_rays, lamp_rays; /* per point; > 0 */
    uint32_t seed;                   /* sequences: lamps, lights, directions of each level */
    bool     lights;                 /* point lights at the points themselves as well, one of
                                        them by chance per lamp ray; where rays end, always */
    bool     clear;                  /* light goes on at mirrors and glass; else they absorb it */
    const Guides *guides;            /* for points beyond level 0; may be NULL */
    bool     indirect_only;          /* no light straight from lamps and lights at level 0 */
    Rgb     *split;                  /* [WAVE_POINTS * (groups + 1)]  gets the irradiance of each
                                        point by groups (render/split.h); NULL: does not */
} WaveOptions;

/* What lies around a point: where light comes from near by, light changes soon. */
typedef struct {
    double nearest;   /* distance, INFINITY: nothing is hit */
    double bright;    /* luminances at the rays' ends, summed */
    double closeness; /* the same over the squares of the distances */
} WaveView;

typedef struct Wave {
    const Gatherer *gatherer;
    const Caustics *caustics;        /* what hemisphere rays leave to photons; NULL: nothing */
    uint64_t  rays;                  /* cast so far */
    Rgb       direct[WAVE_POINTS];   /* irradiance, results of wave_gather */
    Rgb       indirect[WAVE_POINTS];
    WaveView  view[WAVE_POINTS];     /* of points with hemisphere rays, indirect_only */
    WavePoint point[WAVE_LEVELS][WAVE_RAYS];
    Ray       ray[WAVE_RAYS];
    Hit       hit[WAVE_RAYS];
    bool      blocked[WAVE_RAYS];
    Rgb       pass[WAVE_RAYS];       /* share of light that passes along the ray */
    SpecularWay way[WAVE_RAYS];      /* by mirrors and glass */
    float     worth[WAVE_RAYS];      /* of a hemisphere ray: 1 / density of its guide */
    LampSample sample[WAVE_RAYS];
    uint32_t   owner[WAVE_RAYS];     /* of the ray: which point of the level */
    uint32_t   index[WAVE_RAYS];     /* of the hemisphere ray in its sequence */
    double     lit_share;            /* of the last block of lamp rays of level 0 */
    bool       lit_known;
    uint32_t   gathered;             /* points of level 0 with hemisphere rays */
} Wave;

/* Light at the first `count` <= WAVE_POINTS points of level 0 (at, index, guide, seed and group
 * filled by the caller) into direct and indirect. Of them the first `gathered` cast hemisphere
 * rays; for the others indirect is 0. */
void wave_gather(Wave *wave, uint32_t count, uint32_t gathered, const WaveOptions *options);

/* Whether light of a lamp that ray k met, cast from `at`, comes a way that no lamp ray finds, nor
 * photons. */
bool wave_lamp_unaimed(const Wave *wave, const Receiver *at, uint32_t k);

/* How far rays that leave p are moved off their surface. */
double wave_offset(const Room *room, Vec3 p);

/* What all hemisphere rays of a receiver share. */
typedef struct {
    Vec3 origin, normal, s, t;
} WaveFrame;
WaveFrame wave_frame(const Room *room, const Receiver *at);
/* The ray that leaves it for the point u of the square. */
Ray wave_hemisphere(const WaveFrame *frame, const float u[2]);

/* Where a ray ended, as much as the solution needs to know: less than a RoomHit, and cheaper. */
typedef struct {
    uint32_t surface;
    unsigned side;
    double   s, t;
} WaveEnd;
WaveEnd wave_end(const Gatherer *gatherer, const Ray *ray, const Hit *hit);

/* Chance that light is received once more where a hemisphere ray ended: 1 within the edge of the
 * patch there, 0 beyond two, and between them without a kink; 0 on sides that take no part. */
double wave_nearness(const Gatherer *gatherer, const WaveEnd *end, const Hit *hit);

/* Reflected radiosity of the solution there; 0 on sides that take no part. */
Rgb wave_radiosity(const Gatherer *gatherer, const WaveEnd *end);

#endif
