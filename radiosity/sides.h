/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/sides.h -- which sides of which surfaces light or eye can reach, found by rays.
 *
 * The inside of closed furniture and the outside of a room's walls take no part, whatever the
 * winding says: from the sides seen by cameras, measuring points, lamps and point lights, sight is
 * followed from side to side until nothing new turns up. A side takes part when any of its sample
 * points has a free way to a side that does.
 */
#ifndef RADIOSITY_SIDES_H
#define RADIOSITY_SIDES_H

#include "base/monitor.h"
#include "radiosity/room.h"

typedef enum { EMIT_AUTO, EMIT_FRONT, EMIT_BACK, EMIT_BOTH } EmitSide;

typedef struct {
    EmitSide    emit;
    const Vec3 *eye;        /* [eye_count]  cameras, measuring points (moved off surfaces) */
    size_t      eye_count;
    uint32_t    rays;       /* per surface side and round; 0: 32 */
    uint32_t    seed;
    unsigned    threads;
} SidesOptions;

typedef struct {
    uint32_t front, back, both, none; /* surfaces by the sides in use */
    uint32_t lamps_turned;            /* emitters whose emission auto put on the back */
} SidesReport;

/* Fills sides and emitting, each [surfaces->count], as in Room. A scene where nothing emits and no
 * eye is given has all sides in use. EMIT_AUTO: front, except where the front faces a wall a hair
 * away (all sample points blocked within 1/50 of the lamp's extent by a surface that is not a lamp)
 * and the back does not, or where the front sees nothing at all, no eye either, and the back does:
 * a lamp in the plane of its ceiling; or where all light from the front stays in the lamp itself,
 * in its small case, or in a closed part of any size of which the lamp is a third, no eye in there,
 * and the back has the scene before it: a bulb or luminaire wound inward; then back; warned
 * ("lamp-turned"). Faces of a lamp that are wound unlike their neighbours are decided apart.
 * Materials with emits_both emit on both. Where lamps and lights reach hardly any of the scene's
 * area, or nothing but lamps, that is warned of ("dark-scene").
 * fails  ERROR_MEMORY, ERROR_STOPPED. */
bool sides_find(const Surfaces *surfaces, const Bvh *bvh, const Material *materials,
                const Light *lights, size_t light_count, const SidesOptions *options,
                uint8_t *sides, uint8_t *emitting, SidesReport *report, const Monitor *monitor,
                Error *err);

/* For PatchOptions.joined: whether there is a way through the air from just above one point to just
 * above another, straight or over a tent between them. context  a SidesJoined. */
typedef struct {
    const Bvh *bvh;
    double     offset; /* ray_offset(surfaces->largest_coordinate) */
} SidesJoined;
bool sides_joined(const void *context, const SurfacePoint *a, const SurfacePoint *b);

#endif
