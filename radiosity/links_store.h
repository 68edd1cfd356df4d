/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links_store.h -- where links lie: in memory, in a mapped file, or packed; this folder
 * only. */
#ifndef RADIOSITY_LINKS_STORE_H
#define RADIOSITY_LINKS_STORE_H

#include "radiosity/links.h"

/* Rows without content: first, escape and area are zero; room for `nonzeros` links. */
Links *links_allocate(uint32_t count, uint64_t nonzeros, Error *err);
/* The same with the links in a file in that folder; NULL: in memory. Copies the name. */
Links *links_allocate_in(uint32_t count, uint64_t nonzeros, const char *folder, Error *err);

/* Rows that a pass over mapped links goes through before it lets go of them. */
enum { LINKS_PASS = 1024 };

/* To be called for each i of a pass over all rows in order. */
static inline void links_pass(const Links *links, uint32_t i)
{
    if (links->mapped > 0 && i % LINKS_PASS == 0 && i > 0)
        links_leave(links, i - LINKS_PASS, i);
}

/* Where links that need `bytes` go: *folder is NULL when they fit into memory, else the one given.
 * fails  false; ERROR_MEMORY when there is none, its disk is too small or even what must be in
 *        memory for that many patches is too much. */
bool links_choose_folder(double bytes, uint32_t patches, const LinksOptions *options,
                         const char **folder, Error *err);

/* --- chunks ----------------------------------------------------------------------------------- */

/* Two arrays of `links` entries each, in memory or (folder not NULL) in one mapped file of *mapped
 * bytes. */
bool links_chunk_create(uint64_t links, const char *folder, uint32_t **source, float **form_factor,
                        uint64_t *mapped, Error *err);
/* The chunk is not needed for now; nothing for one in memory. */
void links_chunk_leave(const uint32_t *source, uint64_t mapped);
void links_chunk_free(uint32_t **source, float **form_factor, uint64_t *mapped);

/* --- columns ---------------------------------------------------------------------------------- */

/* Part of the links by source: columns begin..end-1 of F. */
typedef struct {
    uint32_t  begin, end;
    uint64_t *first;        /* [end - begin + 1]  of column begin + j at j */
    uint32_t *receiver;     /* [first[end - begin]]  rising within a column */
    float    *form_factor;  /* [first[end - begin]]  from receiver to the column's source */
    uint64_t  mapped;       /* bytes of the mapped file both arrays lie in; 0: memory */
} LinkColumns;

/* total [count + 1]: links in all columns before j. fails  NULL; ERROR_MEMORY. */
uint64_t *links_column_totals(const Links *links, Error *err);
/* The end of the longest run of columns from `begin` on with no more than `most` links, at least
 * one column. */
uint32_t link_columns_end(const uint64_t *total, uint32_t count, uint32_t begin, uint64_t most);
/* Fills columns begin..end-1. `own_file`: in a mapped file when the links are in one. */
bool link_columns_create(const Links *links, const uint64_t *total, uint32_t begin, uint32_t end,
                         bool own_file, LinkColumns *columns, Error *err);
/* Column j is not needed for now. */
void link_columns_leave(const LinkColumns *columns, uint32_t j);
void link_columns_clear(LinkColumns *columns);

/* Links that a block of columns in memory may have where links are mapped: 16 MiB of them. */
enum { COLUMN_BLOCK = 1 << 21 };

#endif
