/* SPDX-License-Identifier: BSD-3-Clause */
/* app/model.h -- scenes made by code: the cases of validate and the box of bench.
 *
 * Errors pass through: each call does nothing when *err is set.
 */
#ifndef APP_MODEL_H
#define APP_MODEL_H

#include "scenes/scene.h"

/* A grey material: reflectance and emitted exitance (not radiance). */
uint32_t model_grey(Scene *scene, const char *name, double reflectance, double exitance,
                    Error *err);
/* A polygon of 3 .. MODEL_CORNERS corners, counter-clockwise seen from its front. */
enum { MODEL_CORNERS = 64 };
void model_polygon(Scene *scene, const Vec3 *corner, int corners, uint32_t material,
                   const char *group, Error *err);
/* The parallelogram o, o+u, o+u+v, o+v; its front is where u x v points. */
void model_rectangle(Scene *scene, Vec3 o, Vec3 u, Vec3 v, uint32_t material, const char *group,
                     Error *err);
/* The box 0..size seen from inside: faces x0 x1 y0 y1 z0 z1, one material each. */
void model_box(Scene *scene, Vec3 size, const uint32_t material[6], Error *err);
/* A shape of math/shape.h, scaled by `scale` (per axis), then moved to `at`. */
void model_shape(Scene *scene, ShapeKind kind, double ratio, Vec3 at, Vec3 scale,
                 uint32_t material, const char *group, Error *err);
void model_point_light(Scene *scene, LightKind kind, Vec3 at, double intensity, Error *err);

/* Cornell box: its published dimensions in millimetres, colours and lamp rounded. */
Scene *model_cornell(Error *err);

#endif
