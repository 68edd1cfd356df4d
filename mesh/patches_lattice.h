/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/patches_lattice.h -- vertices of one side of a surface by their place (i, j): a table for
 * plain grids, a hash table with open addressing for divided ones. This folder only.
 */
#ifndef MESH_PATCHES_LATTICE_H
#define MESH_PATCHES_LATTICE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"

typedef struct {
    uint32_t *vertex;
    uint64_t *key;          /* of a hash table's slots */
    size_t    vertex_capacity, key_capacity;
    size_t    row;          /* > 0: a table with so many places in a row */
    size_t    mask;         /* a hash table has mask + 1 slots, 2^(64 - shift) */
    unsigned  shift;
} PatchLattice;

/* Empties a lattice, { 0 } or used before, and readies it for i <= nu, j <= nv; or for up to `most`
 * points of any place.
 * fails  false; ERROR_MEMORY. */
bool lattice_dense(PatchLattice *lattice, uint32_t nu, uint32_t nv, Error *err);
bool lattice_sparse(PatchLattice *lattice, size_t most, Error *err);
void lattice_clear(PatchLattice *lattice);

/* Where the vertex at (i, j) is kept; PATCH_NONE until it is set. */
uint32_t *lattice_slot(PatchLattice *lattice, uint32_t i, uint32_t j);
/* The vertex at (i, j), or PATCH_NONE. */
uint32_t lattice_find(const PatchLattice *lattice, uint32_t i, uint32_t j);

#endif
