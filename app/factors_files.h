/* SPDX-License-Identifier: BSD-3-Clause */
/* app/factors_files.h -- form factors as files, in the forms that people read them from. */
#ifndef APP_FACTORS_FILES_H
#define APP_FACTORS_FILES_H

#include "app/classes.h"
#include "radiosity/links_errors.h"

/* factor is classes->factor, or exchange factors of the same size. */
bool factors_write_csv(const Classes *classes, FactorsBy by, const double *factor,
                       const char *path, Error *err);
/* Matrix Market, entries that are not 0; names, areas and escaped shares in its comments. */
bool factors_write_class_mtx(const Classes *classes, const double *factor, const char *path,
                             Error *err);
/* What rows sum to, as used and as cast, and what escapes: CSV. */
bool factors_write_class_rows(const Classes *classes, FactorsBy by, const char *path, Error *err);
/* script: they are exchange factors (script-F). */
bool factors_write_view3d(const Classes *classes, const double *factor, bool script,
                          const char *path, Error *err);
/* Arrays F, area, escaped, emissivity, names. */
bool factors_write_npz(const Classes *classes, const double *factor, const char *path,
                       Error *err);
/* Between patches: Matrix Market and a CSV that says what the patches are, with standard errors in
 * its last columns unless errors is NULL. */
bool factors_write_patches(const Pipeline *pipeline, const LinksErrors *errors, const char *matrix,
                           const char *table, Error *err);
/* The same as one archive: a sparse matrix as scipy.sparse.load_npz wants it, and the patches'
 * area, visible_area, centre, normal, group, escaped; standard_error (largest of the row),
 * escaped_error and row_sum_error unless errors is NULL. */
bool factors_write_patches_npz(const Pipeline *pipeline, const LinksErrors *errors,
                               const char *path, Error *err);
/* Standard errors of all pairs of patches as Matrix Market. */
bool factors_write_errors(const LinksErrors *errors, const char *path, Error *err);
/* Net flux per group: group, area, emissivity, temperature, flux, power. */
bool factors_write_flux(const Classes *classes, const double *temperature, const double *flux,
                        const char *path, Error *err);

/* factors --points: reads the points, casts, writes the CSV: x,y,z,nx,ny,nz, a column for each
 * group, escaped, unused (sides that take no part), standard_error (the largest of the row). */
bool factors_of_points(Pipeline *pipeline, const char *output, Error *err);

#endif
