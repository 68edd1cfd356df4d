/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/sides.c -- which sides take part: starts sight at eyes, lamps and lights and counts. */
#include "radiosity/sides.h"

#include <assert.h>
#include <string.h>

#include "math/sampling.h"
#include "math/tolerance.h"
#include "radiosity/internal.h"

/* Rays that all eyes and lights share, and how many each has at least and at most. */
enum { LOOK_RAYS = 1 << 17, LOOK_MIN = 128, LOOK_MAX = 8192 };

/* Surfaces times eyes up to which each surface looks for each eye: a second's work. */
static const size_t AIM_MOST = 1 << 18;

static void start(Reach *reach, const Light *lights, size_t light_count,
                  const SidesOptions *options, const uint8_t *emitting)
{
    for (uint32_t i = 0; i < reach->surfaces->count; i++)
        for (unsigned side = 0; side < 2; side++)
            if ((emitting[i] >> side) & 1)
                reach_add_side(reach, 2 * i + side);
    const size_t eyes = options->eye_count + light_count;
    if (eyes == 0)
        return;
    const size_t each = LOOK_RAYS / eyes;
    const uint32_t rays = each < LOOK_MIN ? LOOK_MIN : each > LOOK_MAX ? LOOK_MAX : (uint32_t)each;
    for (size_t k = 0; k < eyes; k++) {
        const Vec3 eye = k < options->eye_count ? options->eye[k]
                                                : lights[k - options->eye_count].position;
        reach_look(reach, eye, rays,
                   sampling_seed(options->seed, (uint32_t)k, SEED_SIDES, UINT32_MAX));
        if (eyes * reach->surfaces->count <= AIM_MOST)
            reach_aim(reach, eye);
    }
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
    bool done = reach_create(&reach, surfaces, bvh, options, monitor, err);
    if (done) {
        start(&reach, lights, light_count, options, emitting);
        done = reach_spread(&reach, err);
        memcpy(sides, reach.used, surfaces->count);
        count_sides(surfaces, sides, report);
    }
    reach_clear(&reach);
    return done;
}
