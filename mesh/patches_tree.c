/* SPDX-License-Identifier: BSD-3-Clause */
/* Cells of a surface's side: base grid and quadtrees under it, by number and along edges. */
#include <assert.h>
#include <math.h>

#include "mesh/patches_internal.h"

/* Row of a triangle's grid that cell `index` lies in: largest j with n^2 - (n-j)^2 <= index. */
static uint32_t triangle_row(uint32_t n, uint32_t index)
{
    const uint64_t rest = (uint64_t)n * n - index; /* (n-j)^2 >= rest */
    uint64_t root = (uint64_t)sqrt((double)rest);
    while (root * root < rest)
        root++;
    while ((root - 1) * (root - 1) >= rest)
        root--;
    return n - (uint32_t)root;
}

PatchCell patches_base_cell(bool triangle, uint32_t nu, uint32_t index)
{
    if (!triangle)
        return (PatchCell){ .i = index % nu, .j = index / nu };
    const uint32_t j = triangle_row(nu, index);
    const uint32_t left = index - (nu * nu - (nu - j) * (nu - j));
    return (PatchCell){ .i = left / 2, .j = j, .upper = left % 2 };
}

PatchCell patches_cell_child(bool triangle, PatchCell cell, unsigned q)
{
    assert(q < 4 && cell.level < PATCH_LEVELS);
    /* Quarters of quads, of lower and of upper triangles: right, above, upper. */
    static const uint8_t quarter[3][4][3] = {
        { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 1, 1, 0 } },
        { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } },
        { { 1, 0, 1 }, { 0, 1, 1 }, { 1, 1, 1 }, { 1, 1, 0 } },
    };
    const uint8_t *at = quarter[triangle ? 1 + cell.upper : 0][q];
    return (PatchCell){ .i = 2 * cell.i + at[0], .j = 2 * cell.j + at[1], .upper = at[2],
                        .level = (uint8_t)(cell.level + 1) };
}

PatchCell patches_cell_parent(bool triangle, PatchCell cell, unsigned *q)
{
    assert(cell.level > 0);
    const unsigned right = cell.i & 1, above = cell.j & 1;
    PatchCell up = { .i = cell.i / 2, .j = cell.j / 2, .level = (uint8_t)(cell.level - 1) };
    *q = 2 * above + right;
    if (!triangle)
        return up;
    /* Of a square's four, the one at (0,0) and the one at (1,1) have both of their triangles in one
     * of the halves; the other two are cut by the diagonal. */
    up.upper = right + above == 2 ? 1 : right + above == 0 ? 0 : cell.upper;
    if (up.upper)
        *q = cell.upper ? (right + above == 2 ? 2 : right ? 0 : 1) : 3;
    else
        *q = cell.upper ? 3 : *q;
    return up;
}

PatchCell patches_edge_cell(bool triangle, uint32_t nu, uint32_t nv, unsigned k, uint32_t m,
                            unsigned level)
{
    PatchCell cell = { .level = (uint8_t)level };
    const uint32_t length = k % 2 == 0 ? nu : nv;
    assert(m < length);
    const uint32_t back = length - 1 - m;
    if (triangle) {
        cell.i = k == 0 ? m : k == 1 ? back : 0;
        cell.j = k == 0 ? 0 : k == 1 ? m : back;
    } else {
        cell.i = k == 0 ? m : k == 1 ? nu - 1 : k == 2 ? back : 0;
        cell.j = k == 0 ? 0 : k == 1 ? m : k == 2 ? nv - 1 : back;
    }
    return cell;
}

static uint32_t count_leaves(const Patches *p, uint32_t node)
{
    if (!(node & PATCH_DIVIDED))
        return p->parted_count > 0 && (node & PATCH_PARTED) != 0
             ? p->parted[node & ~PATCH_PARTED].parts : 1;
    uint32_t count = 0;
    for (uint32_t q = 0; q < 4; q++)
        count += count_leaves(p, p->tree[(node & ~PATCH_DIVIDED) + q]);
    return count;
}

uint32_t patches_side_cells(const Patches *p, const Surfaces *s, uint32_t surface, unsigned side)
{
    const uint32_t base = patches_base_count(p, s, surface);
    const uint32_t first = p->tree_first[side][surface];
    uint32_t count = 0;
    if (first == PATCH_NONE)
        return base;
    for (uint32_t k = 0; k < base; k++)
        count += count_leaves(p, p->tree[first + k]);
    return count;
}

static void fill_leaves(const uint32_t *tree, uint32_t node, bool triangle, PatchCell at,
                        PatchCell *cell)
{
    if (!(node & PATCH_DIVIDED)) {
        cell[node] = at;
        return;
    }
    for (uint32_t q = 0; q < 4; q++)
        fill_leaves(tree, tree[(node & ~PATCH_DIVIDED) + q], triangle,
                    patches_cell_child(triangle, at, q), cell);
}

void patches_fill_cells(const Patches *p, const Surfaces *s, uint32_t surface, unsigned side,
                        PatchCell *cell)
{
    const bool triangle = s->surface[surface].kind == SURFACE_TRIANGLE;
    const uint32_t nu = p->nu[surface], base = patches_base_count(p, s, surface);
    const uint32_t first = p->tree_first[side][surface];
    for (uint32_t k = 0; k < base; k++) {
        const PatchCell at = patches_base_cell(triangle, nu, k);
        if (first == PATCH_NONE)
            cell[k] = at;
        else
            fill_leaves(p->tree, p->tree[first + k], triangle, at, cell);
    }
}

/* --- along an edge ---------------------------------------------------------------------------- */

typedef struct {
    const uint32_t *tree;
    const uint8_t  *quarter;   /* the two that lie on the edge, in its direction */
    PatchMark       mark;
    void           *context;
    uint32_t        end;
} EdgeWalk;

static bool walk_edge(EdgeWalk *walk, uint32_t node, uint32_t length)
{
    if (node & PATCH_DIVIDED) {
        const uint32_t *quarter = walk->tree + (node & ~PATCH_DIVIDED);
        return walk_edge(walk, quarter[walk->quarter[0]], length / 2)
            && walk_edge(walk, quarter[walk->quarter[1]], length / 2);
    }
    walk->end += length;
    return walk->mark(walk->context, walk->end, length);
}

bool patches_edge_marks(const Patches *p, const Surfaces *s, uint32_t surface, unsigned side,
                        unsigned k, PatchMark mark, void *context)
{
    static const uint8_t quads[4][2] = { { 0, 1 }, { 1, 3 }, { 3, 2 }, { 2, 0 } };
    static const uint8_t triangles[3][2] = { { 0, 1 }, { 1, 2 }, { 2, 0 } };
    const bool triangle = s->surface[surface].kind == SURFACE_TRIANGLE;
    assert(k < (triangle ? 3 : 4));
    const uint32_t nu = p->nu[surface], nv = p->nv[surface];
    const uint32_t n = patches_edge_divisions(p, surface, k);
    const uint32_t first = p->tree_first[side][surface];
    EdgeWalk walk = { .tree = p->tree, .quarter = triangle ? triangles[k] : quads[k],
                      .mark = mark, .context = context };
    for (uint32_t m = 0; m < n; m++) {
        const PatchCell cell = patches_edge_cell(triangle, nu, nv, k, m, 0);
        const uint32_t node = first == PATCH_NONE
                            ? 0 : p->tree[first + patches_base_index(triangle, nu, cell)];
        if (!walk_edge(&walk, node, 1u << PATCH_LEVELS))
            return false;
    }
    return true;
}
