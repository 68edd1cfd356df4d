/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/polygons.h -- what a scene file gives: the polygon soup, the master copy of the geometry.
 *
 * Nothing here is welded, repaired or dropped. Every later thing (triangle, surface, patch) can say
 * which polygon or shape it came from.
 * Units    scene units; right-handed; a polygon's front is where its corners run counter-clockwise.
 */
#ifndef MESH_POLYGONS_H
#define MESH_POLYGONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "math/rgb.h"
#include "math/shape.h"
#include "math/tolerance.h"
#include "math/vec3.h"

typedef struct {
    char  *name;           /* "" when the file gives none; owned */
    Rgb    reflectance;    /* diffuse, 0 <= rho < 1 per band */
    Rgb    emission;       /* emitted radiance L, cd/m2; exitance is pi L */
    Rgb    specular;       /* mirror-like or glossy reflectance, 0..1 */
    double exponent;       /* Phong exponent of the specular part; INFINITY: mirror; 0: none */
    double roughness;      /* 0..1: > 0: the specular part is of microfacets, alpha = roughness^2
                              (render/gloss.h), where the exponent is finite */
    Rgb    transmittance;  /* of a clear pane or body per crossing, 0: opaque */
    Rgb    scattered;      /* diffuse transmittance, kept as read; no solver uses it yet */
    double ior;            /* index of refraction, 1: none */
    double importance;     /* MSD's IMPORTANCE, default 1 */
    bool   emits_both;     /* emission leaves both sides (a file may say so) */
    uint32_t texture;      /* 0: none; else 1 + the scene's image whose colours multiply the
                              reflectance (scenes/texture.h) */
    bool   cut_out;        /* where that image is less than half opaque, nothing is there */
} Material;

typedef struct {
    uint32_t material, group;
    Shape    shape;
} ShapeFace;

typedef struct {
    /* polygons */
    Vec3     *position;      /* [vertex_count] */
    uint32_t *first;         /* [polygon_count + 1]  polygon i has first[i] .. first[i+1]-1 */
    uint32_t *corner;        /* [first[polygon_count]]  index into position */
    uint32_t *material;      /* [polygon_count]  index into materials */
    uint32_t *group;         /* [polygon_count]  index into group_name */
    const uint32_t *origin;  /* NULL, or [polygon_count]  where a polygon is a piece of one that was
                                cut: its number before; borrowed */
    size_t    origin_first;  /* with origin: so many polygons are first pieces, the others follow */
    uint8_t  *contact;       /* NULL, or [first[polygon_count]]  1: another face stands on the edge
                                from this corner to the next (inspect/imprint.h), and the faces at
                                either side are never made one */
    float    *normal;        /* [3 * normal_count]  unit normals by corner, as the file gives them
                                for shading; 0 0 0: none; corners from normal_count on have none */
    size_t    normal_count, normal_capacity;
    double    grain;         /* what positions are known to, when that is coarser than their size
                                says: they were floats far from the origin; else 0 */
    size_t    vertex_count, polygon_count;
    size_t    vertex_capacity, corner_capacity, polygon_capacity;   /* of the arrays above */
    /* exact curved faces */
    ShapeFace *shape;        /* [shape_count] */
    size_t     shape_count, shape_capacity;
    /* what they refer to */
    Material *materials;     /* [material_count] */
    size_t    material_count, material_capacity;
    char    **group_name;    /* [group_count]  unique names */
    size_t    group_count, group_capacity;
    uint32_t *group_slot;    /* [group_slots]  hash table of group_hashed names, 0: free */
    size_t    group_slots, group_hashed;
} Polygons;

/* An empty soup is { 0 }. All adders: false and ERROR_MEMORY (or ERROR_INPUT over 2^32 items);
 * the soup stays valid. */
bool polygons_add_vertex(Polygons *soup, Vec3 p, uint32_t *index, Error *err);
/* count >= 3 corners; corners, material and group must exist (asserted). */
bool polygons_add_polygon(Polygons *soup, const uint32_t *corners, size_t count, uint32_t material,
                          uint32_t group, Error *err);
/* Gives a polygon normals at its corners, of any length; those without one, as 0 0 0 and what is
 * not finite, have none. */
bool polygons_set_normals(Polygons *soup, uint32_t polygon, const Vec3 *normal, Error *err);
/* Those that a polygon of as many corners has in `from`. */
bool polygons_copy_normals(Polygons *soup, uint32_t polygon, const Polygons *from, uint32_t other,
                           Error *err);
bool polygons_add_shape(Polygons *soup, const Shape *shape, uint32_t material, uint32_t group,
                        Error *err);
/* Copies *material and its name (NULL: ""). A default material: material_default(). */
bool polygons_add_material(Polygons *soup, const Material *material, uint32_t *index, Error *err);
/* Finds the group of that name or adds it. "" becomes "default". */
bool polygons_add_group(Polygons *soup, const char *name, uint32_t *index, Error *err);

/* Copies everything of `other` with its positions and shapes mapped; faces keep their outside when
 * the map mirrors. material (an index of soup) and group replace those of other's faces; with
 * UINT32_MAX other's own are added. The map must have an inverse (else ERROR_INPUT). On failure
 * part of it may have been added. */
bool polygons_append(Polygons *soup, const Polygons *other, const Affine *map, uint32_t material,
                     uint32_t group, Error *err);

/* Grey 0.5, nothing else. */
Material material_default(void);

/* Most corners of a polygon whose normals are used: those that bend have few, and each place costs
 * as many steps. */
enum { POLYGON_SHADED_MOST = 64 };

/* Unit normal that the file gives a polygon at `point` in it: between its corners' linear on
 * triangles, by mean value coordinates on others [floater03]. false: it gives none. */
bool polygons_normal_at(const Polygons *soup, uint32_t polygon, Vec3 point, Vec3 *normal);

/* How far apart two positions may be that mean one point (math/tolerance.h), of faces that reach
 * out to `largest`. */
static inline double polygons_tolerance(const Polygons *soup, double largest)
{
    return fmax(position_tolerance(largest), soup->grain);
}

/* Box around everything, shapes included; false when there is nothing finite. */
bool polygons_bounds(const Polygons *soup, Vec3 *lo, Vec3 *hi);

/* Invariants: indices in range, first[] rising by at least 3, 0 <= reflectance < 1, emission finite
 * and >= 0, normals of length 1 or 0. */
bool polygons_check(const Polygons *soup);

/* Frees everything inside, leaves { 0 }. */
void polygons_clear(Polygons *soup);

#endif
