/* SPDX-License-Identifier: BSD-3-Clause */
/* The way from surfaces to patches: divide, number, find edges, make vertices, faces, measures. */
#include "mesh/patches.h"

#include <assert.h>

#include "base/array.h"
#include "mesh/patches_internal.h"

static const uint64_t PATCHES_MOST = UINT64_C(1) << 31; /* as the header says */

bool patches_allocate_surfaces(PatchBuilder *b)
{
    Patches *out = b->out;
    const uint32_t n = out->surface_count = b->surfaces->count;
    out->nu = array_create(n, sizeof *out->nu, "patches", b->err);
    out->nv = array_create(n, sizeof *out->nv, "patches", b->err);
    for (unsigned side = 0; side < 2; side++) {
        out->first[side] = array_create(n, sizeof *out->first[side], "patches", b->err);
        out->first_face[side] = array_create(n, sizeof *out->first_face[side], "patches", b->err);
        out->tree_first[side] = array_create(n, sizeof *out->tree_first[side], "patches", b->err);
    }
    b->block = array_create(2 * (size_t)n, sizeof *b->block, "patches", b->err);
    b->block_merged = array_create(2 * (size_t)n, sizeof *b->block_merged, "patches", b->err);
    if (error_is_set(b->err))
        return false;
    for (uint32_t i = 0; i < n; i++)
        for (unsigned side = 0; side < 2; side++)
            out->first[side][i] = out->tree_first[side][i] = PATCH_NONE;
    return true;
}

/* --- numbers ---------------------------------------------------------------------------------- */

static bool number_patches(PatchBuilder *b)
{
    Patches *out = b->out;
    uint64_t patches = 0, faces = 0;
    for (uint32_t k = 0; k < b->block_count; k++) {
        const uint32_t surface = b->block[k] / 2, side = b->block[k] % 2;
        const uint32_t merged = b->block_merged[k];
        if (merged == PATCH_NONE) {
            out->first[side][surface] = (uint32_t)patches;
            out->first_face[side][surface] = (uint32_t)faces;
            const uint32_t cells = patches_side_cells(out, b->surfaces, surface, side);
            patches += cells;
            faces += cells;
        } else {
            for (uint32_t i = b->merged_first[merged]; i < b->merged_first[merged + 1]; i++) {
                out->first[side][b->merged_piece[i]] = (uint32_t)patches;
                out->first_face[side][b->merged_piece[i]] = (uint32_t)faces++;
            }
            patches++;
        }
        if (patches > PATCHES_MOST || faces > PATCHES_MOST)
            return error_set(b->err, ERROR_INPUT, "more than 2^31 patches");
    }
    out->count = (uint32_t)patches;
    out->face_count = (uint32_t)faces;
    return true;
}

static bool allocate_patches(PatchBuilder *b)
{
    Patches *out = b->out;
    const size_t n = out->count, faces = out->face_count;
    const size_t pieces = b->merged_count == 0 ? 0 : b->merged_first[b->merged_count];
    Error *err = b->err;
    out->surface = array_create(n, sizeof *out->surface, "patches", err);
    out->side = array_create(n, sizeof *out->side, "patches", err);
    out->cell = array_create(n, sizeof *out->cell, "patches", err);
    out->material = array_create(n, sizeof *out->material, "patches", err);
    out->group = array_create(n, sizeof *out->group, "patches", err);
    out->area = array_create(n, sizeof *out->area, "patches", err);
    out->centre = array_create(n, sizeof *out->centre, "patches", err);
    out->normal = array_create(n, sizeof *out->normal, "patches", err);
    out->first_piece = array_create(n + 1, sizeof *out->first_piece, "patches", err);
    out->piece = array_create(pieces, sizeof *out->piece, "patches", err);
    out->piece_end = array_create(pieces, sizeof *out->piece_end, "patches", err);
    out->face_of = array_create(n, sizeof *out->face_of, "patches", err);
    out->face_patch = array_create(faces, sizeof *out->face_patch, "patches", err);
    out->first_corner = array_create(faces + 1, sizeof *out->first_corner, "patches", err);
    if (out->tree == NULL)
        out->tree = array_create(0, sizeof *out->tree, "patches", err);
    b->corner_capacity = b->along_capacity = 4 * faces;
    out->corner = array_create(b->corner_capacity, sizeof *out->corner, "patch corners", err);
    out->corner_along = array_create(b->along_capacity, sizeof *out->corner_along, "patch corners",
                                     err);
    return !error_is_set(err);
}

static void fill_merged(PatchBuilder *b, uint32_t merged, uint32_t patch)
{
    Patches *out = b->out;
    uint32_t piece = out->first_piece[patch], face = out->face_of[patch];
    for (uint32_t i = b->merged_first[merged]; i < b->merged_first[merged + 1]; i++) {
        out->piece[piece++] = b->merged_piece[i];
        out->face_patch[face++] = patch;
    }
    out->first_piece[patch + 1] = piece;
}

static void fill_patches(PatchBuilder *b)
{
    Patches *out = b->out;
    for (uint32_t k = 0; k < b->block_count; k++) {
        const uint32_t surface = b->block[k] / 2, side = b->block[k] % 2;
        const uint32_t merged = b->block_merged[k], first = out->first[side][surface];
        const bool grid = merged == PATCH_NONE;
        const uint32_t count = grid ? patches_side_cells(out, b->surfaces, surface, side) : 1;
        if (grid)
            patches_fill_cells(out, b->surfaces, surface, side, out->cell + first);
        for (uint32_t i = first; i < first + count; i++) {
            out->surface[i] = surface;
            out->side[i] = (uint8_t)side;
            out->material[i] = surfaces_material(b->surfaces, surface, side);
            out->group[i] = surfaces_group(b->surfaces, surface, side);
            out->face_of[i] = out->first_face[side][surface] + (i - first);
            out->first_piece[i + 1] = out->first_piece[i];
            if (grid)
                out->face_patch[out->face_of[i]] = i;
            else
                fill_merged(b, merged, i);
        }
    }
}

bool patches_build(PatchBuilder *b)
{
    if (!number_patches(b) || !patches_find_points(b) || !patches_start_vertices(b)
        || !allocate_patches(b))
        return false;
    fill_patches(b);
    if (!patches_make_faces(b))
        return false;
    patches_measure(b);
    return true;
}

/* --- making and ending ------------------------------------------------------------------------ */

void patches_builder_clear(PatchBuilder *b)
{
    edges_clear(&b->edges);
    array_free(b->cluster);
    array_free(b->block);
    array_free(b->block_merged);
    array_free(b->merged_first);
    array_free(b->merged_piece);
    array_free(b->stitch_use);
    array_free(b->from);
    array_free(b->to);
    array_free(b->mate);
    array_free(b->point_first);
    array_free(b->fraction);
    array_free(b->parent);
    array_free(b->corner_vertex);
    array_free(b->run);
}

/* Gathers the clusters' pieces, each in the order of surfaces. */
static bool gather_merged(PatchBuilder *b)
{
    const size_t nodes = b->cluster_count == 0 ? 0 : 2 * (size_t)b->surfaces->count;
    uint32_t pieces = 0;
    for (size_t node = 0; node < nodes; node++)
        pieces += b->cluster[node] != PATCH_NONE;
    b->merged_count = b->cluster_count;
    b->merged_first = array_create((size_t)b->merged_count + 2, sizeof *b->merged_first,
                                   "patches", b->err);
    b->merged_piece = array_create(pieces, sizeof *b->merged_piece, "patches", b->err);
    if (error_is_set(b->err))
        return false;
    for (size_t node = 0; node < nodes; node++)
        if (b->cluster[node] != PATCH_NONE)
            b->merged_first[b->cluster[node] + 2]++;
    for (uint32_t c = 2; c < b->merged_count + 2; c++)
        b->merged_first[c] += b->merged_first[c - 1];
    /* Filling moves first[c + 1] from the start of c to its end, which is where c + 1 starts. */
    for (size_t node = 0; node < nodes; node++)
        if (b->cluster[node] != PATCH_NONE)
            b->merged_piece[b->merged_first[b->cluster[node] + 1]++] = (uint32_t)(node / 2);
    return true;
}

/* In the order of surfaces, the front first; a merged patch comes with its first piece. */
static bool order_blocks(PatchBuilder *b)
{
    if (!gather_merged(b))
        return false;
    for (uint32_t i = 0; i < b->surfaces->count; i++)
        for (unsigned side = 0; side < 2; side++) {
            const uint32_t node = 2 * i + side;
            const uint32_t merged = b->merged_count == 0 ? PATCH_NONE : b->cluster[node];
            if (!patches_side_used(b, i, side)
                || (merged != PATCH_NONE && b->merged_piece[b->merged_first[merged]] != i))
                continue;
            b->block[b->block_count] = node;
            b->block_merged[b->block_count++] = merged;
        }
    return true;
}

Patches *patches_create(const Surfaces *surfaces, const PatchOptions *options,
                        const Monitor *monitor, Error *err)
{
    assert(surfaces != NULL && options != NULL && err != NULL);
    assert(options->size >= 0);
    if (error_is_set(err))
        return NULL;
    PatchBuilder b = { .surfaces = surfaces, .sides = options->sides, .err = err };
    b.out = array_create(1, sizeof *b.out, "patches", err);
    if (b.out == NULL)
        return NULL;
    const bool ok = patches_allocate_surfaces(&b) && patches_divide(&b, options, monitor)
                 && order_blocks(&b) && patches_find_edges(&b) && patches_build(&b)
                 && patches_part(&b, NULL, NULL);
    patches_builder_clear(&b);
    return ok ? b.out : patches_destroy(b.out);
}

Patches *patches_destroy(Patches *patches)
{
    if (patches == NULL)
        return NULL;
    array_free(patches->surface);
    array_free(patches->side);
    array_free(patches->cell);
    array_free(patches->material);
    array_free(patches->group);
    array_free(patches->area);
    array_free(patches->centre);
    array_free(patches->normal);
    array_free(patches->first_piece);
    array_free(patches->piece);
    array_free(patches->piece_end);
    array_free(patches->face_of);
    array_free(patches->face_patch);
    array_free(patches->first_corner);
    array_free(patches->corner);
    array_free(patches->corner_along);
    array_free(patches->position);
    array_free(patches->nu);
    array_free(patches->nv);
    array_free(patches->tree);
    array_free(patches->parted);
    array_free(patches->part_slicer);
    array_free(patches->part);
    array_free(patches->part_of);
    for (unsigned side = 0; side < 2; side++) {
        array_free(patches->first[side]);
        array_free(patches->first_face[side]);
        array_free(patches->tree_first[side]);
    }
    array_free(patches);
    return NULL;
}
