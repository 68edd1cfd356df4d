/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/measure_plane.h -- a work plane: a grid of points that look up, and the light they get.
 *
 * The rectangle covers the scene, or one group of it, in the plane across `up`, less a margin at
 * its rims. The distance between points is p = 0.2 * 5^(log10 d), d the longer side in metres, or
 * the shorter where the longer is twice as long or more [en12464-1]; each side is divided evenly
 * into the number of cells next to side / p, points stand in their middles. Points inside bodies
 * (more rays along the six axes end on a back than on a front) do not count.
 * Light    of the points from a snapshot: of lamps by their exact irradiance times the share of
 *          them that is seen, of lights by one ray, of all else by cosine-weighted rays that read
 *          the radiosity between vertices. More rays can be added at any time.
 * Threads  the same values for any number.
 */
#ifndef VIEWER_MEASURE_PLANE_H
#define VIEWER_MEASURE_PLANE_H

#include "viewer/measure.h"

#define PLANE_ALL UINT32_MAX

typedef struct {
    uint32_t group;         /* of the mesh, or PLANE_ALL */
    double   height, margin; /* metres over the lowest place (of a group: its highest), and off the
                               rims; height may be below 0 for a group */
    double   metres;        /* of a scene unit */
} PlaneWish;

typedef struct {
    Vec3      origin, along, across, up; /* a corner, and unit vectors */
    double    length, width; /* scene units; along, across */
    double    spacing;      /* p, metres */
    uint32_t  columns, rows, count; /* along, across; count = columns * rows */
    Vec3     *point;        /* [count]  row by row */
    uint8_t  *inside;       /* [count]  1: in a body */
    Rgb      *direct, *sum; /* [count]  irradiance of lamps and lights; sum over `rays` rays */
    uint32_t  rays;         /* so far per point; 0: nothing is known yet */
} Plane;

/* Metres between points for a rectangle of two sides in metres, > 0. */
double plane_spacing(double length, double width);

/* owns   the caller frees with plane_destroy.
 * fails  NULL; ERROR_MEMORY; ERROR_INPUT when nothing is left within the margin, or the grid would
 *        have more than a million points. */
Plane *plane_create(const ShownMesh *mesh, const PlaneWish *wish, unsigned threads, Error *err);
Plane *plane_destroy(Plane *plane);

/* Forgets the light: the snapshot is another one. */
void plane_restart(Plane *plane);
/* `rays` more for each point; a power of two, the same each time; light of lamps the first time.
 * fails  false; ERROR_MEMORY. */
bool plane_gather(Plane *plane, const Snapshot *snapshot, uint32_t rays, unsigned threads,
                  Error *err);
/* Illuminance of a point, NAN inside bodies and before the first rays. */
double plane_value(const Plane *plane, uint32_t i);

typedef struct {
    Statistics all;         /* Eav is its mean, Emin its least */
    double uniformity;      /* U0 = Emin / Eav */
    double diversity;       /* Ud = Emin / Emax */
} PlaneReport;

/* fails  false; ERROR_MEMORY. */
bool plane_report(const Plane *plane, PlaneReport *report, Error *err);
/* CSV: x, y, z and illuminance of each point that counts.
 * fails  false; ERROR_FAILED for the file. */
bool plane_write(const Plane *plane, bool lux, const char *path, Error *err);

#endif
