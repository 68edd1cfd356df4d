/* SPDX-License-Identifier: BSD-3-Clause */
/* What must hold for any Patches. */
#include <assert.h>
#include <math.h>

#include "math/tolerance.h"
#include "mesh/patches_internal.h"

/* shape_area promises this for a whole shape and for each of its cells. */
static const double SHAPE_AREA_ERROR = 1e-9;

static bool check_side(const Patches *p, const Surfaces *s, uint32_t surface, unsigned side)
{
    const Surface *f = &s->surface[surface];
    const uint32_t first = p->first[side][surface], count = patches_of_side(p, s, surface);
    if (first > p->count || count > p->count - first)
        return false;
    double area = 0;
    for (uint32_t i = first; i < first + count; i++) {
        if (p->surface[i] != surface || p->side[i] != side
            || p->material[i] != surfaces_material(s, surface, side)
            || p->group[i] != surfaces_group(s, surface, side) || !(p->area[i] > 0)
            || !isfinite(p->area[i]))
            return false;
        if (!(fabs(vec3_dot(p->normal[i], p->normal[i]) - 1) < rounding_bound(64)))
            return false;
        area += p->area[i];
    }
    /* Cells are products and sums of a few roundings each; their sum adds one per cell. */
    const double slack = f->kind == SURFACE_SHAPE ? 2 * SHAPE_AREA_ERROR
                                                  : (64.0 + count) * DBL_EPSILON;
    return fabs(area - f->area) <= slack * f->area;
}

static bool check_corners(const Patches *p)
{
    if (p->first_corner[0] != 0)
        return false;
    for (uint32_t i = 0; i < p->count; i++) {
        const uint32_t first = p->first_corner[i], end = p->first_corner[i + 1];
        if (end < first || end - first < 3)
            return false;
        for (uint32_t k = first; k < end; k++) {
            const uint32_t next = k + 1 < end ? k + 1 : first;
            if (p->corner[k] >= p->vertex_count || p->corner[k] == p->corner[next])
                return false;
        }
    }
    return true;
}

static bool check_lookup(const Patches *p, const Surfaces *s, uint32_t patch)
{
    const uint32_t surface = p->surface[patch];
    const unsigned side = p->side[patch];
    const PatchCell cell = patches_cell(p, s, surface, patch - p->first[side][surface]);
    const bool triangle = s->surface[surface].kind == SURFACE_TRIANGLE;
    const double within = !triangle ? 0.5 : cell.upper ? 2.0 / 3 : 1.0 / 3;
    return patches_at(p, s, surface, side, (cell.i + within) / p->nu[surface],
                      (cell.j + within) / p->nv[surface]) == patch;
}

static bool check_grid(const Patches *p)
{
    for (uint32_t i = 0; i < p->grid_count; i++)
        if (p->grid_vertex[i] != PATCH_NONE && p->grid_vertex[i] >= p->vertex_count)
            return false;
    return true;
}

bool patches_check(const Patches *patches, const Surfaces *surfaces)
{
    assert(patches != NULL && surfaces != NULL);
    if (patches->surface_count != surfaces->count || !check_corners(patches)
        || !check_grid(patches))
        return false;
    uint64_t count = 0;
    for (uint32_t i = 0; i < surfaces->count; i++)
        for (unsigned side = 0; side < 2; side++)
            if (patches->first[side][i] != PATCH_NONE) {
                if (!check_side(patches, surfaces, i, side))
                    return false;
                count += patches_of_side(patches, surfaces, i);
            }
    if (count != patches->count)
        return false;
    for (uint32_t i = 0; i < patches->count; i++)
        if (!check_lookup(patches, surfaces, i))
            return false;
    return true;
}
