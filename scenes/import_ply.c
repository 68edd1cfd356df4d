/* SPDX-License-Identifier: BSD-3-Clause */
/* PLY: vertices, faces and triangle strips; all else that a file may hold is skipped.
 *
 * assimp reads for ever when a header has no end, crashes on some properties, gives what there is
 * of a file that was cut, and refuses faces before vertices.
 */
#include <assert.h>
#include <math.h>
#include <string.h>
#include <strings.h>

#include "base/array.h"
#include "base/file.h"
#include "scenes/import.h"
#include "scenes/ply_header.h"

typedef struct {
    ImportTarget *target;
    PlyReader     ply;
    uint32_t      base;             /* the soup's index of the first vertex */
    uint64_t      vertices;
    uint32_t      group, material;
    double       *member;           /* of the current list */
    size_t        member_capacity;
    uint32_t     *corner;
    size_t        corner_capacity;
    bool          shaded;           /* vertices have normals */
    Vec3         *normal;           /* [vertices] */
    size_t        normal_capacity;
    Vec3         *corner_normal;
    size_t        corner_normal_capacity;
} PlyImport;

/* --- vertices --------------------------------------------------------------------------------- */

/* Which coordinate a property is, of the place 0, 1, 2, of the normal 3, 4, 5; or -1 for none. */
static int property_axis(const PlyProperty *property)
{
    const char *name = property->name;
    const bool normal = name[0] == 'n' || name[0] == 'N';
    const char c = normal ? name[1] : name[0];

    if (property->count_type != PLY_NO_TYPE || c == 0 || name[normal ? 2 : 1] != 0)
        return -1;
    const int axis = c == 'x' || c == 'X' ? 0 : c == 'y' || c == 'Y' ? 1
                   : c == 'z' || c == 'Z' ? 2 : -1;
    return axis >= 0 && normal ? axis + 3 : axis;
}

/* What is not finite is no normal. */
static bool normal_keep(PlyImport *p, Vec3 normal, Error *err)
{
    if (!array_reserve((void **)&p->normal, &p->normal_capacity, p->vertices + 1,
                       sizeof *p->normal, "normals", err))
        return false;
    p->normal[p->vertices] = vec3_finite(normal) ? normal : vec3(0, 0, 0);
    return true;
}

static bool vertex_read(PlyImport *p, const PlyElement *element, uint64_t number, Error *err)
{
    double place[6] = { 0, 0, 0, 0, 0, 0 };
    uint32_t index;

    for (size_t i = element->first; i < element->end; i++) {
        const PlyProperty *property = &p->ply.property[i];
        const int axis = property_axis(property);
        if (!(axis >= 0 ? ply_value(&p->ply, property->type, &place[axis])
                        : ply_skip(&p->ply, property)))
            return ply_broken(&p->ply, element, number);
    }
    ply_element_end(&p->ply);
    const Vec3 v = vec3(place[0], place[1], place[2]);
    if (!vec3_finite(v))
        return error_at(err, ERROR_INPUT, p->ply.path, 0, "vertex %llu is not finite",
                        (unsigned long long)number);
    if (!import_add_vertex(p->target, v, &index, err) ||
        (p->shaded && !normal_keep(p, vec3(place[3], place[4], place[5]), err)))
        return false;
    if (p->vertices++ == 0)
        p->base = index;
    return true;
}

/* --- faces ------------------------------------------------------------------------------------ */

static bool corner_take(const PlyImport *p, double given, const PlyElement *element,
                        uint64_t number, uint32_t *corner, Error *err)
{
    if (!(given >= 0 && given < (double)p->vertices) || given != floor(given))
        return error_at(err, ERROR_INPUT, p->ply.path, 0,
                        "element \"%s\" %llu names vertex %.17g, but there are %llu",
                        element->name, (unsigned long long)number + 1, given,
                        (unsigned long long)p->vertices);
    *corner = p->base + (uint32_t)given;
    return true;
}

static bool face_add(PlyImport *p, size_t count, Error *err)
{
    if (count < 3) {
        p->target->loose++;
        return true;
    }
    if (p->target->faces == 0 && (!import_add_group(p->target, "", &p->group, err) ||
                                  !import_plain_material(p->target, &p->material, err)))
        return false;
    if (!p->shaded)
        return import_add_face(p->target, p->corner, count, p->material, p->group, err);
    if (!array_reserve((void **)&p->corner_normal, &p->corner_normal_capacity, count,
                       sizeof *p->corner_normal, "corners of a face", err))
        return false;
    for (size_t i = 0; i < count; i++)
        p->corner_normal[i] = p->normal[p->corner[i] - p->base];
    const ImportFace face = { .corner = p->corner, .count = count, .material = p->material,
                              .group = p->group, .normal = p->corner_normal };
    return import_add_valued(p->target, &face, err);
}

static bool polygon_take(PlyImport *p, size_t count, const PlyElement *element, uint64_t number,
                         Error *err)
{
    if (!array_reserve((void **)&p->corner, &p->corner_capacity, count, sizeof *p->corner,
                       "corners of a face", err))
        return false;
    for (size_t i = 0; i < count; i++)
        if (!corner_take(p, p->member[i], element, number, &p->corner[i], err))
            return false;
    return face_add(p, count, err);
}

/* Each corner after the second makes a triangle, every other one turned round; -1 begins anew. */
static bool strip_take(PlyImport *p, size_t count, const PlyElement *element, uint64_t number,
                       Error *err)
{
    uint32_t last[2] = { 0, 0 };
    size_t run = 0;

    if (!array_reserve((void **)&p->corner, &p->corner_capacity, 3, sizeof *p->corner,
                       "corners of a face", err))
        return false;
    for (size_t i = 0; i < count; i++) {
        uint32_t corner = 0;
        if (p->member[i] == -1) {
            run = 0;
            continue;
        }
        if (!corner_take(p, p->member[i], element, number, &corner, err))
            return false;
        p->corner[0] = last[run % 2 == 0 ? 0 : 1];
        p->corner[1] = last[run % 2 == 0 ? 1 : 0];
        p->corner[2] = corner;
        if (run++ >= 2 && !face_add(p, 3, err))
            return false;
        last[0] = last[1];
        last[1] = corner;
    }
    return true;
}

static bool members_read(PlyImport *p, const PlyProperty *property, uint64_t *count, Error *err)
{
    if (!ply_count(&p->ply, property->count_type, count))
        return false;
    for (uint64_t i = 0; i < *count; i++)
        if (!array_reserve((void **)&p->member, &p->member_capacity, i + 1, sizeof *p->member,
                           "members of a list", err) ||
            !ply_value(&p->ply, property->type, &p->member[i]))
            return false;
    return true;
}

/* The list of corners goes by two names. */
static bool is_corners(const PlyProperty *property)
{
    return property->count_type != PLY_NO_TYPE &&
           (strcmp(property->name, "vertex_indices") == 0 ||
            strcmp(property->name, "vertex_index") == 0);
}

static bool face_read(PlyImport *p, const PlyElement *element, uint64_t number, Error *err)
{
    const bool strip = strcmp(element->name, "tristrips") == 0;
    uint64_t count = 0;

    for (size_t i = element->first; i < element->end; i++) {
        const PlyProperty *property = &p->ply.property[i];
        if (!(is_corners(property) ? members_read(p, property, &count, err)
                                   : ply_skip(&p->ply, property)))
            return error_is_set(err) ? false : ply_broken(&p->ply, element, number);
    }
    ply_element_end(&p->ply);
    return strip ? strip_take(p, count, element, number, err)
                 : polygon_take(p, count, element, number, err);
}

/* --- the whole -------------------------------------------------------------------------------- */

static bool other_skip(PlyImport *p, const PlyElement *element, uint64_t number)
{
    for (size_t i = element->first; i < element->end; i++)
        if (!ply_skip(&p->ply, &p->ply.property[i]))
            return ply_broken(&p->ply, element, number);
    ply_element_end(&p->ply);
    return true;
}

/* Faces may stand before their vertices: one walk for each. */
static bool body_read(PlyImport *p, bool faces, Error *err)
{
    ply_rewind(&p->ply);
    for (size_t i = 0; i < p->ply.element_count; i++) {
        const PlyElement *element = &p->ply.element[i];
        const bool is_vertex = strcmp(element->name, "vertex") == 0;
        const bool is_face = strcmp(element->name, "face") == 0 ||
                             strcmp(element->name, "tristrips") == 0;
        for (uint64_t k = 0; k < element->count; k++)
            if (!(is_vertex && !faces  ? vertex_read(p, element, k, err)
                  : is_face && faces   ? face_read(p, element, k, err)
                                       : other_skip(p, element, k)))
                return false;
    }
    return true;
}

/* Without them every vertex would lie in the origin. */
static bool header_check(PlyImport *p, Error *err)
{
    unsigned axes = 0;

    for (size_t i = 0; i < p->ply.element_count; i++)
        for (size_t k = p->ply.element[i].first; k < p->ply.element[i].end; k++)
            if (strcmp(p->ply.element[i].name, "vertex") == 0 &&
                property_axis(&p->ply.property[k]) >= 0)
                axes |= 1U << property_axis(&p->ply.property[k]);
    p->shaded = axes == 63;
    return (axes & 7) == 7 || error_at(err, ERROR_INPUT, p->ply.path, 0,
                                       "has no vertices with properties x, y and z");
}

bool import_ply(ImportTarget *target, Error *err)
{
    assert(target != NULL && err != NULL);
    PlyImport p = { .target = target };
    size_t size = 0;
    char *bytes = file_read(target->path, import_file_limit, &size, err);

    if (bytes == NULL)
        return false;
    target->hash = file_hash(bytes, size, target->hash);
    const bool good = ply_open(&p.ply, target->path, (const uint8_t *)bytes, size, err) &&
                      header_check(&p, err) && body_read(&p, false, err) &&
                      body_read(&p, true, err);
    ply_close(&p.ply);
    array_free(p.member);
    array_free(p.corner);
    array_free(p.normal);
    array_free(p.corner_normal);
    array_free(bytes);
    return good;
}
