/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/sides.c -- which sides take part: starts sight at eyes, lamps and lights and counts. */
#include "radiosity/sides.h"

#include <assert.h>
#include <string.h>

#include "base/array.h"
#include "math/sampling.h"
#include "math/tolerance.h"
#include "radiosity/internal.h"

/* Rays that all eyes and lights share, and how many each has at least and at most. */
enum { LOOK_RAYS = 1 << 17, LOOK_MIN = 128, LOOK_MAX = 8192 };

/* Surfaces times eyes up to which each surface looks for each eye: a second's work. */
static const size_t AIM_MOST = 1 << 18;

/* Lamps and lights that reach less than this share of the scene's area light hardly anything. */
static const double DARK_SHARE = 1.0 / 20;

static void start_lamps(Reach *reach, const uint8_t *emitting)
{
    for (uint32_t i = 0; i < reach->surfaces->count; i++)
        for (unsigned side = 0; side < 2; side++)
            if ((emitting[i] >> side) & 1)
                reach_add_side(reach, 2 * i + side);
}

/* Point number k of all eyes and lights. */
static void start_point(Reach *reach, Vec3 point, size_t k, size_t points, uint32_t seed)
{
    const size_t each = LOOK_RAYS / points;
    const uint32_t rays = each < LOOK_MIN ? LOOK_MIN : each > LOOK_MAX ? LOOK_MAX : (uint32_t)each;
    reach_look(reach, point, rays, sampling_seed(seed, (uint32_t)k, SEED_SIDES, UINT32_MAX));
    if (points * reach->surfaces->count <= AIM_MOST)
        reach_aim(reach, point);
}

/* Parts that are lamps rather than lit rooms have at least this share of their area emitting: a
 * quarter; of a room with a luminous ceiling it is a fifth. */
static const double LAMP_SHARE = 1.0 / 4;

/* Area of all parts but lamps, and how much of it is in reach. */
typedef struct {
    double all, lit;
} Lit;

static bool measure_lit(const Reach *reach, const uint8_t *emitting, Lit *whole, Lit *others,
                        Error *err)
{
    const Surfaces *s = reach->surfaces;
    double *share = array_create(s->part_count, sizeof *share, "parts", err);
    double *area = array_create(s->part_count, sizeof *area, "parts", err);
    for (uint32_t i = 0; !error_is_set(err) && i < s->count; i++) {
        area[s->part[i]] += s->surface[i].area;
        share[s->part[i]] += emitting[i] != 0 ? s->surface[i].area : 0;
    }
    for (uint32_t i = 0; !error_is_set(err) && i < s->count; i++) {
        const double a = s->surface[i].area, lit = reach->used[i] != 0 ? a : 0;
        whole->all += a;
        whole->lit += lit;
        if (share[s->part[i]] >= LAMP_SHARE * area[s->part[i]])
            continue;
        others->all += a;
        others->lit += lit;
    }
    array_free(share);
    array_free(area);
    return !error_is_set(err);
}

/* Warns when what lamps and lights reach by themselves is hardly anything, or nothing else than
 * themselves. */
static bool warn_dark(const Reach *reach, const uint8_t *emitting, Error *err)
{
    Lit whole = { 0 }, others = { 0 };
    if (reach->reached == 0)
        return true;
    if (!measure_lit(reach, emitting, &whole, &others, err))
        return false;
    if (whole.lit < DARK_SHARE * whole.all || (others.all > 0 && !(others.lit > 0)))
        monitor_warn(reach->monitor, "dark-scene", "",
                     "only %.2g %% of the scene's area, lamps left out, is in reach of any light: "
                     "a lamp may be shut in, or wound the wrong way round (--emit back)",
                     others.all > 0 ? 100 * others.lit / others.all : 0);
    return true;
}

/* First what gives light: it is known then what that reaches; then the eyes. */
static bool start(Reach *reach, const Light *lights, size_t light_count,
                  const SidesOptions *options, const uint8_t *emitting, Error *err)
{
    const size_t eyes = options->eye_count, points = eyes + light_count;
    start_lamps(reach, emitting);
    for (size_t k = 0; k < light_count; k++)
        start_point(reach, lights[k].position, eyes + k, points, options->seed);
    if (!reach_spread_on(reach))
        return error_set(err, ERROR_STOPPED, "stopped while looking for sides in sight");
    if (!warn_dark(reach, emitting, err))
        return false;
    for (size_t k = 0; k < eyes; k++)
        start_point(reach, options->eye[k], k, points, options->seed);
    return true;
}

static void count_sides(const Surfaces *surfaces, const uint8_t *sides, SidesReport *report)
{
    for (uint32_t i = 0; i < surfaces->count; i++) {
        report->front += sides[i] == 1;
        report->back += sides[i] == 2;
        report->both += sides[i] == 3;
        report->none += sides[i] == 0;
    }
}

bool sides_find(const Surfaces *surfaces, const Bvh *bvh, const Material *materials,
                const Light *lights, size_t light_count, const SidesOptions *options,
                uint8_t *sides, uint8_t *emitting, SidesReport *report, const Monitor *monitor,
                Error *err)
{
    *report = (SidesReport){ 0 };
    if (error_is_set(err))
        return false;
    assert(surfaces != NULL && bvh != NULL && options != NULL);
    assert(sides != NULL && emitting != NULL);
    if (!sides_emission(surfaces, bvh, materials, options, emitting, &report->lamps_turned, monitor,
                        err))
        return false;
    bool any = options->eye_count > 0 || light_count > 0;
    for (uint32_t i = 0; i < surfaces->count && !any; i++)
        any = emitting[i] != 0;
    if (!any) {
        memset(sides, 3, surfaces->count);
        count_sides(surfaces, sides, report);
        return true;
    }
    Reach reach;
    bool done = reach_create(&reach, surfaces, bvh, materials, options, monitor, err);
    if (done) {
        done = start(&reach, lights, light_count, options, emitting, err)
            && reach_spread(&reach, err);
        memcpy(sides, reach.used, surfaces->count);
        count_sides(surfaces, sides, report);
    }
    reach_clear(&reach);
    return done;
}
