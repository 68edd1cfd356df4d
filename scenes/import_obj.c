/* SPDX-License-Identifier: BSD-3-Clause */
/* OBJ: vertices and polygons line by line; groups are those of the last o or g.
 *
 * Two passes over the lines, so that a face may name a vertex that comes later. Positions stay in
 * double and vertices stay shared as in the file; assimp gives each corner a float vertex of its
 * own, reads UTF-16 as an empty scene, and has no line numbers for errors.
 */
#include <assert.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/array.h"
#include "base/file.h"
#include "scenes/import.h"
#include "scenes/text.h"

typedef struct {
    ImportTarget   *target;
    TextFile        text;
    MaterialLibrary library;
    uint32_t        base;            /* the soup's index of the file's first vertex */
    uint64_t        total;           /* vertices in the file */
    uint64_t        seen;            /* vertices before the current line, second pass */
    char            name[256];       /* of the current group */
    uint32_t        group;           /* UINT32_MAX: not in the soup yet */
    size_t          material;        /* in library; SIZE_MAX: none */
    uint32_t       *corner;
    size_t          corner_capacity;
    uint64_t        small;           /* faces with fewer than 3 corners */
    uint64_t        missing;         /* libraries and materials that are not there */
    uint64_t       *read;            /* [read_count]  hashes of the libraries' paths */
    size_t          read_count, read_capacity;
    double        (*uv)[2];          /* [uv_count]  of the file */
    size_t          uv_count, uv_capacity;
    uint64_t        uv_seen;         /* before the current line, second pass */
    double        (*corner_uv)[2];   /* of the current face */
    size_t          corner_uv_capacity;
    Vec3           *normal;          /* [normal_count]  of the file */
    size_t          normal_count, normal_capacity;
    uint64_t        normal_seen;     /* before the current line, second pass */
    Vec3           *corner_normal;   /* of the current face */
    size_t          corner_normal_capacity;
    char            unknown[64];     /* first statement that is not known */
} ObjReader;

/* A file may miss as many materials as it has lines: this many are told one by one. */
static const uint64_t missing_told = 20;

static const Monitor *reader_monitor(const ObjReader *r) { return r->target->options->monitor; }

/* --- material libraries ----------------------------------------------------------------------- */

/* Where the library may be: as named, or by its bare name beside the OBJ file, since paths of
 * another machine are common. */
static bool library_path(const char *obj, char *name, char *path, size_t size)
{
    struct stat info;

    for (char *c = name; *c != 0; c++)
        if (*c == '\\')
            *c = '/';
    const char *slash = strrchr(name, '/');
    const char *tries[2] = { name, slash != NULL ? slash + 1 : name };
    for (int i = 0; i < 2; i++) {
        if (tries[i][0] == 0 || !file_beside(obj, tries[i], path, size))
            continue;
        /* Not by opening it: a named pipe would wait for a writer. */
        if (stat(path, &info) == 0 && S_ISREG(info.st_mode) && access(path, R_OK) == 0)
            return true;
    }
    return false;
}

static bool library_open(ObjReader *r, char *name, bool *found, Error *err)
{
    char path[PATH_MAX];

    *found = library_path(r->text.path, name, path, sizeof path);
    if (!*found)
        return true;
    /* Some programs name the library before every object: once is enough. */
    const uint64_t hash = file_hash(path, strlen(path), 0);
    for (size_t i = 0; i < r->read_count; i++)
        if (r->read[i] == hash)
            return true;
    if (!array_reserve((void **)&r->read, &r->read_capacity, r->read_count + 1, sizeof *r->read,
                       "material libraries", err))
        return false;
    r->read[r->read_count++] = hash;
    return import_mtl(&r->library, path, &r->target->hash, err);
}

static void library_missing(ObjReader *r, const char *name)
{
    char where[256];

    if (++r->missing > missing_told)
        return;
    snprintf(where, sizeof where, "%s:%u", r->text.path, r->text.line);
    monitor_warn(reader_monitor(r), "material-missing", where,
                 "material library \"%s\" is not there; its materials become grey 0.5", name);
}

/* The whole rest is one name with spaces; if there is no such file, it is several names. */
static bool libraries_read(ObjReader *r, const char *line, Error *err)
{
    char rest[1024], name[1024], missing[1024] = "";
    bool found, any = false;

    text_rest(line, rest, sizeof rest);
    snprintf(name, sizeof name, "%s", rest);
    if (!library_open(r, name, &found, err))
        return false;
    if (found)
        return true;
    for (Word word; (word = text_word(&line)).length > 0; any = any || found) {
        snprintf(name, sizeof name, "%.*s", (int)(word.length < 1000 ? word.length : 1000),
                 word.begin);
        if (!library_open(r, name, &found, err))
            return false;
        if (!found)
            snprintf(missing, sizeof missing, "%s", name);
    }
    if (!any)
        library_missing(r, rest);
    else if (missing[0] != 0)
        library_missing(r, missing);
    return true;
}

static bool material_use(ObjReader *r, const char *line, Error *err)
{
    char name[256];

    text_rest(line, name, sizeof name);
    r->material = library_find(&r->library, name);
    if (r->material != SIZE_MAX)
        return true;
    if (name[0] == 0)
        return true; /* "usemtl" alone: no material */
    char where[256];
    const Material grey = material_default();
    snprintf(where, sizeof where, "%s:%u", r->text.path, r->text.line);
    if (++r->missing <= missing_told)
        monitor_warn(reader_monitor(r), "material-missing", where,
                     "material \"%s\" is in no material library; grey 0.5 is used", name);
    return library_add(&r->library, name, &grey, &r->material, err);
}

/* The soup's material for the faces that follow; only what is used gets there. */
static bool material_index(ObjReader *r, uint32_t *index, Error *err)
{
    if (r->material == SIZE_MAX)
        return import_plain_material(r->target, index, err);
    uint32_t *known = &r->library.index[r->material];
    if (*known == UINT32_MAX) {
        Material m = r->library.material[r->material];
        const MaterialImages *images = &r->library.images[r->material];
        if (r->target->scene != NULL && !r->target->replace && images->path != NULL &&
            !import_images(r->target, images, &m, err))
            return false;
        if (!import_add_material(r->target, &m, known, err))
            return false;
    }
    *index = *known;
    return true;
}

/* --- faces ------------------------------------------------------------------------------------ */

/* Which of `count` values of the file "7/1/3" names behind its `which`th slash; SIZE_MAX: none, or
 * one that is not there. */
static size_t value_named(Word word, int which, uint64_t seen, size_t count)
{
    const char *end = word.begin + word.length, *at = word.begin;
    char *stop = NULL;
    for (int k = 0; k < which && at != NULL; k++) {
        at = memchr(at, '/', (size_t)(end - at));
        at = at != NULL ? at + 1 : NULL;
    }
    if (at == NULL || at == end)
        return SIZE_MAX;
    const long long given = strtoll(at, &stop, 10);
    if (stop == at || stop > end)
        return SIZE_MAX;
    const long long place = given > 0 ? given - 1 : (long long)seen + given;
    return given != 0 && place >= 0 && (size_t)place < count ? (size_t)place : SIZE_MAX;
}

static bool corner_uv_read(const ObjReader *r, Word word, double uv[2])
{
    const size_t at = value_named(word, 1, r->uv_seen, r->uv_count);
    if (at == SIZE_MAX)
        return false;
    memcpy(uv, r->uv[at], sizeof r->uv[at]);
    return true;
}

/* 0 0 0 when there is none. */
static Vec3 corner_normal_read(const ObjReader *r, Word word)
{
    const size_t at = value_named(word, 2, r->normal_seen, r->normal_count);
    return at != SIZE_MAX ? r->normal[at] : vec3(0, 0, 0);
}

/* "7", "7/1", "7//3", "7/1/3" or negative: the position. */
static bool corner_read(const ObjReader *r, Word word, uint32_t *corner, Error *err)
{
    char *end = NULL;
    const long long given = strtoll(word.begin, &end, 10);

    if (end == word.begin || end > word.begin + word.length ||
        (end < word.begin + word.length && *end != '/'))
        return text_error(&r->text, err, "'%.*s' is not a corner of a face",
                          (int)(word.length < 40 ? word.length : 40), word.begin);
    if (given == 0)
        return text_error(&r->text, err, "a face names vertex 0: vertices count from 1");
    if (given > 0 ? (unsigned long long)given > r->total
                  : given < -(long long)r->seen)
        return text_error(&r->text, err, "a face names vertex %lld, but there are %llu", given,
                          (unsigned long long)(given > 0 ? r->total : r->seen));
    const uint64_t at = given > 0 ? (uint64_t)given - 1 : r->seen - (uint64_t)-given;
    *corner = r->base + (uint32_t)at;
    return true;
}

static bool corner_room(ObjReader *r, size_t count, Error *err)
{
    return array_reserve((void **)&r->corner, &r->corner_capacity, count, sizeof *r->corner,
                         "corners of a face", err) &&
           array_reserve((void **)&r->corner_uv, &r->corner_uv_capacity, count,
                         sizeof *r->corner_uv, "corners of a face", err) &&
           array_reserve((void **)&r->corner_normal, &r->corner_normal_capacity, count,
                         sizeof *r->corner_normal, "corners of a face", err);
}

static bool face_read(ObjReader *r, const char *line, Error *err)
{
    size_t count = 0;
    uint32_t material;
    bool mapped = r->uv_count > 0;

    for (Word word; (word = text_word(&line)).length > 0; count++) {
        if (!corner_room(r, count + 1, err) || !corner_read(r, word, &r->corner[count], err))
            return false;
        mapped = mapped && corner_uv_read(r, word, r->corner_uv[count]);
        if (r->normal_count > 0)
            r->corner_normal[count] = corner_normal_read(r, word);
    }
    if (count < 3) {
        r->small++;
        return true;
    }
    if (r->group == UINT32_MAX && !import_add_group(r->target, r->name, &r->group, err))
        return false;
    if (!material_index(r, &material, err))
        return false;
    mapped = mapped && r->material != SIZE_MAX && !r->target->replace &&
             r->target->soup->materials[material].texture > 0;
    const MapImage *image = mapped ? &r->library.images[r->material].colour : NULL;
    for (size_t i = 0; mapped && i < count && image->file != NULL; i++)
        for (int k = 0; k < 2; k++)
            r->corner_uv[i][k] = r->corner_uv[i][k] * image->scale[k] + image->offset[k];
    const ImportFace face = { .corner = r->corner, .count = count, .material = material,
                              .group = r->group,
                              .uv = mapped ? (const double (*)[2])r->corner_uv : NULL,
                              .normal = r->normal_count > 0 ? r->corner_normal : NULL };
    return import_add_valued(r->target, &face, err);
}

/* --- passes ----------------------------------------------------------------------------------- */

static bool vertex_read(ObjReader *r, const char *line, const char *object, Error *err)
{
    const char *rest = line;
    Vec3 p;
    uint32_t index;

    if (!text_number(&r->text, &rest, &p.x) || !text_number(&r->text, &rest, &p.y) ||
        !text_number(&r->text, &rest, &p.z)) {
        const Word bad = text_word(&rest);
        return text_error(&r->text, err, "a vertex needs three numbers; found '%.*s'",
                          (int)(bad.length < 40 ? bad.length : 40), bad.begin);
    }
    if (!vec3_finite(p))
        return text_error(&r->text, err, "vertex %llu of object \"%.60s\" is not finite",
                          (unsigned long long)r->total + 1, object);
    if (!import_add_vertex(r->target, p, &index, err))
        return false;
    if (r->total++ == 0)
        r->base = index;
    return true;
}

/* What is missing or no number counts as 0: an image may be wrong, light is not. */
static bool uv_read(ObjReader *r, const char *line, Error *err)
{
    if (!array_reserve((void **)&r->uv, &r->uv_capacity, r->uv_count + 1, sizeof *r->uv,
                       "places in images", err))
        return false;
    double *uv = r->uv[r->uv_count++];
    for (int k = 0; k < 2; k++)
        if (!text_number(&r->text, &line, &uv[k]) || !isfinite(uv[k]))
            uv[k] = 0;
    return true;
}

/* What is missing or no number makes it no normal. */
static bool normal_read(ObjReader *r, const char *line, Error *err)
{
    double n[3] = { 0, 0, 0 };
    bool good = true;

    if (!array_reserve((void **)&r->normal, &r->normal_capacity, r->normal_count + 1,
                       sizeof *r->normal, "normals", err))
        return false;
    for (int k = 0; k < 3; k++)
        good = good && text_number(&r->text, &line, &n[k]) && isfinite(n[k]);
    r->normal[r->normal_count++] = good ? vec3(n[0], n[1], n[2]) : vec3(0, 0, 0);
    return true;
}

static bool vertices_read(ObjReader *r, Error *err)
{
    char object[256] = "";

    for (const char *line; (line = text_line(&r->text)) != NULL;) {
        if (*line != 'v' && *line != 'o' && *line != 'g')
            continue;
        const Word key = text_word(&line);
        if (word_is(key, "o") || word_is(key, "g"))
            text_rest(line, object, sizeof object);
        else if (word_is(key, "v") && !vertex_read(r, line, object, err))
            return false;
        else if (word_is(key, "vt") && !uv_read(r, line, err))
            return false;
        else if (word_is(key, "vn") && !normal_read(r, line, err))
            return false;
    }
    return true;
}

/* Statements without meaning for light. */
static bool key_ignored(Word key)
{
    static const char *const ignored[] = { "vp",       "s",      "mg",         "lod",
                                           "bevel",    "c_interp", "d_interp", "maplib",
                                           "usemap",   "shadow_obj", "trace_obj" };
    for (size_t i = 0; i < sizeof ignored / sizeof *ignored; i++)
        if (word_is(key, ignored[i]))
            return true;
    return key.length == 0 || key.begin[0] == '#';
}

static bool statement_read(ObjReader *r, Word key, const char *line, Error *err)
{
    if (word_is(key, "v")) {
        r->seen++;
    } else if (word_is(key, "vt")) {
        r->uv_seen++;
    } else if (word_is(key, "vn")) {
        r->normal_seen++;
    } else if (word_is(key, "f") || word_is(key, "fo")) {
        return face_read(r, line, err);
    } else if (word_is(key, "usemtl")) {
        return material_use(r, line, err);
    } else if (word_is(key, "mtllib")) {
        return libraries_read(r, line, err);
    } else if (word_is(key, "o") || word_is(key, "g")) {
        text_rest(line, r->name, sizeof r->name);
        r->group = UINT32_MAX;
    } else if (word_is(key, "l") || word_is(key, "p")) {
        r->target->loose++;
    } else if (!key_ignored(key) && r->unknown[0] == 0) {
        snprintf(r->unknown, sizeof r->unknown, "%.*s", (int)(key.length < 40 ? key.length : 40),
                 key.begin);
    }
    return true;
}

static bool faces_read(ObjReader *r, Error *err)
{
    text_rewind(&r->text);
    for (const char *line; (line = text_line(&r->text)) != NULL;) {
        const Word key = text_word(&line);
        if (!statement_read(r, key, line, err))
            return false;
    }
    return true;
}

static void findings_tell(const ObjReader *r)
{
    if (r->missing > missing_told)
        monitor_warn(reader_monitor(r), "material-missing", r->text.path,
                     "%llu more material libraries or materials are missing",
                     (unsigned long long)(r->missing - missing_told));
    if (r->small > 0)
        monitor_warn(reader_monitor(r), "faces-ignored", r->text.path,
                     "%llu faces have fewer than 3 corners and are left out",
                     (unsigned long long)r->small);
    if (r->unknown[0] != 0)
        monitor_warn(reader_monitor(r), "statement-ignored", r->text.path,
                     "statements that are not polygons are left out, the first is '%s'",
                     r->unknown);
}

bool import_obj(ImportTarget *target, Error *err)
{
    assert(target != NULL && err != NULL);
    ObjReader r = { .target = target, .group = UINT32_MAX, .material = SIZE_MAX };
    const bool good = text_open(&r.text, target->path, import_file_limit, &target->hash, err) &&
                      vertices_read(&r, err) && faces_read(&r, err);

    if (good)
        findings_tell(&r);
    array_free(r.corner);
    array_free(r.corner_uv);
    array_free(r.uv);
    array_free(r.normal);
    array_free(r.corner_normal);
    array_free(r.read);
    library_clear(&r.library);
    text_close(&r.text);
    return good;
}
