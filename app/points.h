/* SPDX-License-Identifier: BSD-3-Clause */
/* app/points.h -- measuring points out of a text file: x,y,z,nx,ny,nz per line.
 *
 * Values are parted by commas, semicolons, tabs or blanks; # starts a comment; empty lines are
 * passed over; the first line may be a heading; lines end in LF or CRLF.
 */
#ifndef APP_POINTS_H
#define APP_POINTS_H

#include <stddef.h>

#include "base/error.h"
#include "math/vec3.h"

typedef struct {
    Vec3  *point;     /* [count] */
    Vec3  *given;     /* [count]  normal as it stands in the file */
    Vec3  *normal;    /* [count]  the same, unit length */
    size_t count;
    size_t capacity[3];
} Points;

/* Reads a file; "-" is standard input. *points starts as { 0 }.
 * fails  false and ERROR_INPUT with file and line; points_free is due in any case. */
bool points_read(Points *points, const char *path, Error *err);
/* The same from text with a 0 after its last byte; `name` is for messages. */
bool points_parse(Points *points, const char *text, size_t size, const char *name, Error *err);
void points_free(Points *points);

#endif
