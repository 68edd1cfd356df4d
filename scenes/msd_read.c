/* SPDX-License-Identifier: BSD-3-Clause */
/* The MSD reader from its first byte to the finished Scene. */
#include <assert.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"
#include "scenes/msd.h"

/* Faces of a scene: what 20 million take is some gigabytes, and no MSD file needs more but one
 * whose REFs multiply. */
static const uint64_t OBJECTS_MAX = 20000000;
/* Bytes of text read, by REF and INCLUDE again and again: half a minute of reading. */
static const uint64_t TEXT_READ_MAX = (uint64_t)1 << 28;
/* The same for text from memory, where a fuzzer wants an answer within milliseconds. */
static const uint64_t OBJECTS_MAX_SMALL = 20000, TEXT_READ_MAX_SMALL = 1 << 20;

static void reader_clear(MsdReader *r)
{
    for (size_t i = 0; i < r->source_count; i++) {
        array_free(r->sources[i].path);
        array_free(r->sources[i].real);
        array_free(r->sources[i].text);
    }
    for (size_t i = 0; i < r->symbol_count; i++)
        array_free(r->symbols[i].text);
    for (size_t i = 0; i < r->import_count; i++) {
        array_free(r->imports[i].real);
        polygons_clear(&r->imports[i].polygons);
    }
    array_free(r->sources);
    array_free(r->string);
    array_free(r->symbols);
    array_free(r->symbol_slot);
    array_free(r->bindings);
    array_free(r->scopes);
    array_free(r->keys);
    array_free(r->key_slot);
    array_free(r->imports);
    array_free(r->placed);
    if (r->locale != (locale_t)0)
        freelocale(r->locale);
}

static bool reader_init(MsdReader *r, const char *file, const SceneReadOptions *options, Error *err)
{
    *r = (MsdReader){ .options = options, .err = err, .map = affine_identity(), .group = MSD_NONE,
                      .override = MSD_NONE, .colour_range = 1, .objects_max = OBJECTS_MAX,
                      .text_max = TEXT_READ_MAX, .files_allowed = true };
    if (error_is_set(err))
        return false;
    r->locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (r->locale == (locale_t)0)
        return error_set(err, ERROR_FAILED, "no C locale to read numbers in");
    r->scene = scene_create(file, err);
    return r->scene != NULL;
}

/* Reads the source, frees the reader; the scene or NULL. */
static Scene *reader_finish(MsdReader *r, bool opened, uint32_t source)
{
    if (!opened || !msd_file(r, source, IN_FILE) || !msd_placed_finish(r)) {
        assert(error_is_set(r->err));
        r->scene = scene_destroy(r->scene);
    } else if (r->scene->timed && r->options != NULL) {
        r->scene->hash = file_hash(&r->options->time, sizeof r->options->time, r->scene->hash);
    }
    reader_clear(r);
    assert(r->scene == NULL || scene_check(r->scene));
    return r->scene;
}

Scene *scene_read_msd(const char *path, const SceneReadOptions *options, Error *err)
{
    assert(path != NULL && err != NULL);
    MsdReader r;
    uint32_t  source = 0;
    const bool opened = reader_init(&r, path, options, err) &&
                        msd_source_open(&r, path, NULL, &source);
    return reader_finish(&r, opened, source);
}

Scene *scene_parse_msd(const char *file, const char *text, size_t size,
                       const SceneReadOptions *options, Error *err)
{
    assert(file != NULL && (text != NULL || size == 0) && err != NULL);
    MsdReader r;
    uint32_t  source = 0;
    bool      opened = reader_init(&r, file, options, err);

    r.files_allowed = false;
    r.objects_max = OBJECTS_MAX_SMALL;
    r.text_max = TEXT_READ_MAX_SMALL;
    if (opened) {
        char *copy = array_create(size + 1, 1, "text", err);
        if (copy != NULL && size > 0)
            memcpy(copy, text, size);
        opened = msd_source_add(&r, file, NULL, copy, size, &source);
    }
    return reader_finish(&r, opened, source);
}
