/* SPDX-License-Identifier: BSD-3-Clause */
/* app/classes.h -- form factors summed over groups or materials: the matrix people ask for. */
#ifndef APP_CLASSES_H
#define APP_CLASSES_H

#include "app/pipeline.h"

/* Classes without a side in use are left out, so rows are numbered anew. */
typedef struct {
    uint32_t     count;
    const char **name;       /* [count]  the scene's */
    double      *area;       /* [count]  visible, scene units^2 */
    double      *factor;     /* [count * count]  F from row to column */
    double      *escape;     /* [count]  share that meets nothing */
    double      *sum;        /* [count]  of the row, escape included */
    double      *raw_sum, *raw_escape; /* [count]  the same of factors as cast */
    double      *error;      /* [count * count]  standard error of factor; NULL: not known */
    double      *emissivity; /* [count]  1 - reflectance (luminance), mean over the area */
    uint32_t    *row;        /* [the scene's groups or materials]  PATCH_NONE: none */
    bool         open;       /* something escapes somewhere */
} Classes;

/* Sums the links in use; by group or material. Classes of the scene without a side in use are told
 * ("unused-row").
 * owns   the caller frees with classes_clear.
 * fails  false; ERROR_MEMORY. */
bool classes_sum(const Pipeline *pipeline, FactorsBy by, Classes *classes, Error *err);
/* Fills classes->error where patches were summed: the matrix of classes from each of LINKS_CASTS
 * casts of all rows, and what these disagree by (radiosity/links_errors.h).
 * fails  false; ERROR_MEMORY, ERROR_STOPPED. */
bool classes_errors(const Pipeline *pipeline, FactorsBy by, Classes *classes, Error *err);
void classes_clear(Classes *classes);

#endif
