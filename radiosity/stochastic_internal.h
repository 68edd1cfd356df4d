/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/stochastic_internal.h -- what the files of the stochastic solver share. */
#ifndef RADIOSITY_STOCHASTIC_INTERNAL_H
#define RADIOSITY_STOCHASTIC_INTERNAL_H

#include "radiosity/internal.h"
#include "radiosity/stochastic.h"

enum {
    SHOT_CHUNK = BVH_BLOCK,  /* rays sorted and traced together */
    SHOT_ROUND = 32,         /* chunks whose hits are kept until they are summed */
    SHOT_BUCKETS = 64,       /* ranges of patches that are summed apart */
    OPEN_CELLS = 64          /* of a patch, 8 x 8 */
};

/* Where a ray came to, and what its power is multiplied with. */
typedef struct {
    uint32_t target, source;
    float    weight;
} Shot;

/* Irradiance of one patch. */
typedef struct {
    double   direct[ROOM_BANDS], indirect[ROOM_BANDS];
    uint32_t rays, missed;     /* that told something; that met nothing */
} Gathered;

enum { GATHER_CHUNK = 512, GATHER_RAYS = 32, GATHER_SIGHTS = 2048 };

/* What a thread traces rays with. */
typedef struct {
    Ray      *ray;      /* [SHOT_CHUNK] */
    Hit      *hit;      /* [SHOT_CHUNK] */
    bool     *blocked;  /* [SHOT_CHUNK] */
    uint32_t *pending;  /* [SHOT_CHUNK]  rays to be shot again */
    uint32_t *source;   /* [SHOT_CHUNK] */
    float    *value;    /* [SHOT_CHUNK] */
    Shot     *shot;     /* [SHOT_CHUNK] */
    Gathered *gathered; /* [GATHER_CHUNK] */
    uint64_t  rays;
} ShotScratch;

/* Hits of a chunk, sorted by bucket. */
typedef struct {
    Shot    *shot;                     /* [SHOT_CHUNK] */
    uint32_t first[SHOT_BUCKETS + 1];
    double   sent[ROOM_BANDS], escaped[ROOM_BANDS];
} ShotChunk;

typedef struct {
    const Room         *room;
    const OpenPlaces   *places;
    const SolveProblem *problem;
    unsigned     threads;
    uint32_t     count, seed;
    LampTable    lamps;
    double       lamp_power;    /* sum over bands and patches of A E; found by shooter_light */
    uint32_t     samples;       /* to lamps, per patch and batch */
    float       *seen, *square; /* [count]  power of all bands by visibility rays, of all batches;
                                   sum of its squares */
    float       *missed, *told; /* [count]  gathering rays that met nothing; that told something */
    ShotScratch *scratch;       /* [threads] */
    ShotChunk   *chunk;         /* [SHOT_ROUND] */
    uint32_t    *first_ray;     /* [count + 1]  of each patch, in the pass under way */
} Shooter;

/* One pass: which power is shot, and with what. */
typedef struct {
    Shooter      *shooter;
    const double *power;        /* [count * bands]  to be shot */
    double        all;          /* sum of it over patches and bands */
    double       *arrived;      /* [count * bands]  power; added to */
    uint32_t      rays, seed;
    uint32_t      round;        /* first ray of the round under way */
    bool          lamps;        /* hits are weighed against visibility rays */
    double        sent[ROOM_BANDS], escaped[ROOM_BANDS];
} ShotPass;

bool shooter_create(Shooter *shooter, Error *err);
void shooter_clear(Shooter *shooter);

/* --- stochastic_places.c: places of patches outside solids ------------------------------------ */

/* Rays that tell which of the cells of a patch are (OpenPlaces): RAYS_PER_POSITION for each. */
enum { OPEN_RAYS = OPEN_CELLS * RAYS_PER_POSITION };

/* Which cells are, by rays of `row`, made for OPEN_RAYS; nothing else of its row holds then. */
uint64_t open_cells_judge(RowCast *row, const Room *room, uint32_t patch, uint32_t seed);
/* A place of a patch in such a cell, for x in [0,1)^2. open: not 0. */
void open_cells_place(const Room *room, uint64_t open, uint32_t patch, const float x[2],
                      PatchPoint *at);

/* A place of a patch that lies outside solids, for x in [0,1)^2. */
void shooter_place(const Shooter *shooter, uint32_t patch, const float x[2], PatchPoint *at);

/* Shoots pass->power by pass->rays rays; `arrived` gets what came to patches, sent what they and
 * the open were given in all: near to the power, and to be scaled to it. */
void shooter_shoot(ShotPass *pass);

/* Power that comes straight from lamps into out [count * bands], and what escapes of theirs;
 * together exactly what they emit. Batches of even numbers sample one net, those of odd numbers
 * another one. `emitted` [count * bands] is overwritten. */
void shooter_light(Shooter *shooter, uint32_t batch, uint32_t rays, double *emitted, double *out,
                   double escaped[ROOM_BANDS]);

/* Share that a visibility ray between a place of a lamp and one of a patch (`weight`: of the
 * latter, as PatchPoint has it) counts beside `rays` rays from all lamps; geometry: cos cos over
 * the squared distance. */
double shooter_share(const Shooter *shooter, uint32_t lamp, uint32_t patch, double weight,
                     double geometry, uint32_t rays);

/* --- gathering -------------------------------------------------------------------------------- */

/* One round: rays over the hemisphere of patches, and to lamps. */
typedef struct {
    const Shooter  *shooter;
    const double   *reflected; /* [count * bands]  rho H */
    const uint32_t *order;     /* patches; those that stand together share one net of points */
    const uint16_t *sights;    /* [count]  of each patch: rays to lamps */
    const uint32_t *first_sight; /* [count]  by place in `order`: in the net */
    uint32_t        rays;      /* of each patch over its hemisphere */
    uint32_t        hemisphere_seed, sight_seed;
} Gather;

/* Light that comes to patches order[begin..end-1], at most GATHER_CHUNK, into out. */
void gather_patches(const Gather *g, ShotScratch *c, uint32_t begin, uint32_t end, Gathered *out);

/* --- evening out ------------------------------------------------------------------------------ */

/* A tree over the patches: those that lie and look alike stand together. */
typedef struct {
    uint32_t  count;
    uint32_t *order;   /* [count] */
    uint8_t  *joined;  /* [count]  of the node that is parted at this place: its halves see each
                          other */
    uint8_t  *group;   /* [count]  scratch of even_tree_fit */
    const Vec3 *place; /* [count]  of each patch */
} EvenTree;

/* Patches whose noise is told together: enough for 35 % of it. */
enum { EVEN_POOL = 16 };

/* What one parameter of a fit costs, in variances: 2 for a group that was given [mallows73], more
 * where many were to choose from. */
static const double EVEN_PENALTY = 3;

/* Patches of a group whose deviation from its fit is judged together, at most. */
enum { EVEN_JUDGED = 8 };

/* Share of the square of mere noise that is taken for light then: E[r; r > r0] of the correlation r
 * of n = EVEN_JUDGED normal deviates beyond r0 = 0.7071, two standard deviations of it. That is
 * c (1 - r0^2)^((n-1)/2) / (n - 1), c = Gamma(n/2) / (sqrt(pi) Gamma((n-1)/2)). */
static const double EVEN_TAKEN = 0.0129;

bool even_tree_create(const Room *room, const double *area, unsigned threads, EvenTree *tree,
                      Error *err);
void even_tree_clear(EvenTree *tree);

/* Replaces power [count * bands] that came in two independent halves by linear functions of place
 * over groups of patches; in place, sums over groups are kept. Returns the number of groups. */
uint32_t even_tree_fit(const EvenTree *tree, const double *area, double *half[2]);

/* mean [count]: of value [count] over EVEN_POOL patches that follow each other in the tree. */
void even_tree_pool(const EvenTree *tree, const double *value, float *mean);

#endif
