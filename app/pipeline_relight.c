/* SPDX-License-Identifier: BSD-3-Clause */
/* The scene's light or paint is changed after it was solved: the links are there already. */
#include <assert.h>
#include <math.h>
#include <string.h>
#include <time.h>

#include "app/changes.h"
#include "app/pipeline_relight.h"
#include "base/array.h"
#include "radiosity/relight.h"

/* --- the change in the scene ------------------------------------------------------------------ */

/* Materials that surfaces of one group have and those they get instead. */
typedef struct {
    uint32_t *copy;     /* [before]  material that takes its place; UINT32_MAX: not needed yet */
    uint32_t  before;
} Copies;

static bool set_values(Material *m, const Change *c, Error *err)
{
    Rgb *value = c->what == CHANGE_EMISSION ? &m->emission : &m->reflectance;
    return change_value(c, *value, value, err);
}

/* The group's own copy of a material, changed. */
static bool find_copy(Pipeline *p, const Change *c, Copies *copies, uint32_t *material, Error *err)
{
    Polygons *soup = &p->scene->polygons;
    if (copies->copy[*material] == UINT32_MAX) {
        Material m = soup->materials[*material];
        if (!set_values(&m, c, err) ||
            !polygons_add_material(soup, &m, &copies->copy[*material], err))
            return false;
    }
    *material = copies->copy[*material];
    return true;
}

static bool change_group(Pipeline *p, const Change *c, Error *err)
{
    Surfaces *s = p->surfaces;
    Copies copies = { .before = (uint32_t)p->scene->polygons.material_count };
    copies.copy = array_create(copies.before, sizeof *copies.copy, "materials", err);
    if (copies.copy == NULL)
        return false;
    memset(copies.copy, 0xff, copies.before * sizeof *copies.copy);
    for (uint32_t i = 0; i < s->count && !error_is_set(err); i++) {
        Surface *f = &s->surface[i];
        if (f->group == c->index && f->material < copies.before)
            find_copy(p, c, &copies, &f->material, err);
        if (f->back_group == c->index && f->back_material < copies.before)
            find_copy(p, c, &copies, &f->back_material, err);
    }
    array_free(copies.copy);
    return !error_is_set(err);
}

static bool change_lights(Pipeline *p, const Change *c, Error *err)
{
    for (size_t i = 0; i < p->scene->light_count; i++) {
        Light *light = &p->scene->lights[i];
        if (strcmp(light->name, c->name) == 0 &&
            !change_value(c, light->intensity, &light->intensity, err))
            return false;
    }
    return true;
}

/* What did not shine before shines from its front, where that is in use. */
static void set_emitting(Pipeline *p)
{
    const Surfaces *s = p->surfaces;
    const Material *materials = p->scene->polygons.materials;
    for (uint32_t i = 0; i < s->count; i++) {
        if (p->emitting[i] != 0)
            continue;
        if (rgb_max(materials[s->surface[i].material].emission) > 0)
            p->emitting[i] = (p->sides[i] & 1) != 0 ? 1 : p->sides[i] & 2;
        if (s->surface[i].back != SURFACE_NONE &&
            rgb_max(materials[s->surface[i].back_material].emission) > 0)
            p->emitting[i] |= p->sides[i] & 2;
    }
}

static bool change_scene(Pipeline *p, Error *err)
{
    bool lights = false, shines = false;
    for (size_t k = 0; k < p->changes.count; k++) {
        const Change *c = &p->changes.change[k];
        lights = lights || c->kind == CHANGE_LIGHT;
        shines = shines || (c->what == CHANGE_EMISSION && !c->factor);
        const bool done = c->kind == CHANGE_LIGHT ? change_lights(p, c, err)
                          : c->kind == CHANGE_GROUP ? change_group(p, c, err)
                          : set_values(&p->scene->polygons.materials[c->index], c, err);
        if (!done)
            return false;
    }
    p->room.materials = p->scene->polygons.materials;
    p->room.material_count = p->scene->polygons.material_count;
    for (uint32_t i = 0; i < p->patches->count; i++)
        p->patches->material[i] = surfaces_material(p->surfaces, p->patches->surface[i],
                                                    p->patches->side[i]);
    if (shines)
        set_emitting(p);
    p->relit.lights_changed = lights;
    return true;
}

/* --- light groups ----------------------------------------------------------------------------- */

/* Names of what is dimmed: groups of the scene that emit, then point lights. */
static bool find_groups(Pipeline *p, Error *err)
{
    Relit *relit = &p->relit;
    const Polygons *soup = &p->scene->polygons;
    const size_t most = soup->group_count + p->scene->light_count;
    relit->name = array_create(most, sizeof *relit->name, "light groups", err);
    relit->group_of = array_create(soup->group_count, sizeof *relit->group_of, "light groups", err);
    if (error_is_set(err))
        return false;
    memset(relit->group_of, 0xff, soup->group_count * sizeof *relit->group_of);
    for (uint32_t i = 0; i < p->patches->count; i++) {
        const uint32_t g = p->patches->group[i];
        if (relit->group_of[g] == UINT32_MAX && rgb_max(room_emission(&p->room, i)) > 0) {
            relit->group_of[g] = relit->group_count;
            relit->name[relit->group_count++] = soup->group_name[g];
        }
    }
    relit->first_light = relit->group_count;
    for (size_t i = 0; i < p->scene->light_count; i++)
        relit->name[relit->group_count++] = p->scene->lights[i].name;
    return true;
}

/* Light of one lamp group alone. */
static double *group_emission(const Pipeline *p, uint32_t group, Error *err)
{
    const size_t bytes = ROOM_BANDS * sizeof(double);
    double *e = array_create((size_t)p->patches->count * ROOM_BANDS, sizeof *e, "light groups",
                             err);
    for (uint32_t i = 0; e != NULL && i < p->patches->count; i++)
        if (p->relit.group_of[p->patches->group[i]] == group)
            memcpy(&e[(size_t)i * ROOM_BANDS], &p->emission[(size_t)i * ROOM_BANDS], bytes);
    return e;
}

/* Light of one point light alone. */
static double *light_received(Pipeline *p, uint32_t light, Error *err)
{
    const Settings *settings = &p->session->settings;
    bool *only = array_create(p->room.light_count, sizeof *only, "light groups", err);
    const DirectOptions options = { .seed = settings->seed, .threads = settings->threads,
                                    .balance = settings->closure != CLOSURE_NONE, .only = only };
    Direct direct = { 0 };
    if (only == NULL)
        return NULL;
    only[light] = true;
    const bool cast = direct_create(&p->room, p->links, &options, &direct, &p->session->monitor,
                                    err);
    array_free(only);
    return cast ? direct.irradiance : NULL;
}

static SolveOptions solve_options(const Pipeline *p)
{
    const Settings *settings = &p->session->settings;
    return (SolveOptions){ .solver = settings->solver, .tolerance = settings->tolerance,
                           .max_iterations = settings->max_iterations,
                           .relaxation = p->session->options.relaxation,
                           .centre = p->patches->centre, .normal = p->patches->normal,
                           .threads = settings->threads };
}

/* Groups of an earlier run must be those that there are. */
static bool groups_fit(const Pipeline *p, Error *err)
{
    return p->relit.groups->groups == p->relit.group_count ||
           error_at(err, ERROR_INPUT, p->session->options.resume, 0, "holds other light groups");
}

bool pipeline_light_groups(Pipeline *p, Error *err)
{
    Relit *relit = &p->relit;
    if (!find_groups(p, err))
        return false;
    if (relit->groups != NULL)
        return groups_fit(p, err);
    LightGroup *group = array_create(relit->group_count, sizeof *group, "light groups", err);
    const uint64_t bytes = (uint64_t)relit->group_count * p->patches->count * ROOM_BANDS *
                           (2 + 1) * sizeof(double);
    const double begin = progress_now();
    bool good = group != NULL && pipeline_fits(p, bytes, "--light-groups", err);
    for (uint32_t k = 0; good && k < relit->group_count; k++) {
        if (k < relit->first_light)
            group[k].emission = group_emission(p, k, err);
        else
            group[k].received = light_received(p, k - relit->first_light, err);
        good = !error_is_set(err);
    }
    const SolveOptions options = solve_options(p);
    if (good)
        relit->groups = light_groups_solve(p->links, ROOM_BANDS, p->reflectance, group,
                                           relit->group_count, &options, &p->session->monitor,
                                           err);
    for (uint32_t k = 0; group != NULL && k < relit->group_count; k++) {
        array_free((double *)group[k].emission);
        array_free((double *)group[k].received);
    }
    array_free(group);
    relit->groups_seconds = progress_now() - begin;
    return relit->groups != NULL;
}

bool changes_dim(const Pipeline *p)
{
    bool dim = true;
    for (size_t i = 0; i < p->changes.count; i++) {
        const Change *c = &p->changes.change[i];
        dim = dim && c->what == CHANGE_EMISSION && c->factor && c->kind != CHANGE_MATERIAL;
    }
    return dim;
}

/* Dimmers of changes that are all factors on whole light groups. */
static void find_dimmers(const Pipeline *p, double *dimmer)
{
    const Relit *relit = &p->relit;
    for (uint32_t k = 0; k < relit->group_count * ROOM_BANDS; k++)
        dimmer[k] = 1;
    for (size_t i = 0; i < p->changes.count; i++) {
        const Change *c = &p->changes.change[i];
        for (uint32_t k = 0; k < relit->group_count; k++) {
            const bool lamp = c->kind == CHANGE_GROUP && relit->group_of[c->index] == k;
            const bool light = c->kind == CHANGE_LIGHT && k >= relit->first_light &&
                               strcmp(relit->name[k], c->name) == 0;
            if (!lamp && !light)
                continue;
            dimmer[k * ROOM_BANDS] *= c->value.r;
            dimmer[k * ROOM_BANDS + 1] *= c->value.g;
            dimmer[k * ROOM_BANDS + 2] *= c->value.b;
        }
    }
}

/* --- the new light ---------------------------------------------------------------------------- */

static bool mix(Pipeline *p, bool solved, Error *err)
{
    Relit *relit = &p->relit;
    relit->mixed = relit->groups != NULL && changes_dim(p);
    if (!relit->mixed)
        return true;
    relit->dimmer = array_create((size_t)relit->group_count * ROOM_BANDS, sizeof *relit->dimmer,
                                 "dimmers", err);
    if (relit->dimmer == NULL)
        return false;
    find_dimmers(p, relit->dimmer);
    if (!solved)
        light_groups_mix(relit->groups, relit->dimmer, p->session->settings.threads, p->solution);
    return true;
}

static bool solve_again(Pipeline *p, const double *received, Error *err)
{
    SolveOptions options = solve_options(p);
    /* Few passes are all that counts. */
    if (!options_given(&p->session->options, OPTION_SOLVER))
        options.solver = SOLVER_TWO_LEVEL;
    Solution *after = relight(p->links, &p->problem, p->solution, received, &options,
                              &p->session->monitor, err);
    if (after == NULL)
        return false;
    solution_destroy(p->solution);
    p->solution = after;
    return true;
}

/* What all threads have used. */
static double cpu_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Groups that are to be found and solved anew. */
static void relit_forget(Relit *relit)
{
    relit->groups = light_groups_destroy(relit->groups);
    relit->name = array_free(relit->name);
    relit->group_of = array_free(relit->group_of);
    relit->group_count = relit->first_light = 0;
}

bool pipeline_relight(Pipeline *p, bool solved, Error *err)
{
    const double begin = progress_now(), cpu = cpu_now();
    if (!change_scene(p, err))
        return false;
    p->emission = array_free(p->emission);
    p->reflectance = array_free(p->reflectance);
    double *received = p->direct.irradiance; /* what arrived before */
    bool done = p->relit.lights_changed ? pipeline_light(p, err) : pipeline_problem(p, err);
    done = done && mix(p, solved, err) &&
           (solved || p->relit.mixed || solve_again(p, received, err));
    if (received != p->direct.irradiance)
        array_free(received);
    p->relit.seconds = progress_now() - begin;
    p->relit.cpu_seconds = cpu_now() - cpu;
    /* Layers of pictures are of the light as it is now. */
    if (done && p->session->options.light_groups && !p->relit.mixed &&
        p->session->options.command == COMMAND_RENDER) {
        if (!solved)
            relit_forget(&p->relit);
        done = pipeline_light_groups(p, err);
    }
    return done;
}

void relit_clear(Relit *relit)
{
    light_groups_destroy(relit->groups);
    array_free(relit->name);
    array_free(relit->group_of);
    array_free(relit->dimmer);
    array_free(relit->layer_text);
    array_free(relit->layer_name);
    *relit = (Relit){ 0 };
}
