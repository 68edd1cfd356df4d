/* SPDX-License-Identifier: BSD-3-Clause */
/* The parent's side of an import: records from the child, each value checked, into the target. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"
#include "scenes/import.h"
#include "scenes/import_child.h"
#include "scenes/texture_read.h"

static const double   default_seconds = 120;
static const uint64_t default_memory = (uint64_t)8 << 30;

/* Values taken from the pipe at a time: room grows with what really came. */
#define CHUNK 4096

/* A mesh that is placed, and the box around it. */
typedef struct {
    uint32_t prototype;
    Vec3     lo, hi;
} Mesh;

typedef struct {
    ImportTarget *target;
    PipeReader    in;
    Mesh         *mesh;          /* [mesh_count]  the child's number -> the scene's prototype */
    size_t        mesh_count, mesh_capacity;
    uint32_t     *material;      /* [material_count]  the child's number -> the soup's */
    size_t        material_count, material_capacity;
    uint32_t     *texture;       /* [texture_count]  likewise, 1 + the scene's; 0: not wanted */
    size_t        texture_count, texture_capacity;
    double      (*uv)[2];        /* of the vertices of the current part; unused without */
    size_t        uv_capacity;
    double      (*corner_uv)[2]; /* of the current face */
    size_t        corner_uv_capacity;
    Vec3         *normal;        /* likewise */
    size_t        normal_capacity;
    Vec3         *corner_normal;
    size_t        corner_normal_capacity;
    bool          mapped, shaded;
    uint32_t     *size;          /* corners of each face of the current part */
    size_t        size_capacity;
    uint32_t     *corner;        /* of the current face */
    size_t        corner_capacity;
} Receiver;

/* --- records ---------------------------------------------------------------------------------- */

static bool material_take(Receiver *r, Error *err)
{
    char name[256];
    Material m = material_default();
    uint32_t index;

    pipe_get_text(&r->in, name, sizeof name);
    m.name = name;
    m.reflectance = pipe_get_rgb(&r->in);
    m.emission = pipe_get_rgb(&r->in);
    m.specular = pipe_get_rgb(&r->in);
    m.exponent = pipe_get_double(&r->in);
    m.transmittance = pipe_get_rgb(&r->in);
    m.ior = pipe_get_double(&r->in);
    m.roughness = pipe_get_double(&r->in);
    if (r->in.state != PIPE_GOOD)
        return false;
    if (!(m.ior >= 1) || !isfinite(m.ior) || isnan(m.exponent) ||
        !(m.roughness >= 0 && m.roughness <= 1))
        return pipe_nonsense(&r->in);
    if (!array_reserve((void **)&r->material, &r->material_capacity, r->material_count + 1,
                       sizeof *r->material, "materials", err) ||
        !import_add_material(r->target, &m, &index, err))
        return false;
    r->material[r->material_count++] = index;
    return true;
}

/* Whether the target has room for images and for placed meshes: a scene of its own, whose materials
 * are kept. */
static bool owns_scene(const ImportTarget *target)
{
    return target->scene != NULL && target->soup == &target->scene->polygons && !target->replace;
}

static bool image_texture_take(Receiver *r, Error *err)
{
    Texture  texture;
    uint32_t index = 0;

    if (!texture_take(&r->in, &texture, err))
        return false;
    if (!array_reserve((void **)&r->texture, &r->texture_capacity, r->texture_count + 1,
                       sizeof *r->texture, "textures", err)) {
        texture_clear(&texture);
        return false;
    }
    if (!owns_scene(r->target)) {
        texture_clear(&texture);
    } else if (textures_add(&r->target->scene->textures, &texture, &index, err)) {
        index++;
    } else {
        return false;
    }
    r->texture[r->texture_count++] = index;
    return true;
}

static bool image_take(Receiver *r)
{
    const uint32_t material = pipe_get_u32(&r->in), image = pipe_get_u32(&r->in);
    const uint32_t wrap = pipe_get_u32(&r->in), cut = pipe_get_u32(&r->in);

    if (r->in.state != PIPE_GOOD)
        return false;
    if (material >= r->material_count || image >= r->texture_count || wrap > WRAP_MIRROR)
        return pipe_nonsense(&r->in);
    if (r->texture[image] == 0)
        return true;
    Texture  *texture = &r->target->scene->textures.texture[r->texture[image] - 1];
    Material *m = &r->target->soup->materials[r->material[material]];
    texture->wrap = (TextureWrap)wrap;
    m->texture = r->texture[image];
    m->cut_out = cut != 0 && texture->clear;
    return true;
}

static bool glow_take(Receiver *r)
{
    const uint32_t material = pipe_get_u32(&r->in);
    const Rgb mean = pipe_get_rgb(&r->in);

    if (r->in.state != PIPE_GOOD)
        return false;
    if (material >= r->material_count || !(mean.r >= 0 && mean.g >= 0 && mean.b >= 0) ||
        !isfinite(mean.r + mean.g + mean.b))
        return pipe_nonsense(&r->in);
    if (r->target->replace)
        return true;
    Material *m = &r->target->soup->materials[r->material[material]];
    if (!(rgb_max(m->emission) > 0))
        return true;
    m->emission = rgb_mul(m->emission, mean);
    scene_limit_material(m, r->target->path, r->target->options);
    monitor_warn(r->target->options->monitor, "emission-evened", r->target->path,
                 "material \"%s\" emits the mean of its image everywhere", m->name);
    return true;
}

/* What is no number counts as 0: an image may be wrong, light is not. */
static bool uv_take(Receiver *r, uint32_t count, Error *err)
{
    for (uint32_t done = 0; done < count; done++) {
        if (!array_reserve((void **)&r->uv, &r->uv_capacity, (size_t)done + 1, sizeof *r->uv,
                           "places in images", err))
            return false;
        for (int k = 0; k < 2; k++) {
            const double v = pipe_get_double(&r->in);
            r->uv[done][k] = isfinite(v) ? v : 0;
        }
    }
    return r->in.state == PIPE_GOOD;
}

static bool normals_take(Receiver *r, uint32_t count, Error *err)
{
    for (uint32_t done = 0; done < count && r->in.state == PIPE_GOOD; done++) {
        if (!array_reserve((void **)&r->normal, &r->normal_capacity, (size_t)done + 1,
                           sizeof *r->normal, "normals", err))
            return false;
        r->normal[done] = pipe_get_vec3(&r->in);
    }
    return r->in.state == PIPE_GOOD;
}

static bool vertices_take(Receiver *r, const char *group, uint32_t count, uint32_t *base,
                          Error *err)
{
    Vec3 chunk[CHUNK / sizeof(Vec3)];
    const uint32_t step = sizeof chunk / sizeof *chunk;
    uint32_t index;

    for (uint32_t done = 0; done < count;) {
        const uint32_t take = count - done < step ? count - done : step;
        if (!pipe_read(&r->in, chunk, take * sizeof *chunk))
            return false;
        for (uint32_t i = 0; i < take; i++) {
            if (!vec3_finite(chunk[i]))
                return error_at(err, ERROR_INPUT, r->target->path, 0,
                                "object \"%.80s\" has a vertex that is not finite", group);
            if (!import_add_vertex(r->target, chunk[i], &index, err))
                return false;
            if (done == 0 && i == 0)
                *base = index;
        }
        done += take;
    }
    return true;
}

static bool sizes_take(Receiver *r, uint32_t faces, Error *err)
{
    for (uint32_t done = 0; done < faces;) {
        const uint32_t take = faces - done < CHUNK ? faces - done : CHUNK;
        if (!array_reserve((void **)&r->size, &r->size_capacity, (size_t)done + take,
                           sizeof *r->size, "faces", err) ||
            !pipe_read(&r->in, r->size + done, take * sizeof *r->size))
            return false;
        done += take;
    }
    return true;
}

static bool corner_room(Receiver *r, size_t count, Error *err)
{
    return array_reserve((void **)&r->corner, &r->corner_capacity, count, sizeof *r->corner,
                         "corners of a face", err) &&
           array_reserve((void **)&r->corner_uv, &r->corner_uv_capacity, count,
                         sizeof *r->corner_uv, "corners of a face", err) &&
           array_reserve((void **)&r->corner_normal, &r->corner_normal_capacity, count,
                         sizeof *r->corner_normal, "corners of a face", err);
}

/* The file itself may hold indices out of range (the child refuses them): here it is nonsense. */
static bool face_take(Receiver *r, uint32_t size, uint32_t base, uint32_t vertices,
                      uint32_t material, uint32_t group, Error *err)
{
    if (size < 3)
        return pipe_nonsense(&r->in);
    for (uint32_t i = 0; i < size; i++) {
        if (!corner_room(r, (size_t)i + 1, err))
            return false;
        const uint32_t corner = pipe_get_u32(&r->in);
        if (r->in.state != PIPE_GOOD)
            return false;
        if (corner >= vertices)
            return pipe_nonsense(&r->in);
        r->corner[i] = base + corner;
        if (r->mapped)
            memcpy(r->corner_uv[i], r->uv[corner], sizeof r->uv[corner]);
        if (r->shaded)
            r->corner_normal[i] = r->normal[corner];
    }
    const ImportFace face = { .corner = r->corner, .count = size, .material = material,
                              .group = group,
                              .uv = r->mapped ? (const double (*)[2])r->corner_uv : NULL,
                              .normal = r->shaded ? r->corner_normal : NULL };
    return import_add_valued(r->target, &face, err);
}

static bool given_material(Receiver *r, uint32_t given, uint32_t *material, Error *err)
{
    if (given == PIPE_NO_MATERIAL)
        return import_plain_material(r->target, material, err);
    if (given >= r->material_count)
        return pipe_nonsense(&r->in);
    *material = r->material[given];
    return true;
}

static bool part_take(Receiver *r, Error *err)
{
    char name[256];

    pipe_get_text(&r->in, name, sizeof name);
    const uint32_t given = pipe_get_u32(&r->in);
    const uint32_t vertices = pipe_get_u32(&r->in);
    const uint32_t faces = pipe_get_u32(&r->in);
    const uint32_t mapped = pipe_get_u32(&r->in), shaded = pipe_get_u32(&r->in);
    uint32_t base = 0, group, material;

    if (r->in.state != PIPE_GOOD)
        return false;
    if (!given_material(r, given, &material, err) ||
        !import_add_group(r->target, name, &group, err) ||
        !vertices_take(r, name, vertices, &base, err) ||
        (shaded != 0 && !normals_take(r, vertices, err)) ||
        (mapped != 0 && !uv_take(r, vertices, err)) || !sizes_take(r, faces, err))
        return false;
    r->mapped = mapped != 0;
    r->shaded = shaded != 0;
    for (uint32_t i = 0; i < faces; i++)
        if (!face_take(r, r->size[i], base, vertices, material, group, err))
            return false;
    return true;
}

/* Into a soup of its own: its material and group are of no meaning. */
static bool mesh_faces_take(Receiver *r, Error *err)
{
    const uint32_t vertices = pipe_get_u32(&r->in), faces = pipe_get_u32(&r->in);
    const uint32_t shaded = pipe_get_u32(&r->in);
    const Material grey = material_default();
    uint32_t base = 0, group, material;

    if (r->in.state != PIPE_GOOD ||
        !polygons_add_material(r->target->soup, &grey, &material, err) ||
        !import_add_group(r->target, "", &group, err) ||
        !vertices_take(r, "", vertices, &base, err) ||
        (shaded != 0 && !normals_take(r, vertices, err)) || !sizes_take(r, faces, err))
        return false;
    r->mapped = false;
    r->shaded = shaded != 0;
    for (uint32_t i = 0; i < faces; i++)
        if (!face_take(r, r->size[i], base, vertices, material, group, err))
            return false;
    return true;
}

static bool mesh_take(Receiver *r, Error *err)
{
    Polygons soup = { 0 };
    Mesh mesh = { 0 };
    ImportTarget own = { .path = r->target->path, .options = r->target->options, .soup = &soup,
                         .map = affine_identity(), .replace = true, .stem = "mesh" };
    ImportTarget *target = r->target;

    if (!owns_scene(target))
        return pipe_nonsense(&r->in);
    r->target = &own;
    const bool good = mesh_faces_take(r, err);
    r->target = target;
    if (good && !polygons_bounds(&soup, &mesh.lo, &mesh.hi))
        mesh.lo = mesh.hi = vec3(0, 0, 0);
    if (!good || !array_reserve((void **)&r->mesh, &r->mesh_capacity, r->mesh_count + 1,
                                sizeof *r->mesh, "placed meshes", err)) {
        polygons_clear(&soup);
        return false;
    }
    if (!scene_add_prototype(target->scene, &soup, &mesh.prototype, err))
        return false;
    r->mesh[r->mesh_count++] = mesh;
    return true;
}

/* Whether the placed mesh has places that are numbers. */
static bool mesh_reachable(const Mesh *mesh, const Affine *map)
{
    for (int k = 0; k < 8; k++) {
        const Vec3 corner = vec3(k & 1 ? mesh->hi.x : mesh->lo.x, k & 2 ? mesh->hi.y : mesh->lo.y,
                                 k & 4 ? mesh->hi.z : mesh->lo.z);
        if (!vec3_finite(affine_point(map, corner)))
            return false;
    }
    return true;
}

static bool place_take(Receiver *r, Error *err)
{
    char name[256];
    Placement place = { 0 };
    Affine back;

    pipe_get_text(&r->in, name, sizeof name);
    const uint32_t number = pipe_get_u32(&r->in), given = pipe_get_u32(&r->in);
    place.to_world.x = pipe_get_vec3(&r->in);
    place.to_world.y = pipe_get_vec3(&r->in);
    place.to_world.z = pipe_get_vec3(&r->in);
    place.to_world.t = pipe_get_vec3(&r->in);
    if (r->in.state != PIPE_GOOD)
        return false;
    if (number >= r->mesh_count || !affine_invert(&place.to_world, &back))
        return pipe_nonsense(&r->in);
    if (!mesh_reachable(&r->mesh[number], &place.to_world))
        return error_at(err, ERROR_INPUT, r->target->path, 0,
                        "object \"%.80s\" has a vertex that is not finite", name);
    place.prototype = r->mesh[number].prototype;
    r->target->faces++;
    return given_material(r, given, &place.material, err) &&
           scene_add_placement(r->target->scene, &place, err);
}

static bool light_take(Receiver *r, Error *err)
{
    Light light = { 0 };

    pipe_get_text(&r->in, light.name, sizeof light.name);
    const uint32_t kind = pipe_get_u32(&r->in);
    light.position = pipe_get_vec3(&r->in);
    light.direction = pipe_get_vec3(&r->in);
    light.intensity = pipe_get_rgb(&r->in);
    light.cos_inner = pipe_get_double(&r->in);
    light.cos_outer = pipe_get_double(&r->in);
    if (r->in.state != PIPE_GOOD)
        return false;
    const Rgb i = light.intensity;
    if (kind > LIGHT_COSINE || !vec3_finite(light.position) || !vec3_finite(light.direction) ||
        !(i.r >= 0 && i.g >= 0 && i.b >= 0 && isfinite(i.r + i.g + i.b)) ||
        !(light.cos_outer <= light.cos_inner))
        return pipe_nonsense(&r->in);
    light.kind = (LightKind)kind;
    return r->target->scene == NULL || scene_add_light(r->target->scene, &light, err);
}

static bool camera_take(Receiver *r, Error *err)
{
    Camera camera = { 0 };

    pipe_get_text(&r->in, camera.name, sizeof camera.name);
    camera.eye = pipe_get_vec3(&r->in);
    camera.target = pipe_get_vec3(&r->in);
    camera.up = pipe_get_vec3(&r->in);
    camera.vertical_fov = pipe_get_double(&r->in);
    camera.aspect = pipe_get_double(&r->in);
    if (r->in.state != PIPE_GOOD)
        return false;
    if (!vec3_finite(camera.eye) || !vec3_finite(camera.target) || !vec3_finite(camera.up) ||
        !(camera.vertical_fov > 0 && camera.vertical_fov < 180) ||
        !(camera.aspect >= 0 && isfinite(camera.aspect)))
        return pipe_nonsense(&r->in);
    return r->target->scene == NULL || scene_add_camera(r->target->scene, &camera, err);
}

static bool up_take(Receiver *r)
{
    const Vec3 up = pipe_get_vec3(&r->in);

    if (r->in.state != PIPE_GOOD)
        return false;
    if (!vec3_finite(up) || !(vec3_length(up) > 0))
        return pipe_nonsense(&r->in);
    if (r->target->scene != NULL)
        r->target->scene->up = vec3_unit(up);
    return true;
}

static bool warning_take(Receiver *r)
{
    char code[64], where[256], text[512];

    pipe_get_text(&r->in, code, sizeof code);
    pipe_get_text(&r->in, where, sizeof where);
    pipe_get_text(&r->in, text, sizeof text);
    if (r->in.state != PIPE_GOOD)
        return false;
    monitor_warn(r->target->options->monitor, code, where, "%s", text);
    return true;
}

static bool error_take(Receiver *r, Error *err)
{
    char text[512];
    const uint32_t code = pipe_get_u32(&r->in);

    pipe_get_text(&r->in, text, sizeof text);
    if (r->in.state != PIPE_GOOD)
        return false;
    return error_set(err, code == ERROR_MEMORY ? ERROR_MEMORY : ERROR_INPUT, "%s", text);
}

/* --- the whole -------------------------------------------------------------------------------- */

/* Takes one record; false at the last one too, which sets *complete. */
static bool record_take(Receiver *r, bool *complete, Error *err)
{
    uint8_t kind;
    uint64_t hash;

    if (!pipe_read(&r->in, &kind, 1))
        return false;
    switch (kind) {
    case RECORD_MATERIAL: return material_take(r, err);
    case RECORD_TEXTURE: return image_texture_take(r, err);
    case RECORD_IMAGE: return image_take(r);
    case RECORD_GLOW: return glow_take(r);
    case RECORD_PART: return part_take(r, err);
    case RECORD_MESH: return mesh_take(r, err);
    case RECORD_PLACE: return place_take(r, err);
    case RECORD_LIGHT: return light_take(r, err);
    case RECORD_CAMERA: return camera_take(r, err);
    case RECORD_UP: return up_take(r);
    case RECORD_WARNING: return warning_take(r);
    case RECORD_ERROR: return error_take(r, err);
    case RECORD_LOOSE: r->target->loose += pipe_get_u64(&r->in); return r->in.state == PIPE_GOOD;
    case RECORD_END:
        hash = pipe_get_u64(&r->in);
        r->target->hash = file_hash(&hash, sizeof hash, r->target->hash);
        *complete = r->in.state == PIPE_GOOD;
        return false;
    default: return pipe_nonsense(&r->in);
    }
}

/* Why the records broke off, as far as the pipe knows; the child's own end may say more. */
static void state_tell(const Receiver *r, double seconds, Error *err)
{
    const char *path = r->target->path;

    if (r->in.state == PIPE_STOPPED)
        error_set(err, ERROR_STOPPED, "%s: stopped while it was being read", path);
    else if (r->in.state == PIPE_TIMEOUT)
        error_at(err, ERROR_INPUT, path, 0, "the importer needed more than %g seconds", seconds);
    else if (r->in.state == PIPE_NONSENSE)
        error_at(err, ERROR_INPUT, path, 0, "the importer handed back data that make no sense; "
                 "the file is damaged or uses something it cannot read");
}

/* A mesh for another's scene is faces alone. */
static PipeWish wish_of(const ImportTarget *target)
{
    const SceneReadOptions *o = target->options;
    return (PipeWish){ .instances = owns_scene(target) ? o->instances : INSTANCES_FLATTEN,
                       .most = o->instances_most > 0 ? o->instances_most : INSTANCES_MOST };
}

bool import_from_child(ImportTarget *target, ImportWork work, Error *err)
{
    assert(target != NULL && work != NULL && err != NULL);
    const SceneReadOptions *options = target->options;
    const ChildLimits limits = {
        .seconds = options->import_seconds > 0 ? options->import_seconds : default_seconds,
        .memory = options->import_memory > 0 ? options->import_memory : default_memory,
        .wish = wish_of(target) };
    Receiver r = { .target = target };
    ImportChild child;
    bool complete = false;

    if (error_is_set(err) || !child_start(&child, &limits, work, target->path, err))
        return false;
    r.in = (PipeReader){ .fd = child.fd, .deadline = pipe_clock() + limits.seconds,
                         .monitor = options->monitor };
    while (record_take(&r, &complete, err)) { }
    state_tell(&r, limits.seconds, err);
    if (!complete && (error_is_set(err) || r.in.state != PIPE_ENDED))
        child_kill(&child);
    child_finish(&child, target->path, err);
    if (!complete)
        error_at(err, ERROR_INPUT, target->path, 0, "the importer ended before it was done");
    array_free(r.mesh);
    array_free(r.material);
    array_free(r.size);
    array_free(r.corner);
    array_free(r.corner_uv);
    array_free(r.uv);
    array_free(r.normal);
    array_free(r.corner_normal);
    array_free(r.texture);
    return !error_is_set(err);
}
