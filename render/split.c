/* SPDX-License-Identifier: BSD-3-Clause */
/* What a gatherer knows of light groups. */
#include "render/split.h"

#include <assert.h>

#include "base/array.h"
#include "radiosity/mirrors.h"

/* --- making ----------------------------------------------------------------------------------- */

static void fill_sides(Split *split, const Room *room, const GatherGroups *groups)
{
    const Surfaces *s = room->surfaces;
    for (uint32_t i = 0; i < s->count; i++)
        for (unsigned side = 0; side < 2; side++) {
            const uint32_t k = groups->of_group[surfaces_group(s, i, side)];
            const bool emits = room->emitting[i] >> side & 1;
            split->of_side[2 * (size_t)i + side] = k < split->count ? k : split->count;
            split->rest = split->rest || (emits && k >= split->count);
        }
}

/* One group's reflected radiosity per patch. */
static void reflected(const Gatherer *g, const GatherGroups *groups, uint32_t k, double *value)
{
    const Patches *patches = g->room->patches;
    const double  *b = groups->radiosity + (size_t)k * patches->count * ROOM_BANDS;
    static const double one[ROOM_BANDS] = { 1, 1, 1 };
    const double  *dimmer = groups->dimmer != NULL ? groups->dimmer + ROOM_BANDS * (size_t)k : one;
    for (uint32_t i = 0; i < patches->count; i++) {
        const bool   own = groups->of_group[patches->group[i]] == k;
        const Rgb    e = own ? room_emission(g->room, i) : rgb(0, 0, 0);
        const double kept = mirrors_kept(g->room, i);
        double      *v = value + ROOM_BANDS * (size_t)i;
        const double *all = b + ROOM_BANDS * (size_t)i;
        v[0] = fmax(kept * dimmer[0] * all[0] - e.r, 0); /* rounding */
        v[1] = fmax(kept * dimmer[1] * all[1] - e.g, 0);
        v[2] = fmax(kept * dimmer[2] * all[2] - e.b, 0);
    }
}

/* The whole becomes the sum of the groups: what was solved apart differs within the tolerance. */
static bool fill_vertices(Gatherer *g, const GatherGroups *groups, const Links *links, Error *err)
{
    const Patches *patches = g->room->patches;
    const size_t   n = patches->count, nv = patches->vertex_count, count = groups->count;
    double *value = array_create(n * ROOM_BANDS, sizeof *value, "light groups", err);
    double *vertex = array_create(nv * ROOM_BANDS, sizeof *vertex, "light groups", err);
    for (size_t i = 0; !error_is_set(err) && i < nv * ROOM_BANDS; i++)
        g->vertex[i] = 0;
    for (uint32_t k = 0; k < count && !error_is_set(err); k++) {
        reflected(g, groups, k, value);
        if (!vertex_radiosity(patches, links->area, ROOM_BANDS, value, vertex, err))
            break;
        for (size_t i = 0; i < nv; i++)
            for (unsigned band = 0; band < ROOM_BANDS; band++) {
                const float v = (float)vertex[i * ROOM_BANDS + band];
                g->split->vertex[(i * count + k) * ROOM_BANDS + band] = v;
                g->vertex[i * ROOM_BANDS + band] += v;
            }
    }
    array_free(value);
    array_free(vertex);
    return !error_is_set(err);
}

bool gatherer_split(Gatherer *g, const GatherGroups *groups, const Links *links, Error *err)
{
    const Room *room = g->room;
    assert(g->split == NULL && groups->count > 0 && groups->of_group != NULL);
    Split *split = array_create(1, sizeof *split, "light groups", err);
    if (split == NULL)
        return false;
    g->split = split;
    split->count = groups->count;
    split->first_light = groups->first_light;
    split->name = groups->name;
    assert(groups->first_light + room->light_count == groups->count);
    split->vertex = array_create((size_t)room->patches->vertex_count * groups->count,
                                 ROOM_BANDS * sizeof(float), "light groups", err);
    split->of_side = array_create(2 * (size_t)room->surfaces->count, sizeof *split->of_side,
                                  "light groups", err);
    if (error_is_set(err))
        return false;
    fill_sides(split, room, groups);
    return fill_vertices(g, groups, links, err);
}

void split_destroy(Split *split)
{
    if (split == NULL)
        return;
    array_free(split->vertex);
    array_free(split->of_side);
    array_free(split);
}

/* --- reading ---------------------------------------------------------------------------------- */

void split_radiosity(const Gatherer *gatherer, const WaveEnd *end, Rgb weight, Rgb *sum)
{
    const Room    *room = gatherer->room;
    const Split   *split = gatherer->split;
    const uint32_t count = split->count;
    uint32_t       vertex[PATCH_WEIGHTS];
    double         part[PATCH_WEIGHTS];
    const int      n = patches_interpolate(room->patches, room->surfaces, end->surface, end->side,
                                           end->s, end->t, vertex, part);
    for (int i = 0; i < n; i++) {
        const float *v = split->vertex + (size_t)vertex[i] * count * ROOM_BANDS;
        const Rgb    w = rgb_scale(weight, part[i]);
        for (uint32_t k = 0; k < count; k++, v += ROOM_BANDS)
            sum[k] = rgb_add(sum[k], rgb_mul(w, rgb(v[0], v[1], v[2])));
    }
}

void split_sample(const Gatherer *gatherer, const Receiver *at, const LampSample *sample,
                  Rgb arrives, double b, Rgb weight, Rgb *sum)
{
    const Split *split = gatherer->split;
    const Lamps *lamps = &gatherer->lamps;
    const bool   light = lamps_is_light(sample);
    if (sample->lamp == LAMP_NONE)
        return;
    const uint32_t k = light ? split->first_light + sample->lamp
                             : split_emission(split, lamps->lamp[sample->lamp].surface,
                                              lamps->lamp[sample->lamp].side);
    sum[k] = rgb_add(sum[k], rgb_mul(weight, rgb_mad(arrives, -b, sample->value)));
    if (!(b > 0))
        return;
    if (!light && !lamps->flat) { /* its own lamp's alone */
        sum[k] = rgb_add(sum[k], rgb_mul(weight, rgb_scale(sample->control, b)));
        return;
    }
    const uint32_t count = light ? (uint32_t)gatherer->room->light_count : lamps->count;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t other = light ? split->first_light + i
                                     : split_emission(split, lamps->lamp[i].surface,
                                                      lamps->lamp[i].side);
        const Rgb e = light ? lamps_light(&gatherer->room->lights[i], at)
                            : lamps_control(lamps, i, at);
        sum[other] = rgb_add(sum[other], rgb_mul(weight, rgb_scale(e, b)));
    }
}
