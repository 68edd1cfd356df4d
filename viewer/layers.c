/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers for patches out of a snapshot, and names for them. */
#include "viewer/layers.h"

#include <assert.h>
#include <math.h>

typedef struct {
    const char *name, *lux, *watt;
    unsigned    needs;      /* bits of Layer */
} LayerRow;

enum {
    NEEDS_B = 1U << LAYER_RADIOSITY,
    NEEDS_H = 1U << LAYER_IRRADIANCE,
    NEEDS_D = 1U << LAYER_DIRECT
};

static const LayerRow layer_rows[SHOWN_COUNT] = {
    [SHOWN_RADIOSITY] = { "radiosity", "lm/m2", "W/m2", NEEDS_B },
    [SHOWN_IRRADIANCE] = { "irradiance", "lux", "W/m2", NEEDS_H },
    [SHOWN_DIRECT] = { "direct", "lux", "W/m2", NEEDS_D },
    [SHOWN_INDIRECT] = { "indirect", "lux", "W/m2", NEEDS_H | NEEDS_D },
    [SHOWN_UNSHOT] = { "unshot", "lm/m2", "W/m2", 1U << LAYER_UNSHOT },
    [SHOWN_RESIDUAL] = { "residual", "lm/m2", "W/m2", NEEDS_B | NEEDS_H },
    [SHOWN_ERROR] = { "error", "lux", "W/m2", 1U << LAYER_ERROR },
    [SHOWN_REFLECTANCE] = { "reflectance", "", "", 0 },
    [SHOWN_FACTORS] = { "form factors", "", "", 0 },
};

const char *layer_name(ShownLayer layer)
{
    assert((unsigned)layer < SHOWN_COUNT);
    return layer_rows[layer].name;
}

const char *layer_unit(ShownLayer layer, bool lux)
{
    assert((unsigned)layer < SHOWN_COUNT);
    return lux ? layer_rows[layer].lux : layer_rows[layer].watt;
}

bool layer_known(const Snapshot *snapshot, ShownLayer layer, bool picked)
{
    for (unsigned k = 0; k < LAYER_COUNT; k++)
        if ((layer_rows[layer].needs >> k & 1) != 0 && snapshot->layer[k] == NULL)
            return false;
    return layer != SHOWN_FACTORS || picked;
}

static Rgb band_values(const Snapshot *s, Layer layer, uint32_t patch)
{
    const float *v = s->layer[layer] + 3 * (size_t)patch;
    return rgb((double)v[0], (double)v[1], (double)v[2]);
}

double layer_value(const Snapshot *s, ShownLayer layer, uint32_t i)
{
    const ShownPatch *patch = &s->mesh->patch[i];
    switch (layer) {
    case SHOWN_RADIOSITY:
        return rgb_luminance(band_values(s, LAYER_RADIOSITY, i));
    case SHOWN_IRRADIANCE:
        return rgb_luminance(band_values(s, LAYER_IRRADIANCE, i));
    case SHOWN_DIRECT:
        return rgb_luminance(band_values(s, LAYER_DIRECT, i));
    case SHOWN_INDIRECT: /* noise of two estimates may leave less than nothing */
        return fmax(0, rgb_luminance(rgb_mad(band_values(s, LAYER_IRRADIANCE, i), -1,
                                             band_values(s, LAYER_DIRECT, i))));
    case SHOWN_UNSHOT:
        return rgb_luminance(band_values(s, LAYER_UNSHOT, i));
    case SHOWN_RESIDUAL: {
        const Rgb back = rgb_mul(snapshot_reflectance(s, i), band_values(s, LAYER_IRRADIANCE, i));
        const Rgb d = rgb_mad(band_values(s, LAYER_RADIOSITY, i), -1, back);
        return patch->lamp ? NAN : rgb_luminance(rgb(fabs(d.r), fabs(d.g), fabs(d.b)));
    }
    case SHOWN_ERROR:
        return rgb_luminance(band_values(s, LAYER_ERROR, i));
    case SHOWN_REFLECTANCE:
        return rgb_luminance(snapshot_reflectance(s, i));
    default:
        return NAN;
    }
}

void layer_fill(const Snapshot *snapshot, ShownLayer layer, const float *factors, float *out)
{
    assert(layer_known(snapshot, layer, factors != NULL));
    for (uint32_t i = 0; i < snapshot->mesh->patch_count; i++)
        out[i] = layer == SHOWN_FACTORS ? factors[i] : (float)layer_value(snapshot, layer, i);
}
