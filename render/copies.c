/* SPDX-License-Identifier: BSD-3-Clause */
/* Meshes in many places: one room of each mesh and material, and the tree over all places. */
#include "render/copies.h"

#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "math/tolerance.h"
#include "radiosity/mirrors.h"
#include "render/normals.h"
#include "render/path_internal.h"
#include "render/specular.h"

typedef struct {
    Surfaces *surfaces;
    const Polygons *soup;  /* the scene's */
    Bvh      *bvh;
    float    *smooth;     /* render/normals.h; NULL: flat */
    bool      smoothed;   /* that has been made */
} Mesh;

/* A mesh of one material. */
typedef struct {
    uint32_t mesh, material;
    uint8_t *emitting, *skin;
    Room     room;
} Look;

struct RoomCopies {
    const Room *room;
    Mesh       *mesh;     /* [mesh_count] */
    size_t      mesh_count;
    Look       *look;     /* [look_count] */
    size_t      look_count, look_capacity;
    uint32_t   *look_of;  /* [placements]  of instance i + 1 */
    Affine     *to_local; /* [placements] */
    const Placement *placement;
    Instances  *instances;
    double      offset;
};

static bool mesh_make(Mesh *mesh, const Polygons *soup, const SurfaceOptions *repair,
                      unsigned threads, const Monitor *monitor, Error *err)
{
    mesh->soup = soup;
    mesh->surfaces = surfaces_repair(soup, repair, NULL, monitor, err);
    if (mesh->surfaces == NULL)
        return false;
    const Surfaces  *s = mesh->surfaces;
    const Primitives primitives = { .position = s->position, .corner = s->corner,
                                    .shape = s->shape, .vertex_count = s->vertex_count,
                                    .triangle_count = s->triangle_count,
                                    .shape_count = s->shape_count };
    mesh->bvh = bvh_create(&primitives, threads, err);
    return mesh->bvh != NULL;
}

static bool look_make(RoomCopies *copies, const Placement *placement, Error *err)
{
    if (!array_reserve((void **)&copies->look, &copies->look_capacity, copies->look_count + 1,
                       sizeof *copies->look, "placed meshes", err))
        return false;
    Mesh           *mesh = &copies->mesh[placement->prototype];
    const Material *material = &copies->room->materials[placement->material];
    const uint32_t  count = mesh->surfaces->count;
    Look           *look = &copies->look[copies->look_count++];
    *look = (Look){ .mesh = placement->prototype, .material = placement->material };
    look->emitting = array_create(count, 1, "placed meshes", err);
    if (rgb_max(material->transmittance) > 0 && !error_is_set(err))
        look->skin = mirrors_skins(mesh->surfaces, material, err);
    if (error_is_set(err))
        return false;
    for (uint32_t i = 0; i < count && rgb_max(material->emission) > 0; i++)
        look->emitting[i] = material->emits_both ||
                            mesh->surfaces->surface[i].back != SURFACE_NONE ? 3 : 1;
    look->room = (Room){ .surfaces = mesh->surfaces, .soup = mesh->soup, .bvh = mesh->bvh,
                         .materials = material, .material_count = 1, .emitting = look->emitting,
                         .skin = look->skin };
    if (!mesh->smoothed)
        mesh->smooth = normals_create(&look->room, err);
    mesh->smoothed = true;
    return !error_is_set(err);
}

/* Scenes have few meshes of few materials, and the same ones follow each other. */
static bool look_find(RoomCopies *copies, const Placement *placement, uint32_t *index, Error *err)
{
    for (size_t i = copies->look_count; i-- > 0;) {
        const Look *look = &copies->look[i];
        if (look->mesh == placement->prototype && look->material == placement->material) {
            *index = (uint32_t)i;
            return true;
        }
    }
    *index = (uint32_t)copies->look_count;
    return look_make(copies, placement, err);
}

/* A ray starts off a copy's surface by what rounding in the world and in the copy's space makes. */
static double offset_of(const RoomCopies *copies, size_t placements)
{
    Vec3   lo, hi;
    double local = 0, largest = copies->room->surfaces->largest_coordinate;
    instances_bounds(copies->instances, &lo, &hi);
    for (int axis = 0; axis < 3; axis++)
        largest = fmax(largest, fmax(fabs(vec3_axis(lo, axis)), fabs(vec3_axis(hi, axis))));
    for (size_t i = 0; i < placements; i++) {
        const Placement *p = &copies->placement[i];
        const Surfaces  *s = copies->mesh[p->prototype].surfaces;
        local = fmax(local, affine_stretch(&p->to_world) * ray_offset(s->largest_coordinate));
    }
    return ray_offset(largest) + local;
}

static bool places_make(RoomCopies *copies, const Scene *scene, unsigned threads, Error *err)
{
    const size_t count = scene->placement_count;
    Instance    *instance = array_create(count + 1, sizeof *instance, "placed meshes", err);
    copies->look_of = array_create(count, sizeof *copies->look_of, "placed meshes", err);
    copies->to_local = array_create(count, sizeof *copies->to_local, "placed meshes", err);
    if (!error_is_set(err))
        instance[0] = (Instance){ copies->room->bvh, affine_identity() };
    for (size_t i = 0; i < count && !error_is_set(err); i++) {
        const Placement *p = &scene->placements[i];
        instance[i + 1] = (Instance){ copies->mesh[p->prototype].bvh, p->to_world };
        if (!affine_invert(&p->to_world, &copies->to_local[i]))
            error_set(err, ERROR_INPUT, "%s: a placed mesh is flat", scene->file);
        else
            look_find(copies, p, &copies->look_of[i], err);
    }
    if (!error_is_set(err))
        copies->instances = instances_create(instance, (uint32_t)count + 1, threads, err);
    array_free(instance);
    if (copies->instances == NULL)
        return false;
    copies->offset = offset_of(copies, count);
    for (size_t i = 0; i < copies->look_count; i++)
        copies->look[i].room.offset = copies->offset;
    return true;
}

RoomCopies *copies_create(const Room *room, const Scene *scene, const SurfaceOptions *repair,
                      unsigned threads, const Monitor *monitor, Error *err)
{
    assert(room != NULL && scene != NULL && err != NULL && scene->placement_count < UINT32_MAX);
    RoomCopies *copies = array_create(1, sizeof *copies, "placed meshes", err);
    if (copies == NULL)
        return NULL;
    copies->room = room;
    copies->placement = scene->placements;
    copies->mesh = array_create(scene->prototype_count, sizeof *copies->mesh, "placed meshes",
                                err);
    for (size_t i = 0; i < scene->prototype_count && !error_is_set(err); i++) {
        copies->mesh_count = i + 1;
        mesh_make(&copies->mesh[i], &scene->prototypes[i], repair, threads, monitor, err);
    }
    if (error_is_set(err) || !places_make(copies, scene, threads, err))
        return copies_destroy(copies);
    return copies;
}

RoomCopies *copies_destroy(RoomCopies *copies)
{
    if (copies == NULL)
        return NULL;
    instances_destroy(copies->instances);
    for (size_t i = 0; i < copies->look_count; i++) {
        array_free(copies->look[i].emitting);
        array_free(copies->look[i].skin);
    }
    for (size_t i = 0; i < copies->mesh_count; i++) {
        array_free(copies->mesh[i].smooth);
        bvh_destroy(copies->mesh[i].bvh);
        surfaces_destroy(copies->mesh[i].surfaces);
    }
    array_free(copies->look);
    array_free(copies->mesh);
    array_free(copies->look_of);
    array_free(copies->to_local);
    return array_free(copies);
}

const Instances *copies_instances(const RoomCopies *copies) { return copies->instances; }

double copies_offset(const RoomCopies *copies) { return copies->offset; }

const Room *copies_hit(const RoomCopies *copies, const InstanceHit *found, Vec3 direction,
                       RoomHit *hit)
{
    assert(copies != NULL && hit != NULL && found->instance != RAY_MISS);
    if (found->instance == 0) {
        path_hit(copies->room, &found->hit, direction, hit);
        return copies->room;
    }
    const uint32_t i = found->instance - 1;
    const Room    *room = &copies->look[copies->look_of[i]].room;
    const Affine  *local = &copies->to_local[i];
    path_hit(room, &found->hit, affine_vector(local, direction), hit);
    hit->point = affine_point(&copies->placement[i].to_world, hit->point);
    hit->normal = vec3_unit(affine_normal(local, hit->normal));
    return room;
}

Vec3 copies_normal(const RoomCopies *copies, const InstanceHit *found, const RoomHit *hit, Vec3 in)
{
    assert(copies != NULL && found->instance != RAY_MISS && found->instance > 0);
    const uint32_t i = found->instance - 1;
    const Look    *look = &copies->look[copies->look_of[i]];
    const Affine  *world = &copies->placement[i].to_world, *local = &copies->to_local[i];
    RoomHit        own = *hit;
    own.normal = vec3_unit(affine_normal(world, hit->normal)); /* the way back */
    const Vec3 n = normals_at(copies->mesh[look->mesh].smooth, &look->room, &own,
                              affine_vector(local, in));
    return vec3_unit(affine_normal(local, n));
}

Receiver copies_receive(const RoomCopies *copies, const InstanceHit *found, const RoomHit *hit)
{
    assert(copies != NULL && found->instance != RAY_MISS && found->instance > 0);
    const uint32_t i = found->instance - 1;
    const Look    *look = &copies->look[copies->look_of[i]];
    const Affine  *world = &copies->placement[i].to_world, *local = &copies->to_local[i];
    RoomHit        own = *hit;
    own.point = affine_point(local, hit->point);
    own.normal = vec3_unit(affine_normal(world, hit->normal)); /* the way back */
    const Receiver at = normals_receive(copies->mesh[look->mesh].smooth, &look->room, &own);
    const Vec3     lift = affine_vector(world, vec3_sub(at.point, own.point));
    return (Receiver){ vec3_add(hit->point, lift), vec3_unit(affine_normal(local, at.normal)),
                       vec3_unit(affine_normal(local, at.face)) };
}
