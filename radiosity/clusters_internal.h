/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/clusters_internal.h -- what clusters*.c share; for them only. */
#ifndef RADIOSITY_CLUSTERS_INTERNAL_H
#define RADIOSITY_CLUSTERS_INTERNAL_H

#include <stdatomic.h>

#include "radiosity/clusters.h"
#include "radiosity/stochastic_internal.h"

/* --- the tree --------------------------------------------------------------------------------- */

typedef struct {
    uint32_t begin, end;   /* leaves, as places in the order of the tree */
    uint32_t child;        /* the first of two, the other follows; 0: a leaf */
    double   area;         /* visible, of all its leaves */
    float    bend;         /* sine by which normals are off their mean, root mean square */
    float    thickness;    /* most that centres are off the plane of the mean normal */
    float    radius;       /* of a ball that holds it, around its centre of area */
    float    centre[3], normal[3]; /* normal: the mean's direction */
} ClusterNode;

/* Children follow their parents; node 0 is the root. Hidden patches are no leaves. */
typedef struct {
    ClusterNode *node;     /* [count] */
    uint32_t  count, leaves;
    uint32_t *patch;       /* [leaves]  of a place */
    double   *before;      /* [leaves + 1]  area of all places before this one */
} ClusterTree;

/* On failure to be cleared as well. */
bool cluster_tree_create(ClusterTree *tree, const Room *room, const double *area, Error *err);
void cluster_tree_clear(ClusterTree *tree);
/* The place below a node that u in [0, 1) stands for, by area; *rest in [0, 1). */
uint32_t cluster_tree_choose(const ClusterTree *tree, uint32_t node, double u, double *rest);

/* --- links ------------------------------------------------------------------------------------ */

/* Irradiance of `to` by `from`: factor * B. */
typedef struct {
    uint32_t to, from;     /* nodes */
    float    factor;
    float    error;        /* standard error of the factor, for leaves below; < 0: as many rays as
                              there may be were cast, minus the error */
} ClusterLink;

/* What links are refined by. */
typedef struct {
    const double *light;   /* [nodes]  luminance of what a node sends, over mean irradiance */
    const double *weight;  /* [nodes]  share of all that counts that lies there */
    double  threshold;     /* light * error * root of weight that a link may have */
} ClusterOracle;

typedef struct Candidate Candidate;
typedef struct CandidateScratch CandidateScratch;

typedef struct {
    Shooter      shooter;  /* room and places alone: for shooter_place */
    const ClusterTree *tree;
    const Monitor *monitor;
    unsigned     threads;
    uint32_t     seed;
    ClusterLink *link;     /* [count]  rising by `to` */
    size_t       count, capacity;
    uint64_t    *first;    /* [nodes + 1]  of each node, as `to` */
    Candidate   *stack;    /* [stacked] */
    size_t       stacked, stack_capacity;
    CandidateScratch *scratch; /* [threads] */
    uint64_t     rays, most_rays; /* cast; allowed */
    uint64_t     most_links;
    size_t       largest;  /* links there were at a time, those being replaced included */
    bool         spent, full, stopped; /* why no more are refined */
} ClusterLinks;

/* One link, from the root to itself. On failure to be cleared as well. */
bool cluster_links_create(ClusterLinks *links, const Room *room, const OpenPlaces *places,
                          const ClusterTree *tree, const ClustersOptions *options,
                          const Monitor *monitor, Error *err);
void cluster_links_clear(ClusterLinks *links);
/* Refines what the oracle says, down to where it is satisfied; *refined gets how many of the links
 * there were gave way. */
bool cluster_links_refine(ClusterLinks *links, const ClusterOracle *oracle, uint64_t *refined,
                          Error *err);
/* Takes `count` links, as bytes, for those there are: they lie in order.
 * fails  false; ERROR_MEMORY. */
bool cluster_links_set(ClusterLinks *links, const unsigned char *bytes, size_t count, Error *err);
/* Root of the sum over links of (light * error)^2 * weight. */
double cluster_links_error(const ClusterLinks *links, const ClusterOracle *oracle);

/* --- one link's rays -------------------------------------------------------------------------- */

enum { CANDIDATE_SAMPLES = 4 };

/* A ray between two points. */
typedef struct {
    uint32_t to, from;     /* places */
    float    value;        /* cos cos / (pi d^2), times places' weights; < 0: blocked, minus that */
} ClusterSample;

/* A link that may yet give way. */
struct Candidate {
    uint32_t to, from;
    float    error;        /* > 0: it stays as it is, with this error, and its samples are new ones
                              that had no part in deciding that */
    uint32_t count;        /* of sample */
    uint32_t taken;        /* samples that are in the sums alone */
    double   sum, square, open; /* of values, their squares, what they might be */
    ClusterSample sample[CANDIDATE_SAMPLES];
};

/* Fills up the samples of candidates and traces them, by one thread; returns rays cast. */
uint64_t candidates_sample(const ClusterLinks *links, CandidateScratch *scratch,
                           Candidate *candidate, uint32_t count);
/* Puts the samples into the sums. */
void candidate_sum(const ClusterLinks *links, Candidate *candidate);
/* The link that a candidate's samples make. */
ClusterLink candidate_link(const ClusterLinks *links, const Candidate *candidate);

enum { CANDIDATE_CHUNK = 1024 };
struct CandidateScratch {
    Ray      *ray;         /* [CANDIDATE_CHUNK * CANDIDATE_SAMPLES] */
    bool     *blocked;     /* likewise */
    ClusterSample **sample; /* likewise; of each ray */
    uint64_t  rays;
};

/* --- light over links ------------------------------------------------------------------------- */

/* What comes to a node by its own links and those of nodes above. */
typedef struct {
    double light[ROOM_BANDS], loose[ROOM_BANDS]; /* irradiance; times links' looseness */
    double rows, loose_rows;                     /* the same of factors */
    double loosest;                              /* of all links */
} ClusterIrradiance;

typedef struct {
    const ClusterLinks *links;
    const SolveProblem *problem;
    double *sent;              /* [nodes * ROOM_BANDS]  radiosity, the mean over patches */
    double *uneven;            /* [nodes]  variance of its luminance over patches */
    ClusterIrradiance *here;   /* [nodes] */
    double *escape;            /* [nodes]  share of the view that meets nothing */
    float  *escape_looseness;  /* [nodes] */
    float  *fill, *scale;      /* [leaves]  factors are to be (1 + looseness * fill) * scale times
                                  what they are */
    double *meaning;           /* [nodes * ROOM_BANDS]  importance; of leaves, later of nodes */
    double  rows;              /* root mean square of what rows lacked */
} ClusterLight;

/* On failure to be cleared as well. */
bool cluster_light_create(ClusterLight *light, const ClusterLinks *links,
                          const SolveProblem *problem, bool importance, Error *err);
void cluster_light_clear(ClusterLight *light);
/* After links have changed: what rows are to be filled with. */
void cluster_light_fill(ClusterLight *light);
/* Gathers over all links, and reflects; radiosity and irradiance [patches * ROOM_BANDS] get what
 * there is then. Returns the power by which that differs from what was sent, relative to all. */
double cluster_light_sweep(ClusterLight *light, double *radiosity, double *irradiance);
/* Radiosity of patches up to all nodes. */
void cluster_light_pull(ClusterLight *light, const double *radiosity);
/* Importance of all patches, given what they weigh themselves, `seen` [patches]: the transposed of
 * light's way, in up to `sweeps` steps. */
void cluster_light_meaning(ClusterLight *light, const double *seen, uint32_t sweeps);
/* Power, of what patches send, that escapes. */
void cluster_light_escaped(const ClusterLight *light, const double *radiosity,
                           double escaped[ROOM_BANDS]);

/* --- the last reflection ---------------------------------------------------------------------- */

/* Replaces the solution by what its patches gather of it, by the options' seed; as it was, if
 * stopped. Patches of less weight [nodes] than a small share of the mean stay. Leaves noise and
 * rays in the report. */
bool clusters_gather(const ClusterLinks *links, const SolveProblem *problem,
                     const ClustersOptions *options, const double *weight, Solution *solution,
                     ClustersReport *report, const Monitor *monitor, Error *err);

/* --- what is kept of a run -------------------------------------------------------------------- */

/* Two rows for each patch, by the halves of one net: their difference tells the noise, and more
 * than that, for together they are spread better. */
enum { CLUSTER_HALVES = 2, CLUSTER_GATHER_CHUNK = 256 };

/* After a round. */
typedef struct {
    uint64_t links, rays, most_links, largest;
    double   threshold, error;
    uint32_t patches, nodes, rounds, iterations;
    uint32_t ended, full, guided; /* flags: it was the last round; no more links fit; there is
                                     importance */
    uint32_t gathered;     /* patches of the last reflection, once it has begun */
} ClustersHead;

/* Where a run has the rest. */
typedef struct {
    ClusterLinks *links;
    double *radiosity;     /* [patches * ROOM_BANDS] */
    double *meaning;       /* [nodes * ROOM_BANDS]; NULL: without importance */
    double *weight;        /* [nodes]  likewise */
} ClustersState;

/* The last reflection under way. */
typedef struct {
    double   *came[CLUSTER_HALVES]; /* [patches * ROOM_BANDS]  irradiance */
    float    *escape;      /* [patches]  of both rows, their sum */
    uint32_t *patch;       /* [patches]  those that gather */
    uint32_t  patches;
    atomic_uint *done;     /* of each chunk of them: rays it took, once it is finished */
} ClustersGathered;

bool clusters_kept_put(ClustersKept *kept, const ClustersHead *head, const ClustersState *from,
                       Error *err);
/* Copies back what was loaded or put; false: there is nothing, or it does not fit: *err is set. */
bool clusters_kept_get(const ClustersKept *kept, ClustersHead *head, const ClustersState *to,
                       Error *err);
/* From now on finished chunks are kept as well, once the last round is; those that were loaded are
 * copied back. */
bool clusters_kept_gather(ClustersKept *kept, const ClustersGathered *gathered, Error *err);
/* Until now; NULL is allowed. */
void clusters_kept_gathered(ClustersKept *kept);

#endif
