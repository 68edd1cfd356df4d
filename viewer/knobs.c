/* SPDX-License-Identifier: BSD-3-Clause */
/* Knobs: which there are, and what they stand at. */
#include "viewer/knobs.h"

#include <assert.h>
#include <string.h>

#include "base/array.h"

static bool add(Knob *knob, uint32_t *count, KnobKind kind, uint32_t index, const char *name,
                Error *err)
{
    if (*count == KNOBS_MOST)
        return true;
    knob[*count] = (Knob){ kind, index, array_string(name, err) };
    return knob[(*count)++].name != NULL;
}

bool knobs_list(const Scene *scene, Knob **knob, uint32_t *count, Error *err)
{
    const Polygons *soup = &scene->polygons;
    *count = 0;
    *knob = array_create(KNOBS_MOST, sizeof **knob, "knobs", err);
    if (*knob == NULL)
        return false;
    for (uint32_t i = 0; i < soup->material_count && !error_is_set(err); i++)
        if (rgb_max(soup->materials[i].emission) > 0)
            add(*knob, count, KNOB_LAMP, i, soup->materials[i].name, err);
    if (scene->light_count > 0 && !error_is_set(err))
        add(*knob, count, KNOB_LIGHTS, 0, "point lights", err);
    for (uint32_t i = 0; i < soup->material_count && !error_is_set(err); i++)
        if (rgb_max(soup->materials[i].reflectance) > 0)
            add(*knob, count, KNOB_PAINT, i, soup->materials[i].name, err);
    return !error_is_set(err);
}

Knob *knobs_free(Knob *knob, uint32_t count)
{
    for (uint32_t k = 0; k < count; k++)
        array_free(knob[k].name);
    return array_free(knob);
}

void knobs_init(Knobs *knobs)
{
    assert(knobs != NULL);
    atomic_init(&knobs->version, 0);
    atomic_init(&knobs->save, false);
    pthread_mutex_init(&knobs->lock, NULL);
    for (unsigned k = 0; k < KNOBS_MOST; k++)
        knobs->value[k] = 1;
}

void knobs_clear(Knobs *knobs) { pthread_mutex_destroy(&knobs->lock); }

double knobs_value(Knobs *knobs, uint32_t k)
{
    assert(k < KNOBS_MOST);
    pthread_mutex_lock(&knobs->lock);
    const double value = knobs->value[k];
    pthread_mutex_unlock(&knobs->lock);
    return value;
}

void knobs_turn(Knobs *knobs, uint32_t k, double value)
{
    assert(k < KNOBS_MOST && value >= 0);
    pthread_mutex_lock(&knobs->lock);
    knobs->value[k] = value;
    atomic_fetch_add(&knobs->version, 1);
    pthread_mutex_unlock(&knobs->lock);
}

unsigned knobs_read(Knobs *knobs, double value[KNOBS_MOST])
{
    pthread_mutex_lock(&knobs->lock);
    memcpy(value, knobs->value, sizeof knobs->value);
    const unsigned version = atomic_load(&knobs->version);
    pthread_mutex_unlock(&knobs->lock);
    return version;
}
