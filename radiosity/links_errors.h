/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links_errors.h -- standard errors of form factors between patches.
 *
 * All rows are cast again with independent scramblings of their nets, each as the links themselves
 * were; what these casts disagree by is the standard error of one of them. Memory: one further set
 * of links at a time, and 16 bytes for each pair that any cast has found.
 * Threads  casts are made in parallel; the same bytes for any number.
 */
#ifndef RADIOSITY_LINKS_ERRORS_H
#define RADIOSITY_LINKS_ERRORS_H

#include "radiosity/links.h"

/* Casts in all, those of the links themselves included: as many as groups have scramblings. */
enum { LINKS_CASTS = 16 };

/* Cast number k, 1 .. LINKS_CASTS - 1, of the links that options made: nothing is kept for later.
 * owns   the caller frees with links_destroy.
 * fails  as links_create. */
Links *links_cast_again(const Room *room, const LinksOptions *options, uint32_t k,
                        const Monitor *monitor, Error *err);

/* What several casts found of one number: how far they are from the first. */
typedef struct {
    double first, sum, squares; /* the first cast's; of the differences to it */
} Spread;

/* Takes the value of one more cast in. */
void   spread_add(Spread *spread, double value);
/* Standard error of one of so many casts, >= 2; the rounding to float included. */
double spread_error(const Spread *spread, uint32_t casts);

/* A pair that some cast has found. */
typedef struct {
    uint32_t source;
    float    first, sum, squares; /* as in Spread */
} LinksPair;

typedef struct {
    uint32_t   count, casts;  /* patches; casts so far */
    uint64_t  *begin;         /* [count + 1] */
    LinksPair *pair;          /* [begin[count]]  sources rising within a row */
    Spread    *escape;        /* [count] */
    Spread    *sum;           /* [count]  of the row, escape included */
} LinksErrors;

/* Begins with the links as they were cast; not closed ones.
 * owns   the caller frees with links_errors_destroy.
 * fails  NULL; ERROR_MEMORY. */
LinksErrors *links_errors_create(const Links *links, Error *err);
/* Takes one more cast of the same patches in.
 * max_bytes  that the pairs may take together; 0: no limit.
 * fails      false; ERROR_MEMORY. */
bool links_errors_add(LinksErrors *errors, const Links *cast, uint64_t max_bytes, Error *err);
/* Frees; NULL is allowed. Always returns NULL. */
LinksErrors *links_errors_destroy(LinksErrors *errors);

/* Standard error of a pair's factor. */
double links_pair_error(const LinksErrors *errors, const LinksPair *pair);
/* The largest of row i. */
double links_row_error(const LinksErrors *errors, uint32_t i);

#endif
