/* SPDX-License-Identifier: BSD-3-Clause */
/* Files named in an MSD file: INCLUDE and BREPOBJ. Each is read once, however often it is used. */
#include <assert.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"
#include "scenes/msd.h"

/* A hand-written scene has kilobytes; beyond this something else was meant. */
static const size_t TEXT_MAX = (size_t)1 << 30;
/* Files within files; a cycle is told apart and needs no limit. */
static const unsigned INCLUDES_MAX = 32;

/* --- sources --------------------------------------------------------------------------------- */

bool msd_source_add(MsdReader *r, const char *path, const char *real, char *text, size_t size,
                    uint32_t *index)
{
    assert(path != NULL && index != NULL);
    if (text == NULL || !array_reserve((void **)&r->sources, &r->source_capacity,
                                       r->source_count + 1, sizeof *r->sources, "files", r->err)) {
        array_free(text);
        return false;
    }
    MsdSource *source = &r->sources[r->source_count];
    *source = (MsdSource){ .path = array_string(path, r->err), .text = text, .size = size };
    source->real = array_string(real != NULL ? real : path, r->err);
    *index = (uint32_t)r->source_count++; /* from here on freed with the reader */
    r->scene->hash = file_hash(text, size, r->scene->hash);
    return !error_is_set(r->err);
}

bool msd_source_open(MsdReader *r, const char *path, const MsdPlace *from, uint32_t *index)
{
    char        buffer[PATH_MAX];
    const char *real = realpath(path, buffer);
    Error       cause = { 0 };
    size_t      size = 0;

    for (size_t i = 0; real != NULL && i < r->source_count; i++)
        if (strcmp(r->sources[i].real, real) == 0) {
            *index = (uint32_t)i;
            return true;
        }
    char *text = file_read(path, TEXT_MAX, &size, &cause);
    if (text == NULL)
        return from != NULL ? msd_error_from(r, *from, &cause)
                            : error_set(r->err, cause.code, "%s", cause.text);
    return msd_source_add(r, path, real, text, size, index);
}

/* A path that is named in the source of `place`. */
static bool path_beside(MsdReader *r, MsdPlace place, const char *name, char path[PATH_MAX])
{
    if (!r->files_allowed)
        return msd_error(r, place, "found the name of a file, which may not be opened here");
    if (!file_beside(r->sources[place.source].path, name, path, PATH_MAX))
        return msd_error(r, place, "found a file name that is too long");
    return true;
}

/* --- INCLUDE file [name] [surface] ; ---------------------------------------------------------- */

typedef struct {
    MsdPlace place;
    char     file[MSD_PATH_MAX];
    uint32_t name;     /* symbol, or MSD_NONE */
    uint32_t override; /* material, or MSD_NONE */
} Include;

static bool include_read(MsdReader *r, Include *in)
{
    in->place = r->token.place;
    in->name = in->override = MSD_NONE;
    if (!msd_file_name(r, in->file, sizeof in->file))
        return false;
    if (r->token.kind == TOKEN_NAME) {
        in->name = r->token.symbol;
        if (!msd_next(r))
            return false;
    }
    return msd_is(r, ';') || msd_surface_use(r, &in->override);
}

/* Reads the file, then goes on behind the INCLUDE. */
static bool include_run(MsdReader *r, const Include *in)
{
    const MsdPlace behind = r->token.place;
    const uint32_t group = r->group, override = r->override;
    char           path[PATH_MAX];
    uint32_t       source = 0;

    if (!path_beside(r, in->place, in->file, path) ||
        !msd_source_open(r, path, &in->place, &source))
        return false;
    if (r->sources[source].active)
        return msd_error(r, in->place, "file %.150s includes itself", in->file);
    if (r->includes >= INCLUDES_MAX)
        return msd_error(r, in->place, "INCLUDE nested more than %u deep", INCLUDES_MAX);
    r->includes++;
    if (r->override == MSD_NONE)
        r->override = in->override;
    if (r->group == MSD_NONE)
        r->group = in->name;
    if (!msd_file(r, source, IN_INCLUDE))
        return false;
    r->group = group;
    r->override = override;
    r->includes--;
    return msd_jump(r, behind);
}

bool msd_include(MsdReader *r)
{
    Include in;

    if (!include_read(r, &in))
        return false;
    /* The sign behind is read again after the file: it must be the current token, not gone. */
    if (!msd_is(r, ';'))
        return msd_expected(r, in.name == MSD_NONE ? "a name, a surface or ';'" : "';'");
    if (r->dry == 0 && !include_run(r, &in))
        return false;
    if (in.name != MSD_NONE) {
        const MsdBinding b = { .symbol = in.name, .kind = NAME_OBJECT,
                               .as.object = { .place = in.place, .range = r->colour_range } };
        if (!msd_define(r, &b))
            return false;
    }
    return msd_next(r);
}

/* --- BREPOBJ surface "file" ------------------------------------------------------------------- */

/* The file's polygons as they are, from the first use on kept in r->imports. */
static bool import_open(MsdReader *r, MsdPlace place, const char *path, size_t *index)
{
    const Material grey = material_default();
    const Affine   still = affine_identity();
    Error          cause = { 0 };
    uint32_t       material = 0;

    for (*index = 0; *index < r->import_count; ++*index)
        if (strcmp(r->imports[*index].real, path) == 0)
            return true;
    if (!array_reserve((void **)&r->imports, &r->import_capacity, r->import_count + 1,
                       sizeof *r->imports, "imported files", r->err))
        return false;
    MsdImport *import = &r->imports[r->import_count];
    *import = (MsdImport){ .real = array_string(path, r->err) };
    if (import->real == NULL)
        return false;
    r->import_count++;
    if (!polygons_add_material(&import->polygons, &grey, &material, r->err))
        return false;
    if (!scene_import_into(&import->polygons, path, material, &still, r->options,
                           &r->scene->hash, &cause))
        return msd_error_from(r, place, &cause);
    if (!polygons_bounds(&import->polygons, &import->lo, &import->hi))
        import->lo = import->hi = vec3(0, 0, 0);
    return true;
}

/* One name for the whole object when GROUP or REF gives one or the file has none of its own. */
static bool import_group(MsdReader *r, const Polygons *polygons, const MsdThing *thing,
                         uint32_t *group)
{
    const bool nameless = polygons->group_count == 0 ||
                          (polygons->group_count == 1 &&
                           strcmp(polygons->group_name[0], "default") == 0);
    *group = MSD_NONE;
    return (r->group == MSD_NONE && !nameless) || msd_group(r, thing, group);
}

bool msd_brep(MsdReader *r, const MsdThing *thing)
{
    const MsdPlace place = r->token.place;
    char           name[MSD_PATH_MAX], path[PATH_MAX];
    uint32_t       group = MSD_NONE;
    size_t         index = 0;

    if (!msd_string(r, "a file name in quotes", name, sizeof name))
        return false;
    if (r->dry > 0)
        return true;
    if (!path_beside(r, place, name, path) || !import_open(r, place, path, &index))
        return false;
    return import_group(r, &r->imports[index].polygons, thing, &group) &&
           msd_place(r, thing, index, group);
}
