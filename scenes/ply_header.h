/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/ply_header.h -- what a PLY file says of itself, and its values one by one; this folder.
 *
 * The bytes are the caller's; the one behind the last must be 0, as file_read leaves it.
 */
#ifndef SCENES_PLY_HEADER_H
#define SCENES_PLY_HEADER_H

#include <locale.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"

typedef enum { PLY_NO_TYPE, PLY_I8, PLY_U8, PLY_I16, PLY_U16, PLY_I32, PLY_U32, PLY_F32,
               PLY_F64 } PlyType;

typedef struct {
    char    name[32];
    PlyType type;           /* of the value, or of each member of a list */
    PlyType count_type;     /* PLY_NO_TYPE: no list */
} PlyProperty;

typedef struct {
    char     name[32];
    uint64_t count;         /* < 2^32 */
    size_t   first, end;    /* its properties */
} PlyElement;

typedef enum { PLY_UNKNOWN, PLY_ASCII, PLY_LITTLE, PLY_BIG } PlyEncoding;

typedef struct {
    const char    *path;
    const uint8_t *at, *end;    /* not read yet */
    const uint8_t *body;
    unsigned       line;        /* in the header */
    bool           bare_cr;     /* lines end with CR alone */
    PlyEncoding    encoding;
    PlyElement    *element;     /* [element_count] */
    PlyProperty   *property;    /* [property_count] */
    size_t         element_count, element_capacity, property_count, property_capacity;
    locale_t       numbers;
    Error         *err;
} PlyReader;

/* Reads the header; the body comes next.
 * fails  false and ERROR_INPUT with the line; ply_close is allowed then. */
bool ply_open(PlyReader *r, const char *path, const uint8_t *bytes, size_t size, Error *err);
void ply_close(PlyReader *r);
/* Back to the begin of the body. */
void ply_rewind(PlyReader *r);

/* These are false, without an error, where the file ends or holds something else. */
bool ply_value(PlyReader *r, PlyType type, double *value);
bool ply_count(PlyReader *r, PlyType type, uint64_t *count);
bool ply_skip(PlyReader *r, const PlyProperty *property);
/* After the last property of an element: what else stands in its line is nobody's. */
void ply_element_end(PlyReader *r);
/* Says that the file is broken at element `number`, from 0. Always false. */
bool ply_broken(PlyReader *r, const PlyElement *element, uint64_t number);

#endif
