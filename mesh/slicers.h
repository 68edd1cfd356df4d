/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/slicers.h -- what parts a surface where curved shapes stand on it or pass through it.
 *
 * A slicer is another surface of the scene, as a function of place that is positive on its one side
 * and negative on the other; it goes on beyond that surface's rim. Two places of a surface between
 * which a slicer changes sign may lie in different rooms. Where the places on one side of a shape
 * are not connected, its splits tell them apart: planes through its middle, and the cylinder
 * through the ring of a torus. They stand for nothing that stops light.
 * Threads  nothing changes once made.
 */
#ifndef MESH_SLICERS_H
#define MESH_SLICERS_H

#include "mesh/surfaces.h"

typedef enum { SLICER_PLANE, SLICER_SHAPE, SLICER_SPLIT_PLANE, SLICER_SPLIT_RING } SlicerKind;

enum { SLICER_SPLITS = 4 }; /* most that follow a shape */

struct Slicer {
    SlicerKind kind;
    uint32_t   shape;   /* index into surfaces->shape; SLICER_PLANE: none */
    uint32_t   splits;  /* how many follow, of a shape's own; the ring of a torus is the first */
    Vec3       normal;  /* planes: unit */
    double     level;   /* planes: normal . p of their points */
    double     scale;   /* shapes: length in the world of 1 in the unit form, at the least */
    Vec3       lo, hi;  /* box of the surface it stands for */
    double     size;    /* shapes: how thin they are at most; planes: infinite */
};

/* The slicers that a plane or shape stands for: writes at most 1 + SLICER_SPLITS and returns how
 * many. */
Slicer   slicer_plane(Vec3 normal, double level, Vec3 lo, Vec3 hi);
uint32_t slicer_shape(const Surfaces *surfaces, uint32_t shape, Slicer *slicer);

/* Which side of a slicer p is on: never more than its distance, and over a way of length 1 it
 * changes by no more than 1. */
double slicer_side(const Surfaces *surfaces, const Slicer *slicer, Vec3 p);

/* So near to a slicer that rounding decides on which side of it rays are. */
double slicer_margin(const Surfaces *surfaces, const Slicer *slicer);

/* Bit k of *signs: whether p is on the positive side of slicer[k]; false within their margins. */
bool slicer_signs(const Surfaces *surfaces, const uint32_t *slicer, uint32_t count, Vec3 p,
                  uint32_t *signs);

#endif
