/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/mirrors.h -- ideal mirrors and clear glass: where rays between diffuse patches go on.
 *
 * Extended form factors [wallace87], [sillion89]: a ray that meets a mirror or glass goes on with
 * the chance S of its light being reflected or let through there, and ends there otherwise. So each
 * ray stays a share of 1 and rows still sum to 1: what ends at a mirror is what it absorbs or, if
 * it is partly diffuse, scatters. Reciprocity holds in this form: with kept = 1 - S, mean over the
 * hemisphere, a patch of area A takes part with the area kept A, the emission E / kept and the
 * reflectance rho / kept (mirrors_problem), and its radiosity comes out as B / kept.
 * Inside a body of index n (under water) a patch takes part with n^2 of its area, for there as much
 * more of the light that leaves it stays in; quantities there are over n^2 (basic radiance).
 * S is grey: the luminance of the material's colours; only the eye sees mirrors in colour.
 * Only with room->mirrors; without it they absorb all light, as geometric factors want.
 */
#ifndef RADIOSITY_MIRRORS_H
#define RADIOSITY_MIRRORS_H

#include "radiosity/room.h"

/* Whether any material is an ideal mirror, clear, or cut out by an image (radiosity/places.h): what
 * light passes where nothing is. */
bool mirrors_exist(const Material *materials, size_t count);
static inline bool mirrors_is(const Material *m)
{
    return rgb_max(m->transmittance) > 0 || m->cut_out ||
           (rgb_max(m->specular) > 0 && isinf(m->exponent));
}

/* The share of even light, of what is not absorbed, that gloss of a finite exponent sends back:
 * for the modified Phong lobe as for a sharp one, 2/3 (0.735 at exponent 1). */
double mirrors_gloss_back(const Material *m);
/* What a material scatters of even light: gloss counts as diffuse where the eye does not see it. */
Rgb mirrors_scattered(const Material *m, Rgb diffuse);

/* Which surfaces are the skin of a clear body, and so bend light: those that hang together with
 * clear ones alone, over every edge. A pane has a rim, or opaque neighbours: it does not bend it.
 * owns   [surfaces->count], the caller's, for room->skin; freed with array_free.
 * fails  NULL and ERROR_MEMORY. */
uint8_t *mirrors_skins(const Surfaces *surfaces, const Material *materials, Error *err);
/* The same of one surface; without room->skin it is judged by its own edges alone. */
bool mirrors_is_skin(const Room *room, uint32_t surface);

/* What becomes of light that meets a side at an angle. */
typedef struct {
    double back, through; /* shares that go on, of sum <= 1 */
    double eta;           /* index beyond over that here; 1: straight through */
} MirrorShare;
MirrorShare mirrors_share(const Material *material, bool skin, unsigned side, double cosine);

/* The share of light that ends at a patch: 1 - S, mean over the hemisphere; 1 for what is no
 * mirror, and without room->mirrors. */
double mirrors_kept(const Room *room, uint32_t patch);
/* The share of the light that comes at an angle, relative to that mean, `kept`. */
double mirrors_weight(const Room *room, uint32_t patch, double kept, double cosine);

/* Emission and reflectance of a patch as they stand in the problem to solve. */
void mirrors_problem(const Room *room, uint32_t patch, Rgb *emission, Rgb *reflectance);

/* One more step of a ray that met a mirror: false: it ends here, or what it met is none. Else *ray
 * goes on from there; *straight is cleared when it was turned. choice in [0, 1). */
bool mirrors_step(const Room *room, const Hit *hit, double choice, Ray *ray, bool *straight);

/* Index of refraction of the body that a ray is in when it meets this: 1 where that is no skin seen
 * from inside; 0 for a skin seen from outside. */
double mirrors_medium(const Room *room, const Hit *hit, Vec3 way);

/* Share of light that passes the panes on a blocked ray's way: 0 where anything else stands. */
double mirrors_between(const Room *room, Ray ray);

/* Steps after which a ray ends where it is. */
enum { MIRRORS_MOST = 64 };

#endif
