/* SPDX-License-Identifier: BSD-3-Clause */
/* Materials with images. */
#include "radiosity/places.h"

#include <assert.h>
#include <math.h>

#include "math/tolerance.h"

/* Where an image is less opaque, nothing is there. */
static const double OPAQUE_LEAST = 0.5;

static Rgb limited(Rgb c)
{
    const double most = TOLERANCE_REFLECTANCE_MAX;
    return rgb(fmin(c.r, most), fmin(c.g, most), fmin(c.b, most));
}

/* The place of a side in its image; NULL: it has none. A plate's back may be a face of its own. */
static const FaceMap *map_of(const Room *room, uint32_t primitive, unsigned side)
{
    const Surfaces *s = room->surfaces;
    if (room->textures == NULL || primitive >= s->triangle_count)
        return NULL;
    const uint32_t back = s->triangle_back[primitive];
    const uint32_t face = side == 1 && back != SURFACE_NONE ? back : s->triangle_face[primitive];
    return textures_map(room->textures, face);
}

static uint32_t material_of(const Room *room, uint32_t primitive, unsigned side)
{
    const uint32_t surface = surfaces_of_primitive(room->surfaces, primitive);
    return surfaces_material(room->surfaces, surface, side);
}

/* Nothing is there: a pane that takes no light. */
static Material hole(const Material *m)
{
    Material h = material_default();
    h.name = m->name;
    h.reflectance = rgb(0, 0, 0);
    h.transmittance = rgb(1, 1, 1);
    return h;
}

const Material *places_material(const Room *room, uint32_t primitive, unsigned side, Vec3 point,
                                Material *scratch)
{
    const Material *m = &room->materials[material_of(room, primitive, side)];
    assert(side < 2 && scratch != NULL);
    if (m->texture == 0)
        return m;
    const FaceMap *map = map_of(room, primitive, side);
    if (map == NULL && !m->cut_out)
        return m;
    *scratch = *m;
    scratch->cut_out = false; /* here it is whole, or a hole */
    if (map == NULL)
        return scratch;
    double alpha;
    const Rgb c = texture_at(&room->textures->texture[m->texture - 1], face_map_u(map, point),
                             face_map_v(map, point), &alpha);
    if (m->cut_out && alpha < OPAQUE_LEAST)
        *scratch = hole(m);
    else
        scratch->reflectance = limited(rgb_mul(m->reflectance, c));
    return scratch;
}

/* --- means ------------------------------------------------------------------------------------ */

enum { SIDE_MOST = 32, SIDE_LEAST = 4 }; /* samples along a patch's side */

/* As many samples as it has texels along a side, within limits. */
static int samples_along(const Texture *t, const FaceMap *map, double extent)
{
    const double u = vec3_length(map->du) * extent * t->width;
    const double v = vec3_length(map->dv) * extent * t->height;
    return (int)fmin(fmax(ceil(fmax(u, v)), SIDE_LEAST), SIDE_MOST);
}

Rgb places_reflectance(const Room *room, uint32_t patch, double *opaque)
{
    const Patches  *patches = room->patches;
    const Material *m = &room->materials[patches->material[patch]];
    const unsigned  side = patches->side[patch];
    PatchPoint at;
    Rgb        sum = { 0, 0, 0 };
    double     weights = 0, whole = 0;
    assert(patch < patches->count);
    if (opaque != NULL)
        *opaque = 1;
    if (m->texture == 0 || room->textures == NULL)
        return m->reflectance;
    patches_point(patches, room->surfaces, patch, 0.5, 0.5, &at);
    const FaceMap *map = map_of(room, at.point.primitive, side);
    if (map == NULL)
        return m->reflectance;
    const Texture *t = &room->textures->texture[m->texture - 1];
    const double   extent = patches_extent(patches, room->surfaces, patch);
    const int      n = samples_along(t, map, extent);
    for (int k = 0; k < n * n; k++) {
        patches_point(patches, room->surfaces, patch, (k % n + 0.5) / n, (k / n + 0.5) / n, &at);
        const FaceMap *here = map_of(room, at.point.primitive, side);
        if (here == NULL)
            here = map;
        const double u = face_map_u(here, at.point.point), v = face_map_v(here, at.point.point);
        const double size = fmax(vec3_length(here->du), vec3_length(here->dv)) * extent / n;
        double alpha;
        const Rgb c = texture_mean_at(t, u, v, size, &alpha);
        const double weight = at.weight * (m->cut_out ? alpha : 1);
        sum = rgb_mad(sum, weight, c);
        weights += weight;
        whole += at.weight;
    }
    assert(whole > 0);
    if (opaque != NULL)
        *opaque = weights / whole;
    return weights > 0 ? limited(rgb_mul(m->reflectance, rgb_scale(sum, 1 / weights)))
                       : rgb(0, 0, 0);
}
