/* SPDX-License-Identifier: BSD-3-Clause */
/* bench/bench.h -- what the parts of the bench program share: scenes, sets of rays, tracers.
 *
 * models.c   triangles of a file, or made here
 * rays.c     the rays of three kinds of work
 * count.c    steps of the walk
 * copies.c   a picture of many copies
 * embree.c   the peer; without Embree's headers it is not compiled
 * raybench.c the measuring
 */
#ifndef BENCH_BENCH_H
#define BENCH_BENCH_H

#include "raycast/bvh.h"

typedef struct {
    char      name[64];
    Vec3     *position; /* [vertex_count] */
    uint32_t *corner;   /* [3 * triangle_count] */
    uint32_t  vertex_count, triangle_count;
    Vec3      lo, hi;
    Vec3      eye, target;
    double    fov; /* degrees, upright */
} Model;

/* `name`: "cornell", "cornell100k", "room", "room12m", "solids" (the room without walls), or a
 * scene file.
 * owns  the caller clears with model_clear. */
bool model_read(Model *model, const char *name, Error *err);
void model_clear(Model *model);

typedef enum { WORK_HEMISPHERE, WORK_VISIBILITY, WORK_PRIMARY, WORKS } Work;

typedef struct {
    Work     work;
    Ray     *ray;   /* [count]  as a solver makes them */
    Ray     *tiled; /* [count]  hemisphere: each patch's in order of direction; else as ray */
    Ray     *mixed; /* [count]  hemisphere: patches at random, tiled; else as ray */
    uint32_t count;
    uint32_t batch; /* rays that are handed over at once */
} RaySet;

const char *work_name(Work work);
bool rays_make(RaySet *set, const Model *model, Work work, Error *err);
void rays_clear(RaySet *set);

/* Nodes and triangles that a ray visits on the average when it is traced alone. */
void rays_count(const Bvh *bvh, const RaySet *set, double *nodes, double *triangles);

/* --- the peer -------------------------------------------------------------------------------- */

typedef struct Peer Peer;

typedef struct {
    const char *name;  /* "16 tiled coherent" */
    int         width; /* 1, 8, 16; 0: NM stream; -1: 1M stream */
    int         order; /* 0: as a solver makes them, 1: tiled, 2: patches at random */
    bool        coherent;
} PeerMode;

typedef struct {
    double   seconds;
    uint64_t hits, primitives; /* rays that hit, sum of the primitives hit */
} Traced;

#define PEER_MODES_MAX 32

/* Ways to trace this work; how many. 0: no Embree in this build. */
int peer_modes(Work work, PeerMode mode[PEER_MODES_MAX]);
Peer *peer_create(const Model *model, unsigned threads, double *build_seconds, uint64_t *bytes);
Peer *peer_destroy(Peer *peer);
Traced peer_trace(const Peer *peer, const RaySet *set, const PeerMode *mode, unsigned threads);

/* A picture (PNG) of copies of a model, and what they take. */
bool copies_draw(const Model *model, uint32_t count, unsigned threads, const char *path,
                 Error *err);

double bench_now(void);

#endif
