/* SPDX-License-Identifier: BSD-3-Clause */
/* app/ply_notes.h -- what the comment lines of a solved mesh tell of its scene: units, what is up,
 * cameras, point lights, names of materials.
 *
 *   comment up X Y Z
 *   comment camera EYE TARGET UP DEGREES NAME
 *   comment light point|spot|cosine PLACE DIRECTION R G B COS_INNER COS_OUTER NAME
 *
 * Files without them are complete all the same, and a comment of another form is none of ours.
 */
#ifndef APP_PLY_NOTES_H
#define APP_PLY_NOTES_H

#include <stdio.h>

#include "scenes/scene.h"

typedef struct {
    double   unit_m;           /* 0: not told */
    bool     watts;            /* W/m2, not lux */
    bool     has_up;
    Vec3     up;
    Camera  *camera;           /* [camera_count]  perspective, in the file's coordinates */
    Light   *light;            /* [light_count]  likewise */
    char   **material_name;    /* [material_count] */
    uint32_t camera_count, light_count, material_count;
    size_t   camera_capacity, light_capacity, material_capacity;
} PlyNotes;

/* Writes the lines above. */
void ply_notes_put(FILE *out, const Scene *scene);
/* Takes what follows "comment " in a line. *notes starts as { 0 }.
 * fails  false; ERROR_MEMORY. ply_notes_clear is due in any case. */
bool ply_notes_take(PlyNotes *notes, const char *line, Error *err);
void ply_notes_clear(PlyNotes *notes);

#endif
