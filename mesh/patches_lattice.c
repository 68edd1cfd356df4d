/* SPDX-License-Identifier: BSD-3-Clause */
/* Vertices by their place on a lattice. */
#include "mesh/patches_lattice.h"

#include <assert.h>

#include "base/array.h"
#include "mesh/patches.h"

#define NO_KEY UINT64_MAX

static bool reserve(PatchLattice *l, size_t slots, Error *err)
{
    if (!array_reserve((void **)&l->vertex, &l->vertex_capacity, slots, sizeof *l->vertex,
                       "patch grid", err))
        return false;
    for (size_t k = 0; k < slots; k++)
        l->vertex[k] = PATCH_NONE;
    return true;
}

bool lattice_dense(PatchLattice *lattice, uint32_t nu, uint32_t nv, Error *err)
{
    lattice->row = (size_t)nu + 1;
    return reserve(lattice, lattice->row * ((size_t)nv + 1), err);
}

bool lattice_sparse(PatchLattice *lattice, size_t most, Error *err)
{
    size_t slots = 16;
    for (lattice->shift = 60; slots < 2 * most; lattice->shift--)
        slots *= 2;
    lattice->row = 0;
    lattice->mask = slots - 1;
    if (!reserve(lattice, slots, err)
        || !array_reserve((void **)&lattice->key, &lattice->key_capacity, slots,
                          sizeof *lattice->key, "patch grid", err))
        return false;
    for (size_t k = 0; k < slots; k++)
        lattice->key[k] = NO_KEY;
    return true;
}

void lattice_clear(PatchLattice *lattice)
{
    array_free(lattice->vertex);
    array_free(lattice->key);
    *lattice = (PatchLattice){ 0 };
}

/* The slot that has the key, or the empty one where it would go. */
static size_t probe(const PatchLattice *l, uint64_t key)
{
    /* Multiplied by 2^64 over the golden ratio, the high bits of neighbours are far apart. */
    size_t k = (size_t)(key * UINT64_C(0x9e3779b97f4a7c15) >> l->shift);
    while (l->key[k] != NO_KEY && l->key[k] != key)
        k = (k + 1) & l->mask;
    return k;
}

uint32_t *lattice_slot(PatchLattice *lattice, uint32_t i, uint32_t j)
{
    if (lattice->row > 0)
        return &lattice->vertex[j * lattice->row + i];
    const uint64_t key = (uint64_t)j << 32 | i;
    const size_t k = probe(lattice, key);
    lattice->key[k] = key;
    return &lattice->vertex[k];
}

uint32_t lattice_find(const PatchLattice *lattice, uint32_t i, uint32_t j)
{
    if (lattice->row > 0)
        return lattice->vertex[j * lattice->row + i];
    return lattice->vertex[probe(lattice, (uint64_t)j << 32 | i)];
}
