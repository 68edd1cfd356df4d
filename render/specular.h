/* SPDX-License-Identifier: BSD-3-Clause */
/* render/specular.h -- how the eye's ray goes on at mirrors, glass and gloss. */
#ifndef RENDER_SPECULAR_H
#define RENDER_SPECULAR_H

#include "radiosity/room.h"

/* Whether a material has more than its diffuse part. */
bool specular_exists(const Material *material);

/* Whether its more is an ideal mirror or glass, which show things sharp. */
bool specular_is_sharp(const Material *material);

/* One way on for a ray that came along `in` (unit) and met `hit`, a mirror or glass, which reflects
 * or refracts as u in [0,1) chooses. normal: unit, maybe smoothed. *weight is what its light
 * counts, at most 1 in each band. false: none.
 * A transparent surface with a rim is a pane, not the skin of a body: it does not bend light. */
bool specular_continue(const Room *room, const RoomHit *hit, Vec3 normal, Vec3 in,
                       float u, Ray *ray, Rgb *weight);

/* Whether the way on leads unbent through a pane. */
bool specular_is_straight(const Room *room, const RoomHit *hit, const Material *m, const Ray *on);

/* The same without chance, of mirrors and glass alone: the way back, and across if there is one,
 * and what each counts. material: what stands there. Returns how many. */
unsigned specular_ways(const Room *room, const Material *material, const RoomHit *hit, Vec3 normal,
                       Vec3 in, Ray ray[2], Rgb weight[2]);

/* What happened to a ray that gathers light on its way (specular_follow). */
typedef struct {
    bool     turned;        /* by a mirror or glass: no ray straight to a lamp finds the same way */
    bool     by_mirror;     /* by a single mirror, which it met first: */
    uint32_t surface;       /* that one, */
    unsigned side;          /* on this side */
} SpecularWay;

/* Follows a ray that gathers light from its nearest hit on, through mirrors and glass, to where it
 * ends: *ray is its last part, *hit its end (RAY_MISS: none), t with the way before. smooth: as of
 * render/normals.h. *rays counts those cast. Returns what its light counts.
 * Ideal mirrors and glass alone pass it on; what is diffuse as well ends it by chance. */
Rgb specular_follow(const Room *room, const float *smooth, uint32_t seed, Ray *ray, Hit *hit,
                    SpecularWay *way, uint64_t *rays);

/* Phong exponent of the specular part: INFINITY for a mirror, a soft gloss where none is given. */
double specular_exponent(const Material *material);

#endif
