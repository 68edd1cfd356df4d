/* SPDX-License-Identifier: BSD-3-Clause */
/* Patches as triangles and outlines. */
#include "viewer/shown_mesh.h"

#include <assert.h>
#include <math.h>

#include "base/array.h"

/* A face with a vertex on an edge is drawn as a fan round its middle, so that no triangle is flat
 * and no crack opens. */
static bool has_middle(const Patches *p, uint32_t face)
{
    for (uint32_t k = p->first_corner[face]; k < p->first_corner[face + 1]; k++)
        if (p->corner_along[k] > floor(p->corner_along[k]))
            return true;
    return p->first_corner[face + 1] - p->first_corner[face] > 4;
}

static void count_parts(const Patches *p, ShownMesh *mesh)
{
    uint32_t middles = 0, triangles = 0;
    for (uint32_t f = 0; f < p->face_count; f++) {
        const uint32_t n = p->first_corner[f + 1] - p->first_corner[f];
        middles += has_middle(p, f);
        triangles += has_middle(p, f) ? n : n - 2;
    }
    mesh->patch_count = p->count;
    mesh->plain_count = p->vertex_count;
    mesh->vertex_count = p->vertex_count + middles;
    mesh->triangle_count = triangles;
    mesh->edge_count = p->first_corner[p->face_count];
}

static bool take_room(ShownMesh *mesh, Error *err)
{
    const size_t t = mesh->triangle_count;
    mesh->patch = array_create(mesh->patch_count, sizeof *mesh->patch, "mesh", err);
    mesh->position = array_create(mesh->vertex_count, sizeof *mesh->position, "mesh", err);
    mesh->corner = array_create(3 * t, sizeof *mesh->corner, "mesh", err);
    mesh->triangle_patch = array_create(t, sizeof *mesh->triangle_patch, "mesh", err);
    mesh->edge = array_create(2 * (size_t)mesh->edge_count, sizeof *mesh->edge, "mesh", err);
    mesh->mean_of = array_create(4 * (size_t)(mesh->vertex_count - mesh->plain_count),
                                 sizeof *mesh->mean_of, "mesh", err);
    return !error_is_set(err);
}

/* The cell's own corners of a face, the last one repeated on triangles: four. */
static void own_corners(const Patches *p, uint32_t face, uint32_t own[4])
{
    const uint32_t first = p->first_corner[face], end = p->first_corner[face + 1];
    unsigned n = 0;
    for (uint32_t k = first; k < end && n < 4; k++)
        if (p->corner_along[k] == floor(p->corner_along[k]))
            own[n++] = p->corner[k];
    for (uint32_t k = first; k < end && n < 3; k++)
        own[n++] = p->corner[k];
    if (n == 3)
        own[3] = own[(face & 1) + 1];
}

static void add_triangle(ShownMesh *mesh, uint32_t *count, uint32_t patch, uint32_t a, uint32_t b,
                         uint32_t c)
{
    uint32_t *corner = mesh->corner + 3 * (size_t)*count;
    corner[0] = a;
    corner[1] = b;
    corner[2] = c;
    mesh->triangle_patch[(*count)++] = patch;
}

static void fill_faces(const Patches *p, ShownMesh *mesh)
{
    uint32_t triangles = 0, edges = 0, middle = mesh->plain_count;
    for (uint32_t i = 0; i < p->vertex_count; i++)
        mesh->position[i] = p->position[i];
    for (uint32_t f = 0; f < p->face_count; f++) {
        const uint32_t *c = p->corner + p->first_corner[f];
        const uint32_t n = p->first_corner[f + 1] - p->first_corner[f];
        for (uint32_t k = 0; k < n; k++) {
            mesh->edge[2 * (size_t)edges] = c[k];
            mesh->edge[2 * (size_t)edges++ + 1] = c[(k + 1) % n];
        }
        if (!has_middle(p, f)) {
            for (uint32_t k = 1; k + 1 < n; k++)
                add_triangle(mesh, &triangles, p->face_patch[f], c[0], c[k], c[k + 1]);
            continue;
        }
        uint32_t *own = mesh->mean_of + 4 * (size_t)(middle - mesh->plain_count);
        own_corners(p, f, own);
        for (unsigned k = 0; k < 4; k++)
            mesh->position[middle] = vec3_mad(mesh->position[middle], 0.25, p->position[own[k]]);
        for (uint32_t k = 0; k < n; k++)
            add_triangle(mesh, &triangles, p->face_patch[f], middle, c[k], c[(k + 1) % n]);
        middle++;
    }
    assert(triangles == mesh->triangle_count && edges == mesh->edge_count);
    mesh->lo = vec3(INFINITY, INFINITY, INFINITY);
    mesh->hi = vec3_scale(mesh->lo, -1);
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        mesh->lo = vec3_min(mesh->lo, mesh->position[i]);
        mesh->hi = vec3_max(mesh->hi, mesh->position[i]);
    }
}

static void fill_patches(const Scene *scene, const Patches *p, const uint8_t *emitting,
                         ShownMesh *mesh)
{
    for (uint32_t i = 0; i < p->count; i++) {
        const Material *m = &scene->polygons.materials[p->material[i]];
        mesh->patch[i] = (ShownPatch){
            .group = p->group[i], .material = p->material[i], .side = p->side[i],
            .level = p->cell[i].level, .area = p->area[i], .centre = p->centre[i],
            .normal = p->normal[i], .reflectance = m->reflectance,
            .lamp = (emitting[p->surface[i]] >> p->side[i] & 1) != 0 };
    }
}

static bool copy_names(const Scene *scene, ShownMesh *mesh, Error *err)
{
    const Polygons *soup = &scene->polygons;
    mesh->group_name = array_create(soup->group_count, sizeof(char *), "names", err);
    mesh->material_name = array_create(soup->material_count, sizeof(char *), "names", err);
    for (; !error_is_set(err) && mesh->group_count < soup->group_count; mesh->group_count++)
        mesh->group_name[mesh->group_count] =
            array_string(soup->group_name[mesh->group_count], err);
    for (; !error_is_set(err) && mesh->material_count < soup->material_count;
         mesh->material_count++)
        mesh->material_name[mesh->material_count] =
            array_string(soup->materials[mesh->material_count].name, err);
    return !error_is_set(err);
}

static bool copy_lights(const Scene *scene, ShownMesh *mesh, Error *err)
{
    mesh->light = array_create(scene->light_count, sizeof *mesh->light, "lights", err);
    for (; mesh->light != NULL && mesh->light_count < scene->light_count; mesh->light_count++)
        mesh->light[mesh->light_count] = scene->lights[mesh->light_count];
    return mesh->light != NULL;
}

static bool copy_cameras(const Scene *scene, const Camera *camera, ShownMesh *mesh, Error *err)
{
    mesh->camera = array_create(scene->camera_count + 1, sizeof *mesh->camera, "cameras", err);
    if (mesh->camera == NULL)
        return false;
    mesh->camera[mesh->camera_count++] = *camera;
    for (size_t i = 0; i < scene->camera_count; i++)
        mesh->camera[mesh->camera_count++] = scene->cameras[i];
    mesh->up = scene->up;
    mesh->origin = scene->origin;
    mesh->scene_hash = scene->hash;
    return true;
}

ShownMesh *shown_mesh_create(const Scene *scene, const Patches *patches, const uint8_t *emitting,
                             const Camera *camera, unsigned threads, Error *err)
{
    ShownMesh *mesh = array_create(1, sizeof *mesh, "mesh", err);
    if (mesh == NULL)
        return NULL;
    atomic_init(&mesh->references, 1);
    count_parts(patches, mesh);
    if (!take_room(mesh, err) || !copy_names(scene, mesh, err) ||
        !copy_cameras(scene, camera, mesh, err) || !copy_lights(scene, mesh, err) ||
        !knobs_list(scene, &mesh->knob, &mesh->knob_count, err))
        return shown_mesh_leave(mesh);
    fill_faces(patches, mesh);
    fill_patches(scene, patches, emitting, mesh);
    const Primitives primitives = { .position = mesh->position, .corner = mesh->corner,
                                    .vertex_count = mesh->vertex_count,
                                    .triangle_count = mesh->triangle_count };
    mesh->bvh = bvh_create(&primitives, threads, err);
    return mesh->bvh != NULL ? mesh : shown_mesh_leave(mesh);
}

ShownMesh *shown_mesh_share(ShownMesh *mesh)
{
    assert(atomic_load(&mesh->references) > 0);
    atomic_fetch_add(&mesh->references, 1);
    return mesh;
}

ShownMesh *shown_mesh_leave(ShownMesh *mesh)
{
    if (mesh == NULL || atomic_fetch_sub(&mesh->references, 1) > 1)
        return NULL;
    array_free(mesh->patch);
    array_free(mesh->position);
    array_free(mesh->corner);
    array_free(mesh->triangle_patch);
    array_free(mesh->edge);
    array_free(mesh->mean_of);
    bvh_destroy(mesh->bvh);
    array_free(mesh->camera);
    array_free(mesh->light);
    for (uint32_t i = 0; i < mesh->group_count; i++)
        array_free(mesh->group_name[i]);
    for (uint32_t i = 0; i < mesh->material_count; i++)
        array_free(mesh->material_name[i]);
    knobs_free(mesh->knob, mesh->knob_count);
    array_free(mesh->group_name);
    array_free(mesh->material_name);
    return array_free(mesh);
}
