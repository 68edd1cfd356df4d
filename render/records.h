/* SPDX-License-Identifier: BSD-3-Clause */
/* render/records.h -- indirect light kept at points of surfaces, and read in between them.
 *
 * A record holds the indirect irradiance of a point, how it changes along the surface, and the
 * ellipse within which it is of use: what is seen aslant is wide one way for the same pixels.
 * Between records their planes are blended, so that light is smooth where it is in truth.
 * Method   irradiance caching [ward88], records placed before they are read. Values and slopes
 *          are fitted to the neighbours' values by least squares, which takes noise away too.
 * Threads  reading from any; adding and fitting from one at a time.
 */
#ifndef RENDER_RECORDS_H
#define RENDER_RECORDS_H

#include "base/error.h"
#include "math/rgb.h"
#include "render/lamps.h"

typedef struct {
    Receiver at;
    Vec3     along;      /* unit, along the surface: the long way of the ellipse */
    double   radius;     /* across it */
    double   stretch;    /* >= 1: as many times the radius along it */
    Rgb      irradiance; /* as gathered */
    double   deviation;  /* standard error of its luminance */
    Vec3     across;     /* unit; set by records_add, like all below */
    double   fitted_deviation;
    double   fit[3][3];  /* of each band: 1, along, across, lengths in radii */
} Record;

typedef struct Records Records;

/* owns   the caller frees with records_destroy.
 * fails  NULL; ERROR_MEMORY. */
Records *records_create(Error *err);
/* Frees; NULL is allowed. Always returns NULL. */
Records *records_destroy(Records *records);

/* Records of light by groups as well (render/split.h), from the first one on. */
enum { RECORDS_GROUPS_MOST = 33 };
void records_split(Records *records, uint32_t groups);
uint32_t records_groups(const Records *records);

/* Adds records, level so far, and makes them known to records_find.
 * fails  false; ERROR_MEMORY. */
bool records_add(Records *records, const Record *record, uint32_t count, Error *err);
/* The same with the irradiance of each by groups [count * groups]; NULL: without groups. */
bool records_add_apart(Records *records, const Record *record, const Rgb *light, uint32_t count,
                       Error *err);
/* Fits record begin..end-1 to all records' values. Threads: several may, for ranges apart. */
void records_fit(Records *records, uint32_t begin, uint32_t end);
uint32_t records_count(const Records *records);

/* What the records say of a point. */
typedef struct {
    Rgb    irradiance;
    double deviation;  /* standard error of its luminance, as far as records have noise */
    double nearness;   /* 1 at a record, 0 where the last one's radius ends */
} Recorded;
/* false: no record reaches the point. */
bool records_find(const Records *records, const Receiver *at, Recorded *out);
/* Adds what they say by groups to sum [groups], and returns what that comes to; a group's light may
 * be below 0 by a little, where planes are carried on. */
Rgb records_find_apart(const Records *records, const Receiver *at, Rgb *sum);

#endif
