/* SPDX-License-Identifier: BSD-3-Clause */
/* render/lamps.h -- all that emits, and how to choose where on it to aim a shadow ray.
 *
 * A lamp is a flat facet or a curved surface, one side of it. With few lamps each receiving point
 * weighs them by what they would send there if nothing were in the way: for facets that is exact
 * (Lambert's formula), so one sample of one lamp, times the exact sum, has no noise where all is
 * lit or all is dark. Of many lamps the strongest few are weighed so, the rest together by what
 * they may send, and one of these is chosen by a tree of them (render/lamp_tree.h); then, and for
 * curved lamps always, hemisphere rays that hit a lamp count too, by multiple importance sampling
 * [veach95].
 * Threads  never changes once made.
 */
#ifndef RENDER_LAMPS_H
#define RENDER_LAMPS_H

#include "math/light.h"
#include "radiosity/room.h"
#include "render/facet.h"
#include "render/lamp_tree.h"

/* The material of one side: a thin plate made of two faces may have two. */
static inline const Material *lamps_material(const Room *room, uint32_t surface, unsigned side)
{
    const Surface *s = &room->surfaces->surface[surface];
    return &room->materials[side == 0 ? s->material : s->back_material];
}

/* Up to so many lamps are weighed at each point; of more, so many of the strongest at most. */
enum { LAMPS_WEIGHED = 64, LAMPS_STRONGEST = 16 };

typedef struct {
    Facet    facet;    /* count 0: curved */
    uint32_t surface;  /* a piece of it */
    unsigned side;
    uint32_t fan;      /* > 0: this and the lamps behind it, so many in all, are one face */
    Rgb      radiance;
    double   strength; /* luminance of the radiance; for a colour without any: its largest band */
    double   area;
    Vec3     centre;
    double   radius;   /* of a ball around the lamp */
} Lamp;

typedef struct {
    const Room *room;
    Lamp       *lamp;    /* [count] */
    uint32_t    count, capacity;
    uint32_t    weighed[LAMPS_WEIGHED]; /* [weighed_count]  lamps, their numbers rising */
    uint32_t    weighed_count;
    LampTree    tree;    /* of the others */
    bool        many;    /* more than LAMPS_WEIGHED: the tree is there */
    uint32_t   *first;   /* [2 * surfaces->count]  side * count + surface -> its first lamp, the
                            others follow; or UINT32_MAX */
    bool        shared;  /* hemisphere rays that hit lamps count */
    bool        flat;    /* all lamps are facets, weighed exactly */
} Lamps;

bool lamps_init(Lamps *lamps, const Room *room, Error *err);
void lamps_clear(Lamps *lamps);

/* A receiving point: rays leave it towards the side of `face`. */
typedef struct {
    Vec3 point, normal; /* unit; maybe smoothed, then light counts by normals_share too */
    Vec3 face;          /* unit: of the surface as rays meet it */
} Receiver;

/* A place to aim at. value: its irradiance over its density, if nothing is in the way;
 * control: what the mean of `value` over all choices is known to be (or value itself). */
#define LAMP_NONE UINT32_MAX
typedef struct {
    Vec3 point, normal; /* normal (0,0,0): a point light */
    Rgb  value, control;
    uint32_t lamp;      /* number of the lamp or point light; LAMP_NONE: none, value 0 */
} LampSample;
static inline bool lamps_is_light(const LampSample *sample)
{
    return sample->normal.x == 0 && sample->normal.y == 0 && sample->normal.z == 0;
}

/* Where all lamps are `flat`: what of lamp_sample's control is lamp k's. */
Rgb lamps_control(const Lamps *lamps, uint32_t k, const Receiver *at);

/* How a receiver's light is sampled: how many rays of each kind, for their weights. */
typedef struct {
    double lamp_rays, gather_rays;
} LampPlan;

/* Chooses by (a, b) in [0,1)^2. false: no lamp can light the receiver at all. */
bool lamps_sample(const Lamps *lamps, const Receiver *at, const LampPlan *plan, double a, double b,
                  LampSample *out);

/* Share of a hemisphere ray that left `at` and met the lamp on hit's surface and side; 0 where
 * lamp samples do it all. */
double lamps_share(const Lamps *lamps, const Receiver *at, const LampPlan *plan,
                   const RoomHit *hit);

/* For light that is not scattered diffusely: a point of a lamp, its radiance, and the density of
 * its choice per solid angle. false: none. */
bool lamps_aim(const Lamps *lamps, const Receiver *at, double a, double b, LampSample *out,
               Rgb *radiance, double *density);
/* Density with which lamps_aim would have chosen the point of a lamp that a ray from `at` met. */
double lamps_density(const Lamps *lamps, const Receiver *at, const RoomHit *hit);

/* Irradiance from point light k at the receiver, if nothing is in the way. */
Rgb lamps_light(const Light *light, const Receiver *at);
/* Chooses one of the point lights by what it sends there; false: none does. */
bool lamps_sample_light(const Lamps *lamps, const Receiver *at, double a, LampSample *out);

#endif
