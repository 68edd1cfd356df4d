/* SPDX-License-Identifier: BSD-3-Clause */
/* Changes of light and paint, read. */
#include "app/changes.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "app/json.h"
#include "base/array.h"
#include "base/file.h"

static const size_t FILE_MOST = (size_t)16 << 20;

static bool refuse(const Change *c, const char *why, Error *err)
{
    return error_set(err, c->blame, "%s: '%s' %s", c->from, c->name, why);
}

/* "0.5", "0.5,0.4,0.3", with a * before it factors. */
static bool read_value(const char *text, Change *c)
{
    Vec3 three;
    double one;
    c->factor = *text == '*';
    text += c->factor;
    if (value_number(text, &one))
        c->value = rgb(one, one, one);
    else if (value_vector(text, &three))
        c->value = rgb(three.x, three.y, three.z);
    else
        return false;
    const double low = fmin(c->value.r, fmin(c->value.g, c->value.b));
    return low >= 0 && isfinite(rgb_max(c->value));
}

/* Which group, material or light the name is. */
static bool find_name(Change *c, const Scene *scene)
{
    const Polygons *soup = &scene->polygons;
    for (size_t i = 0; i < soup->group_count; i++)
        if (strcmp(soup->group_name[i], c->name) == 0) {
            c->kind = CHANGE_GROUP;
            c->index = (uint32_t)i;
            return true;
        }
    for (size_t i = 0; i < soup->material_count; i++)
        if (strcmp(soup->materials[i].name, c->name) == 0) {
            c->kind = CHANGE_MATERIAL;
            c->index = (uint32_t)i;
            return true;
        }
    for (size_t i = 0; i < scene->light_count; i++)
        if (c->what == CHANGE_EMISSION && strcmp(scene->lights[i].name, c->name) == 0) {
            c->kind = CHANGE_LIGHT;
            c->index = (uint32_t)i;
            return true;
        }
    return false;
}

typedef struct {
    Changes     *changes;
    const Scene *scene;
    const char  *from;
    ErrorCode    blame;
} Reading;

static bool add(void *user, const char *name, const char *what, const char *value, Error *err)
{
    const Reading *r = user;
    Changes *all = r->changes;
    if (!array_reserve((void **)&all->change, &all->capacity, all->count + 1, sizeof *all->change,
                       "changes", err))
        return false;
    Change *c = &all->change[all->count++];
    *c = (Change){ .name = array_string(name, err), .from = array_string(r->from, err),
                   .blame = r->blame };
    if (error_is_set(err))
        return false;
    if (strcmp(what, "emission") != 0 && strcmp(what, "reflectance") != 0)
        return refuse(c, "has neither emission nor reflectance behind it", err);
    c->what = strcmp(what, "emission") == 0 ? CHANGE_EMISSION : CHANGE_REFLECTANCE;
    if (!read_value(value, c))
        return refuse(c, "needs a number, three with commas between, or * and factors", err);
    if (c->what == CHANGE_REFLECTANCE && !c->factor && !(rgb_max(c->value) < 1))
        return refuse(c, "needs reflectances below 1", err);
    return find_name(c, r->scene) ||
           refuse(c, "is no group, material or light of the scene", err);
}

/* NAME.emission=VALUE; a name may hold dots and equals signs. */
static bool read_option(const Reading *r, const char *text, Error *err)
{
    static const char *const whats[] = { "emission", "reflectance" };
    char word[1024];
    for (int k = 0; k < 2; k++) {
        char key[32];
        const int n = snprintf(key, sizeof key, ".%s=", whats[k]);
        const char *at = NULL;
        for (const char *p = strstr(text, key); p != NULL; p = strstr(p + 1, key))
            at = p;
        if (at == NULL || at == text || (size_t)(at - text) >= sizeof word)
            continue;
        memcpy(word, text, (size_t)(at - text));
        word[at - text] = '\0';
        return add((void *)r, word, whats[k], at + n, err);
    }
    return error_set(err, ERROR_USAGE, "--set '%s' is not NAME.emission=VALUE or "
                     "NAME.reflectance=VALUE", text);
}

bool changes_read(Changes *changes, const Options *options, const Scene *scene, Error *err)
{
    Reading r = { .changes = changes, .scene = scene };
    *changes = (Changes){ 0 };
    if (options->changes != NULL) {
        size_t size;
        char *bytes = file_read(options->changes, FILE_MOST, &size, err);
        r.from = options->changes;
        r.blame = ERROR_INPUT;
        if (bytes != NULL)
            json_read_members(bytes, size, options->changes, add, &r, err);
        array_free(bytes);
    }
    r.from = "--set";
    r.blame = ERROR_USAGE;
    for (uint32_t k = 0; k < options->set.count && !error_is_set(err); k++)
        read_option(&r, options->set.text[k], err);
    return !error_is_set(err);
}

void changes_clear(Changes *changes)
{
    for (size_t k = 0; k < changes->count; k++) {
        array_free(changes->change[k].name);
        array_free(changes->change[k].from);
    }
    array_free(changes->change);
    *changes = (Changes){ 0 };
}

bool change_value(const Change *c, Rgb before, Rgb *after, Error *err)
{
    *after = c->factor ? rgb_mul(before, c->value) : c->value;
    if (c->what == CHANGE_REFLECTANCE && !(rgb_max(*after) < 1))
        return refuse(c, "would reflect more than arrives", err);
    return isfinite(rgb_max(*after)) || refuse(c, "would shine without bounds", err);
}
