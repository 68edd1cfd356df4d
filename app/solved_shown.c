/* SPDX-License-Identifier: BSD-3-Clause */
/* Faces of a file as triangles, patches and values for the window. */
#include "app/solved_shown.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "scenes/view.h"

/* Positions are rounded to floats: a corner that lies nearer than that to the line between its
 * neighbours, relative to the face's size, lies on it. */
static const double COLLINEAR = 64 * FLT_EPSILON;
/* A patch emits when what leaves it is more than what it reflects by that share; radiosity is
 * solved for far better, and written as floats. */
static const double OWN_SHARE = 0.01;
/* Whole vertical angle of a view of one's own: a normal lens seen upright. */
static const double OWN_FOV = 50;

/* --- faces ------------------------------------------------------------------------------------ */

static uint32_t corners_of(const SolvedMesh *in, uint32_t face)
{
    return in->first_corner[face + 1] - in->first_corner[face];
}

/* Whether corner k of a face lies on the line between its neighbours: a finer neighbour's. */
static bool on_edge(const SolvedMesh *in, uint32_t face, uint32_t k)
{
    const uint32_t n = corners_of(in, face);
    const uint32_t *c = in->corner + in->first_corner[face];
    const Vec3 a = in->position[c[(k + n - 1) % n]], b = in->position[c[(k + 1) % n]];
    const Vec3 to = vec3_sub(b, a), at = vec3_sub(in->position[c[k]], a);
    return vec3_length(vec3_cross(to, at)) <= COLLINEAR * vec3_dot(to, to);
}

/* As shown_mesh.c: a fan round the middle, so that no triangle is flat and no crack opens. */
static bool has_middle(const SolvedMesh *in, uint32_t face)
{
    const uint32_t n = corners_of(in, face);
    bool edge = n > 4;
    for (uint32_t k = 0; n == 4 && k < n; k++)
        edge = edge || on_edge(in, face, k);
    return edge;
}

static bool count_parts(const SolvedMesh *in, ShownMesh *mesh, const char *path, Error *err)
{
    uint64_t middles = 0, triangles = 0;
    uint32_t patches = 0;
    for (uint32_t f = 0; f < in->face_count; f++) {
        const uint32_t n = corners_of(in, f);
        const bool middle = has_middle(in, f);
        middles += middle;
        triangles += middle ? n : n - 2;
        if (in->patch[f] >= in->face_count)
            return error_at(err, ERROR_INPUT, path, 0, "face %u is of patch %u, there are %u faces",
                            f, in->patch[f], in->face_count);
        patches = in->patch[f] + 1 > patches ? in->patch[f] + 1 : patches;
    }
    if (in->face_count == 0)
        return error_at(err, ERROR_INPUT, path, 0, "there is no face in it");
    if (triangles > UINT32_MAX / 3 || in->vertex_count + middles > UINT32_MAX / 3)
        return error_at(err, ERROR_INPUT, path, 0, "too many triangles to show");
    mesh->patch_count = patches;
    mesh->plain_count = in->vertex_count;
    mesh->vertex_count = in->vertex_count + (uint32_t)middles;
    mesh->triangle_count = (uint32_t)triangles;
    mesh->edge_count = in->first_corner[in->face_count];
    return true;
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

/* Four corners whose mean lies inside: those that are no finer neighbour's, the last one again
 * where there are three. */
static void own_corners(const SolvedMesh *in, uint32_t face, uint32_t own[4])
{
    const uint32_t n = corners_of(in, face), *c = in->corner + in->first_corner[face];
    unsigned count = 0;
    for (uint32_t k = 0; k < n && count < 4; k++)
        if (!on_edge(in, face, k))
            own[count++] = c[k];
    for (uint32_t k = 0; k < n && count < 3; k++)
        own[count++] = c[k];
    if (count == 3)
        own[3] = own[2];
}

static void add_triangle(ShownMesh *mesh, uint32_t *count, uint32_t patch, uint32_t a, uint32_t b,
                         uint32_t c)
{
    memcpy(mesh->corner + 3 * (size_t)*count, (uint32_t[]){ a, b, c }, 3 * sizeof(uint32_t));
    mesh->triangle_patch[(*count)++] = patch;
}

static void fill_faces(const SolvedMesh *in, ShownMesh *mesh)
{
    uint32_t triangles = 0, edges = 0, middle = mesh->plain_count;
    memcpy(mesh->position, in->position, in->vertex_count * sizeof *in->position);
    for (uint32_t f = 0; f < in->face_count; f++) {
        const uint32_t n = corners_of(in, f), *c = in->corner + in->first_corner[f];
        for (uint32_t k = 0; k < n; k++) {
            mesh->edge[2 * (size_t)edges] = c[k];
            mesh->edge[2 * (size_t)edges++ + 1] = c[(k + 1) % n];
        }
        if (!has_middle(in, f)) {
            for (uint32_t k = 1; k + 1 < n; k++)
                add_triangle(mesh, &triangles, in->patch[f], c[0], c[k], c[k + 1]);
            continue;
        }
        uint32_t *own = mesh->mean_of + 4 * (size_t)(middle - mesh->plain_count);
        own_corners(in, f, own);
        for (unsigned k = 0; k < 4; k++)
            mesh->position[middle] = vec3_mad(mesh->position[middle], 0.25, in->position[own[k]]);
        for (uint32_t k = 0; k < n; k++)
            add_triangle(mesh, &triangles, in->patch[f], middle, c[k], c[(k + 1) % n]);
        middle++;
    }
    assert(triangles == mesh->triangle_count && edges == mesh->edge_count);
    mesh->lo = vec3(INFINITY, INFINITY, INFINITY);
    mesh->hi = vec3_scale(mesh->lo, -1);
    for (uint32_t i = 0; i < 3 * mesh->triangle_count; i++) {
        mesh->lo = vec3_min(mesh->lo, mesh->position[mesh->corner[i]]);
        mesh->hi = vec3_max(mesh->hi, mesh->position[mesh->corner[i]]);
    }
}

/* --- patches ---------------------------------------------------------------------------------- */

static bool is_lamp(const SolvedMesh *in, uint32_t face)
{
    const double *b = in->face_radiosity + 3 * (size_t)face;
    const double *h = in->face_irradiance + 3 * (size_t)face;
    const double *rho = in->face_reflectance + 3 * (size_t)face;
    bool lamp = false;
    for (unsigned k = 0; k < 3; k++)
        lamp = lamp || b[k] - rho[k] * h[k] > OWN_SHARE * b[k];
    return lamp;
}

/* Twice the area, along the normal. */
static Vec3 face_normal(const SolvedMesh *in, uint32_t face)
{
    const uint32_t n = corners_of(in, face), *c = in->corner + in->first_corner[face];
    const Vec3 from = in->position[c[0]];
    Vec3 sum = vec3(0, 0, 0);
    for (uint32_t k = 1; k + 1 < n; k++)
        sum = vec3_add(sum, vec3_cross(vec3_sub(in->position[c[k]], from),
                                       vec3_sub(in->position[c[k + 1]], from)));
    return sum;
}

static Vec3 face_middle(const SolvedMesh *in, uint32_t face)
{
    const uint32_t n = corners_of(in, face), *c = in->corner + in->first_corner[face];
    Vec3 sum = vec3(0, 0, 0);
    for (uint32_t k = 0; k < n; k++)
        sum = vec3_mad(sum, 1.0 / n, in->position[c[k]]);
    return sum;
}

/* Faces of one patch add up. The last material stands for numbers that have no name. */
static void fill_patches(const SolvedMesh *in, ShownMesh *mesh)
{
    for (uint32_t f = 0; f < in->face_count; f++) {
        ShownPatch *p = &mesh->patch[in->patch[f]];
        const double *rho = in->face_reflectance + 3 * (size_t)f;
        p->group = in->group[f];
        p->material = in->material[f] < in->notes.material_count ? in->material[f]
                                                                 : in->notes.material_count;
        p->side = in->side[f];
        p->lamp = is_lamp(in, f);
        p->reflectance = rgb(rho[0], rho[1], rho[2]);
        p->area += in->whole_area[f];
        p->centre = vec3_mad(p->centre, in->whole_area[f], face_middle(in, f));
        p->normal = vec3_add(p->normal, face_normal(in, f));
    }
    for (uint32_t i = 0; i < mesh->patch_count; i++) {
        ShownPatch *p = &mesh->patch[i];
        const double length = vec3_length(p->normal);
        p->centre = p->area > 0 ? vec3_scale(p->centre, 1 / p->area) : p->centre;
        p->normal = length > 0 ? vec3_scale(p->normal, 1 / length) : vec3(0, 0, 1);
    }
}

/* --- names, cameras, lights ------------------------------------------------------------------- */

static bool copy_names(const SolvedMesh *in, ShownMesh *mesh, Error *err)
{
    const PlyNotes *notes = &in->notes;
    const uint32_t materials = notes->material_count + 1;
    mesh->group_name = array_create(in->group_count, sizeof(char *), "names", err);
    mesh->material_name = array_create(materials, sizeof(char *), "names", err);
    for (; !error_is_set(err) && mesh->group_count < in->group_count; mesh->group_count++)
        mesh->group_name[mesh->group_count] = array_string(in->group_name[mesh->group_count], err);
    for (; !error_is_set(err) && mesh->material_count < materials; mesh->material_count++)
        mesh->material_name[mesh->material_count] =
            array_string(mesh->material_count < notes->material_count
                             ? notes->material_name[mesh->material_count] : "", err);
    return !error_is_set(err);
}

static bool copy_lights(const PlyNotes *notes, ShownMesh *mesh, Error *err)
{
    mesh->light = array_create(notes->light_count, sizeof *mesh->light, "lights", err);
    for (; mesh->light != NULL && mesh->light_count < notes->light_count; mesh->light_count++) {
        Light *light = &mesh->light[mesh->light_count];
        *light = notes->light[mesh->light_count];
        light->position = vec3_sub(light->position, mesh->origin);
    }
    return mesh->light != NULL;
}

static Camera in_place(const ShownMesh *mesh, const Camera *camera)
{
    Camera moved = *camera;
    moved.eye = vec3_sub(camera->eye, mesh->origin);
    moved.target = vec3_sub(camera->target, mesh->origin);
    return moved;
}

static bool first_camera(const PlyNotes *notes, const ShownMesh *mesh, const Options *options,
                         Camera *camera, Error *err)
{
    const bool own = options_given(options, OPTION_EYE);
    uint32_t named = 0;
    while (options->camera != NULL && named < notes->camera_count &&
           strcmp(notes->camera[named].name, options->camera) != 0)
        named++;
    if (own) {
        const Vec3 middle = vec3_add(vec3_lerp(mesh->lo, mesh->hi, 0.5), mesh->origin);
        *camera = (Camera){ .name = "own", .eye = options->eye, .up = mesh->up,
                            .target = options_given(options, OPTION_TARGET) ? options->target
                                                                            : middle,
                            .vertical_fov = OWN_FOV };
        *camera = in_place(mesh, camera);
    } else if (named < notes->camera_count) {
        *camera = in_place(mesh, &notes->camera[named]);
    } else if (options->camera != NULL) {
        return error_set(err, ERROR_USAGE, "%s: there is no camera '%.60s' in it", options->scene,
                         options->camera);
    } else {
        view_of_triangles(mesh->bvh, mesh->lo, mesh->hi, mesh->up, camera);
    }
    if (options->fov > 0)
        camera->vertical_fov = options->fov;
    if (!(vec3_length(vec3_sub(camera->target, camera->eye)) > 0))
        return error_set(err, ERROR_USAGE, "--eye and --target are the same point");
    if (!(camera->vertical_fov < 180))
        return error_set(err, ERROR_USAGE, "--fov %g: below 180", camera->vertical_fov);
    return true;
}

static bool copy_cameras(const PlyNotes *notes, const Options *options, ShownMesh *mesh,
                         Error *err)
{
    mesh->camera = array_create((size_t)notes->camera_count + 1, sizeof *mesh->camera, "cameras",
                                err);
    if (mesh->camera == NULL || !first_camera(notes, mesh, options, &mesh->camera[0], err))
        return false;
    mesh->camera_count = 1;
    for (uint32_t i = 0; i < notes->camera_count; i++)
        mesh->camera[mesh->camera_count++] = in_place(mesh, &notes->camera[i]);
    return true;
}

/* --- all of it -------------------------------------------------------------------------------- */

/* Places near the origin, where floats are fine. */
static void bring_near(SolvedMesh *in, ShownMesh *mesh)
{
    Vec3 lo = in->position[0], hi = lo;
    for (uint32_t i = 0; i < in->vertex_count; i++) {
        lo = vec3_min(lo, in->position[i]);
        hi = vec3_max(hi, in->position[i]);
    }
    mesh->origin = vec3_lerp(lo, hi, 0.5);
    solved_mesh_move(in, mesh->origin);
}

static ShownMesh *make_mesh(SolvedMesh *in, const Options *options, Error *err)
{
    ShownMesh *mesh = array_create(1, sizeof *mesh, "mesh", err);
    if (mesh == NULL)
        return NULL;
    atomic_init(&mesh->references, 1);
    if (!count_parts(in, mesh, options->scene, err))
        return shown_mesh_leave(mesh);
    if (in->far)
        bring_near(in, mesh);
    mesh->up = options_given(options, OPTION_UP) ? vec3_unit(options->up)
               : in->notes.has_up ? in->notes.up : vec3(0, 1, 0);
    if (!take_room(mesh, err) || !copy_names(in, mesh, err) || !copy_lights(&in->notes, mesh, err))
        return shown_mesh_leave(mesh);
    fill_faces(in, mesh);
    fill_patches(in, mesh);
    const Primitives primitives = { .position = mesh->position, .corner = mesh->corner,
                                    .vertex_count = mesh->vertex_count,
                                    .triangle_count = mesh->triangle_count };
    mesh->bvh = bvh_create(&primitives, options->threads, err);
    return mesh->bvh != NULL && copy_cameras(&in->notes, options, mesh, err)
               ? mesh : shown_mesh_leave(mesh);
}

static void fill_vertices(const SolvedMesh *in, const ShownMesh *mesh, float *out)
{
    for (size_t i = 0; i < 3 * (size_t)mesh->plain_count; i++)
        out[i] = (float)in->radiosity[i];
    for (uint32_t i = mesh->plain_count; i < mesh->vertex_count; i++) {
        const uint32_t *of = mesh->mean_of + 4 * (size_t)(i - mesh->plain_count);
        for (size_t c = 0; c < 4; c++)
            for (size_t k = 0; k < 3; k++)
                out[3 * (size_t)i + k] += 0.25F * (float)in->radiosity[3 * (size_t)of[c] + k];
    }
}

static float *face_layer(const SolvedMesh *in, uint32_t patches, const double *value, Error *err)
{
    float *out = array_create(3 * (size_t)patches, sizeof *out, "layer", err);
    for (uint32_t f = 0; out != NULL && f < in->face_count; f++)
        for (size_t k = 0; k < 3; k++)
            out[3 * (size_t)in->patch[f] + k] = (float)value[3 * (size_t)f + k];
    return out;
}

Snapshot *solved_shown(SolvedMesh *solved, const Options *options, Error *err)
{
    assert(solved != NULL && options->scene != NULL);
    Snapshot *s = array_create(1, sizeof *s, "snapshot", err);
    if (s == NULL)
        return NULL;
    s->mesh = make_mesh(solved, options, err);
    s->shooter = PATCH_NONE;
    s->step = STEP_SOLVED;
    if (s->mesh != NULL) {
        const uint32_t patches = s->mesh->patch_count;
        s->vertex = array_create(3 * (size_t)s->mesh->vertex_count, sizeof *s->vertex, "vertices",
                                 err);
        s->layer[LAYER_RADIOSITY] = face_layer(solved, patches, solved->face_radiosity, err);
        s->layer[LAYER_IRRADIANCE] = face_layer(solved, patches, solved->face_irradiance, err);
    }
    if (error_is_set(err))
        return snapshot_destroy(s);
    fill_vertices(solved, s->mesh, s->vertex);
    return s;
}
