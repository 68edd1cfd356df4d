/* SPDX-License-Identifier: BSD-3-Clause */
/* render/lamp_faces.h -- lamps that were cut into pieces where other faces meet them, whole again.
 *
 * A rectangle or a triangle of the scene is one lamp, sampled by its solid angle as a whole, and
 * any other convex face a fan of few triangles. Its pieces may be thousands, many of them slivers,
 * which are hard to choose among near by.
 */
#ifndef RENDER_LAMP_FACES_H
#define RENDER_LAMP_FACES_H

#include "radiosity/room.h"

enum { LAMP_CORNERS = 64 };

/* A face of which all pieces shine to one side. */
typedef struct {
    Vec3     corner[LAMP_CORNERS]; /* convex, counter-clockwise from the front */
    uint32_t corners;
    bool     whole;      /* a triangle or a parallelogram */
    uint32_t begin, end; /* its pieces, in LampFaces.piece */
} LampFace;

typedef struct {
    uint32_t face, side, surface;
} LampPiece;

typedef struct {
    LampPiece *piece; /* [piece_count]  by face, side, surface */
    LampFace  *face;  /* [face_count]   of two pieces at least */
    uint32_t   piece_count, face_count;
} LampFaces;

/* The caller clears it with lamp_faces_clear, also when it fails.
 * fails  false; ERROR_MEMORY. */
bool lamp_faces_find(LampFaces *faces, const Room *room, Error *err);
void lamp_faces_clear(LampFaces *faces);

#endif
