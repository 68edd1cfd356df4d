/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links.h -- who exchanges light with whom: form factors as compressed rows.
 *
 * F_ij is the share of what leaves patch i that arrives at patch j; over the parts of both that are
 * not inside other solids, A_i F_ij = A_j F_ji. Cosine-weighted rays from points all over patch i
 * (a scrambled Sobol' net in four dimensions: place and direction) estimate the row: each ray is a
 * share of 1. Patches that emit are sampled from their own side as well, with visibility rays, and
 * the two estimates are combined by the power heuristic [veach95], so a small lamp is never left to
 * chance and a near one never blows up.
 * A sample point half or more of whose rays meet sides that take no part (the inside of a box that
 * stands on the patch) lies inside a solid: it neither sends nor receives.
 * A last gather reads a patch from farther away than its edge only, and follows rays on that end
 * nearer. For it (room->pocket) places that see nothing farther away than the edge of what they see
 * or are, and no lamp, take no part either: a wall's one value is that of its open places then, not
 * of those behind a picture, and what leaves it does not end on the picture's back, which has no
 * other light than what the wall would not give it there.
 * Threads  made in parallel, the same bytes for any number; a finished Links never changes.
 */
#ifndef RADIOSITY_LINKS_H
#define RADIOSITY_LINKS_H

#include "base/error.h"
#include "base/monitor.h"
#include "radiosity/room.h"

typedef enum { CLOSURE_NONE, CLOSURE_ROWS, CLOSURE_RECIPROCITY, CLOSURE_BOTH } Closure;

typedef struct {
    uint32_t rays;        /* hemisphere rays per patch; 0: 256 */
    uint32_t lamp_rays;   /* visibility rays per patch to emitting patches; 0: rays / 4 */
    uint32_t seed;
    unsigned threads;
    uint64_t max_bytes;   /* that may be taken; 0: no limit */
    const char *folder;   /* where more than that goes, into files without a name that are mapped;
                             NULL: refuse with ERROR_MEMORY before it is taken */
    struct KeptRows *kept; /* rows of an earlier run to go on from, and where finished ones can be
                              saved from (radiosity/kept_rows.h); NULL: none */
} LinksOptions;

typedef struct {
    uint32_t  count;        /* patches */
    uint64_t *first;        /* [count + 1] */
    uint32_t *source;       /* [first[count]]  rising within a row */
    float    *form_factor;  /* [first[count]]  from receiver to source, in [0, 1] */
    float    *escape;       /* [count]  share of what leaves that meets nothing */
    double   *area;         /* [count]  visible area: the patch's area outside other solids */
    uint8_t  *lamp;         /* [count]  1: sampled from its own side as well; NULL: none */
    uint64_t  rays;         /* cast */
    uint64_t  clamped;      /* factors that chance put above 1: limited to it */
    double    seconds;
    /* where the links lie; { 0 }: in memory, as above */
    uint64_t  mapped;       /* bytes of the mapped file they lie in */
    char     *folder;       /* of that file, and of those of links made from these */
    uint16_t *packed;       /* [2 * first[count]]  in place of source, form_factor (links_pack) */
    float    *scale;        /* [count]  of packed rows */
} Links;

/* One row, as it lies or unpacked. */
typedef struct {
    const uint32_t *source;      /* [count]  rising, but for links with factor 0 of packed rows */
    const float    *form_factor; /* [count] */
    uint64_t        count;
} LinksRow;

/* Room for one unpacked row: one for each thread that reads rows. */
typedef struct {
    uint32_t *source;
    float    *form_factor;
} LinksScratch;

/* How far rows and pairs are from what must hold; relative row sums |sum_j F_ij + escape - 1|;
 * reciprocity |A_i F_ij - A_j F_ji| / max over the larger row's area. */
typedef struct {
    double   row_sum_error_max, row_sum_error_rms;
    double   reciprocity_error_max, reciprocity_error_rms;
    double   escaped;       /* area-weighted mean of escape */
    uint64_t nonzeros, bytes;
} LinksReport;

/* What enforcing has changed. */
typedef struct {
    double   largest;       /* |after - before| of a factor */
    double   before, after; /* that factor */
    uint32_t row, column;
    double   escape;        /* the same of a row's escaped share */
} LinksChange;

/* Casts all rays.
 * owns   the caller frees with links_destroy.
 * fails  NULL; ERROR_MEMORY, also over max_bytes, with what it would take, and where the disk is
 *        too small; ERROR_STOPPED. */
Links *links_create(const Room *room, const LinksOptions *options, const Monitor *monitor,
                    Error *err);
/* Links of a room whose patches were divided further (patches_split): old are the links before, as
 * cast, and parent [room->patches->count] says which old patch each is or is part of. Only the rows
 * of parts are cast. All other rows keep what they have; where they name a patch that was divided,
 * its parts share that factor in proportion to what their own rows say by reciprocity, or by area
 * where these say nothing: sums of rows do not change.
 * fails  as links_create. */
Links *links_refine(const Links *old, const Room *room, const uint32_t *parent,
                    const LinksOptions *options, const Monitor *monitor, Error *err);
/* Rows to be filled by the caller: first, escape and area are zero; room for `nonzeros` links.
 * fails  NULL; ERROR_MEMORY. */
Links *links_empty(uint32_t count, uint64_t nonzeros, Error *err);
/* Frees; NULL is allowed. Always returns NULL. */
Links *links_destroy(Links *links);
/* Measures the links as they are; not packed.
 * fails  false; ERROR_MEMORY. */
bool   links_report(const Links *links, LinksReport *report, Error *err);
/* Compares two links between the same patches, one enforced from the other; not packed. */
void   links_change(const Links *before, const Links *after, LinksChange *change);
/* Bytes of the links, wherever they lie. */
uint64_t links_bytes(const Links *links);
/* Invariants: rows in order, sources rising and < count, 0 <= F <= 1, escape in [0, 1]. */
bool   links_check(const Links *links);

/* Enforces what must hold, as a step of its own that leaves the raw links to the caller: a new
 * Links.
 *   ROWS         each row scaled so that it and its escape sum to 1; factors to lamps, which are
 *                known better, stay as they are where that is possible
 *   RECIPROCITY  A_i F_ij and A_j F_ji become their mean, weighted by 1/A_i and 1/A_j, the inverses
 *                of their variances; between a lamp and another patch, what the other found by
 *                visibility rays, unless it is large and the lamp near
 *   BOTH         reciprocity, then one factor per patch, d_i d_j on links and d_i on escape, so
 *                that rows hold to 1e-7 ([sinkhorn67] in its symmetric form, found by Newton's
 *                method; less on links between a lamp and another patch)
 * patches  those that the links are between, to know which lamps are near; NULL: none is.
 * Zeros stay zero, nothing becomes negative. What was reached is in a links_report of the result.
 * fails  NULL; ERROR_MEMORY, ERROR_STOPPED. Where BOTH has no solution, patches concerned let some
 *        light escape ("closure-opened"); what misses all the same gives its best and warns
 *        ("closure-missed"). */
Links *links_close(const Links *links, const Patches *patches, Closure closure, unsigned threads,
                   const Monitor *monitor, Error *err);

/* --- rows wherever they lie ------------------------------------------------------------------- */

/* The same links in half the bytes: 16 bits a factor, 16 the way to its source. Each factor is
 * rounded by at most 2^-11 of itself (less than 2^-31 of its row's largest becomes that); rows keep
 * their sums. *rounding gets the largest share by which a factor has changed.
 * folder  NULL: in memory; else in a mapped file there.
 * fails   NULL; ERROR_MEMORY. */
Links *links_pack(const Links *links, const char *folder, unsigned threads, double *rounding,
                  Error *err);

/* Does nothing, and takes nothing, for links that are not packed. */
bool links_scratch_create(const Links *links, LinksScratch *scratch, Error *err);
void links_scratch_clear(LinksScratch *scratch);
LinksRow links_unpack_row(const Links *links, uint32_t i, LinksScratch *scratch);

/* Row i; it holds until the scratch is used again.
 * hot  checks nothing. */
static inline LinksRow links_row(const Links *links, uint32_t i, LinksScratch *scratch)
{
    const uint64_t first = links->first[i];
    if (links->packed != NULL)
        return links_unpack_row(links, i, scratch);
    return (LinksRow){ &links->source[first], &links->form_factor[first],
                       links->first[i + 1] - first };
}

/* Rows begin..end-1 are not needed for now: mapped ones leave the process's memory. */
void links_leave(const Links *links, uint32_t begin, uint32_t end);

#endif
