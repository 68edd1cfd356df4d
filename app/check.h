/* SPDX-License-Identifier: BSD-3-Clause */
/* app/check.h -- what `isolux check` finds out, and how it tells it. */
#ifndef APP_CHECK_H
#define APP_CHECK_H

#include "app/json.h"
#include "app/pipeline.h"
#include "inspect/inspect.h"

/* Where every face of the file went: input = patches + hidden + left + lost. */
typedef struct {
    uint64_t input;
    uint64_t patches;            /* have patches: some side of them is in use */
    uint64_t hidden;             /* are there, but no side can be reached */
    uint64_t left[DEFECT_KINDS]; /* left out, by the reason */
    uint64_t lost;               /* without any reason: a bug of this program */
    uint64_t plain;              /* have no material in the file */
} FaceAccount;

/* Whether lengths look like those of a room in metres. */
typedef struct {
    double      least, largest;  /* extents of the scene's box, in metres; least that is not 0 */
    double      eye;             /* height of the first camera over the lowest point, metres; NAN */
    bool        suspicious;
    double      guess;           /* metres a unit may have instead; 0: no idea */
    const char *name;            /* of that unit */
} UnitGuess;

typedef struct {
    const Pipeline *pipeline;
    Inspection      inspection;
    FaceAccount     faces;
    UnitGuess       units;
    uint64_t        missing;     /* warnings about missing materials */
} Check;

/* Places of each kind, rims and parts that are told. */
enum { CHECK_PLACES = 5, CHECK_PLACES_JSON = 20 };
/* Of a coordinate in the report for people. */
enum { CHECK_DIGITS = 5 };

/* check_account.c.  fails  ERROR_MEMORY. */
bool check_account(const Pipeline *pipeline, FaceAccount *account, Error *err);
uint64_t check_left_out(const FaceAccount *account);

/* check_units.c */
void check_units(const Pipeline *pipeline, UnitGuess *units);

/* The group that a face of the file belongs to; curved faces are counted after polygons. */
const char *check_group(const Polygons *soup, uint32_t face);

/* check_print.c: the report for people, on standard output unless JSON or mesh go there. */
void check_print(const Check *check);
void check_say(const Check *check, const char *format, ...) __attribute__((format(printf, 2, 3)));
static inline const char *check_plural(uint64_t count) { return count == 1 ? "" : "s"; }

/* check_places.c: its parts that name places. */
void check_say_rims(const Check *check);
void check_say_places(const Check *check, DefectKind kind);
void check_say_materials(const Check *check);

/* check_json.c: the keys of `check`, into an open object. */
void check_json(Json *json, const Check *check);

#endif
