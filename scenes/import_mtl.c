/* SPDX-License-Identifier: BSD-3-Clause */
/* Material libraries of OBJ files: what Kd, Ks, Ns, Ke, d, Tr, Tf, Ni and illum mean for light.
 *
 * assimp gives up on a whole scene for one word it half knows ("aniso") and does not tell which
 * materials are missing; the language is small enough to read here.
 */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"
#include "scenes/import.h"
#include "scenes/text.h"

/* A highlight of cos^100 is half as bright 6.7 degrees off the mirror direction; where the file
 * asks for a ray-traced reflection as sharp as that, a mirror is meant. */
static const double mirror_exponent = 100;

/* What the lines of one material said. */
typedef struct {
    char   name[256];
    Rgb    kd, ks, ke, filter;
    double ns, alpha, ni, pr; /* pr < 0: not given */
    bool   has_kd;
    MaterialImages images;  /* path is set at the end */
    int    illum;           /* -1: not given */
} MtlEntry;

static MtlEntry entry_empty(void)
{
    return (MtlEntry){ .kd = { 0.5, 0.5, 0.5 }, .filter = { 1, 1, 1 }, .alpha = 1, .ni = 1,
                       .pr = -1, .illum = -1 };
}

/* --- the table -------------------------------------------------------------------------------- */

/* The slot of that name, or the free one where it would be. */
static size_t slot_find(const MaterialLibrary *library, const char *name)
{
    assert(library->slots > library->count);
    size_t at = (size_t)file_hash(name, strlen(name), 0) & (library->slots - 1);

    while (library->slot[at] != 0 &&
           strcmp(library->material[library->slot[at] - 1].name, name) != 0)
        at = (at + 1) & (library->slots - 1);
    return at;
}

size_t library_find(const MaterialLibrary *library, const char *name)
{
    assert(library != NULL && name != NULL);
    if (library->slots == 0)
        return SIZE_MAX;
    const uint32_t found = library->slot[slot_find(library, name)];
    return found != 0 ? found - 1 : SIZE_MAX;
}

/* Room for one more name, with at least half of the slots free. */
static bool slots_reserve(MaterialLibrary *library, Error *err)
{
    static const size_t fewest = 64;

    if (library->count >= UINT32_MAX - 1)
        return error_set(err, ERROR_INPUT, "more than 2^32 materials");
    if (2 * (library->count + 1) <= library->slots)
        return true;
    const size_t slots = library->slots > 0 ? 2 * library->slots : fewest;
    uint32_t *slot = array_create(slots, sizeof *slot, "materials", err);
    if (slot == NULL)
        return false;
    array_free(library->slot);
    library->slot = slot;
    library->slots = slots;
    for (size_t i = 0; i < library->count; i++)
        slot[slot_find(library, library->material[i].name)] = (uint32_t)i + 1;
    return true;
}

bool library_add(MaterialLibrary *library, const char *name, const Material *material, size_t *at,
                 Error *err)
{
    assert(library != NULL && name != NULL && material != NULL && at != NULL);
    assert(library_find(library, name) == SIZE_MAX);
    const size_t needed = library->count + 1;

    if (!slots_reserve(library, err) ||
        !array_reserve((void **)&library->material, &library->capacity, needed,
                       sizeof *library->material, "materials", err) ||
        !array_reserve((void **)&library->index, &library->index_capacity, needed,
                       sizeof *library->index, "materials", err) ||
        !array_reserve((void **)&library->images, &library->images_capacity, needed,
                       sizeof *library->images, "materials", err))
        return false;
    char *copy = array_string(name, err);
    if (copy == NULL)
        return false;
    *at = library->count;
    library->slot[slot_find(library, copy)] = (uint32_t)*at + 1;
    library->count++;
    library->material[*at] = *material;
    library->material[*at].name = copy;
    library->index[*at] = UINT32_MAX;
    library->images[*at] = (MaterialImages){ 0 };
    return true;
}

void library_clear(MaterialLibrary *library)
{
    for (size_t i = 0; i < library->count; i++) {
        array_free(library->material[i].name);
        material_images_clear(&library->images[i]);
    }
    array_free(library->material);
    array_free(library->index);
    array_free(library->images);
    array_free(library->slot);
    *library = (MaterialLibrary){ 0 };
}

/* --- meaning ---------------------------------------------------------------------------------- */

/* Pr: a mirror, microfacets, or so rough that the solver takes it for diffuse better. Below the
 * least width a float knows no more of the distribution than of a mirror. */
static void rough_apply(double pr, Material *m)
{
    static const double least = 0.01, most = 0.9;
    m->exponent = pr < least ? INFINITY : 1;
    m->roughness = pr < least ? 0 : fmin(pr, 1);
    if (pr > most) {
        m->reflectance = rgb_add(m->reflectance, m->specular);
        m->specular = rgb(0, 0, 0);
        m->exponent = m->roughness = 0;
    }
}

/* illum 3 to 9 ask for traced reflections; 4, 6, 7 and 9 for transparency; 0 and 1 have no
 * specular part, unless there is nothing else: many exporters write illum 1 whatever they mean, and
 * a metal must not turn into a hole. Without illum: 2. */
static Material entry_material(const MtlEntry *entry)
{
    Material m = material_default();
    const int illum = entry->illum < 0 ? 2 : entry->illum;
    const bool clear = illum == 4 || illum == 6 || illum == 7 || illum == 9;
    const double alpha = fmin(fmax(entry->alpha, 0), 1);
    const double passes = alpha < 1 ? 1 - alpha : clear ? 1 : 0;

    const bool special = rgb_max(entry->ks) > 0 || rgb_max(entry->ke) > 0 || passes > 0;

    /* Without Kd: grey, but a lamp, a mirror or a pane that says no more is only that. */
    m.reflectance = rgb_scale(!entry->has_kd && special ? rgb(0, 0, 0) : entry->kd, alpha);
    m.emission = entry->ke;
    if (illum >= 2 || (entry->has_kd && rgb_max(entry->kd) == 0)) {
        m.specular = entry->ks;
        m.exponent = illum >= 3 && illum <= 9 && entry->ns >= mirror_exponent ? INFINITY
                                                                             : fmax(entry->ns, 0);
    }
    if (rgb_max(m.specular) > 0 && entry->pr >= 0)
        rough_apply(entry->pr, &m);
    m.transmittance = rgb_scale(entry->filter, passes);
    m.ior = passes > 0 && entry->ni >= 1 ? entry->ni : 1;
    return m;
}

/* The entry's images go to the library. */
static bool entry_finish(MaterialLibrary *library, MtlEntry *entry, const char *path, Error *err)
{
    const Material material = entry_material(entry);
    size_t at;

    /* A name given twice: the last one counts, as in the programs that write such files. */
    at = library_find(library, entry->name);
    if (at == SIZE_MAX) {
        if (!library_add(library, entry->name, &material, &at, err))
            return false;
    } else {
        char *name = library->material[at].name;
        library->material[at] = material;
        library->material[at].name = name;
    }
    material_images_clear(&library->images[at]);
    library->images[at] = entry->images;
    entry->images = (MaterialImages){ 0 };
    library->images[at].path = array_string(path, err);
    return library->images[at].path != NULL;
}

/* --- lines ------------------------------------------------------------------------------------ */

/* One number stands for all three bands. */
static bool color_read(const TextFile *text, Word key, const char *line, Rgb *color, Error *err)
{
    const char *peek = line;
    const Word first = text_word(&peek);
    Rgb c;

    if (word_is(first, "spectral") || word_is(first, "xyz"))
        return text_error(text, err, "%.*s as %.*s is not supported: give r g b", (int)key.length,
                          key.begin, (int)first.length, first.begin);
    if (!text_number(text, &line, &c.r))
        return text_error(text, err, "%.*s: expected a number, found '%.*s'", (int)key.length,
                          key.begin, (int)first.length, first.begin);
    c.g = c.b = c.r;
    peek = line;
    if (text_word(&peek).length > 0 &&
        (!text_number(text, &line, &c.g) || !text_number(text, &line, &c.b)))
        return text_error(text, err, "%.*s: expected one or three numbers", (int)key.length,
                          key.begin);
    if (!isfinite(c.r) || !isfinite(c.g) || !isfinite(c.b))
        return text_error(text, err, "%.*s is not finite", (int)key.length, key.begin);
    *color = c;
    return true;
}

static bool value_read(const TextFile *text, Word key, const char *line, double *value, Error *err)
{
    const char *peek = line;
    const Word first = text_word(&peek);

    if (word_is(first, "-halo")) /* d -halo factor */
        line = peek;
    if (!text_number(text, &line, value) || !isfinite(*value))
        return text_error(text, err, "%.*s: expected a number, found '%.*s'", (int)key.length,
                          key.begin, (int)first.length, first.begin);
    return true;
}

/* d and Tr = 1 - d often stand together; when they disagree, d counts. */
static bool opacity_read(const TextFile *text, Word key, const char *line, MtlEntry *entry,
                         bool *has_d, Error *err)
{
    const bool is_d = word_is(key, "d");
    double value = 1;

    if (!value_read(text, key, line, &value, err))
        return false;
    if (is_d || !*has_d)
        entry->alpha = is_d ? value : 1 - value;
    *has_d = *has_d || is_d;
    return true;
}

static bool line_read(const TextFile *text, Word key, const char *line, MtlEntry *entry,
                      bool *has_d, Error *err)
{
    double illum;

    if (word_is(key, "Kd")) {
        entry->has_kd = true;
        return color_read(text, key, line, &entry->kd, err);
    }
    if (word_is(key, "Ks"))
        return color_read(text, key, line, &entry->ks, err);
    if (word_is(key, "Ke"))
        return color_read(text, key, line, &entry->ke, err);
    if (word_is(key, "Tf") || word_is(key, "Kt"))
        return color_read(text, key, line, &entry->filter, err);
    if (word_is(key, "Ns"))
        return value_read(text, key, line, &entry->ns, err);
    if (word_is(key, "Pr"))
        return value_read(text, key, line, &entry->pr, err);
    if (word_is(key, "Ni"))
        return value_read(text, key, line, &entry->ni, err);
    if (word_is(key, "d") || word_is(key, "Tr"))
        return opacity_read(text, key, line, entry, has_d, err);
    if (word_is(key, "illum")) {
        if (!value_read(text, key, line, &illum, err))
            return false;
        entry->illum = illum >= 0 && illum <= 10 ? (int)illum : 2;
    }
    if (word_is(key, "map_Kd"))
        return map_image_read(text, line, &entry->images.colour, err);
    if (word_is(key, "map_Ke"))
        return map_image_read(text, line, &entry->images.emission, err);
    if (word_is(key, "map_d"))
        return map_image_read(text, line, &entry->images.cut, err);
    return true;
}

static bool entries_read(MaterialLibrary *library, TextFile *text, MtlEntry *entry, Error *err)
{
    bool inside = false, has_d = false;

    for (const char *line; (line = text_line(text)) != NULL;) {
        const Word key = text_word(&line);
        if (word_is(key, "newmtl")) {
            if (inside && !entry_finish(library, entry, text->path, err))
                return false;
            *entry = entry_empty();
            text_rest(line, entry->name, sizeof entry->name);
            inside = true;
            has_d = false;
        } else if (inside && !line_read(text, key, line, entry, &has_d, err)) {
            return false;
        }
    }
    return !inside || entry_finish(library, entry, text->path, err);
}

static bool lines_read(MaterialLibrary *library, TextFile *text, Error *err)
{
    MtlEntry   entry = entry_empty();
    const bool good = entries_read(library, text, &entry, err);
    material_images_clear(&entry.images);
    return good;
}

bool import_mtl(MaterialLibrary *library, const char *path, uint64_t *hash, Error *err)
{
    assert(library != NULL && path != NULL && hash != NULL && err != NULL);
    TextFile text;
    const bool good = text_open(&text, path, import_file_limit, hash, err) &&
                      lines_read(library, &text, err);
    text_close(&text);
    return good;
}
