/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/surfaces.h -- the soup made connected: what rays meet and what is cut into patches.
 *
 * A surface is a piece with parameters (s, t) in [0,1]^2 (triangles: s + t <= 1):
 *   TRIANGLE  one triangle: s, t are the weights of its corners 1 and 2
 *   QUAD      two triangles (a,b,c), (a,c,d) that share a diagonal; (s,t) is linear on each of
 *             them: a (0,0), b (1,0), c (1,1), d (0,1). A parallelogram is exactly affine.
 *   SHAPE     an exact curved face with the parameters of math/shape.h
 *
 * Primitives are what a ray can hit: triangles first, then shapes; primitive k >= triangle_count is
 * shape k - triangle_count. A hit's (primitive, u, v) gives (surface, s, t).
 *
 * Made from the soup: positions are welded, polygons (concave, any number of corners) are cut into
 * triangles, triangles that form a planar parallelogram become one quad again, half-edges are built
 * by OpenMesh; faces it refuses keep their place with vertices of their own. Repaired on the way,
 * unless switched off: duplicates merged, T-junctions stitched, edges of more than two triangles
 * split, windings of a part made to agree.
 * Units    scene units.
 * Threads  never changes once made.
 */
#ifndef MESH_SURFACES_H
#define MESH_SURFACES_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "base/monitor.h"
#include "mesh/defects.h"
#include "mesh/polygons.h"

#define SURFACE_NONE UINT32_MAX

typedef enum { SURFACE_TRIANGLE, SURFACE_QUAD, SURFACE_SHAPE } SurfaceKind;

typedef struct {
    SurfaceKind kind;
    uint32_t    primitive;  /* first primitive: a quad's second triangle is primitive + 1 */
    uint32_t    face;       /* polygon it came from; for a shape: polygon_count + shape index */
    uint32_t    back;       /* polygon that lies on it the other way round and so is its other
                               side, as in thin plates made of two faces; or SURFACE_NONE */
    uint32_t    material, group;
    uint32_t    back_material, back_group; /* those of `back`; without it the same as the front's */
    double      area;
    /* neighbour over edge k (triangle: edges 01 12 20; quad: ab bc cd da; shape: none), or
     * SURFACE_NONE at a rim or refused edge; of an edge with stitches: over its first piece */
    uint32_t    neighbour[4];
} Surface;

/* A corner of another face that lies on an edge of a surface, inside it: a T-junction, stitched. */
typedef struct {
    uint32_t vertex;        /* index into position */
    uint32_t neighbour;     /* over the piece of the edge from here to the next stitch or corner, or
                               SURFACE_NONE */
    double   fraction;      /* of the way along the edge, 0 < fraction < 1 */
} Stitch;

/* Another surface by whose side places of one are told apart (mesh/slicers.h). */
typedef struct Slicer Slicer;

/* What was found and done while connecting; all are counts. */
typedef struct {
    uint32_t welded;        /* vertices that fell together with an earlier one */
    uint32_t duplicate;     /* faces with the corners of an earlier one, wound like it or like the
                               one that is its back already: left out */
    uint32_t degenerate;    /* triangles without area: left out */
    uint32_t nonmanifold;   /* triangles at an edge that has two already: kept, linked at most to
                               others of that edge */
    uint32_t flipped;       /* faces turned round to agree with their neighbours */
    uint32_t stitched;      /* corners of other faces let into edges they lie on */
    uint32_t refused;       /* triangles the half-edge mesh would not take still: kept, unlinked */
} Repairs;

typedef struct {
    Surface  *surface;            /* [count] */
    uint32_t  count;
    Vec3     *position;           /* [vertex_count]  welded */
    uint32_t  vertex_count;
    uint32_t *corner;             /* [3 * triangle_count]  index into position */
    uint32_t *triangle_surface;   /* [triangle_count] */
    /* polygon each triangle is of, and the one that is its other side or SURFACE_NONE; the two
     * halves of a quad may come from different ones */
    uint32_t *triangle_face, *triangle_back; /* [triangle_count] */
    uint32_t  triangle_count;
    /* edge k of surface i has stitches stitch_first[4 i + k] .. stitch_first[4 i + k + 1] - 1,
     * fractions rising from its corner k; stitch_first is NULL when nothing was stitched */
    uint32_t *stitch_first;       /* [4 * count + 1] */
    Stitch   *stitch;
    Shape    *shape;              /* [shape_count] */
    uint32_t *shape_surface;      /* [shape_count] */
    uint32_t  shape_count;
    Vec3      lo, hi;             /* bounds */
    double    largest_coordinate; /* max |coordinate|, for ray_offset */
    uint32_t *part;               /* [count]  number of the connected part a surface belongs to */
    uint32_t  part_count;
    /* [part_count]  1: no rim; every edge has a face at either side or an even number of faces,
     * plates count as two; of the shapes spheres and tori */
    uint8_t  *part_closed;
    bool      closed;             /* all parts are closed */
    /* surfaces that curved ones meet, found by imprint_curved: those that part surface i are
     * slicer[cut[k]], k = cut_first[i] .. cut_first[i + 1] - 1; cut_first is NULL without any */
    uint32_t *cut_first;          /* [count + 1] */
    uint32_t *cut;                /* [cut_first[count]] */
    Slicer   *slicer;             /* [slicer_count] */
    uint32_t  slicer_count;
    Repairs   repairs;
} Surfaces;

/* What is not to be repaired; { 0 } repairs everything. */
typedef struct {
    bool   keep_apart;      /* no welding: only bit for bit equal positions are one vertex */
    double weld;            /* > 0: welding distance in scene units, instead of the derived ones */
    bool   keep_duplicates; /* faces that lie exactly on an earlier one stay */
    bool   keep_junctions;  /* T-junctions stay open */
    bool   keep_nonmanifold;/* triangles at an edge of more than two are linked to nobody there */
    bool   keep_winding;    /* fronts stay as in the file */
} SurfaceOptions;

/* options  NULL: everything is repaired.
 * defects  NULL, or gets whatever was found and what was done about it, face by face.
 * owns     the caller frees with surfaces_destroy; the soup is copied, not kept.
 * fails    NULL; ERROR_MEMORY, or ERROR_INPUT when nothing with area is left. */
Surfaces *surfaces_repair(const Polygons *soup, const SurfaceOptions *options, Defects *defects,
                          const Monitor *monitor, Error *err);
/* The same without options and list. */
Surfaces *surfaces_create(const Polygons *soup, const Monitor *monitor, Error *err);
Surfaces *surfaces_destroy(Surfaces *surfaces);

static inline uint32_t surfaces_primitive_count(const Surfaces *s)
{
    return s->triangle_count + s->shape_count;
}
static inline uint32_t surfaces_of_primitive(const Surfaces *s, uint32_t primitive)
{
    return primitive < s->triangle_count ? s->triangle_surface[primitive]
                                         : s->shape_surface[primitive - s->triangle_count];
}

/* What a side (0 front, 1 back) is made of. */
static inline uint32_t surfaces_material(const Surfaces *s, uint32_t surface, unsigned side)
{
    return side == 0 ? s->surface[surface].material : s->surface[surface].back_material;
}
static inline uint32_t surfaces_group(const Surfaces *s, uint32_t surface, unsigned side)
{
    return side == 0 ? s->surface[surface].group : s->surface[surface].back_group;
}

/* (s, t) of a hit, from a primitive and the hit's u, v (triangle: weights of corners 1 and 2). */
void surfaces_parameters(const Surfaces *surfaces, uint32_t primitive, double u, double v,
                         double *s, double *t);
/* Point, unit front normal, and area per unit of (s,t) at (s, t). `primitive` may be NULL. */
typedef struct {
    Vec3     point, normal;
    double   density;
    uint32_t primitive; /* the one that holds the point: rays leaving it need not meet it again */
} SurfacePoint;
void surfaces_point(const Surfaces *surfaces, uint32_t surface, double s, double t,
                    SurfacePoint *out);
/* Its point and normal alone, bit for bit: sooner on shapes. */
void surfaces_place(const Surfaces *surfaces, uint32_t surface, double s, double t, Vec3 *point,
                    Vec3 *normal);
/* Unit front normal of a primitive at a hit. */
Vec3 surfaces_normal(const Surfaces *surfaces, uint32_t primitive, double u, double v);

/* Invariants: indices in range, areas positive and adding up to the triangles' and shapes' areas,
 * neighbours mutual, stitches on their edges in order. */
bool surfaces_check(const Surfaces *surfaces);

#endif
