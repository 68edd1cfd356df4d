/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links_lamps.c -- samples taken from the lamps' own side: a small lamp, which rays of the
 * hemisphere hit by luck only, is always found, and the two kinds are combined [veach95]. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "math/sampling.h"
#include "radiosity/internal.h"

bool lamp_table_create(const Room *room, LampTable *lamps, Error *err)
{
    const Patches *patches = room->patches;
    *lamps = (LampTable){ 0 };
    lamps->probability = array_create(patches->count, sizeof *lamps->probability, "lamps", err);
    if (lamps->probability == NULL)
        return false;
    double power = 0;
    for (uint32_t i = 0; i < patches->count; i++) {
        const double p = patches->area[i] * rgb_luminance(room_emission(room, i));
        assert(p >= 0);
        lamps->count += p > 0;
        power += p;
    }
    lamps->patch = array_create(lamps->count, sizeof *lamps->patch, "lamps", err);
    lamps->cumulative = array_create(lamps->count, sizeof *lamps->cumulative, "lamps", err);
    if (error_is_set(err)) {
        lamp_table_clear(lamps);
        return false;
    }
    double sum = 0;
    for (uint32_t i = 0, k = 0; i < patches->count; i++) {
        const double p = patches->area[i] * rgb_luminance(room_emission(room, i));
        if (!(p > 0))
            continue;
        sum += p;
        lamps->patch[k] = i;
        lamps->cumulative[k++] = sum / power;
        lamps->probability[i] = (float)(p / power);
    }
    if (lamps->count > 0)
        lamps->cumulative[lamps->count - 1] = 1;
    return true;
}

void lamp_table_clear(LampTable *lamps)
{
    array_free(lamps->patch);
    array_free(lamps->cumulative);
    array_free(lamps->probability);
    *lamps = (LampTable){ 0 };
}

uint32_t lamp_table_choose(const LampTable *lamps, double u)
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
    return lamps->patch[low];
}

/* How much more thinly than evenly patches_point spreads its points at (s, t): PatchPoint.weight of
 * any place. 1 on triangles, whose density is the same all over. */
static double point_weight(const Room *room, uint32_t patch, double s, double t)
{
    const uint32_t surface = room->patches->surface[patch];
    if (room->surfaces->surface[surface].kind == SURFACE_TRIANGLE)
        return 1;
    SurfacePoint at;
    surfaces_point(room->surfaces, surface, s, t, &at);
    const double cells = (double)room->patches->nu[surface] * room->patches->nv[surface];
    return at.density / (cells * room->patches->area[patch]);
}

static double density_at(const Room *room, const LampTable *lamps, uint32_t patch, double weight,
                         double distance, double cosine)
{
    const double area_density = lamps->probability[patch] / (room->patches->area[patch] * weight);
    return area_density * distance * distance / cosine;
}

double lamp_density(const Room *room, const LampTable *lamps, uint32_t patch, double s, double t,
                    double distance, double cosine)
{
    if (!(cosine > 0))
        return INFINITY; /* a grazing hit: the lamp's own samples see it as well as none */
    return density_at(room, lamps, patch, point_weight(room, patch, s, t), distance, cosine);
}

/* One sample: the visibility ray, and what it carries when nothing is in the way; 0: turned away. */
static double aim(const RowCast *row, const Room *room, const LampTable *lamps,
                  const CastPosition *from, uint32_t lamp, const float x[4], double rays, Ray *ray)
{
    PatchPoint to;
    patches_point(room->patches, room->surfaces, lamp, x[1], x[2], &to);
    const Vec3 p = from->at.point.point, q = to.point.point;
    const Vec3 way = vec3_sub(q, p);
    const double distance = vec3_length(way);
    const double here = vec3_dot(way, from->at.point.normal);
    const double there = -vec3_dot(way, to.point.normal);
    if (!(here > 0 && there > 0 && distance > 2 * room->offset && to.weight > 0))
        return 0;
    *ray = ray_between(p, from->at.point.normal, q, to.point.normal, room->offset);
    const double own = here / distance / M_PI;
    const double lamps_density =
        density_at(room, lamps, lamp, to.weight, distance, there / distance);
    return own / (rays * own + row->lamp_rays * lamps_density);
}

void row_cast_lamps(RowCast *row, const Room *room, const LampTable *lamps, uint32_t seed,
                    double hemisphere_rays)
{
    assert(row->valid_count > 0 && lamps->count > 0);
    const uint32_t first = row->keys;
    uint32_t aimed = 0;
    double weights = 0;
    for (uint32_t m = 0; m < row->lamp_rays; m++) {
        const uint64_t place = (uint64_t)m * row->valid_count / row->lamp_rays;
        const CastPosition *from = &row->position[row->valid[place]];
        float x[4];
        sampling_sobol4(m, seed, x);
        const uint32_t lamp = lamp_table_choose(lamps, x[0]);
        weights += from->at.weight;
        const double share = aim(row, room, lamps, from, lamp, x, hemisphere_rays,
                                 &row->ray[aimed]);
        if (share > 0) {
            row_cast_add(row, lamp, share * from->at.weight);
            aimed++;
        }
    }
    bvh_blocked_many(room->bvh, row->ray, row->blocked, aimed);
    row->cast += aimed;
    const double scale = weights > 0 ? row->lamp_rays / weights : 0;
    for (uint32_t k = 0; k < aimed; k++)
        row->value[first + k] = row->blocked[k] ? 0 : (float)(row->value[first + k] * scale);
}
