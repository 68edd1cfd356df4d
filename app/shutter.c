/* SPDX-License-Identifier: BSD-3-Clause */
/* A scene at several moments. */
#include "app/shutter.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"

enum { MOMENTS_DEFAULT = 16 };

/* What the scene is like at one moment; *timed: whether others can differ. */
static bool read_moment(Moment *m, Session *session, bool *timed, Error *err)
{
    Pipeline scratch = { .session = session, .time = &m->time };
    const bool read = pipeline_read(&scratch, err);
    if (read) {
        const Scene *scene = scratch.scene;
        *timed = scene->timed;
        m->light = scene_fingerprint(scene);
        m->cameras = scene->camera_count;
        m->camera = array_create(m->cameras, sizeof *m->camera, "cameras", err);
        if (m->camera != NULL && m->cameras > 0)
            memcpy(m->camera, scene->cameras, m->cameras * sizeof *m->camera);
    }
    pipeline_clear(&scratch);
    return !error_is_set(err);
}

/* Numbers the solutions in the order of their first moments. */
static void number_solutions(Shutter *s)
{
    for (uint32_t i = 0; i < s->count; i++) {
        uint32_t j = 0;
        while (s->moment[j].light != s->moment[i].light)
            j++;
        s->moment[i].solution = j < i ? s->moment[j].solution : s->solutions++;
    }
}

static int compare_moments(const void *a, const void *b)
{
    const Moment *one = a, *two = b;
    if (one->solution != two->solution)
        return one->solution < two->solution ? -1 : 1;
    return (one->rank > two->rank) - (one->rank < two->rank);
}

/* The next of the numbers below `count` in the order of their bits reversed [vandercorput35]: each
 * few in a row are spread over all. *at: begins with 0. */
static uint32_t next_part(uint32_t count, uint32_t *at)
{
    uint32_t bits = 0, part;
    while ((uint64_t)1 << bits < count)
        bits++;
    do {
        part = 0;
        for (uint32_t i = 0; i < bits; i++)
            part |= (*at >> i & 1) << (bits - 1 - i);
        ++*at;
    } while (part >= count);
    return part;
}

bool shutter_read(Shutter *s, Session *session, Error *err)
{
    const Options *options = &session->options;
    const double opens = options->shutter[0], length = options->shutter[1] - opens;
    const uint32_t wanted = options->time_samples > 0 ? options->time_samples : MOMENTS_DEFAULT;
    uint32_t at = 0;
    bool timed = true;
    assert(length > 0);
    *s = (Shutter){ .count = wanted };
    s->moment = array_create(wanted, sizeof *s->moment, "moments", err);
    for (uint32_t k = 0; s->moment != NULL && k < s->count && !error_is_set(err); k++) {
        if (session_stopped(session))
            return error_set(err, ERROR_STOPPED, "stopped while the scene's moments were read");
        s->moment[k].rank = k;
        s->moment[k].time = opens + length * (next_part(s->count, &at) + 0.5) / s->count;
        if (read_moment(&s->moment[k], session, &timed, err) && !timed) {
            s->moment[0].time = opens + length / 2;
            s->count = 1;
            monitor_warn(&session->monitor, "time-unused", options->scene,
                         "nothing in the file depends on TIME: --shutter blurs nothing");
        }
    }
    if (error_is_set(err))
        return false;
    number_solutions(s);
    qsort(s->moment, s->count, sizeof *s->moment, compare_moments);
    const double middle = opens + length / 2;
    for (uint32_t k = 1; k < s->count; k++)
        if (fabs(s->moment[k].time - middle) < fabs(s->moment[s->middle].time - middle))
            s->middle = k;
    return true;
}

void shutter_clear(Shutter *s)
{
    for (uint32_t k = 0; s->moment != NULL && k < s->count; k++)
        array_free(s->moment[k].camera);
    array_free(s->moment);
    *s = (Shutter){ 0 };
}
