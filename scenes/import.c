/* SPDX-License-Identifier: BSD-3-Clause */
/* Foreign scene files: which reader a file gets, and what all readers put into a scene. */
#include "scenes/import.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/array.h"

/* --- names ------------------------------------------------------------------------------------ */

/* Bytes of the UTF-8 character at c, or 0 when there is none. */
static size_t utf8_length(const unsigned char *c)
{
    const size_t length = c[0] < 0x80 ? 1 : c[0] >= 0xC2 && c[0] < 0xE0 ? 2
                        : (c[0] & 0xF0) == 0xE0 ? 3 : c[0] >= 0xF0 && c[0] < 0xF5 ? 4 : 0;

    for (size_t i = 1; i < length; i++)
        if ((c[i] & 0xC0) != 0x80)
            return 0;
    if (length >= 3) {
        const unsigned second = c[1];
        if ((c[0] == 0xE0 && second < 0xA0) || (c[0] == 0xED && second >= 0xA0) ||
            (c[0] == 0xF0 && second < 0x90) || (c[0] == 0xF4 && second >= 0x90))
            return 0;
    }
    return length;
}

/* A name that may stand in any output: valid UTF-8, no control characters; '?' for the rest. */
static void name_clean(const char *name, char *clean, size_t size)
{
    const unsigned char *c = (const unsigned char *)name;
    size_t used = 0;

    while (*c != 0) {
        const size_t length = utf8_length(c);
        const bool good = length > 0 && *c >= 0x20 && *c != 0x7F;
        const size_t put = good ? length : 1;
        if (used + put >= size)
            break;
        if (good)
            memcpy(clean + used, c, length);
        else
            clean[used] = '?';
        used += put;
        c += put;
    }
    clean[used] = 0;
}

/* --- what readers add ------------------------------------------------------------------------- */

bool import_add_vertex(ImportTarget *target, Vec3 p, uint32_t *index, Error *err)
{
    assert(target != NULL && target->soup != NULL);
    const Vec3 q = affine_point(&target->map, p);

    if (!vec3_finite(q))
        return error_at(err, ERROR_INPUT, target->path, 0, "has a position that is not finite");
    return polygons_add_vertex(target->soup, q, index, err);
}

bool import_add_face(ImportTarget *target, uint32_t *corners, size_t count, uint32_t material,
                     uint32_t group, Error *err)
{
    assert(target != NULL && corners != NULL && count >= 3);
    if (target->mirrored)
        for (size_t i = 0, j = count - 1; i < j; i++, j--) {
            const uint32_t swap = corners[i];
            corners[i] = corners[j];
            corners[j] = swap;
        }
    target->faces++;
    return polygons_add_polygon(target->soup, corners, count, material, group, err);
}

/* Corners that a linear map misses by more than this share of the image show that it is bent. */
static const double BENT = 1e-3;

static void map_corners(const ImportTarget *target, const uint32_t *corners, size_t count,
                        Vec3 *place)
{
    for (size_t i = 0; i < count; i++)
        place[i] = target->soup->position[corners[i]];
}

static bool add_shaded(ImportTarget *target, const ImportFace *face, Error *err)
{
    enum { MOST = POLYGON_SHADED_MOST };
    const size_t count = face->count;
    Vec3 mapped[MOST];
    if (!import_add_face(target, face->corner, count, face->material, face->group, err))
        return false;
    if (face->normal == NULL || count > MOST)
        return true;
    /* The corners of a target that is mirrored run the other way. */
    for (size_t i = 0; i < count; i++)
        mapped[target->mirrored ? count - 1 - i : i] = affine_cofactor(&target->map,
                                                                       face->normal[i]);
    return polygons_set_normals(target->soup, (uint32_t)target->soup->polygon_count - 1, mapped,
                                err);
}

/* One face with its map; a face without a size has none. */
static bool add_mapped(ImportTarget *target, const ImportFace *face, Error *err)
{
    enum { MOST = 16 };
    const size_t polygon = target->soup->polygon_count, count = face->count;
    Vec3    few[MOST] = { 0 };
    double  misfit = 0;
    FaceMap map = { .used = false };
    Vec3   *place = count <= MOST ? few : array_create(count, sizeof *place, "corners", err);
    if (place == NULL)
        return false;
    map_corners(target, face->corner, count, place);
    (void)face_map_fit(&map, place, face->uv, count, &misfit);
    if (place != few)
        array_free(place);
    return add_shaded(target, face, err) &&
           textures_set_map(&target->scene->textures, (uint32_t)polygon, &map, err);
}

/* Corners 0, k and k + 1 of a quad. */
static bool add_half(ImportTarget *target, const ImportFace *quad, size_t k, Error *err)
{
    const size_t at[3] = { 0, k, k + 1 };
    uint32_t corner[3];
    double   uv[3][2];
    Vec3     normal[3];
    for (size_t i = 0; i < 3; i++) {
        corner[i] = quad->corner[at[i]];
        uv[i][0] = quad->uv[at[i]][0];
        uv[i][1] = quad->uv[at[i]][1];
        normal[i] = quad->normal != NULL ? quad->normal[at[i]] : vec3(0, 0, 0);
    }
    const ImportFace half = { .corner = corner, .count = 3, .material = quad->material,
                              .group = quad->group, .uv = (const double (*)[2])uv,
                              .normal = quad->normal != NULL ? normal : NULL };
    return add_mapped(target, &half, err);
}

bool import_add_valued(ImportTarget *target, const ImportFace *face, Error *err)
{
    assert(target != NULL && face != NULL && face->corner != NULL && face->count >= 3);
    double  misfit = 0;
    Vec3    place[4];
    FaceMap map;
    if (face->uv == NULL || target->scene == NULL ||
        &target->scene->polygons != target->soup || target->replace)
        return add_shaded(target, face, err);
    if (face->count == 4) {
        map_corners(target, face->corner, 4, place);
        if (face_map_fit(&map, place, face->uv, 4, &misfit) && misfit > BENT)
            return add_half(target, face, 1, err) && add_half(target, face, 2, err);
    }
    return add_mapped(target, face, err);
}

bool import_add_group(ImportTarget *target, const char *name, uint32_t *index, Error *err)
{
    char clean[256];

    name_clean(name, clean, sizeof clean);
    return polygons_add_group(target->soup, clean[0] != 0 ? clean : target->stem, index, err);
}

bool import_add_material(ImportTarget *target, const Material *material, uint32_t *index,
                         Error *err)
{
    assert(target != NULL && material != NULL && index != NULL);
    char clean[256];
    Material m = *material;

    if (target->replace) {
        *index = target->material;
        return true;
    }
    name_clean(material->name != NULL ? material->name : "", clean, sizeof clean);
    m.name = clean;
    scene_limit_material(&m, target->path, target->options);
    return polygons_add_material(target->soup, &m, index, err);
}

bool import_plain_material(ImportTarget *target, uint32_t *index, Error *err)
{
    const Material grey = material_default();

    if (target->plain == UINT32_MAX && !import_add_material(target, &grey, &target->plain, err))
        return false;
    *index = target->plain;
    return true;
}

/* --- files ------------------------------------------------------------------------------------ */

static const char *path_ending(const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *dot = strrchr(slash != NULL ? slash : path, '.');
    return dot != NULL ? dot + 1 : "";
}

static bool file_usable(const char *path, Error *err)
{
    struct stat info;

    if (stat(path, &info) != 0)
        return error_at(err, ERROR_INPUT, path, 0, "there is no such file, or it cannot be read");
    if (S_ISDIR(info.st_mode))
        return error_at(err, ERROR_INPUT, path, 0, "is a folder, not a scene file");
    if (!S_ISREG(info.st_mode))
        return error_at(err, ERROR_INPUT, path, 0, "is not a regular file");
    if (info.st_size == 0)
        return error_at(err, ERROR_INPUT, path, 0, "the file is empty");
    if ((uint64_t)info.st_size > import_file_limit)
        return error_at(err, ERROR_INPUT, path, 0, "is larger than 2 GiB");
    return true;
}

/* Reads whatever the file is into the target. */
static bool target_read(ImportTarget *target, Error *err)
{
    const Monitor *monitor = target->options->monitor;

    if (!file_usable(target->path, err))
        return false;
    const char *ending = path_ending(target->path);
    const bool good = strcasecmp(ending, "obj") == 0   ? import_obj(target, err)
                      : strcasecmp(ending, "ply") == 0 ? import_ply(target, err)
                      : strcasecmp(ending, "vs3") == 0 ? import_vs3(target, err)
                      : import_from_child(target, import_assimp, err);
    if (!good)
        return false;
    if (target->faces == 0)
        return error_at(err, ERROR_INPUT, target->path, 0, target->loose > 0
                        ? "has no faces, only points or lines" : "has no faces");
    if (target->loose > 0)
        monitor_warn(monitor, "lines-ignored", target->path,
                     "%llu points and lines are left out: only faces reflect light",
                     (unsigned long long)target->loose);
    return true;
}

static ImportTarget target_start(const char *path, const SceneReadOptions *options)
{
    return (ImportTarget){ .path = path, .options = options, .map = affine_identity(),
                           .plain = UINT32_MAX };
}

Scene *scene_read_import(const char *path, const SceneReadOptions *options, Error *err)
{
    assert(path != NULL && options != NULL && err != NULL);
    Scene *scene = scene_create(path, err);
    ImportTarget target = target_start(path, options);

    if (scene == NULL)
        return NULL;
    /* STL comes from machine building, where z is up; the other formats say or agree on y. */
    scene->up = strcasecmp(path_ending(path), "stl") == 0 ? vec3(0, 0, 1) : vec3(0, 1, 0);
    target.soup = &scene->polygons;
    target.scene = scene;
    if (!target_read(&target, err))
        return scene_destroy(scene);
    scene->hash = target.hash;
    scene->has_screen = scene->camera_count > 0;
    return scene;
}

bool scene_import_into(Polygons *soup, const char *path, uint32_t material, const Affine *map,
                       const SceneReadOptions *options, uint64_t *hash, Error *err)
{
    assert(soup != NULL && path != NULL && map != NULL && hash != NULL && err != NULL);
    assert(material == UINT32_MAX || material < soup->material_count);
    static const SceneReadOptions usual = { 0 };
    if (error_is_set(err))
        return false;
    ImportTarget target = target_start(path, options != NULL ? options : &usual);
    const char *slash = strrchr(path, '/');
    const char *name = slash != NULL ? slash + 1 : path;
    const char *dot = strrchr(name, '.');

    if (strcasecmp(path_ending(path), "msd") == 0)
        return error_at(err, ERROR_INPUT, path, 0, "is a scene, not a mesh: INCLUDE reads it");
    target.soup = soup;
    target.map = *map;
    target.mirrored = affine_determinant(map) < 0;
    target.replace = material != UINT32_MAX;
    target.material = material;
    target.hash = *hash;
    snprintf(target.stem, sizeof target.stem, "%.*s",
             (int)(dot != NULL && dot > name ? dot - name : (int)strlen(name)), name);
    if (!target_read(&target, err))
        return false;
    *hash = target.hash;
    return true;
}
