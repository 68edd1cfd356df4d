/* SPDX-License-Identifier: BSD-3-Clause */
/* What must hold for any Patches. */
#include <assert.h>
#include <math.h>

#include "math/tolerance.h"
#include "mesh/patches_internal.h"

/* shape_area promises this for a whole shape and for each of its cells. */
static const double SHAPE_AREA_ERROR = 1e-9;

static bool check_patch(const Patches *p, const Surfaces *s, uint32_t i)
{
    const uint32_t surface = p->surface[i], side = p->side[i];
    return surface < p->surface_count && side < 2
        && p->material[i] == surfaces_material(s, surface, side)
        && p->group[i] == surfaces_group(s, surface, side) && p->area[i] > 0
        && isfinite(p->area[i])
        && fabs(vec3_dot(p->normal[i], p->normal[i]) - 1) < rounding_bound(64);
}

/* A side cut into cells. */
static bool check_cells(const Patches *p, const Surfaces *s, uint32_t surface, unsigned side,
                        uint32_t *count)
{
    const Surface *f = &s->surface[surface];
    const uint32_t first = p->first[side][surface], face = p->first_face[side][surface];
    *count = patches_side_cells(p, s, surface, side);
    if (*count > p->count - first)
        return false;
    double area = 0;
    for (uint32_t i = first; i < first + *count; i++) {
        if (p->surface[i] != surface || p->side[i] != side || patches_is_merged(p, i)
            || p->face_of[i] != face + (i - first) || p->cell[i].level > PATCH_LEVELS)
            return false;
        area += p->area[i];
    }
    /* Cells are products and sums of a few roundings each; their sum adds one per cell. */
    const double slack = f->kind == SURFACE_SHAPE ? 2 * SHAPE_AREA_ERROR
                                                  : (64.0 + *count) * DBL_EPSILON;
    return fabs(area - f->area) <= slack * f->area;
}

/* A merged patch: its pieces name it, its area is theirs. */
static bool check_merged(const Patches *p, const Surfaces *s, uint32_t patch)
{
    const uint32_t first = p->first_piece[patch], end = p->first_piece[patch + 1];
    const unsigned side = p->side[patch];
    double area = 0, before = 0;
    if (end - first < 2 || p->piece[first] != p->surface[patch])
        return false;
    for (uint32_t k = first; k < end; k++) {
        const uint32_t piece = p->piece[k];
        if (piece >= p->surface_count || p->first[side][piece] != patch
            || p->first_face[side][piece] != p->face_of[patch] + (k - first)
            || p->nu[piece] != 1 || p->nv[piece] != 1
            || p->tree_first[side][piece] != PATCH_NONE || !(p->piece_end[k] > before)
            || surfaces_material(s, piece, side) != p->material[patch])
            return false;
        before = p->piece_end[k];
        area += s->surface[piece].area;
    }
    return before == 1
        && fabs(area - p->area[patch]) <= (64.0 + (end - first)) * DBL_EPSILON * area;
}

static bool check_face(const Patches *p, uint32_t face)
{
    const uint32_t first = p->first_corner[face], end = p->first_corner[face + 1];
    const bool parted = p->part_of != NULL && p->part_of[p->face_patch[face]] != PATCH_NONE;
    if (end < first || end - first < 3 || (!parted && p->corner_along[first] != 0))
        return false;
    for (uint32_t k = first; k < end; k++) {
        const uint32_t next = k + 1 < end ? k + 1 : first;
        if (p->corner[k] >= p->vertex_count || p->corner[k] == p->corner[next]
            || !(p->corner_along[k] >= 0 && p->corner_along[k] < 4))
            return false;
    }
    return true;
}

static bool check_faces(const Patches *p)
{
    if (p->first_corner[0] != 0)
        return false;
    for (uint32_t face = 0; face < p->face_count; face++) {
        const uint32_t patch = p->face_patch[face];
        if (patch >= p->count || face < p->face_of[patch] || !check_face(p, face))
            return false;
        const uint32_t pieces = p->first_piece[patch + 1] - p->first_piece[patch];
        if (face - p->face_of[patch] >= (pieces == 0 ? 1 : pieces))
            return false;
    }
    return true;
}

static bool check_tree(const Patches *p)
{
    for (uint32_t k = 0; k < p->tree_count; k++) {
        const uint32_t at = p->tree[k] & ~PATCH_DIVIDED;
        /* Quarters stand behind, so that no walk can go round. */
        if ((p->tree[k] & PATCH_DIVIDED) != 0 && (at <= k || p->tree_count - at < 4))
            return false;
    }
    return true;
}

/* patches_at finds the patch again at points of it, among them the nearest to its corners. */
static bool check_lookup(const Patches *p, const Surfaces *s, uint32_t patch)
{
    static const double place[5][2] = { { 0.5, 0.5 }, { 0, 0 }, { 1 - 0x1p-24, 0 },
                                        { 0, 1 - 0x1p-24 }, { 1 - 0x1p-24, 1 - 0x1p-24 } };
    for (unsigned k = 0; k < 5; k++) {
        PatchPoint at;
        patches_point(p, s, patch, place[k][0], place[k][1], &at);
        if (patches_at(p, s, at.surface, p->side[patch], at.s, at.t) != patch)
            return false;
    }
    return true;
}

static bool check_sides(const Patches *p, const Surfaces *s)
{
    uint64_t patches = 0, pieces = 0;
    for (uint32_t i = 0; i < s->count; i++)
        for (unsigned side = 0; side < 2; side++) {
            const uint32_t first = p->first[side][i];
            uint32_t count = 0;
            if (first == PATCH_NONE)
                continue;
            if (first >= p->count)
                return false;
            if (patches_is_merged(p, first)) {
                pieces++;
                continue;
            }
            if (!check_cells(p, s, i, side, &count))
                return false;
            patches += count;
        }
    for (uint32_t i = 0; i < p->count; i++)
        if (patches_is_merged(p, i)) {
            if (!check_merged(p, s, i))
                return false;
            patches++;
        }
    return patches == p->count && pieces == p->first_piece[p->count];
}

/* Parts and patches name each other, and all parts of a cell are on its side. */
static bool check_parts(const Patches *p)
{
    for (uint32_t k = 0; k < p->part_count; k++) {
        const PatchPart *part = &p->part[k];
        if (part->patch >= p->count || p->part_of[part->patch] != k
            || part->parted >= p->parted_count || !(part->share > 0))
            return false;
        const PatchParted *parted = &p->parted[part->parted];
        const uint32_t first = p->part[parted->first_part].patch;
        if (k - parted->first_part >= parted->parts
            || p->surface[part->patch] != p->surface[first]
            || p->side[part->patch] != p->side[first])
            return false;
    }
    return true;
}

bool patches_check(const Patches *patches, const Surfaces *surfaces)
{
    assert(patches != NULL && surfaces != NULL);
    if (patches->surface_count != surfaces->count || !check_tree(patches)
        || !check_sides(patches, surfaces) || !check_faces(patches) || !check_parts(patches))
        return false;
    for (uint32_t i = 0; i < patches->count; i++)
        if (!check_patch(patches, surfaces, i) || !check_lookup(patches, surfaces, i))
            return false;
    return true;
}
