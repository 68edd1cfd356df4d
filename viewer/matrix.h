/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/matrix.h -- a camera as a matrix, and moved about. */
#ifndef VIEWER_MATRIX_H
#define VIEWER_MATRIX_H

#include "scenes/scene.h"

/* Clip coordinates of places given from `middle`; columns first, as OpenGL wants them. lo, hi:
 * bounds of what is shown, for the depth's range. */
void matrix_of_camera(const Camera *camera, double aspect, Vec3 middle, Vec3 lo, Vec3 hi,
                      float matrix[16]);

/* Unit vectors of a view, perpendicular to each other. */
typedef struct {
    Vec3 forward, right, up;
} ViewFrame;
ViewFrame view_frame(const Camera *camera);
/* Unit direction through a pixel of a picture. */
Vec3 view_direction(const Camera *camera, double x, double y, int width, int height);
/* The pixel that shows a place, also outside the picture; false: it is behind the eye. */
bool view_pixel(const Camera *camera, Vec3 place, int width, int height, double *x, double *y);

/* Whether both show the same. */
bool view_same(const Camera *a, const Camera *b);

/* Turns the eye round the target, or the target round the eye; radians to the right and up. The
 * picture stays upright: `up` is that of the scene. */
void view_orbit(Camera *camera, Vec3 up, double across, double along);
void view_look(Camera *camera, Vec3 up, double across, double along);
/* Moves eye and target, in lengths of the scene. */
void view_move(Camera *camera, double right, double up, double forward);
/* The eye comes nearer: its distance from the target times `factor`. */
void view_dolly(Camera *camera, double factor);
/* Moves the eye along its direction until a sphere is seen whole, and makes it the target. */
void view_fit(Camera *camera, Vec3 centre, double radius, double aspect);

#endif
