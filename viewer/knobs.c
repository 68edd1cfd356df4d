/* SPDX-License-Identifier: BSD-3-Clause */
/* Knobs: which there are, and what they stand at. */
#include "viewer/knobs.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "math/tolerance.h"

/* --- the list --------------------------------------------------------------------------------- */

typedef struct {
    const Scene *scene;
    Knob        *knob;      /* [KNOBS_MOST] */
    uint32_t     count;
    Error       *err;
} KnobList;

static bool add(KnobList *list, const Knob *like, const char *name)
{
    if (list->count == KNOBS_MOST)
        return true;
    Knob *knob = &list->knob[list->count];
    *knob = *like;
    knob->name = array_string(name, list->err);
    list->count += knob->name != NULL;
    return knob->name != NULL;
}

static Rgb largest(Rgb a, Rgb b) { return rgb(fmax(a.r, b.r), fmax(a.g, b.g), fmax(a.b, b.b)); }

/* Emission of each group, and whether one material is all it has; how many emit. */
static uint32_t find_groups(const Polygons *soup, Rgb *emission, uint32_t *material, bool *mixed)
{
    uint32_t groups = 0;
    for (size_t i = 0; i < soup->group_count; i++)
        material[i] = UINT32_MAX;
    for (size_t i = 0; i < soup->polygon_count + soup->shape_count; i++) {
        const bool polygon = i < soup->polygon_count;
        const size_t s = i - soup->polygon_count;
        const uint32_t m = polygon ? soup->material[i] : soup->shape[s].material;
        const uint32_t g = polygon ? soup->group[i] : soup->shape[s].group;
        mixed[g] = mixed[g] || (material[g] != UINT32_MAX && material[g] != m);
        material[g] = m;
        groups += !(rgb_max(emission[g]) > 0) && rgb_max(soup->materials[m].emission) > 0;
        emission[g] = largest(emission[g], soup->materials[m].emission);
    }
    return groups;
}

/* False: too many, or copies of which nobody says here what group they are of. */
static bool list_groups(KnobList *list)
{
    const Polygons *soup = &list->scene->polygons;
    const size_t n = soup->group_count;
    Rgb *emission = array_create(n, sizeof *emission, "knobs", list->err);
    uint32_t *material = array_create(n, sizeof *material, "knobs", list->err);
    bool *mixed = array_create(n, sizeof *mixed, "knobs", list->err);
    const bool known = list->scene->placement_count == 0 && !error_is_set(list->err) &&
                       find_groups(soup, emission, material, mixed) <= KNOBS_GROUPS;
    for (uint32_t g = 0; known && g < n && !error_is_set(list->err); g++)
        if (rgb_max(emission[g]) > 0)
            add(list, &(Knob){ .kind = KNOB_GROUP, .index = g, .base = emission[g],
                               .plain = !mixed[g] }, soup->group_name[g]);
    array_free(emission);
    array_free(material);
    array_free(mixed);
    return known;
}

static void list_lamps(KnobList *list)
{
    const Polygons *soup = &list->scene->polygons;
    for (uint32_t i = 0; i < soup->material_count && !error_is_set(list->err); i++)
        if (rgb_max(soup->materials[i].emission) > 0)
            add(list, &(Knob){ .kind = KNOB_LAMP, .index = i, .plain = true,
                               .base = soup->materials[i].emission }, soup->materials[i].name);
}

/* The first light of that name. */
static uint32_t first_of_name(const Scene *scene, uint32_t light)
{
    uint32_t i = 0;
    while (strcmp(scene->lights[i].name, scene->lights[light].name) != 0)
        i++;
    return i;
}

static void list_lights(KnobList *list)
{
    const Scene *scene = list->scene;
    const uint32_t begin = list->count;
    Rgb all = rgb(0, 0, 0);
    for (uint32_t i = 0; i < scene->light_count; i++)
        all = largest(all, scene->lights[i].intensity);
    for (uint32_t i = 0; i < scene->light_count && !error_is_set(list->err); i++) {
        const uint32_t first = first_of_name(scene, i);
        uint32_t k = begin;
        while (k < list->count && list->knob[k].index != first)
            k++;
        if (k < list->count) {
            list->knob[k].base = largest(list->knob[k].base, scene->lights[i].intensity);
            continue;
        }
        if (list->count - begin == KNOBS_LIGHTS) { /* one for all of them */
            while (list->count > begin)
                array_free(list->knob[--list->count].name);
            add(list, &(Knob){ .kind = KNOB_LIGHTS, .base = all }, "point lights");
            return;
        }
        add(list, &(Knob){ .kind = KNOB_LIGHT, .index = first,
                           .base = scene->lights[i].intensity }, scene->lights[i].name);
    }
}

static void list_paint(KnobList *list)
{
    const Polygons *soup = &list->scene->polygons;
    for (uint32_t i = 0; i < soup->material_count && !error_is_set(list->err); i++)
        if (rgb_max(soup->materials[i].reflectance) > 0)
            add(list, &(Knob){ .kind = KNOB_PAINT, .index = i, .plain = true,
                               .base = soup->materials[i].reflectance }, soup->materials[i].name);
}

bool knobs_list(const Scene *scene, Knob **knob, uint32_t *count, Error *err)
{
    KnobList list = { .scene = scene, .err = err };
    list.knob = array_create(KNOBS_MOST, sizeof *list.knob, "knobs", err);
    if (list.knob != NULL) {
        if (!list_groups(&list))
            list_lamps(&list);
        list_lights(&list);
        list_paint(&list);
    }
    *knob = list.knob;
    *count = list.count;
    return !error_is_set(err);
}

Knob *knobs_free(Knob *knob, uint32_t count)
{
    for (uint32_t k = 0; k < count; k++)
        array_free(knob[k].name);
    return array_free(knob);
}

/* --- one of them ------------------------------------------------------------------------------ */

bool knob_shines(const Knob *knob) { return knob->kind != KNOB_PAINT; }

static double apply_band(const Knob *knob, double value, double base, double before)
{
    const double after = base > 0 ? before * (value / base) : knob->plain ? value : before;
    return knob_shines(knob) ? after : fmin(after, TOLERANCE_REFLECTANCE_MAX);
}

Rgb knob_apply(const Knob *knob, Rgb value, Rgb before)
{
    return rgb(apply_band(knob, value.r, knob->base.r, before.r),
               apply_band(knob, value.g, knob->base.g, before.g),
               apply_band(knob, value.b, knob->base.b, before.b));
}

bool knob_is_factor(const Knob *knob, Rgb value)
{
    const Rgb b = knob->base;
    return !knob->plain || ((b.r > 0 || !(value.r > 0)) && (b.g > 0 || !(value.g > 0)) &&
                            (b.b > 0 || !(value.b > 0)));
}

/* --- what they stand at ----------------------------------------------------------------------- */

void knobs_init(Knobs *knobs)
{
    assert(knobs != NULL);
    atomic_init(&knobs->version, 0);
    atomic_init(&knobs->settled, UINT_MAX); /* nothing is solved for yet */
    atomic_init(&knobs->save, false);
    pthread_mutex_init(&knobs->lock, NULL);
    memset(&knobs->setting, 0, sizeof knobs->setting);
}

void knobs_clear(Knobs *knobs) { pthread_mutex_destroy(&knobs->lock); }

Rgb knobs_value(Knobs *knobs, const Knob *knob, uint32_t k)
{
    assert(k < KNOBS_MOST && knob != NULL);
    pthread_mutex_lock(&knobs->lock);
    const Rgb value = knobs->setting.turned[k] ? knobs->setting.value[k] : knob->base;
    pthread_mutex_unlock(&knobs->lock);
    return value;
}

void knobs_turn(Knobs *knobs, uint32_t k, Rgb value)
{
    assert(k < KNOBS_MOST && value.r >= 0 && value.g >= 0 && value.b >= 0);
    pthread_mutex_lock(&knobs->lock);
    knobs->setting.value[k] = value;
    knobs->setting.turned[k] = true;
    atomic_fetch_add(&knobs->version, 1);
    pthread_mutex_unlock(&knobs->lock);
}

void knobs_reset(Knobs *knobs)
{
    pthread_mutex_lock(&knobs->lock);
    memset(&knobs->setting, 0, sizeof knobs->setting);
    atomic_fetch_add(&knobs->version, 1);
    pthread_mutex_unlock(&knobs->lock);
}

unsigned knobs_read(Knobs *knobs, KnobSetting *setting)
{
    pthread_mutex_lock(&knobs->lock);
    *setting = knobs->setting;
    const unsigned version = atomic_load(&knobs->version);
    pthread_mutex_unlock(&knobs->lock);
    return version;
}
