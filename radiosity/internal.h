/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/internal.h -- what the files of this folder share; this folder only. */
#ifndef RADIOSITY_INTERNAL_H
#define RADIOSITY_INTERNAL_H

#include <stdatomic.h>

#include "radiosity/kept_rows.h"
#include "radiosity/links.h"
#include "radiosity/links_store.h"
#include "radiosity/room.h"
#include "radiosity/sides.h"
#include "radiosity/solve.h"

/* --- solvers ---------------------------------------------------------------------------------- */

/* A problem made ready: what all solvers read. */
typedef struct {
    const Links        *links;
    const SolveProblem *problem;
    const Monitor      *monitor;
    unsigned            bands, threads;
    double              tolerance;
    uint32_t            max_iterations; /* UINT32_MAX: no limit */
    const SolveOptions *options;
    const Solution     *solution;       /* being made */
    double             *begin;          /* seconds of the clock at the start, traces left out */
    Reflected          *reflected;      /* NULL: no bound was asked for */
    double             *start;          /* [count * bands]  the caller's, 0 in bands without
                                           power; NULL: none */
    double             *shown, *after;  /* [count * bands]  of a trace: an iterate, the next one */
    double             *source;         /* [count * bands]  E + rho H0 */
    double             *power;          /* [bands]  sum of A (E + rho H0) */
    double             *chunk_sum;      /* [chunks * bands]  scratch of solve_apply */
    LinksScratch       *scratch;        /* [threads]  for rows that are packed */
} SolveSystem;

/* next = E + rho (H0 + F radiosity) in parallel; `irradiance` gets H0 + F radiosity unless NULL.
 * Returns the residual of `radiosity`. */
double solve_apply(const SolveSystem *system, const double *radiosity, double *next,
                   double *irradiance);

/* H0 + F radiosity of one patch into out[bands], by the thread that is `worker`. */
void solve_gather_row(const SolveSystem *system, const double *radiosity, uint32_t patch,
                      unsigned worker, double *out);

/* max over bands of sum[b] / power[b]; a band without power has nothing to miss. */
double solve_relative(const SolveSystem *system, const double *sum);

/* A power as a share of what there is in the band with the least, dark ones apart. */
double solve_share(const SolveSystem *system, double power);

/* Tells when an iteration no longer gains: rounding sets a floor that no tolerance can undercut. */
typedef struct {
    double   best;
    uint32_t since;
} SolveStall;
bool solve_stalled(SolveStall *stall, double residual);

/* What an iteration starts from, into radiosity [count * bands]: the caller's, or `otherwise`. */
void solve_start(const SolveSystem *system, const double *otherwise, double *radiosity);

/* Makes the radiosity that a solver has got to, into out [count * bands]. */
typedef void (*SolveShow)(void *context, double *out);

/* Tells how much light is still missing after work that read the links `passes` times. `show` is
 * asked only when someone wants to see; NULL: it is in the solution. True when the caller wants to
 * stop. */
bool solve_report(const SolveSystem *system, double left, double passes, SolveShow show,
                  void *context);

/* Each leaves radiosity, iterations and unshot in *solution. */
bool solve_jacobi(const SolveSystem *system, Solution *solution, Error *err);
bool solve_gauss_seidel(const SolveSystem *system, Solution *solution, Error *err);
bool solve_progressive(const SolveSystem *system, Solution *solution, Error *err);

/* --- rays in a room --------------------------------------------------------------------------- */

/* Patch, surface parameters included, that a ray along `direction` met; PATCH_NONE when it met a
 * side not in use. Cheaper than room_hit. */
uint32_t room_patch(const Room *room, const Hit *hit, Vec3 direction, uint32_t *surface, double *s,
                    double *t);

/* Where a ray came to: PATCH_NONE at a side not in use. */
typedef struct {
    uint32_t patch, surface;
    bool     escaped;
    double   s, t;
} RayEnd;

/* Seeds of what is sampled here differ by these, so that no two use the same points. */
enum { SEED_ROWS = 0x726f7773, SEED_LAMPS = 0x6c616d70, SEED_LIGHTS = 0x6c697465,
       SEED_SIDES = 0x73696465, SEED_PARTS = 0x70617274, SEED_ADAPT = 0x61647074,
       SEED_MIRRORS = 0x6d697272, SEED_POCKETS = 0x706f636b,
       SEED_GROUPS = 0x67727073,
       SEED_POINTS = 0x706f696e,
       SEED_CLUSTERS = 0x636c7573, SEED_CLUSTERS_AGAIN = 0x636c6167,
       SEED_AGAIN = 0x61676169,
       SEED_CHECK = 0x6368656b };

/* Stands for a patch in seeds: where it lies, not its number, so that a patch keeps its rays when
 * others are divided. */
uint32_t room_patch_key(const Room *room, uint32_t patch);

/* --- lamps ------------------------------------------------------------------------------------ */

/* Emitting patches, chosen in proportion to their power. */
typedef struct {
    uint32_t  count;
    uint32_t *patch;        /* [count]  rising */
    double   *cumulative;   /* [count]  probability of this one or one before it; the last is 1 */
    float    *probability;  /* [patches]  0: no lamp */
} LampTable;

bool lamp_table_create(const Room *room, LampTable *lamps, Error *err);
void lamp_table_clear(LampTable *lamps);
/* The lamp that u in [0, 1) stands for; *rest in [0, 1) is where in the lamp's range u lies. */
uint32_t lamp_table_choose(const LampTable *lamps, double u, double *rest);
/* Solid-angle density, seen from a point at `distance`, of choosing the direction towards the point
 * of a lamp that a ray came to; `cosine` is taken at the lamp. */
double lamp_density(const Room *room, const LampTable *lamps, const RayEnd *end, double distance,
                    double cosine);

/* --- casting one row -------------------------------------------------------------------------- */

/* Rays whose places on the patch lie in one cell of a grid over it judge together whether that cell
 * lies in the open or inside a solid: it takes several to tell, and more would blur the edge. */
enum { RAYS_PER_POSITION = 4 };

typedef struct {
    PatchPoint at;              /* place of the first good ray, else of the first */
    uint32_t   first;           /* that ray */
    uint32_t   good, bad, rays; /* rays that met a side in use or nothing, others, all */
    uint32_t   near;            /* of the good ones, those that ended in a pocket */
    double     weight, good_weight; /* mean over all rays; sum over the good ones */
} CastPosition;

/* A sample between a patch and a lamp: what it carries when nothing is in the way. */
typedef struct {
    uint32_t lamp;
    double   share;
} LampSample;

/* What a row is cast with, and the row itself. */
typedef struct {
    uint32_t      rays, lamp_rays, positions, patch;
    uint32_t      begin;       /* point of the net that the first ray takes: 0 or `rays`; rays to
                                  lamps begin at 0 or `lamp_rays` then */
    CastPosition *position;    /* [positions] */
    uint32_t     *valid;       /* [valid_count]  positions that are not void */
    uint32_t      valid_count;
    Ray          *ray;         /* [rays] */
    Hit          *hit;         /* [rays] */
    RayEnd       *end;         /* [rays] */
    uint32_t      good_rays;   /* from positions that are valid */
    LampSample   *sample;      /* [lamp_rays]  those with a ray, `sample_count` of them */
    Ray          *lamp_ray;    /* [lamp_rays] */
    bool         *blocked;     /* [lamp_rays] */
    uint32_t      sample_count;
    double        sample_scale;/* on all shares */
    uint32_t      seed;        /* of the rays' points */
    double        medium;      /* square of the index of refraction of what the patch lies in */
    double       *cosine;      /* [rays]  at the patch */
    bool         *turned;      /* [rays]  by a mirror: no lamp's sample finds the same way */
    uint32_t     *cell;        /* [rays]  its position */
    uint32_t     *start;       /* [rays]  the surface it leaves */
    double       *weight;      /* [rays]  of the place it leaves */
    float       (*place)[2];   /* [rays]  of the patch's square, that it leaves */
    float        *value;       /* [rays + lamp_rays]  share of each ray that arrived */
    uint64_t     *key, *other; /* [rays + lamp_rays]  patch and number of the ray; for sorting */
    uint32_t      keys;
    /* the row */
    uint32_t     *source;      /* [rays + lamp_rays] */
    float        *form_factor; /* [rays + lamp_rays] */
    uint32_t      links;
    double        escape, area;
    uint64_t      cast, clamped;
} RowCast;

bool row_cast_create(RowCast *row, uint32_t rays, uint32_t lamp_rays, Error *err);
/* With room for the rays of several patches, one after the other, in all arrays of rays. */
bool row_cast_allocate(RowCast *row, uint32_t rays, uint32_t lamp_rays, uint32_t patches,
                       Error *err);
void row_cast_clear(RowCast *row);
/* Casts a patch's hemisphere rays and tells which of its positions lie outside solids (`valid`, the
 * others have good 0); returns how many rays count. */
uint32_t row_cast_positions(RowCast *row, const Room *room, uint32_t patch, uint32_t seed);

/* The same in steps, so that the rays of many patches are traced together: make the rays, let them
 * find their hits, judge the positions, make the rays to lamps, let them be found blocked or not,
 * finish. */
void row_cast_rays(RowCast *row, const Room *room, uint32_t patch, uint32_t seed);
/* Where rays go on at mirrors, after their first hits. */
void row_cast_follow(RowCast *row, const Room *room);
void row_cast_judge(RowCast *row, const Room *room);
void row_cast_aim(RowCast *row, const Room *room, const LampTable *lamps, uint32_t patch,
                  uint32_t seed);
void row_cast_finish(RowCast *row, const Room *room, const LampTable *lamps, uint32_t patch);
/* Adds the shares of rays to lamps that nothing blocked, or panes alone. */
void row_cast_lamps(RowCast *row, const Room *room);
/* A share that arrived at a patch. */
void row_cast_add(RowCast *row, uint32_t patch, double share);

/* --- casting rows together -------------------------------------------------------------------- */

/* Most patches whose rays are traced together. */
enum { TILE_PATCHES = 64 };

/* What one thread casts rows with: those of a tile share what only the last step needs. */
typedef struct {
    RowCast  row[TILE_PATCHES];
    uint32_t patch[TILE_PATCHES];
    uint32_t most, count;      /* patches that fit; in the tile now */
    RowCast  all;              /* the arrays that the rows are slices of */
    uint64_t cast, clamped;
} RowTile;

bool row_tile_create(RowTile *tile, uint32_t rays, uint32_t lamp_rays, Error *err);
void row_tile_clear(RowTile *tile);
/* Casts all rays of up to `most` patches. Same numbers whichever thread asks, and whatever patches
 * are asked for beside. */
void row_tile_cast(RowTile *tile, const Room *room, const LampTable *lamps, const uint32_t *patch,
                   uint32_t count, uint32_t seed);
/* The finished row of patch[k]; it holds until the next one is asked for. */
const RowCast *row_tile_row(RowTile *tile, const Room *room, const LampTable *lamps, uint32_t k);

/* --- rows in parallel ------------------------------------------------------------------------- */

/* Patches a thread takes at a time: some 10^4 rays, a few milliseconds. */
enum { MAKER_CHUNK = 64 };

/* Rows of one chunk, packed one after the other. */
typedef struct {
    uint32_t   *source;
    float      *form_factor;
    uint64_t    links, cast, clamped; /* cast, clamped: what was counted for it */
    atomic_bool done;                 /* all of it is there, for whoever sees this set */
    uint64_t    mapped;               /* bytes of the file that both arrays lie in; 0: memory */
} RowChunk;

/* The chunk that a thread is at. */
typedef struct {
    uint32_t *source;
    float    *form_factor;
    size_t    source_capacity, factor_capacity;
    uint64_t  links, row;  /* row: where the current one begins */
    uint64_t  cast, clamped; /* counts of the thread when the chunk began */
    Error     error;
} RowBuffer;

typedef struct {
    const Room *room;
    LampTable   lamps;
    uint32_t    seed;
    unsigned    threads;
    RowTile    *tile;      /* [threads] */
    RowBuffer  *buffer;    /* [threads] */
    const char *folder;    /* of files that chunks and links lie in; NULL: memory */
    RowChunk   *chunk;     /* [chunks] */
    uint32_t    chunks, count;
    uint32_t   *length;    /* [count]  links in the row */
    float      *escape;    /* [count] */
    double     *area;      /* [count] */
    double      begun;     /* clock */
    KeptRows   *kept;      /* the caller's, or NULL */
    uint64_t    taken_cast, taken_clamped; /* of chunks that were taken over from it */
} RowMaker;

/* Rows for the caller to save, and rows it had saved (kept_rows.h). */
struct KeptRows {
    const RowMaker *maker;  /* casting them; NULL: none under way */
    /* loaded, for the next maker */
    uint32_t  count;        /* rows; 0: nothing was loaded */
    RowChunk *chunk;        /* [chunks of count rows] */
    uint32_t *length;       /* [count] */
    float    *escape;       /* [count] */
    double   *area;         /* [count] */
};

/* On failure to be cleared as well. */
bool row_maker_create(RowMaker *maker, const Room *room, const LinksOptions *options, Error *err);
/* Rays of a row, those to lamps that may turn out to be needless included. */
uint32_t row_maker_rays(const RowMaker *maker);
void row_maker_clear(RowMaker *maker);
/* A link of the thread's current row, sources rising. */
void row_maker_add(RowMaker *maker, unsigned worker, uint32_t source, float form_factor);
/* The current row is that of patch `row`, and complete. */
void row_maker_end(RowMaker *maker, unsigned worker, uint32_t row, float escape, double area);
/* Both, by rays, for rows that follow each other in the order of their making. */
void row_maker_cast(RowMaker *maker, const uint32_t *row, uint32_t count, unsigned worker);
/* Whether the chunk that begins at row `begin` was made by an earlier run. */
bool row_maker_has(const RowMaker *maker, uint32_t begin);
/* The chunk that begins at row `begin` is complete. */
void row_maker_keep(RowMaker *maker, uint32_t begin, unsigned worker);
/* All chunks as links, once; they are gone afterwards. */
Links *row_maker_gather(RowMaker *maker, Error *err);

/* --- links ------------------------------------------------------------------------------------ */

/* Both estimates of each pair made one: form_factor of the result holds S_ij = A_i F_ij, symmetric
 * bit for bit. Pairs nobody sees, or with a patch that is hidden or sees nothing, are left out. */
Links *links_pairs(const Links *links, const Patches *patches, unsigned threads, Error *err);
typedef struct {
    double   missed;   /* greatest error of a row, relative to its area */
    uint32_t opened;   /* rows that could be balanced only by letting some light escape */
} BalanceReport;

/* Scales pairs symmetrically until each row and its escape sum to the area, and turns them into
 * factors; rows that are `alone` are left as they are. */
bool links_balance(Links *pairs, const bool *alone, unsigned threads, const Monitor *monitor,
                   BalanceReport *report, Error *err);

/* --- point lights ----------------------------------------------------------------------------- */

/* Irradiance per intensity on the axis at p, facing n, if nothing is in the way: cos / d^2. */
double light_arriving(const Light *light, Vec3 p, Vec3 n);
/* From a surface point to a light, which is no surface: only the start is moved. */
Ray ray_to_light(const Room *room, const Light *light, Vec3 p, Vec3 n);

/* --- sides ------------------------------------------------------------------------------------ */

/* A side of a surface is 2 * surface + side here. */
typedef struct {
    uint32_t side;   /* SIDE_NONE: nothing was met */
    float    s, t;
} Place;
#define SIDE_NONE UINT32_MAX

/* Which places are known to lie in reach, at most one per cell of a grid on each side. */
typedef struct {
    const Surfaces *surfaces;
    const Bvh      *bvh;
    const Material *materials;
    const Monitor  *monitor;
    uint32_t  rays, seed;
    unsigned  threads;
    double    offset;
    double    cell_area;  /* of a cell as wanted */
    uint64_t *first;      /* [2 * surfaces + 1]  first cell of a side */
    uint16_t *grid;       /* [surfaces]  cells along s and along t */
    Place    *cell;       /* [first[2 * surfaces]]  side SIDE_NONE: not reached there */
    uint32_t *queue;      /* [cells]  cells reached, in order; those before `shot` have shot on */
    uint64_t  reached, shot;
    uint8_t  *used;       /* [surfaces]  bit 0/1: front/back */
    uint8_t  *shell;      /* [parts]  1: no sight passes it (shells_find) */
    uint8_t  *entered;    /* [parts]  bit 0/1: some front/back is used */
    Place    *found;      /* [found_capacity]  what one block of rays met */
} Reach;

bool reach_create(Reach *reach, const Surfaces *surfaces, const Bvh *bvh,
                  const Material *materials, const SidesOptions *options,
                  const Monitor *monitor, Error *err);
void reach_clear(Reach *reach);
/* Marks a place as in reach. */
void reach_add(Reach *reach, Place place);
/* All of a side: its light leaves from anywhere. */
void reach_add_side(Reach *reach, uint32_t side);
/* What can be seen from a point in the air, by `rays` rays all round. */
void reach_look(Reach *reach, Vec3 eye, uint32_t rays, uint32_t seed);
/* The same the other way round: sides that an eye far off hits too rarely look for it. */
void reach_aim(Reach *reach, Vec3 eye);
/* Follows sight from all places reached until nothing new turns up.
 * fails  false and ERROR_STOPPED. */
bool reach_spread(Reach *reach, Error *err);
/* Only lets what was added look on, without looking back; false when stopped. */
bool reach_spread_on(Reach *reach);

/* sides_shells.c: whether a surface and its neighbour over edge k are wound alike: then they run
 * along their edge in opposite directions. Where they share several edges, all must say so. */
bool shells_alike(const Surfaces *surfaces, uint32_t surface, unsigned k, uint32_t neighbour);
/* Which parts are closed and wound alike: sight never passes from their fronts to their backs. */
bool shells_find(const Surfaces *surfaces, uint8_t **shell, Error *err);

/* Decides which sides emit; returns how many surfaces EMIT_AUTO turned. */
bool sides_emission(const Surfaces *surfaces, const Bvh *bvh, const Material *materials,
                    const SidesOptions *options, uint8_t *emitting, uint32_t *turned,
                    const Monitor *monitor, Error *err);

#endif
