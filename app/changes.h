/* SPDX-License-Identifier: BSD-3-Clause */
/* app/changes.h -- what is to be another way in a scene that is solved: lamps and paint.
 *
 * NAME.emission=VALUE and NAME.reflectance=VALUE, from --set and from a JSON file of --changes:
 *   { "lamp": { "emission": "*0.5" }, "wall": { "reflectance": [0.6, 0.5, 0.4] } }
 * A value is a number for all bands, three of them, or with a * before them factors of what there
 * is. NAME is a group, else a material, else a point light (its intensity).
 */
#ifndef APP_CHANGES_H
#define APP_CHANGES_H

#include <stdbool.h>
#include <stddef.h>

#include "app/options.h"
#include "math/rgb.h"
#include "scenes/scene.h"

typedef enum { CHANGE_EMISSION, CHANGE_REFLECTANCE } ChangeWhat;
typedef enum { CHANGE_GROUP, CHANGE_MATERIAL, CHANGE_LIGHT } ChangeKind;

typedef struct {
    char      *name;      /* owned */
    ChangeWhat what;
    bool       factor;    /* value is times what there is */
    Rgb        value;     /* emission: radiance or, of a light, intensity, as in the file */
    ChangeKind kind;      /* of what the name names */
    uint32_t   index;     /* group, material, or the first light of that name */
    char      *from;      /* owned: the option or file that asks for it, for messages */
    ErrorCode  blame;     /* ERROR_USAGE or ERROR_INPUT */
} Change;

typedef struct {
    Change *change;       /* [count] */
    size_t  count, capacity;
} Changes;

/* Reads all that the options ask for, in order, the file first, and finds what is named.
 * fails  false; ERROR_USAGE for an option, ERROR_INPUT for a file: not of that form, a name that
 *        nothing has, a value out of range. */
bool changes_read(Changes *changes, const Options *options, const Scene *scene, Error *err);
void changes_clear(Changes *changes);

/* What a value becomes; reflectances stay below 1. False when it is out of range.
 * fails  *err with the change's name. */
bool change_value(const Change *change, Rgb before, Rgb *after, Error *err);

#endif
