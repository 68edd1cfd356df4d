/* SPDX-License-Identifier: BSD-3-Clause */
/* SURFACE: MSD's materials. Equal ones are made once, however often a REF defines them. */
#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"
#include "scenes/msd.h"

static const uint32_t NUMBER_MAX = 0x7fffffff; /* what an integer of the language can hold */

/* --- reading --------------------------------------------------------------------------------- */

static bool coefficient(MsdReader *r, const char *what, double *value)
{
    return msd_number_in(r, what, 0, false, DBL_MAX, value);
}

/* How files write a mirror: the highlight is half as bright a fifth of a degree off, which no eye
 * tells from none. */
static const double MIRROR_EXPONENT = 1e5;

/* ka ; diffuse kd ; specular ks, exponent */
static bool phong_read(MsdReader *r, Material *m)
{
    double ka = 0, kd = 0, ks = 0;

    /* ka weighs an ambient light that radiosity computes instead. */
    if (!coefficient(r, "an ambient coefficient", &ka) || !msd_take(r, ';') ||
        !msd_colour(r, &m->reflectance) || !coefficient(r, "a diffuse coefficient", &kd) ||
        !msd_take(r, ';') || !msd_colour(r, &m->specular) ||
        !coefficient(r, "a specular coefficient", &ks) || !msd_take(r, ',') ||
        !coefficient(r, "a specular exponent", &m->exponent))
        return false;
    m->reflectance = rgb_scale(m->reflectance, kd);
    m->specular = rgb_scale(m->specular, ks);
    if (m->exponent >= MIRROR_EXPONENT)
        m->exponent = INFINITY;
    return true;
}

/* The short forms are not reserved: as a matrix' name they begin the next object. */
static MsdWord modifier_word(MsdReader *r)
{
    static const struct { const char *text; MsdWord word; } brief[] = {
        { "F", WORD_REFRACTION },      { "f", WORD_REFRACTION },     { "DT", WORD_DIFFUSE_TRANS },
        { "dt", WORD_DIFFUSE_TRANS },  { "ST", WORD_SPECULAR_TRANS }, { "st", WORD_SPECULAR_TRANS },
        { "EM", WORD_EMISSIVE },       { "em", WORD_EMISSIVE },      { "IMP", WORD_IMPORTANCE },
        { "imp", WORD_IMPORTANCE },
    };

    if (r->token.kind == TOKEN_WORD)
        return r->token.word;
    if (r->token.kind != TOKEN_NAME || msd_starts_matrix(r))
        return WORD_NONE;
    for (size_t i = 0; i < sizeof brief / sizeof brief[0]; i++)
        if (strcmp(r->symbols[r->token.symbol].text, brief[i].text) == 0)
            return brief[i].word;
    return WORD_NONE;
}

static bool index_read(MsdReader *r, double *ior)
{
    if (!coefficient(r, "an index of refraction", ior))
        return false;
    if (*ior == 0) /* how files write "none" */
        *ior = 1;
    return true;
}

/* ; kt index, with kt a colour or one number. Returns with *more false when what follows the sign
 * is no kt: then the sign only ended the surface or stands before another modifier. */
static bool transmission_read(MsdReader *r, Material *m)
{
    double kt = 0;
    Vec3   v = { 0 };

    if (!msd_next(r))
        return false;
    if (msd_is(r, '(')) { /* a coefficient, not a colour: COLORRANGE does not count */
        const MsdPlace place = r->token.place;
        if (!msd_vector(r, &v))
            return false;
        if (v.x < 0 || v.y < 0 || v.z < 0)
            return msd_error(r, place, "found a negative part, expected a transmission "
                                       "coefficient");
        m->transmittance = rgb(v.x, v.y, v.z);
        return index_read(r, &m->ior);
    }
    if (r->token.kind != TOKEN_NUMBER)
        return true;
    if (!coefficient(r, "a transmission coefficient", &kt))
        return false;
    m->transmittance = rgb(kt, kt, kt);
    return index_read(r, &m->ior);
}

static bool scattered_read(MsdReader *r, Material *m)
{
    const MsdPlace place = r->token.place;

    if (!msd_next(r) || !msd_colour(r, &m->scattered))
        return false;
    if (rgb_max(m->scattered) > 0 && r->dry == 0)
        msd_warn(r, place, "diffuse-transmission",
                 "diffuse transmission is read, but not built yet: the surface counts as opaque");
    return true;
}

static bool modifiers_read(MsdReader *r, Material *m)
{
    for (;;) {
        bool good;
        if (msd_is(r, ';')) {
            good = transmission_read(r, m);
        } else {
            switch (modifier_word(r)) {
            case WORD_REFRACTION: good = msd_next(r) && index_read(r, &m->ior); break;
            case WORD_DIFFUSE_TRANS: good = scattered_read(r, m); break;
            case WORD_SPECULAR_TRANS: good = msd_next(r) && msd_colour(r, &m->transmittance); break;
            case WORD_EMISSIVE: good = msd_next(r) && msd_colour(r, &m->emission); break;
            case WORD_IMPORTANCE:
                good = msd_next(r) && coefficient(r, "an importance", &m->importance);
                break;
            default: return true;
            }
        }
        if (!good)
            return false;
    }
}

/* --- keeping --------------------------------------------------------------------------------- */

static MsdMaterialKey key_of(uint32_t number, const Material *m)
{
    return (MsdMaterialKey){ { number, m->reflectance.r, m->reflectance.g, m->reflectance.b,
                               m->emission.r, m->emission.g, m->emission.b, m->specular.r,
                               m->specular.g, m->specular.b, m->exponent, m->transmittance.r,
                               m->transmittance.g, m->transmittance.b, m->scattered.r,
                               m->scattered.g, m->scattered.b, m->ior, m->importance } };
}

static size_t key_slot(const MsdReader *r, const MsdMaterialKey *key)
{
    const size_t mask = r->key_slots - 1;
    size_t       slot = (size_t)file_hash(key, sizeof *key, 0) & mask;

    while (r->key_slot[slot] != 0 && memcmp(&r->keys[r->key_slot[slot] - 1], key, sizeof *key) != 0)
        slot = (slot + 1) & mask;
    return slot;
}

static bool keys_grow(MsdReader *r)
{
    if (2 * (r->key_count + 1) > r->key_slots) {
        const size_t slots = r->key_slots > 0 ? 2 * r->key_slots : 64;
        uint32_t    *table = array_create(slots, sizeof *table, "surfaces", r->err);
        if (table == NULL)
            return false;
        array_free(r->key_slot);
        r->key_slot = table;
        r->key_slots = slots;
        for (size_t i = 0; i < r->key_count; i++)
            table[key_slot(r, &r->keys[i])] = (uint32_t)i + 1;
    }
    return array_reserve((void **)&r->keys, &r->key_capacity, r->key_count + 1, sizeof *r->keys,
                         "surfaces", r->err);
}

/* Index of the scene's material with these values, made if there is none. */
static bool material_keep(MsdReader *r, MsdPlace place, uint32_t number, uint32_t symbol,
                          Material *m, uint32_t *index)
{
    char name[48], where[MSD_WHERE_MAX];
    const MsdMaterialKey key = key_of(number, m);

    if (!keys_grow(r))
        return false;
    const size_t slot = key_slot(r, &key);
    if (r->key_slot[slot] != 0) {
        *index = r->key_slot[slot] - 1;
        return true;
    }
    const unsigned nth = ++r->symbols[symbol].materials;
    if (nth == 1)
        snprintf(name, sizeof name, "surface-%u", number);
    else /* another of that number, elsewhere in the file */
        snprintf(name, sizeof name, "surface-%u-%u", number, nth);
    m->name = name;
    msd_where(r, place, where);
    scene_limit_material(m, where, r->options);
    const bool added = polygons_add_material(&r->scene->polygons, m, index, r->err);
    m->name = NULL;
    if (!added)
        return false;
    assert(*index == r->key_count);
    r->keys[r->key_count++] = key;
    r->key_slot[slot] = (uint32_t)r->key_count;
    return true;
}

/* --- SURFACE and its use --------------------------------------------------------------------- */

bool msd_surface(MsdReader *r)
{
    const MsdPlace place = r->token.place;
    MsdBinding     b = { .kind = NAME_SURFACE, .as.surface = MSD_NONE };
    Material       m = { .ior = 1, .importance = 1 };
    uint32_t       number = 0;

    if (!msd_next(r) || !msd_integer(r, "a surface's number", 1, NUMBER_MAX, &number))
        return false;
    if (msd_is_word(r, WORD_PHONG) && !msd_next(r))
        return false;
    if (r->token.kind == TOKEN_WORD && r->token.word == WORD_UNBUILT)
        return msd_expected(r, "PHONG or an ambient coefficient");
    if (!phong_read(r, &m) || !modifiers_read(r, &m) ||
        !msd_surface_symbol(r, number, &b.symbol))
        return false;
    if (r->dry == 0) {
        const MsdBinding *old = msd_lookup(r, b.symbol);
        if (old != NULL && old->scope == r->scope_count - 1)
            msd_warn(r, place, "surface-again",
                     "surface %u is defined again; what follows has the new one", number);
        if (!material_keep(r, place, number, b.symbol, &m, &b.as.surface))
            return false;
    }
    return msd_define(r, &b);
}

bool msd_surface_use(MsdReader *r, uint32_t *material)
{
    const MsdPlace place = r->token.place;
    double         value = 0;
    uint32_t       symbol = 0;

    if (!msd_number(r, &value))
        return false;
    if (!(value >= 1 && value <= NUMBER_MAX) || value != floor(value))
        return msd_error(r, place, "found %g, expected a surface's number, whole and above 0",
                         value);
    *material = MSD_NONE;
    if (r->dry > 0)
        return true;
    *material = r->override;
    if (*material != MSD_NONE)
        return true;
    if (!msd_surface_symbol(r, (uint32_t)value, &symbol))
        return false;
    const MsdBinding *b = msd_lookup(r, symbol);
    if (b == NULL)
        return msd_error(r, place, "found surface %.0f, which is not defined, expected one that is",
                         value);
    *material = b->as.surface;
    assert(*material < r->scene->polygons.material_count);
    return true;
}
