/* SPDX-License-Identifier: BSD-3-Clause */
/* How quick the window is. */
#include "viewer/pace.h"

#include <assert.h>
#include <math.h>

#include "base/array.h"

static const double LEAST = 1e-5, STEP = 1.02;

void pace_init(Pace *pace, double before)
{
    assert(before >= 0);
    *pace = (Pace){ .before = before, .first_frame = NAN, .first_lit = NAN, .event = -1,
                    .changed = -1 };
}

void pace_clear(Pace *pace)
{
    array_free(pace->light);
    pace_init(pace, 0);
}

static void add_time(PaceTimes *times, double seconds)
{
    const double at = log(fmax(seconds, LEAST) / LEAST) / log(STEP);
    times->bin[at < PACE_BINS - 1 ? (int)at : PACE_BINS - 1]++;
    times->count++;
    times->most = fmax(times->most, seconds);
}

double pace_quantile(const PaceTimes *times, double share)
{
    const double wanted = share * (double)times->count;
    double sum = 0;
    assert(share >= 0 && share <= 1);
    for (int k = 0; k < PACE_BINS && times->count > 0; k++) {
        sum += times->bin[k];
        if (sum > 0 && sum >= wanted)
            return fmin(LEAST * pow(STEP, k + 0.5), times->most);
    }
    return NAN;
}

static double power_received(const Snapshot *s)
{
    const float *e = s->layer[LAYER_IRRADIANCE];
    double sum = 0;
    for (uint32_t i = 0; i < s->mesh->patch_count; i++, e += 3)
        if (!s->mesh->patch[i].lamp)
            sum += s->mesh->patch[i].area *
                   rgb_luminance(rgb((double)e[0], (double)e[1], (double)e[2]));
    return sum;
}

bool pace_snapshot(Pace *pace, const Snapshot *snapshot, bool finished, double now, Error *err)
{
    if (finished) {
        if (pace->changed >= 0)
            add_time(&pace->updates, now - pace->changed);
        pace->changed = now;
        return true;
    }
    if (snapshot->layer[LAYER_IRRADIANCE] == NULL)
        return true;
    if (!array_reserve((void **)&pace->light, &pace->light_capacity, pace->light_count + 1,
                       sizeof *pace->light, "figures of the window", err))
        return false;
    pace->light[pace->light_count++] = (PaceLight){ pace->before + now, power_received(snapshot) };
    return true;
}

void pace_event(Pace *pace, double now)
{
    if (pace->event < 0)
        pace->event = now;
}

void pace_frame(Pace *pace, double begin, double now, bool lit, bool finished)
{
    assert(now >= begin);
    add_time(finished ? &pace->resting : &pace->working, now - begin);
    if (pace->event >= 0)
        add_time(&pace->latency, now - pace->event);
    pace->event = -1;
    if (isnan(pace->first_frame))
        pace->first_frame = pace->before + now;
    if (lit && isnan(pace->first_lit))
        pace->first_lit = pace->before + now;
    if (lit && !finished)
        pace->working_seconds = pace->before + now - pace->first_lit;
}

double pace_light_at(const Pace *pace, double share)
{
    const double last = pace->light_count > 0 ? pace->light[pace->light_count - 1].power : 0;
    for (size_t i = 0; i < pace->light_count; i++)
        if (last > 0 && pace->light[i].power >= share * last)
            return pace->light[i].seconds;
    return NAN;
}
