/* SPDX-License-Identifier: BSD-3-Clause */
/* render/gloss.h -- gloss: how a rough mirror scatters light, whatever its colour.
 *
 * Materials with `roughness` are microfacets by Trowbridge, Reitz [walter07] with the height-
 * correlated shadowing of [heitz14], their visible normals sampled [heitz18]; others a cosine lobe
 * about the mirror direction, the modified Phong model [lafortune94]. Neither sends back more than
 * arrives, and both are reciprocal.
 * Units    directions are unit vectors that leave the place.
 */
#ifndef RENDER_GLOSS_H
#define RENDER_GLOSS_H

#include "mesh/polygons.h"

typedef struct {
    Vec3   face;     /* none goes below it */
    Vec3   normal;   /* maybe smoothed; towards where `view` points */
    Vec3   view;
    Vec3   axis;     /* of a lobe: the mirror direction */
    double exponent; /* of a lobe, when width is 0 */
    double width;    /* alpha of the microfacets' distribution */
} Gloss;

/* in: of the ray that came; in . normal < 0. */
void gloss_init(Gloss *gloss, const Material *material, Vec3 face, Vec3 normal, Vec3 in);

/* Chooses a direction by two numbers in [0,1). false: it would lead below. */
bool gloss_sample(const Gloss *gloss, const float u[2], Vec3 *out);

/* Scattering times the cosine, for a specular colour of 1; *density: of gloss_sample per solid
 * angle. Both 0 below the face. Their ratio is at most 1, of a lobe
 * (exponent + 2) / (exponent + 1). */
double gloss_value(const Gloss *gloss, Vec3 out, double *density);

#endif
