/* SPDX-License-Identifier: BSD-3-Clause */
/* render/path_internal.h -- what the files of the path tracer share. */
#ifndef RENDER_PATH_INTERNAL_H
#define RENDER_PATH_INTERNAL_H

#include "radiosity/room.h"
#include "render/internal.h"
#include "render/lamp_tree.h"
#include "render/lamps.h"
#include "render/path.h"

/* --- path_lamps.c: all that emits, and the choice among it ----------------------------------- */

/* Up to so many lamps are weighed by what they may send to a place; more by a tree. */
enum { PATH_WEIGHED = 32 };

typedef struct PathScene PathScene;

/* A side that emits, or a light without size. */
typedef struct {
    uint32_t     surface;
    unsigned     side;
    const Light *light;   /* NULL: a surface */
    double       power;   /* luminance sent out, or largest band of a colour without */
    double       area;
    Vec3         centre;
    double       radius;  /* of a ball around it */
    Vec3         axis;    /* if `flat`: unit, the way it shines */
    bool         flat;
    /* What it takes to aim at it lies together: of many lamps each is fetched from afar. */
    Rgb          emission;
    unsigned     triangles; /* 0: a shape */
    Vec3         corner[4]; /* of triangles 0 1 2 and 0 2 3 */
    double       share;     /* of the first triangle in the area */
} PathLamp;

typedef struct {
    const Room *room;
    PathLamp   *lamp;     /* [count] */
    uint32_t    count;
    LampTree    tree;     /* of more than PATH_WEIGHED lamps */
    uint32_t   *of_side;  /* [2 * surfaces->count]  side * count + surface -> lamp, or UINT32_MAX */
} PathLamps;

bool path_lamps_init(PathLamps *lamps, const Room *room, Error *err);
void path_lamps_clear(PathLamps *lamps);

/* A place on a surface: the side the normal points to. */
typedef struct {
    Vec3 point, normal;
} PathPlace;

/* A point of a lamp as seen from a place. */
typedef struct {
    Vec3   point, normal; /* normal 0: a light without size */
    Vec3   way;           /* unit, from the place */
    Rgb    light;         /* radiance / density, or intensity / distance^2 / chance */
    double density;       /* per solid angle; 0: no ray of another kind can meet it */
} PathAim;

/* u in [0,1)^3. false: nothing arrives that way. */
bool path_lamps_aim(const PathLamps *lamps, const PathPlace *from, const float u[3], PathAim *aim);

/* Density, per solid angle, with which path_lamps_aim chooses the point that a ray met. */
double path_lamps_density(const PathLamps *lamps, const PathPlace *from, const RoomHit *hit);

/* --- path_surface.c: how light goes on at a surface ------------------------------------------ */

typedef struct {
    const Room     *room;     /* that the hit's surface is of: a mesh's, where copies stand */
    const Material *material; /* may be `made`: not to be copied */
    Material        made;     /* where an image makes it */
    RoomHit         hit;
    Vec3            normal;   /* for mirrors, maybe smoothed */
    Receiver        at;       /* of light that is scattered: smooth where the eye sees it sharp */
    Vec3            in;       /* unit, of the ray that came */
    double          diffuse, gloss, clear; /* chances of the kinds of ways on, of sum 1 or all 0 */
} PathSurface;

/* room and hit: as path_place says of `found`, which may be NULL where no copies stand. sharp: the
 * eye sees the place, straight or by way of mirrors and glass alone. */
void path_surface_init(PathSurface *surface, const PathScene *scene, const Room *room,
                       const InstanceHit *found, const RoomHit *hit, Vec3 in, bool sharp);
/* Diffuse scattering alone, times the cosine. */
Rgb path_surface_diffuse(const PathSurface *surface, Vec3 out);

/* Diffuse and glossy scattering into a direction: f cos, and the density of the same way being
 * chosen by path_surface_next. 0 for mirrors and glass. */
Rgb path_surface_value(const PathSurface *surface, Vec3 out, double *density);

typedef struct {
    Vec3   out;           /* unit */
    Rgb    weight;        /* f cos / density, chances included */
    double density;       /* per solid angle; 0: a mirror or glass */
    bool   across;        /* leaves to the other side */
    bool   straight;      /* through a pane, unbent */
} PathNext;

/* u in [0,1)^3. false: the path ends. */
bool path_surface_next(const PathSurface *surface, const float u[3], PathNext *next);

/* Share of light that crosses the surface straight: 0 unless it is a clear pane. */
Rgb path_surface_pane(const Room *room, const RoomHit *hit, Vec3 in);

/* The hit without patches. */
void path_hit(const Room *room, const Hit *hit, Vec3 direction, RoomHit *out);

/* --- path_trace.c: many paths at once -------------------------------------------------------- */

/* Sums over the paths of a pixel. */
typedef struct {
    Rgb radiance, direct, indirect;
} PathSum;

/* What all paths of a picture share. */
struct PathScene {
    const Room        *room;
    const PathOptions *options;
    PathLamps          lamps;
    const RoomCopies      *copies;   /* or NULL */
    double             offset;   /* of rays off surfaces */
    float             *smooth;   /* render/normals.h, or NULL */
    bool               panes;    /* some material is clear */
};

enum { PATH_PIXELS = 64, PATH_WAVE = 1024 }; /* pixels and paths that are traced together */

/* Space for one thread. */
typedef struct PathWave PathWave;
PathWave *path_wave_create(Error *err);
PathWave *path_wave_destroy(PathWave *wave);

/* The nearest hit of one ray. */
bool path_nearest(const PathScene *scene, const Ray *ray, InstanceHit *found);
/* Where that is, and the room it counts in. */
const Room *path_place(const PathScene *scene, const InstanceHit *found, Vec3 direction,
                       RoomHit *hit);

/* Puts a path's first ray in; fewer than PATH_WAVE may be in. seed and index: of its points. */
void path_wave_add(PathWave *wave, const Ray *ray, uint32_t pixel, uint32_t seed, uint32_t index);
/* Traces all paths to their ends, adds them to sum[pixel] in a fixed order and empties the wave.
 * Returns the rays cast.
 * fails  ERROR_MEMORY: the wave is emptied, sums are not whole. */
uint64_t path_wave_run(PathWave *wave, const PathScene *scene, PathSum *sum, Error *err);

#endif
