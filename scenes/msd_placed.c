/* SPDX-License-Identifier: BSD-3-Clause */
/* Meshes of BREPOBJ in their places: as faces of the soup, or by reference when they are many. */
#include <assert.h>

#include "base/array.h"
#include "scenes/msd.h"

/* Corners of the box around the mesh, in the world: what lies between them is as near. */
static bool box_reachable(MsdReader *r, const MsdThing *thing, const MsdImport *import)
{
    const Vec3 lo = import->lo, hi = import->hi;

    for (int k = 0; k < 8; k++) {
        const Vec3 corner = vec3(k & 1 ? hi.x : lo.x, k & 2 ? hi.y : lo.y, k & 4 ? hi.z : lo.z);
        if (!msd_reachable(r, thing->place, affine_point(&r->map, corner)))
            return false;
    }
    return true;
}

/* Puts the mesh's faces among the soup's, and notes where. */
static bool flatten(MsdReader *r, MsdPlaced *placed, Error *err)
{
    Polygons       *soup = &r->scene->polygons;
    const Polygons *mesh = &r->imports[placed->import].polygons;

    placed->polygon = soup->polygon_count;
    placed->vertex = soup->vertex_count;
    placed->shape = soup->shape_count;
    if (!polygons_append(soup, mesh, &placed->map, placed->material, placed->group, err))
        return false;
    placed->polygons = soup->polygon_count - placed->polygon;
    placed->vertices = soup->vertex_count - placed->vertex;
    placed->shapes = soup->shape_count - placed->shape;
    return true;
}

/* --- from faces back to references ------------------------------------------------------------ */

/* Adds the old soup's faces from one place up to the next. */
static bool gap_copy(Polygons *to, const Polygons *from, const MsdPlaced *begin,
                     const MsdPlaced *end, Error *err)
{
    const size_t vertex = begin->vertex + begin->vertices;
    const size_t base = to->vertex_count;
    uint32_t     index = 0, few[4], *many = NULL;
    size_t       most = 0;

    for (size_t i = vertex; i < end->vertex; i++)
        if (!polygons_add_vertex(to, from->position[i], &index, err))
            return false;
    for (size_t i = begin->polygon + begin->polygons; i < end->polygon; i++) {
        const size_t count = from->first[i + 1] - from->first[i];
        if (count > 4 && !array_reserve((void **)&many, &most, count, sizeof *many, "corners",
                                           err))
            break;
        uint32_t *use = count > 4 ? many : few;
        for (size_t k = 0; k < count; k++) {
            const size_t old = from->corner[from->first[i] + k];
            assert(old >= vertex && old < end->vertex); /* no object uses another's vertices */
            use[k] = (uint32_t)(old - vertex + base);
        }
        if (!polygons_add_polygon(to, use, count, from->material[i], from->group[i], err) ||
            !polygons_copy_normals(to, (uint32_t)to->polygon_count - 1, from, (uint32_t)i, err))
            break;
    }
    array_free(many);
    for (size_t i = begin->shape + begin->shapes; i < end->shape && !error_is_set(err); i++)
        polygons_add_shape(to, &from->shape[i].shape, from->shape[i].material,
                           from->shape[i].group, err);
    return !error_is_set(err);
}

static void geometry_free(Polygons *soup)
{
    array_free(soup->position);
    array_free(soup->first);
    array_free(soup->corner);
    array_free(soup->material);
    array_free(soup->group);
    array_free(soup->normal);
    array_free(soup->shape);
}

/* Takes all faces of placed meshes out of the soup again. */
static bool unflatten(MsdReader *r)
{
    Polygons       *soup = &r->scene->polygons, lean = *soup;
    const MsdPlaced start = { 0 }, stop = { .polygon = soup->polygon_count,
                                            .vertex = soup->vertex_count,
                                            .shape = soup->shape_count };
    bool            good = true;

    lean.position = NULL;
    lean.first = lean.corner = lean.material = lean.group = NULL;
    lean.shape = NULL;
    lean.normal = NULL;
    lean.normal_count = lean.normal_capacity = 0;
    lean.vertex_count = lean.polygon_count = lean.shape_count = 0;
    lean.vertex_capacity = lean.corner_capacity = lean.polygon_capacity = lean.shape_capacity = 0;
    for (size_t i = 0; i <= r->placed_count && good; i++)
        good = gap_copy(&lean, soup, i > 0 ? &r->placed[i - 1] : &start,
                        i < r->placed_count ? &r->placed[i] : &stop, r->err);
    geometry_free(good ? soup : &lean);
    if (good)
        *soup = lean;
    for (size_t i = 0; i < r->placed_count && good; i++) {
        MsdPlaced *p = &r->placed[i];
        r->objects -= p->polygons + p->shapes;
        p->polygons = p->vertices = p->shapes = 0;
    }
    return good;
}

/* --- one object ------------------------------------------------------------------------------- */

static SceneInstances wanted(const MsdReader *r)
{
    return r->options != NULL ? r->options->instances : INSTANCES_FLATTEN;
}

/* Faces of meshes that are there already, once more. */
static bool too_many(MsdReader *r, const MsdPlaced *placed)
{
    const Polygons *mesh = &r->imports[placed->import].polygons;

    if (!r->imports[placed->import].used) {
        r->imports[placed->import].used = true;
        return false;
    }
    r->repeated += mesh->polygon_count + mesh->shape_count;
    const uint64_t most = r->options->instances_most;
    return r->repeated > (most > 0 ? most : INSTANCES_MOST);
}

bool msd_place(MsdReader *r, const MsdThing *thing, size_t import, uint32_t group)
{
    const Polygons *mesh = &r->imports[import].polygons;
    MsdPlaced       placed = { .import = import, .material = thing->material, .group = group,
                               .map = r->map };

    assert(import < r->import_count && r->dry == 0);
    if (!box_reachable(r, thing, &r->imports[import]))
        return false;
    if (wanted(r) == INSTANCES_FLATTEN)
        return msd_count(r, thing->place, mesh->polygon_count + mesh->shape_count + 1) &&
               flatten(r, &placed, r->err);
    if (!r->kept && (wanted(r) == INSTANCES_KEEP || too_many(r, &placed))) {
        if (!unflatten(r))
            return false;
        r->kept = true;
    }
    const uint64_t faces = r->kept ? 0 : mesh->polygon_count + mesh->shape_count;
    if (!msd_count(r, thing->place, faces + 1) || (!r->kept && !flatten(r, &placed, r->err)) ||
        !array_reserve((void **)&r->placed, &r->placed_capacity, r->placed_count + 1,
                       sizeof *r->placed, "placed objects", r->err))
        return false;
    r->placed[r->placed_count++] = placed;
    return true;
}

/* --- the end ---------------------------------------------------------------------------------- */

bool msd_placed_finish(MsdReader *r)
{
    const Polygons *soup = &r->scene->polygons;
    size_t          first = 0;

    if (!r->kept)
        return true;
    /* Whatever looks at the scene's own faces finds some. */
    while (first < r->placed_count && soup->polygon_count + soup->shape_count == 0)
        if (!flatten(r, &r->placed[first++], r->err))
            return false;
    for (size_t i = first; i < r->placed_count; i++) {
        const MsdPlaced *p = &r->placed[i];
        MsdImport       *import = &r->imports[p->import];
        Placement        placement = { .material = p->material, .to_world = p->map };
        if (!import->moved &&
            !scene_add_prototype(r->scene, &import->polygons, &import->prototype, r->err))
            return false;
        import->moved = true;
        placement.prototype = import->prototype;
        if (!scene_add_placement(r->scene, &placement, r->err))
            return false;
    }
    return true;
}
