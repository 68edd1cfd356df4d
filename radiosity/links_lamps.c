/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links_lamps.c -- samples taken from the lamps' own side: a small lamp, which rays of
 * the hemisphere hit by luck only, is always found, and the two kinds are combined [veach95]. */
#include <assert.h>
#include <float.h>
#include <math.h>

#include "base/array.h"
#include "math/sampling.h"
#include "radiosity/internal.h"
#include "radiosity/mirrors.h"
#include "radiosity/visible.h"

/* Share of the samples that lamps get evenly, not by their power: a weak one may be the only light
 * of its room, and what no sample of a row finds is lost to that row. */
static const double EVEN_SHARE = 0.25;

static double patch_power(const Room *room, uint32_t i)
{
    return room->patches->area[i] * rgb_luminance(room_emission(room, i));
}

/* Power of each lamp (a connected part of the scene's faces), and how many of them there are. */
static uint32_t sum_lamps(const Room *room, double *part)
{
    const Patches *patches = room->patches;
    uint32_t lamps = 0;
    for (uint32_t i = 0; i < patches->count; i++) {
        double *power = &part[room->surfaces->part[patches->surface[i]]];
        const double p = patch_power(room, i);
        assert(p >= 0);
        lamps += p > 0 && !(*power > 0);
        *power += p;
    }
    return lamps;
}

static void fill_table(const Room *room, LampTable *table, const double *part, uint32_t lamps)
{
    double power = 0, sum = 0;
    for (uint32_t k = 0; k < room->surfaces->part_count; k++)
        power += part[k];
    for (uint32_t i = 0, k = 0; i < room->patches->count; i++) {
        const double p = patch_power(room, i);
        if (!(p > 0))
            continue;
        const double lamp = part[room->surfaces->part[room->patches->surface[i]]];
        const double chance = (1 - EVEN_SHARE) * p / power + EVEN_SHARE * p / (lamp * lamps);
        sum += chance;
        table->patch[k] = i;
        table->cumulative[k++] = sum;
        table->probability[i] = (float)chance;
    }
    if (table->count > 0)
        table->cumulative[table->count - 1] = 1;
}

bool lamp_table_create(const Room *room, LampTable *lamps, Error *err)
{
    const uint32_t count = room->patches->count;
    *lamps = (LampTable){ 0 };
    double *part = array_create(room->surfaces->part_count, sizeof *part, "lamps", err);
    lamps->probability = array_create(count, sizeof *lamps->probability, "lamps", err);
    uint32_t parts = 0;
    if (!error_is_set(err)) {
        parts = sum_lamps(room, part);
        for (uint32_t i = 0; i < count; i++)
            lamps->count += patch_power(room, i) > 0;
        lamps->patch = array_create(lamps->count, sizeof *lamps->patch, "lamps", err);
        lamps->cumulative = array_create(lamps->count, sizeof *lamps->cumulative, "lamps", err);
    }
    if (error_is_set(err))
        lamp_table_clear(lamps);
    else
        fill_table(room, lamps, part, parts);
    array_free(part);
    return !error_is_set(err);
}

void lamp_table_clear(LampTable *lamps)
{
    array_free(lamps->patch);
    array_free(lamps->cumulative);
    array_free(lamps->probability);
    *lamps = (LampTable){ 0 };
}

uint32_t lamp_table_choose(const LampTable *lamps, double u, double *rest)
{
    assert(lamps->count > 0 && u < 1);
    uint32_t low = 0, high = lamps->count - 1;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (lamps->cumulative[middle] > u)
            high = middle;
        else
            low = middle + 1;
    }
    const double before = low > 0 ? lamps->cumulative[low - 1] : 0;
    *rest = fmin(fmax((u - before) / (lamps->cumulative[low] - before), 0), 1 - DBL_EPSILON);
    return lamps->patch[low];
}

static double density_at(const Room *room, const LampTable *lamps, uint32_t patch, double weight,
                         double distance, double cosine)
{
    const double area_density = lamps->probability[patch] / (room->patches->area[patch] * weight);
    return area_density * distance * distance / cosine;
}

double lamp_density(const Room *room, const LampTable *lamps, const RayEnd *end, double distance,
                    double cosine)
{
    if (!(cosine > 0))
        return INFINITY; /* a grazing hit: the lamp's own samples see it as well as none */
    const double weight = patches_weight(room->patches, room->surfaces, end->patch, end->surface,
                                         end->s, end->t);
    return density_at(room, lamps, end->patch, weight, distance, cosine);
}

/* What all samples of a row have in common. */
typedef struct {
    const Room      *room;
    const LampTable *lamps;
    double           rays, lamp_rays; /* of the patch's hemisphere; to lamps */
} LampAim;

/* One sample with its visibility ray; share 0: turned away, no ray. u chooses the lamp and, by what
 * the choice leaves of it, the place along it; v the place across. */
static LampSample aim(const LampAim *a, const PatchPoint *from, double u, double v, Ray *ray)
{
    const Room *room = a->room;
    PatchPoint to;
    LampSample sample = { .share = 0 };
    double rest;
    sample.lamp = lamp_table_choose(a->lamps, u, &rest);
    patches_point(room->patches, room->surfaces, sample.lamp, rest, v, &to);
    visible_move(room, &to);
    const Vec3 p = from->point.point, q = to.point.point;
    const Vec3 way = vec3_sub(q, p);
    const double distance = vec3_length(way);
    const double here = vec3_dot(way, from->point.normal);
    const double there = -vec3_dot(way, to.point.normal);
    if (!(here > 0 && there > 0 && distance > 2 * room->offset && to.weight > 0))
        return sample;
    const double own = here / distance / M_PI;
    const double by_rays = a->rays * own;
    const double by_lamps = a->lamp_rays * density_at(room, a->lamps, sample.lamp, to.weight,
                                                      distance, there / distance);
    *ray = ray_between(p, from->point.normal, q, to.point.normal, room->offset);
    sample.share = own * by_lamps / (by_rays * by_rays + by_lamps * by_lamps);
    return sample;
}

static double cosine_of(const Ray *ray, Vec3 normal)
{
    return vec3_dot(vec3_unit(vec3(ray->dx, ray->dy, ray->dz)), normal);
}

/* Place and lamp are the four coordinates of one net, so that they are spread together. Only where
 * a part of the patch is hidden, the places are those found to be outside solids. */
void row_cast_aim(RowCast *row, const Room *room, const LampTable *lamps, uint32_t patch,
                  uint32_t seed)
{
    row->sample_count = 0;
    if (row->good_rays == 0 || lamps->count == 0)
        return;
    const LampAim common = { room, lamps, row->good_rays, row->lamp_rays };
    const bool whole = row->valid_count == row->positions;
    const double kept = mirrors_kept(room, patch);
    const uint32_t own_seed = sampling_seed(seed, room_patch_key(room, patch), SEED_LAMPS, 0);
    const uint32_t first = row->begin > 0 ? row->lamp_rays : 0;
    double weights = 0;
    for (uint32_t m = 0; m < row->lamp_rays; m++) {
        float x[4];
        PatchPoint from;
        sampling_sobol4(first + m, own_seed, x);
        if (whole) {
            patches_point(room->patches, room->surfaces, patch, x[0], x[1], &from);
            visible_move(room, &from);
        } else {
            from = row->position[row->valid[(uint64_t)m * row->valid_count / row->lamp_rays]].at;
        }
        weights += from.weight;
        LampSample sample = aim(&common, &from, x[2], x[3], &row->lamp_ray[row->sample_count]);
        sample.share *= from.weight;
        if (room->mirrors && sample.share > 0)
            sample.share *= mirrors_weight(room, patch, kept,
                                           cosine_of(&row->lamp_ray[row->sample_count],
                                                     from.point.normal));
        if (sample.share > 0)
            row->sample[row->sample_count++] = sample;
    }
    row->cast += row->sample_count;
    row->sample_scale = weights > 0 ? row->lamp_rays / weights : 0;
}

void row_cast_lamps(RowCast *row, const Room *room)
{
    for (uint32_t k = 0; k < row->sample_count; k++) {
        double pass = row->blocked[k] ? 0 : 1;
        if (row->blocked[k] && room->mirrors)
            pass = mirrors_between(room, row->lamp_ray[k]);
        if (pass > 0)
            row_cast_add(row, row->sample[k].lamp,
                         row->sample[k].share * row->sample_scale * pass);
    }
}
