/* SPDX-License-Identifier: BSD-3-Clause */
/* Materials of a glTF as this program understands them: constant colours, diffuse and specular. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "scenes/gltf.h"

/* A lobe about as wide as cos^1 is nearer to diffuse than to a mirror: rougher metal counts as a
 * diffuse surface of its colour. */
static const double diffuse_exponent = 1;

typedef struct {
    Rgb    base;
    double alpha, metallic, roughness;
    Rgb    specular;        /* of pbrSpecularGlossiness */
    const Json *image;      /* of the colour; NULL: none */
} PbrValues;

/* --- values ----------------------------------------------------------------------------------- */

/* An entry of a list by a number that may be anything; NULL: there is none. */
static const Json *entry_of(const GltfContext *c, const Json *object, const char *where,
                            const char *key, const Json *list)
{
    const double at = gltf_number(c, object, where, key, -1);
    return at >= 0 && at < (double)gltf_count(list) && at == floor(at)
               ? gltf_item(list, (size_t)at) : NULL;
}

/* Whether an image is really there: its numbers lead to one that has bytes or a name. One that is
 * missing, or in a form that is an extension, is told. */
static bool image_exists(const GltfContext *c, const Json *root, const Json *info,
                         const char *where)
{
    const Json *images = gltf_list(c, root, "", "images");

    if (info == NULL)
        return false;
    const Json *texture = entry_of(c, info, where, "index", gltf_list(c, root, "", "textures"));
    const Json *image = texture != NULL ? entry_of(c, texture, where, "source", images) : NULL;
    const bool there = gltf_member(image, "uri") != NULL ||
                       gltf_member(image, "bufferView") != NULL;
    if (!there)
        monitor_warn(c->monitor, "image-missing", where,
                     "its image is not in the file in a form that can be read; it has one colour");
    return there;
}

static Rgb color_read(const GltfContext *c, const Json *object, const char *where, const char *key,
                      Rgb fallback)
{
    double v[3];
    return gltf_numbers(c, object, where, key, v, 3) ? rgb(v[0], v[1], v[2]) : fallback;
}

static void base_read(const GltfContext *c, const Json *object, const char *where, const char *key,
                      PbrValues *s)
{
    double v[4];

    if (gltf_numbers(c, object, where, key, v, 4)) {
        s->base = rgb(v[0], v[1], v[2]);
        s->alpha = v[3];
    }
}

static double share(double value) { return fmin(fmax(value, 0), 1); }

/* Metal and roughness, or the older diffuse, specular and glossiness. */
static PbrValues surface_read(const GltfContext *c, const Json *material, const char *where)
{
    PbrValues s = { .base = { 1, 1, 1 }, .alpha = 1, .metallic = 1, .roughness = 1 };
    const Json *extensions = gltf_object(c, material, where, "extensions");
    const Json *old = gltf_object(c, extensions, where, "KHR_materials_pbrSpecularGlossiness");
    const Json *pbr = gltf_object(c, material, where, "pbrMetallicRoughness");

    if (old != NULL) {
        s.metallic = 0;
        base_read(c, old, where, "diffuseFactor", &s);
        s.specular = color_read(c, old, where, "specularFactor", rgb(1, 1, 1));
        s.roughness = 1 - share(gltf_number(c, old, where, "glossinessFactor", 1));
        s.image = gltf_object(c, old, where, "diffuseTexture");
        return s;
    }
    base_read(c, pbr, where, "baseColorFactor", &s);
    s.metallic = share(gltf_number(c, pbr, where, "metallicFactor", 1));
    s.roughness = share(gltf_number(c, pbr, where, "roughnessFactor", 1));
    s.image = gltf_object(c, pbr, where, "baseColorTexture");
    return s;
}

/* Phong exponent as sharp as a microfacet lobe: 2 / alpha^2 - 2 with alpha = roughness^2
 * [walter07]. */
static double roughness_exponent(double roughness)
{
    const double a = roughness * roughness;
    return a > 0 ? 2 / (a * a) - 2 : INFINITY;
}

/* --- meaning ---------------------------------------------------------------------------------- */

static void transparency_apply(const GltfContext *c, const Json *material, const char *where,
                               const PbrValues *s, Material *m)
{
    const Json *extensions = gltf_object(c, material, where, "extensions");
    const Json *glass = gltf_object(c, extensions, where, "KHR_materials_transmission");
    const Json *ior = gltf_object(c, extensions, where, "KHR_materials_ior");
    const char *mode = gltf_word(c, material, where, "alphaMode", "OPAQUE");
    const double cutoff = gltf_number(c, material, where, "alphaCutoff", 0.5);
    double covers = 1;

    if (strcmp(mode, "BLEND") == 0)
        covers = share(s->alpha);
    else if (strcmp(mode, "MASK") == 0)
        covers = s->alpha < cutoff ? 0 : 1;
    if (glass != NULL) {
        const double passes = share(gltf_number(c, glass, where, "transmissionFactor", 0))
                              * (1 - s->metallic);
        m->transmittance = rgb_scale(s->base, passes);
        m->reflectance = rgb_scale(m->reflectance, 1 - passes);
        if (passes > 0)
            m->ior = fmax(1, gltf_number(c, ior, where, "ior", 1.5));
    }
    m->reflectance = rgb_scale(m->reflectance, covers);
    m->specular = rgb_scale(m->specular, covers);
    m->emission = rgb_scale(m->emission, covers);
    m->transmittance = rgb_mad(rgb(1 - covers, 1 - covers, 1 - covers), covers, m->transmittance);
}

static Material material_read(const GltfContext *c, const Json *root, const Json *json,
                              const char *where, bool *image)
{
    Material m = material_default();
    const PbrValues s = surface_read(c, json, where);
    const Json *extensions = gltf_object(c, json, where, "extensions");
    const Json *strong = gltf_object(c, extensions, where, "KHR_materials_emissive_strength");
    const double strength = gltf_number(c, strong, where, "emissiveStrength", 1);
    const double exponent = roughness_exponent(s.roughness);

    m.reflectance = rgb_scale(s.base, 1 - s.metallic);
    m.specular = rgb_mad(s.specular, s.metallic, s.base);
    m.exponent = rgb_max(m.specular) > 0 ? exponent : 0;
    m.roughness = rgb_max(m.specular) > 0 && isfinite(exponent) ? s.roughness : 0;
    if (exponent < diffuse_exponent) {
        m.reflectance = rgb_add(m.reflectance, m.specular);
        m.specular = rgb(0, 0, 0);
        m.exponent = m.roughness = 0;
    }
    m.emission = rgb_scale(color_read(c, json, where, "emissiveFactor", rgb(0, 0, 0)), strength);
    transparency_apply(c, json, where, &s, &m);
    *image = image_exists(c, root, s.image, where);
    m.cut_out = *image && strcmp(gltf_word(c, json, where, "alphaMode", "OPAQUE"), "OPAQUE") != 0;
    return m;
}

bool gltf_read_materials(const GltfContext *c, const Json *root, Gltf *gltf)
{
    const Json *list = gltf_list(c, root, "", "materials");

    gltf->image = array_create(gltf_count(list), sizeof *gltf->image, "materials", c->err);
    gltf->glow = array_create(gltf_count(list), sizeof *gltf->glow, "materials", c->err);
    gltf->material = array_create(gltf_count(list), sizeof *gltf->material, "materials", c->err);
    for (size_t i = 0; i < gltf_count(list) && !error_is_set(c->err); i++) {
        const Json *json = gltf_item(list, i);
        char where[48];
        snprintf(where, sizeof where, "materials[%zu]", i);
        if (!gltf_is_object(json))
            return gltf_error(c, where, "is not an object");
        gltf->material[i] = material_read(c, root, json, where, &gltf->image[i]);
        gltf->material[i].name = array_string(gltf_word(c, json, where, "name", where), c->err);
        gltf->material_count++;
        gltf->glow[i] = rgb_max(gltf->material[i].emission) > 0 &&
                        image_exists(c, root, gltf_object(c, json, where, "emissiveTexture"),
                                     where);
    }
    return !error_is_set(c->err);
}
