/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/patches.h -- surfaces cut into patches: the flat arrays that solvers work on.
 *
 * Each side of a surface that is in use (front 0, back 1) has patches of its own. Large surfaces
 * are cut on a grid: quads and shapes nu x nv cells of (s,t), triangles n x n congruent ones
 * (nu = nv = n); cells are divided further by quadtrees where light changes, each side on its own.
 * Where triangles are much smaller than the patch size, neighbours with like normals and the same
 * material make up one patch, small ones of several parts as well: its pieces, each a whole surface
 * (nu = nv = 1).
 *
 *   quad, shape   cell (i, j) of (nu << level) x (nv << level)
 *   triangle      cell (i, j, upper) of n << level: corners (i,j) (i+1,j) (i,j+1), or when upper
 *                 (i+1,j+1) (i,j+1) (i+1,j)
 *   divided       (i, j) of a quad into (2i,2j) (2i+1,2j) (2i,2j+1) (2i+1,2j+1); a lower triangle
 *                 into (2i,2j) (2i+1,2j) (2i,2j+1) and upper (2i,2j); an upper one into upper
 *                 (2i+1,2j) (2i,2j+1) (2i+1,2j+1) and lower (2i+1,2j+1); in that order
 *
 * A cell that other surfaces part (mesh/slicers.h) is several patches, its parts: those of its
 * places that lie on the same sides of all that part it. Places within rounding of what parts a
 * cell belong to no patch.
 *
 * Cells of one side of one surface are numbered in a row, base cells in the order
 *   quad, shape   j * nu + i
 *   triangle      n^2 - (n-j)^2 + 2 i + upper
 * and a divided one gives way to its quarters, a parted one to its parts, which need not follow
 * each other. Cell or part c there is patch first + c and face first_face + c; a piece of a merged
 * patch is cell 0.
 *
 * Faces are what is drawn and written: polygons between vertices, one per cell. Vertices carry
 * values (radiosity is smoothed to them): faces that continue each other smoothly on the same side
 * with the same material share them; at creases and material borders there are several vertices at
 * one position, bit for bit equal, so that the mesh has no crack. A face has its 3 or 4 corners,
 * and between them vertices of finer neighbours on its edges (T-vertices are built in).
 * Units    scene units.
 * Threads  never changes once made.
 */
#ifndef MESH_PATCHES_H
#define MESH_PATCHES_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "base/monitor.h"
#include "mesh/surfaces.h"

#define PATCH_NONE UINT32_MAX
#define PATCH_DIVIDED 0x80000000u
#define PATCH_PARTED 0x40000000u

enum {
    PATCH_LEVELS = 12,  /* times a base cell can be quartered */
    PATCH_WEIGHTS = 12  /* most vertices that patches_interpolate gives */
};

typedef struct {
    double   size;         /* greatest wanted patch edge, scene units; 0: from `wanted` */
    uint32_t wanted;       /* total number of patches aimed at; 0: 10,000 */
    const uint8_t *sides;  /* [surfaces->count]  bit 0: front in use, bit 1: back; NULL: both */
    const uint8_t *emitting; /* [surfaces->count]  the same for the sides that emit: pieces of a
                              merged patch agree in it; NULL: none emits */
    /* whether light can go from just above a to just above b (points of small surfaces, the normals
     * out of their sides) without passing anything: then both may be pieces of one merged patch.
     * NULL: only neighbours are merged */
    bool   (*joined)(const void *context, const SurfacePoint *a, const SurfacePoint *b);
    const void *joined_context;
    bool     separate;     /* small triangles stay patches of their own, however many that makes */
} PatchOptions;

/* Which cell of its surface's side a patch is; all 0 for a merged patch. */
typedef struct {
    uint32_t i, j;
    uint8_t  upper, level;
} PatchCell;

/* A cell that is parted. */
typedef struct {
    uint32_t first_slicer; /* index into Patches.part_slicer */
    uint32_t first_part;   /* index into Patches.part */
    uint16_t slicers, parts;
} PatchParted;

/* One part of a cell; in the cell's square [0,1]^2, which triangles fold up, it lies within
 * a0..a1, b0..b1. */
typedef struct {
    uint32_t patch;
    uint32_t parted;       /* index into Patches.parted */
    uint32_t signs;        /* as slicer_signs gives them */
    float    a0, a1, b0, b1;
    double   s, t;         /* a place that belongs to it */
    double   share;        /* of the square */
} PatchPart;

typedef struct {
    uint32_t  count;
    uint32_t *surface;     /* [count]  of a merged patch: that of its first piece */
    uint8_t  *side;        /* [count]  0 front, 1 back */
    PatchCell *cell;       /* [count] */
    uint32_t *material;    /* [count] */
    uint32_t *group;       /* [count] */
    double   *area;        /* [count]  > 0; exact on shapes */
    Vec3     *centre;      /* [count]  on the surface; of a merged patch: on one of its pieces */
    Vec3     *normal;      /* [count]  unit, out of the patch's side, at the centre; of a merged
                              patch: the mean */
    /* merged patches: several pieces each; all other patches have none here */
    uint32_t *first_piece; /* [count + 1] */
    uint32_t *piece;       /* [first_piece[count]]  surfaces, same side as the patch */
    double   *piece_end;   /* [first_piece[count]]  share of the patch's area up to and with it */
    /* faces: of patch i, face_of[i] and, when merged, one per piece from there on */
    uint32_t  face_count;
    uint32_t *face_of;     /* [count] */
    uint32_t *face_patch;  /* [face_count] */
    uint32_t *first_corner;/* [face_count + 1] */
    uint32_t *corner;      /* [first_corner[face_count]]  vertices, counter-clockwise from its side,
                              from the cell's own corner 0 on */
    double   *corner_along;/* [first_corner[face_count]]  where each lies on its cell's outline: k +
                              the fraction of the way from the cell's corner k to the next */
    uint32_t  vertex_count;
    Vec3     *position;    /* [vertex_count] */
    /* per surface and side */
    uint32_t  surface_count;
    uint32_t *first[2];    /* [surface_count]  patch of cell 0; PATCH_NONE: side not in use */
    uint32_t *first_face[2]; /* [surface_count]  face of cell 0 */
    uint16_t *nu, *nv;     /* [surface_count]  base divisions; triangles: nu = nv */
    /* quadtrees: tree[tree_first[side][surface] + base cell] is a cell's number, or, with
     * PATCH_DIVIDED set, where in tree its four quarters stand, or, with PATCH_PARTED set where
     * parted_count > 0, an index into parted; tree_first is PATCH_NONE where nothing is divided nor
     * parted */
    uint32_t *tree_first[2]; /* [surface_count] */
    uint32_t *tree;        /* [tree_count] */
    uint32_t  tree_count;
    uint32_t  parted_count;
    PatchParted *parted;   /* [parted_count] */
    uint32_t *part_slicer; /* indices into surfaces->slicer */
    uint32_t  part_count;
    PatchPart *part;       /* [part_count] */
    uint32_t *part_of;     /* [count]  the part that a patch is, or PATCH_NONE; NULL without any */
    double    size;        /* the patch edge that was used */
    double    total_area;
} Patches;

/* owns   the caller frees with patches_destroy.
 * fails  NULL; ERROR_MEMORY; ERROR_INPUT when more than 2^31 patches would be made. */
Patches *patches_create(const Surfaces *surfaces, const PatchOptions *options,
                        const Monitor *monitor, Error *err);
Patches *patches_destroy(Patches *patches);

/* The same patches but for those with split[i] != 0: cells in four, merged patches in two or more
 * by place. Others are split as well where a neighbour over a smooth edge would be finer by more
 * than one level. Order is kept: parent[k], [new count], the old patch that new patch k is (part
 * of), never falls. Patches at their last level stay whole.
 * owns   the caller frees both, *parent with array_free.
 * fails  NULL; ERROR_MEMORY; ERROR_INPUT as above. */
Patches *patches_split(const Patches *patches, const Surfaces *surfaces, const uint8_t *split,
                       uint32_t **parent, Error *err);

/* Patch at (s, t) of a surface's side, or PATCH_NONE when that side is not in use or the place lies
 * within rounding of what parts its cell. s and t may be off [0,1] by rounding.
 * hot    checks nothing in release builds. */
uint32_t patches_at(const Patches *patches, const Surfaces *surfaces, uint32_t surface,
                    unsigned side, double s, double t);

/* A point of patch i for (a, b) in [0,1)^2, with the (s, t) it lies at. On shapes and bent quads
 * points are not area-uniform: weight them by density * (range of (s,t)) / area.
 * `weight` gets that factor; its mean over (a, b) is 1. On a part of a cell points are shifted
 * until they lie in it. On a merged patch `a` chooses the piece, by
 * area, and what the choice leaves of it goes on. normal points out of the patch's side. */
typedef struct {
    SurfacePoint point;
    uint32_t     surface;  /* one of the pieces when the patch is merged */
    double       s, t;
    double       weight;
} PatchPoint;
void patches_point(const Patches *patches, const Surfaces *surfaces, uint32_t patch, double a,
                   double b, PatchPoint *out);

/* PatchPoint.weight at (s, t) of a surface whose patch there is `patch`. */
double patches_weight(const Patches *patches, const Surfaces *surfaces, uint32_t patch,
                      uint32_t surface, double s, double t);

/* Longest edge of the cell, or for a merged patch the root of its area. */
double patches_extent(const Patches *patches, const Surfaces *surfaces, uint32_t patch);

/* Vertices and weights (sum 1) that interpolate vertex values at (s, t) of a surface's side;
 * returns how many, 0 for an unused side or a place of no patch. Continuous over all smooth edges,
 * linear between neighbouring vertices along an edge, T-vertices included (a Coons patch [coons67];
 * without T-vertices bilinear, on triangles linear); exact for linear functions on flat
 * parallelograms and triangles. Weights can be a little negative beside T-vertices. On parts of
 * cells, values of corners that belong to another part are replaced by one of their own. */
int patches_interpolate(const Patches *patches, const Surfaces *surfaces, uint32_t surface,
                        unsigned side, double s, double t, uint32_t vertex[PATCH_WEIGHTS],
                        double weight[PATCH_WEIGHTS]);

/* Invariants: areas positive, sum over sides = area of the surface's sides in use, indices in
 * range, each patch found again by patches_at at points of it, faces closed. */
bool patches_check(const Patches *patches, const Surfaces *surfaces);

#endif
