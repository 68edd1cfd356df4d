/* SPDX-License-Identifier: BSD-3-Clause */
/* Objects of MSD that have flat faces: polygons, counter-clockwise seen from the front. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scenes/msd.h"

/* Rays are float, and squares of distances must stay finite: half of sqrt(FLT_MAX) = 1.84e19. */
static const double COORDINATE_MAX = 9.2e18;

enum { POINTS_MAX = 8, CORNERS_MAX = 4 };

typedef struct {
    int count;                /* corners */
    int corner[CORNERS_MAX];  /* index of a point */
} Face;

bool msd_reachable(MsdReader *r, MsdPlace place, Vec3 p)
{
    const double largest = fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z)));

    return (vec3_finite(p) && largest <= COORDINATE_MAX) ||
           msd_error(r, place, "a point lies at (%g, %g, %g), expected coordinates up to %g", p.x,
                     p.y, p.z, COORDINATE_MAX);
}

bool msd_count(MsdReader *r, MsdPlace place, uint64_t more)
{
    if (more > r->objects_max - r->objects)
        return msd_error(r, place, "more than %llu faces; REF or INCLUDE may repeat too much",
                         (unsigned long long)r->objects_max);
    r->objects += more;
    return true;
}

bool msd_group(MsdReader *r, const MsdThing *thing, uint32_t *group)
{
    char name[48];

    if (r->group != MSD_NONE) {
        MsdSymbol *symbol = &r->symbols[r->group];
        if (symbol->group == MSD_NONE &&
            !polygons_add_group(&r->scene->polygons, symbol->text, &symbol->group, r->err))
            return false;
        *group = symbol->group;
        return true;
    }
    snprintf(name, sizeof name, "%s-%u", thing->name, ++r->made[thing->word]);
    return polygons_add_group(&r->scene->polygons, name, group, r->err);
}

/* Puts points, already in the world, and the faces between them into the soup. */
static bool faces_add(MsdReader *r, const MsdThing *thing, const Vec3 *point, int point_count,
                      const Face *face, int face_count, bool turned)
{
    Polygons *soup = &r->scene->polygons;
    uint32_t  index[POINTS_MAX], corner[CORNERS_MAX], group = 0;

    assert(point_count <= POINTS_MAX && thing->material < soup->material_count);
    if (!msd_count(r, thing->place, (uint64_t)face_count) || !msd_group(r, thing, &group))
        return false;
    for (int i = 0; i < point_count; i++)
        if (!msd_reachable(r, thing->place, point[i]) ||
            !polygons_add_vertex(soup, point[i], &index[i], r->err))
            return false;
    for (int i = 0; i < face_count; i++) {
        const int n = face[i].count;
        assert(n >= 3 && n <= CORNERS_MAX);
        for (int k = 0; k < n; k++)
            corner[k] = index[face[i].corner[turned ? n - 1 - k : k]];
        if (!polygons_add_polygon(soup, corner, (size_t)n, thing->material, group, r->err))
            return false;
    }
    return true;
}

/* A map that mirrors turns every face round. */
static bool is_mirrored(const MsdReader *r) { return affine_determinant(&r->map) < 0; }

static bool points_read(MsdReader *r, int count, Vec3 *point)
{
    for (int i = 0; i < count; i++)
        if (!msd_vector(r, &point[i]))
            return false;
    return true;
}

static void points_map(const MsdReader *r, int count, Vec3 *point)
{
    for (int i = 0; i < count; i++)
        point[i] = affine_point(&r->map, point[i]);
}

static bool polygon_read(MsdReader *r, const MsdThing *thing, int count)
{
    const Face face = { count, { 0, 1, 2, 3 } };
    Vec3       point[CORNERS_MAX] = { 0 };

    if (!points_read(r, count, point))
        return false;
    points_map(r, count, point);
    return r->dry > 0 || faces_add(r, thing, point, count, &face, 1, is_mirrored(r));
}

/* Start, end of the first and end of the second spanning vector. */
static bool parallel_read(MsdReader *r, const MsdThing *thing)
{
    static const Face face = { 4, { 0, 1, 2, 3 } };
    Vec3              p[3] = { 0 };

    if (!points_read(r, 3, p))
        return false;
    Vec3 point[4] = { p[0], p[1], vec3_add(p[1], vec3_sub(p[2], p[0])), p[2] };
    points_map(r, 4, point);
    return r->dry > 0 || faces_add(r, thing, point, 4, &face, 1, is_mirrored(r));
}

/* Corner k of a box lies at the upper end of axis i when bit i of k is set. */
static bool box_read(MsdReader *r, const MsdThing *thing)
{
    static const Face faces[6] = {
        { 4, { 0, 4, 6, 2 } }, { 4, { 1, 3, 7, 5 } }, { 4, { 0, 1, 5, 4 } },
        { 4, { 2, 6, 7, 3 } }, { 4, { 0, 2, 3, 1 } }, { 4, { 4, 5, 7, 6 } },
    };
    Vec3   centre = { 0 }, point[8];
    double half[3] = { 0 };
    int    count = 0;

    if (!msd_vector(r, &centre) || !msd_sizes(r, 3, 3, false, half, &count))
        return false;
    for (int k = 0; k < 8; k++)
        point[k] = vec3(centre.x + (k & 1 ? half[0] : -half[0]),
                        centre.y + (k & 2 ? half[1] : -half[1]),
                        centre.z + (k & 4 ? half[2] : -half[2]));
    points_map(r, 8, point);
    return r->dry > 0 || faces_add(r, thing, point, 8, faces, 6, is_mirrored(r));
}

/* Faces outward whatever the order of the four points and whether or not the map mirrors: the
 * table is right when the fourth lies behind the first three. */
static bool tetrahedron_read(MsdReader *r, const MsdThing *thing)
{
    static const Face faces[4] = {
        { 3, { 0, 1, 2, 0 } }, { 3, { 1, 0, 3, 0 } }, { 3, { 2, 1, 3, 0 } }, { 3, { 0, 2, 3, 0 } },
    };
    Vec3 p[4] = { 0 };

    if (!points_read(r, 4, p))
        return false;
    points_map(r, 4, p);
    const Vec3 normal = vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0]));
    const bool turned = vec3_dot(normal, vec3_sub(p[3], p[0])) > 0;
    return r->dry > 0 || faces_add(r, thing, p, 4, faces, 4, turned);
}

/* --- all kinds ------------------------------------------------------------------------------- */

static bool data_read(MsdReader *r, const MsdThing *thing)
{
    switch (thing->word) {
    case WORD_TRIANGLE: return polygon_read(r, thing, 3);
    case WORD_QUADRANGLE: return polygon_read(r, thing, 4);
    case WORD_PARALLEL: return parallel_read(r, thing);
    case WORD_BOX: return box_read(r, thing);
    case WORD_TETRAHEDRON: return tetrahedron_read(r, thing);
    case WORD_BREPOBJ: return msd_brep(r, thing);
    default: return msd_curved(r, thing);
    }
}

static bool is_thing(const MsdReader *r)
{
    if (r->token.kind != TOKEN_WORD)
        return false;
    switch (r->token.word) {
    case WORD_BOX:
    case WORD_BREPOBJ:
    case WORD_CONE:
    case WORD_CYLINDER_COAT:
    case WORD_DISC:
    case WORD_ELLIPSOID:
    case WORD_GEN_CYLINDER:
    case WORD_PARALLEL:
    case WORD_QUADRANGLE:
    case WORD_SPHERE:
    case WORD_TETRAHEDRON:
    case WORD_TORUS:
    case WORD_TRIANGLE: return true;
    default: return false;
    }
}

bool msd_thing(MsdReader *r)
{
    MsdThing    thing = { .word = r->token.word, .place = r->token.place };
    const char *text = r->sources[thing.place.source].text + thing.place.offset;

    if (!is_thing(r))
        return msd_expected(r, "a declaration, a surface or an object");
    for (size_t i = 0; i < r->token.end - thing.place.offset; i++) {
        assert(i + 1 < sizeof thing.name);
        thing.name[i] = text[i] >= 'A' && text[i] <= 'Z' ? (char)(text[i] - 'A' + 'a') : text[i];
    }
    return msd_next(r) && msd_surface_use(r, &thing.material) && data_read(r, &thing);
}
