/* SPDX-License-Identifier: BSD-3-Clause */
/* app/validate.h -- cases with known answers, run through the same stages as any scene.
 *
 * Expected values come from closed forms, energy balance, or independent numerical solutions of
 * the same equations; their sources stand beside them.
 */
#ifndef APP_VALIDATE_H
#define APP_VALIDATE_H

#include "app/pipeline.h"

typedef struct {
    char   name[40], quantity[40];
    double expected, value;
    double tolerance;       /* absolute */
    double standard_error;  /* NAN: not known */
    bool   passed;
} Check;

typedef struct {
    Session    *session;    /* the program's */
    const char *name;       /* of the case that runs */
    FILE       *out;        /* table; NULL: none */
    Check      *checks;     /* [count] */
    size_t      count, capacity, failed;
} Validation;

/* What a case asks of the program. */
typedef struct {
    Command  command;       /* whose defaults hold: FACTORS or SOLVE */
    Closure  closure;
    UseSides sides;
    uint32_t patches, rays;
    const Vec3 *point, *normal; /* [points]  measured later */
    size_t   points;
    bool     patches_only;  /* stop when there are patches */
    const int *solver;      /* as of --solver; NULL: what that says */
} CaseSetup;

typedef bool (*CaseRun)(Validation *validation, Error *err);

typedef struct {
    const char *name, *title;
    CaseRun     run;
} Case;

/* The cases of a file, `*count` of them. */
const Case *validate_factor_cases(size_t *count);
const Case *validate_closed_cases(size_t *count);
const Case *validate_light_cases(size_t *count);
const Case *validate_room_cases(size_t *count);
const Case *validate_plate_cases(size_t *count);
const Case *validate_view_cases(size_t *count);
const Case *validate_made_cases(size_t *count);
const Case *validate_enclosure_cases(size_t *count);
const Case *validate_solver_cases(size_t *count);

/* A pipeline over a scene made by code, which it takes; solved unless the command is FACTORS or
 * only patches are wanted. The session is filled for it, silent. Clear both in any case with
 * validation_end. */
bool validation_run(const Validation *validation, Scene *scene, const CaseSetup *setup,
                    Session *session, Pipeline *pipeline, Error *err);
void validation_end(Session *session, Pipeline *pipeline);

/* Notes one figure. standard_error NAN: not known. */
void validation_check(Validation *validation, const char *quantity, double expected, double value,
                      double tolerance, double standard_error, Error *err);

/* Area-weighted mean of a solution's values (band 0) over one side of a group. */
enum { FRONT_SIDE, BACK_SIDE, ANY_SIDE };
double validation_mean(const Pipeline *pipeline, const double *value, const char *group,
                       unsigned side);

/* A mean that is known: radiosity of one side of a group. */
typedef struct {
    const char *quantity, *group;
    unsigned    side;
    double      radiosity;
} WallMean;

/* A value at a point that is known: radiosity of a surface there of that exitance and reflectance,
 * which receives from the side of the normal. */
typedef struct {
    const char *quantity;
    Vec3        point, normal;
    double      exitance, reflectance, radiosity;
} PointRadiosity;

typedef struct {
    uint32_t patches, rays;
    double   tolerance; /* absolute */
    const PointRadiosity *point; /* [points]  gathered once more */
    size_t   points;
} MeanSetup;

/* Solves the scene, which it takes, with closure of rows and pairs, and checks means and points. */
bool validation_means(Validation *validation, Scene *scene, const MeanSetup *setup,
                      const WallMean *walls, size_t count, Error *err);
/* Irradiance at a point, luminance, and its standard error. */
double validation_measure(const Pipeline *pipeline, Vec3 point, Vec3 normal, double *error,
                          Error *err);

#endif
