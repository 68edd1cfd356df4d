/* SPDX-License-Identifier: BSD-3-Clause */
/* Surfaces much smaller than a patch are put together: which ones may be, and the order of steps.
 *
 * Regions grow over neighbours with like normals and are relaxed as in variational shape
 * approximation [cohen-steiner04].
 *
 * A patch has one radiosity, so light that reached one piece would leave from all: no wall may
 * stand between them. Neighbours over an edge are safe where no third surface has the edge and both
 * look the same way. Over the edge of a box there may be a slab that it stands on, and across a gap
 * a wall: what is left over is joined across gaps only where the caller finds a way through the
 * air.
 */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "mesh/patches_merge.h"

/* Larger surfaces are cells of a grid: two of them are a cluster, so less than half of one. */
static const double PIECE_AREA_MOST = 0.5;

/* Longer ones as well: cells of theirs are cheaper than a patch that long is wrong. Most triangles
 * of the area above are much shorter; needles are not. */
static const double PIECE_EDGE_MOST = 4;

typedef struct {
    Merge         *merge;
    const PatchOptions *options;
    double         size;
    unsigned       side;
    const uint8_t *shared;     /* [surfaces->count]  of merge_shared_edges */
    uint64_t      *kind;       /* [kind_count]  rising: what pieces must agree in */
    uint32_t       kind_count;
    Error         *err;
} MergeSetup;

/* Corners a b c d; a triangle has d = a. */
static void surface_corners(const Surfaces *s, const Surface *f, Vec3 p[4])
{
    const uint32_t *c = s->corner + 3 * (size_t)f->primitive;
    for (int k = 0; k < 3; k++)
        p[k] = s->position[c[k]];
    p[3] = s->position[f->kind == SURFACE_QUAD ? c[5] : c[0]];
}

static bool has_short_edges(const Vec3 p[4], double most)
{
    for (int k = 0; k < 4; k++) {
        const Vec3 edge = vec3_sub(p[(k + 1) % 4], p[k]);
        if (!(vec3_dot(edge, edge) < most * most))
            return false;
    }
    return true;
}

/* Fills *out but for class and next; false when the surface is none of the small ones. */
static bool make_piece(const MergeSetup *setup, uint32_t surface, MergePiece *out)
{
    const Surfaces *s = setup->merge->surfaces;
    const Surface *f = &s->surface[surface];
    const double size = setup->size;
    Vec3 p[4];
    const uint32_t *cut = s->cut_first; /* what others part is divided, not merged */
    if (f->kind == SURFACE_SHAPE || (cut != NULL && cut[surface + 1] > cut[surface])
        || !(f->area > 0 && f->area < PIECE_AREA_MOST * size * size))
        return false;
    surface_corners(s, f, p);
    if (!has_short_edges(p, PIECE_EDGE_MOST * size))
        return false;
    const Vec3 diagonal = vec3_sub(p[2], p[0]);
    const Vec3 half[2] = { vec3_cross(vec3_sub(p[1], p[0]), diagonal),
                           vec3_cross(diagonal, vec3_sub(p[3], p[0])) };
    const double area[2] = { vec3_length(half[0]), vec3_length(half[1]) };
    const double share = area[1] / (area[0] + area[1]);
    const Vec3 third = vec3_lerp(p[1], p[3], share);
    const Vec3 middle = vec3_scale(vec3_add(third, vec3_add(p[0], p[2])), 1.0 / 3);
    const Vec3 n = vec3_scale(vec3_unit(vec3_add(half[0], half[1])), setup->side == 0 ? 1 : -1);
    const Vec3 lo = vec3_min(vec3_min(p[0], p[1]), vec3_min(p[2], p[3]));
    const Vec3 hi = vec3_max(vec3_max(p[0], p[1]), vec3_max(p[2], p[3]));
    for (int k = 0; k < MERGE_PLACE; k++) {
        const double least = vec3_axis(s->lo, k);
        out->at[k] = (float)((vec3_axis(middle, k) - least) / size);
        out->lo[k] = (float)((vec3_axis(lo, k) - least) / size);
        out->hi[k] = (float)((vec3_axis(hi, k) - least) / size);
        out->at[MERGE_PLACE + k] = (float)vec3_axis(n, k);
    }
    out->area = (float)(f->area / (size * size));
    out->surface = surface;
    return out->area > 0; /* 0: too small for a float beside the patch size */
}

static uint64_t piece_kind(const MergeSetup *setup, uint32_t surface)
{
    const Surfaces *s = setup->merge->surfaces;
    return (uint64_t)surfaces_material(s, surface, setup->side) << 32
         | surfaces_group(s, surface, setup->side);
}

static uint32_t kind_find(const MergeSetup *setup, uint64_t kind)
{
    uint32_t lo = 0, hi = setup->kind_count - 1;
    while (lo < hi) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (setup->kind[middle] < kind)
            lo = middle + 1;
        else
            hi = middle;
    }
    assert(setup->kind[lo] == kind);
    return lo;
}

/* Numbers the kinds in use and gives each piece its class. */
static bool make_classes(MergeSetup *setup)
{
    Merge *m = setup->merge;
    const uint8_t *emitting = setup->options->emitting;
    setup->kind = array_create(m->count, sizeof *setup->kind, "patch pieces", setup->err);
    if (setup->kind == NULL)
        return false;
    uint32_t runs = 0;
    for (uint32_t i = 0; i < m->count; i++) {
        const uint64_t kind = piece_kind(setup, m->piece[i].surface);
        if (runs == 0 || setup->kind[runs - 1] != kind)
            setup->kind[runs++] = kind;
    }
    edges_sort_keys(setup->kind, runs);
    for (uint32_t i = 0; i < runs; i++)
        if (i == 0 || setup->kind[i] != setup->kind[setup->kind_count - 1])
            setup->kind[setup->kind_count++] = setup->kind[i];
    for (uint32_t i = 0; i < m->count; i++) {
        const uint32_t surface = m->piece[i].surface;
        const bool emits = emitting != NULL && (emitting[surface] >> setup->side & 1) != 0;
        m->piece[i].class = 2 * kind_find(setup, piece_kind(setup, surface)) + emits;
    }
    setup->kind = array_free(setup->kind);
    return true;
}

static void link_pieces(const MergeSetup *setup)
{
    Merge *m = setup->merge;
    for (uint32_t i = 0; i < m->count; i++) {
        MergePiece *piece = &m->piece[i];
        const Surface *f = &m->surfaces->surface[piece->surface];
        for (unsigned k = 0; k < 4; k++) {
            const bool open = k < patches_corners(f) && !(setup->shared[piece->surface] >> k & 1);
            const uint32_t other = open ? f->neighbour[k] : SURFACE_NONE;
            const uint32_t j = other == SURFACE_NONE ? MERGE_NONE : m->local[other];
            piece->next[k] = j != MERGE_NONE && m->piece[j].class == piece->class ? j : MERGE_NONE;
        }
    }
}

static bool make_pieces(MergeSetup *setup)
{
    Merge *m = setup->merge;
    for (uint32_t i = 0; i < m->surfaces->count; i++) {
        m->local[i] = MERGE_NONE;
        if (merge_side_used(m, i) && make_piece(setup, i, &m->piece[m->count]))
            m->local[i] = m->count++;
    }
    if (!make_classes(setup))
        return false;
    link_pieces(setup);
    return true;
}

static void merge_clear(Merge *m)
{
    array_free(m->piece);
    array_free(m->local);
    array_free(m->cluster_of);
    array_free(m->cluster);
}

/* Clusters of one side: writes their numbers, from `base` on, as they come. */
static bool merge_side(MergeSetup *setup, const Surfaces *surfaces, uint32_t *cluster,
                       uint32_t *base)
{
    Merge m = { .surfaces = surfaces, .sides = setup->options->sides, .side = setup->side };
    const uint32_t count = surfaces->count;
    setup->merge = &m;
    setup->kind_count = 0;
    m.piece = array_create(count, sizeof *m.piece, "patch pieces", setup->err);
    m.local = array_create(count, sizeof *m.local, "patch pieces", setup->err);
    m.cluster_of = array_create(count, sizeof *m.cluster_of, "patch pieces", setup->err);
    m.cluster = array_create(count, sizeof *m.cluster, "patch pieces", setup->err);
    if (!error_is_set(setup->err) && make_pieces(setup) && merge_grow(&m, setup->err)
        && merge_relax(&m, setup->err) && merge_join(&m, setup->options, setup->err)) {
        for (uint32_t i = 0; i < m.count; i++)
            cluster[2 * (size_t)m.piece[i].surface + setup->side] = *base + m.cluster_of[i];
        *base += m.cluster_count;
    }
    merge_clear(&m);
    return !error_is_set(setup->err);
}

/* Clusters get their final numbers; one piece alone is none. */
static bool number_clusters(uint32_t *cluster, uint32_t count, uint32_t raw, uint32_t *numbered,
                            Error *err)
{
    uint32_t *number = array_create(raw, sizeof *number, "patch pieces", err);
    if (number == NULL)
        return false;
    for (uint32_t i = 0; i < count; i++)
        if (cluster[i] != PATCH_NONE)
            number[cluster[i]]++;
    for (uint32_t c = 0; c < raw; c++)
        number[c] = number[c] >= 2 ? MERGE_NONE - 1 : PATCH_NONE;
    *numbered = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (cluster[i] == PATCH_NONE)
            continue;
        uint32_t *n = &number[cluster[i]];
        if (*n == MERGE_NONE - 1)
            *n = (*numbered)++;
        cluster[i] = *n;
    }
    array_free(number);
    return true;
}

bool merge_small(const Surfaces *surfaces, const PatchOptions *options, double size,
                 uint32_t *cluster, uint32_t *cluster_count, Error *err)
{
    assert(surfaces != NULL && options != NULL && cluster != NULL && cluster_count != NULL);
    assert(err != NULL && size > 0);
    const uint32_t nodes = 2 * surfaces->count;
    uint32_t raw = 0;
    *cluster_count = 0;
    for (uint32_t i = 0; i < nodes; i++)
        cluster[i] = PATCH_NONE;
    uint8_t *shared = array_create(surfaces->count, sizeof *shared, "patch edges", err);
    bool ok = shared != NULL && merge_shared_edges(surfaces, shared, err);
    for (unsigned side = 0; ok && side < 2; side++) {
        MergeSetup setup = { .options = options, .size = size, .side = side, .shared = shared,
                             .err = err };
        ok = merge_side(&setup, surfaces, cluster, &raw);
    }
    array_free(shared);
    return ok && number_clusters(cluster, nodes, raw, cluster_count, err);
}
