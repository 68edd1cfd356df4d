/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/measure.h -- numbers about what is seen: statistics of a region, and a list of probes.
 *
 * Knows no window: values in, figures out.
 */
#ifndef VIEWER_MEASURE_H
#define VIEWER_MEASURE_H

#include "viewer/snapshot.h"

typedef struct {
    double   least, mean, greatest, median, deviation; /* NAN where nothing was counted */
    double   weight;        /* sum of weights counted */
    uint32_t count;         /* values counted */
} Statistics;

/* value, weight [count]; weight NULL: all alike. Values that are NAN or whose weight is not above 0
 * do not count. median: the least value that half of the weight does not pass. deviation: standard
 * deviation.
 * fails  false; ERROR_MEMORY. */
bool statistics_find(const double *value, const double *weight, uint32_t count, Statistics *out,
                     Error *err);

/* What is read at one place; NAN: not known now. */
typedef struct {
    Vec3     place, normal;
    uint32_t patch, group, material;
    double   area;          /* scene units squared */
    double   irradiance, radiosity, luminance, row_sum, error; /* luminous: weights of BT.709 */
    double   here;          /* radiosity at the place itself, between vertices */
} Reading;

/* The mesh's triangle that was hit at (u, v), and its light. */
void reading_take(const Snapshot *snapshot, uint32_t triangle, double u, double v, Reading *out);

/* Readings that were kept, with the names they had then. */
typedef struct {
    Reading reading;
    char   *group, *material;
} Probe;

typedef struct {
    Probe *probe;           /* [count] */
    size_t count, capacity;
} Probes;

/* *probes starts as { 0 }; probes_clear is due.
 * fails  false, the list is as before; ERROR_MEMORY. */
bool probes_add(Probes *probes, const ShownMesh *mesh, const Reading *reading, Error *err);
void probes_remove(Probes *probes, size_t index);
void probes_clear(Probes *probes);

/* A row each, a heading first; unknown values are empty, names in quotes as RFC 4180 asks.
 * lux: photometric names of columns, else those of watts.
 * fails  false; ERROR_FAILED for the file. */
bool probes_write(const Probes *probes, bool lux, const char *path, Error *err);

#endif
