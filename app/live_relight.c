/* SPDX-License-Identifier: BSD-3-Clause */
/* Knobs that are turned: the scene changed, solved from the last solution on. */
#include "app/live_relight.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "app/live_changes.h"
#include "app/live_dimming.h"
#include "app/pipeline_clusters.h"
#include "app/pipeline_stochastic.h"
#include "base/array.h"
#include "radiosity/relight.h"

/* While a slider moves, light need not be known better than is seen: a two-hundredth of a stop. */
static const double MOVING_TOLERANCE = 1e-3;
/* A slider that rests so long has been let go of. */
static const double MOVING_SECONDS = 0.3;

/* --- the scene before ------------------------------------------------------------------------- */

static double *copy(const double *value, size_t n, Error *err)
{
    double *out = array_create(n, sizeof *out, "knobs", err);
    if (out != NULL)
        memcpy(out, value, n * sizeof *out);
    return out;
}

/* Knob k's own copy of a material that emits; *material becomes it. copy_of [before]. */
static bool own_material(Relighting *r, uint32_t k, Polygons *soup, uint32_t *copy_of,
                         uint32_t before, uint32_t *material, Error *err)
{
    if (*material >= before || !(rgb_max(soup->materials[*material].emission) > 0))
        return true;
    if (copy_of[*material] == UINT32_MAX) {
        const Material m = soup->materials[*material];
        if (!polygons_add_material(soup, &m, &copy_of[*material], err))
            return false;
        r->lamp[copy_of[*material]] = k;
        r->paint[copy_of[*material]] = r->paint[*material];
    }
    *material = copy_of[*material];
    return true;
}

/* Lamps of a knob's group get materials of their own. */
static bool part_group(Relighting *r, uint32_t k, Pipeline *p, Error *err)
{
    const uint32_t group = r->knob[k].index;
    Polygons *soup = &p->scene->polygons;
    const uint32_t before = (uint32_t)soup->material_count;
    uint32_t *copy_of = array_create(before, sizeof *copy_of, "knobs", err);
    if (copy_of == NULL)
        return false;
    memset(copy_of, 0xff, before * sizeof *copy_of);
    for (uint32_t i = 0; i < p->surfaces->count && !error_is_set(err); i++) {
        Surface *s = &p->surfaces->surface[i];
        if (s->group == group)
            own_material(r, k, soup, copy_of, before, &s->material, err);
        if (s->back_group == group)
            own_material(r, k, soup, copy_of, before, &s->back_material, err);
    }
    array_free(copy_of);
    return !error_is_set(err);
}

static bool part_lamps(Relighting *r, Pipeline *p, Error *err)
{
    const uint32_t originals = (uint32_t)p->scene->polygons.material_count;
    const size_t most = ((size_t)KNOBS_GROUPS + 1) * originals;
    r->lamp = array_create(most, sizeof *r->lamp, "knobs", err);
    r->paint = array_create(most, sizeof *r->paint, "knobs", err);
    if (error_is_set(err))
        return false;
    memset(r->lamp, 0xff, most * sizeof *r->lamp);
    memset(r->paint, 0xff, most * sizeof *r->paint);
    for (uint32_t k = 0; k < r->knob_count; k++) {
        if (r->knob[k].kind == KNOB_LAMP)
            r->lamp[r->knob[k].index] = k;
        if (r->knob[k].kind == KNOB_PAINT)
            r->paint[r->knob[k].index] = k;
    }
    for (uint32_t k = 0; k < r->knob_count && r->knob[k].kind == KNOB_GROUP; k++)
        if (!part_group(r, k, p, err))
            return false;
    return true;
}

static bool note_lights(Relighting *r, const Scene *scene, Error *err)
{
    r->intensity = array_create(scene->light_count, sizeof *r->intensity, "knobs", err);
    r->light = array_create(scene->light_count, sizeof *r->light, "knobs", err);
    r->alone = array_create(r->knob_count, sizeof *r->alone, "knobs", err);
    for (uint32_t i = 0; !error_is_set(err) && i < scene->light_count; i++) {
        r->intensity[i] = scene->lights[i].intensity;
        r->light[i] = UINT32_MAX;
        for (uint32_t k = 0; k < r->knob_count; k++) {
            const Knob *knob = &r->knob[k];
            if (knob->kind == KNOB_LIGHTS ||
                (knob->kind == KNOB_LIGHT && strcmp(knob->name, scene->lights[i].name) == 0))
                r->light[i] = k;
        }
    }
    return !error_is_set(err);
}

/* What the room reads from the scene, once materials have moved or were added. */
static void follow_materials(Pipeline *p)
{
    p->room.materials = p->scene->polygons.materials;
    p->room.material_count = p->scene->polygons.material_count;
    for (uint32_t i = 0; i < p->patches->count; i++)
        p->patches->material[i] = surfaces_material(p->surfaces, p->patches->surface[i],
                                                    p->patches->side[i]);
}

bool relighting_begin(Relighting *r, Live *live, Error *err)
{
    Pipeline *p = live->pipeline;
    *r = (Relighting){ 0 };
    if (!knobs_list(p->scene, &r->knob, &r->knob_count, err) || !part_lamps(r, p, err) ||
        !note_lights(r, p->scene, err))
        return false;
    follow_materials(p);
    const Polygons *soup = &p->scene->polygons;
    r->materials = (uint32_t)soup->material_count;
    r->emission = array_create(r->materials, sizeof *r->emission, "knobs", err);
    r->reflectance = array_create(r->materials, sizeof *r->reflectance, "knobs", err);
    for (uint32_t m = 0; !error_is_set(err) && m < r->materials; m++) {
        r->emission[m] = soup->materials[m].emission;
        r->reflectance[m] = soup->materials[m].reflectance;
    }
    r->brings = array_create(r->knob_count, sizeof *r->brings, "knobs", err);
    if (p->direct.irradiance != NULL)
        r->direct = copy(p->direct.irradiance, (size_t)ROOM_BANDS * p->patches->count, err);
    return !error_is_set(err);
}

void relighting_end(Relighting *r)
{
    for (uint32_t k = 0; r->alone != NULL && k < r->knob_count; k++)
        array_free(r->alone[k]);
    array_free(r->alone);
    dimming_forget(r);
    array_free(r->brings);
    array_free(r->emission);
    array_free(r->reflectance);
    array_free(r->lamp);
    array_free(r->paint);
    array_free(r->intensity);
    array_free(r->light);
    array_free(r->direct);
    knobs_free(r->knob, r->knob_count);
    *r = (Relighting){ 0 };
}

/* --- the scene as the knobs stand ------------------------------------------------------------- */

static void turn_materials(const Relighting *r, Pipeline *p, const KnobSetting *s)
{
    for (uint32_t m = 0; m < r->materials; m++) {
        Material *material = &p->scene->polygons.materials[m];
        const uint32_t lamp = r->lamp[m], paint = r->paint[m];
        material->emission = lamp != UINT32_MAX && s->turned[lamp]
                                 ? knob_apply(&r->knob[lamp], s->value[lamp], r->emission[m])
                                 : r->emission[m];
        material->reflectance = paint != UINT32_MAX && s->turned[paint]
                                    ? knob_apply(&r->knob[paint], s->value[paint],
                                                 r->reflectance[m])
                                    : r->reflectance[m];
    }
}

/* What arrives from the lights of one knob, as they are in the scene. */
static bool cast_alone(Relighting *r, Pipeline *p, uint32_t k, Error *err)
{
    const Settings *settings = &p->session->settings;
    Light *light = array_create(p->scene->light_count, sizeof *light, "knobs", err);
    bool  *only = array_create(p->scene->light_count, sizeof *only, "knobs", err);
    const DirectOptions options = { .seed = settings->seed, .threads = settings->threads,
                                    .balance = settings->closure != CLOSURE_NONE, .only = only };
    Room room = p->room;
    Direct direct = { 0 };
    room.lights = light;
    for (uint32_t i = 0; !error_is_set(err) && i < p->scene->light_count; i++) {
        light[i] = p->scene->lights[i];
        light[i].intensity = r->intensity[i];
        only[i] = r->light[i] == k;
    }
    if (!error_is_set(err) &&
        direct_create(&room, p->links, &options, &direct, &p->session->monitor, err))
        r->alone[k] = direct.irradiance;
    array_free(light);
    array_free(only);
    return r->alone[k] != NULL;
}

static bool turn_lights(Relighting *r, Pipeline *p, const KnobSetting *s, Error *err)
{
    const size_t n = (size_t)ROOM_BANDS * p->patches->count;
    if (p->scene->light_count == 0)
        return true;
    memcpy(p->direct.irradiance, r->direct, n * sizeof *r->direct);
    for (uint32_t k = 0; k < r->knob_count; k++) {
        const Knob *knob = &r->knob[k];
        if ((knob->kind != KNOB_LIGHT && knob->kind != KNOB_LIGHTS) || !s->turned[k])
            continue;
        if (r->alone[k] == NULL && !cast_alone(r, p, k, err))
            return false;
        const Rgb one = rgb(1, 1, 1), f = knob_apply(knob, s->value[k], one);
        const double more[ROOM_BANDS] = { f.r - 1, f.g - 1, f.b - 1 };
        for (size_t i = 0; i < n; i++) /* rounding may leave less than nothing */
            p->direct.irradiance[i] = fmax(0, p->direct.irradiance[i] +
                                                  more[i % ROOM_BANDS] * r->alone[k][i]);
    }
    for (uint32_t i = 0; i < p->scene->light_count; i++) {
        const uint32_t k = r->light[i];
        p->scene->lights[i].intensity =
            k != UINT32_MAX && s->turned[k] ? knob_apply(&r->knob[k], s->value[k], r->intensity[i])
                                            : r->intensity[i];
    }
    return true;
}

/* --- the light ------------------------------------------------------------------------------- */

static Solution *solve_again(Pipeline *p, const double *received, double tolerance, Error *err)
{
    const SolveOptions so = { .solver = SOLVER_TWO_LEVEL, .tolerance = tolerance,
                              .threads = p->session->settings.threads,
                              .centre = p->patches->centre, .normal = p->patches->normal };
    Solution *const before = p->solution;
    if (!p->session->settings.stochastic)
        return relight(p->links, &p->problem, before, received, &so, &p->session->monitor, err);
    p->solution = NULL;
    if (p->session->settings.clusters)
        pipeline_clusters_solve(p, err);
    else
        pipeline_stochastic_solve(p, err);
    Solution *after = p->solution;
    p->solution = before;
    return after;
}

bool relighting_turn(Relighting *r, Pipeline *p, const KnobSetting *setting, Error *err)
{
    turn_materials(r, p, setting);
    if (!turn_lights(r, p, setting, err))
        return false;
    p->emission = array_free(p->emission);
    p->reflectance = array_free(p->reflectance);
    return pipeline_problem(p, err);
}

/* The light of another paint, or where links are not kept: from the last one on. */
static bool solve_on(Relighting *r, Pipeline *p, const KnobSetting *setting, Error *err)
{
    const size_t n = (size_t)ROOM_BANDS * p->patches->count;
    double *received = p->direct.irradiance != NULL ? copy(p->direct.irradiance, n, err) : NULL;
    Solution *after = NULL;
    dimming_forget(r);
    if (!error_is_set(err) && relighting_turn(r, p, setting, err))
        after = solve_again(p, received, MOVING_TOLERANCE, err);
    array_free(received);
    if (after == NULL)
        return false;
    solution_destroy(p->solution);
    p->solution = after;
    return true;
}

static bool change(Relighting *r, Pipeline *p, const KnobSetting *setting, Error *err)
{
    bool could;
    if (!dimming_follow(r, p, setting, &could, err) || (!could && !solve_on(r, p, setting, err)))
        return false;
    r->setting = *setting;
    return true;
}

static void save(const Relighting *r, const Live *live)
{
    const Pipeline *p = live->pipeline;
    char path[4096], line[256];
    KnobSetting setting;
    Error err = { 0 };
    knobs_read(&live->control->knobs, &setting);
    if (live_changes_save(p->scene, p->session->options.scene, r->knob, r->knob_count, &setting,
                          path, sizeof path, &err))
        snprintf(line, sizeof line, "saved %.200s, which --changes reads", path);
    else
        snprintf(line, sizeof line, "%.255s", err.text);
    control_say(live->control, line);
}

/* Whether the last solution is for the knobs as they stand, or none was ever turned. */
static bool up_to_date(const Relighting *r, Knobs *knobs)
{
    KnobSetting setting;
    bool any = false;
    if (atomic_load(&knobs->version) == r->version)
        return true;
    knobs_read(knobs, &setting);
    for (uint32_t k = 0; k < r->knob_count; k++)
        any = any || setting.turned[k];
    return !any && r->version == 0;
}

static bool publish(Live *live, const Links *links, Error *err)
{
    const Pipeline *p = live->pipeline;
    const LiveLight light = { .radiosity = p->solution->radiosity,
                              .irradiance = p->solution->irradiance,
                              .visible_area = p->links->area, .links = links,
                              .shooter = PATCH_NONE, .changed = true };
    live->report.unshot = p->solution->unshot;
    live->report.residual = live_residual(p);
    live->report.steps = p->solution->iterations;
    live->report.done = 1;
    live_report(live);
    return live_publish(live, &light, err);
}

/* To the tolerance that the window has now. */
static bool solve_further(Live *live, Error *err)
{
    Pipeline *p = live->pipeline;
    Solution *after = solve_again(p, p->direct.irradiance, live_wish(live), err);
    if (after == NULL)
        return false;
    solution_destroy(p->solution);
    p->solution = after;
    return true;
}

/* Nothing was turned for a while: to the solver's own tolerance, with all that links tell. */
static bool settle(Relighting *r, Live *live, Error *err)
{
    Pipeline *p = live->pipeline;
    r->moving = false;
    return (p->session->settings.stochastic || solve_further(live, err)) &&
           publish(live, live_links(live), err);
}

bool relighting_rest(Relighting *r, Live *live, bool *done, Error *err)
{
    Knobs *knobs = &live->control->knobs;
    const unsigned version = atomic_load(&knobs->version);
    *done = !r->moving && live_tolerance(live) < live->asked;
    if (*done) {
        live_begin(live, "solving", STEP_SOLVED);
        if (!solve_further(live, err))
            return false;
        live_begin(live, live->pipeline->solution->converged ? "converged" : "stopped",
                   STEP_SOLVED);
        return publish(live, live_links(live), err);
    }
    if (r->moving || !up_to_date(r, knobs))
        return true;
    if (!live->lit_wholly && !live_errors(live, r->version > 0, err))
        return false;
    if (live->lit_wholly)
        atomic_store(&knobs->settled, version);
    if (live_tolerance(live) < live->asked) /* just now: the window has said so before us */
        atomic_store(&knobs->settled, UINT_MAX);
    return true;
}

bool relighting_follow(Relighting *r, Live *live, bool *done, Error *err)
{
    KnobSetting setting;
    Knobs *knobs = &live->control->knobs;
    assert(live->pipeline->solution != NULL && r->emission != NULL);
    *done = false;
    if (atomic_exchange(&knobs->save, false))
        save(r, live);
    if (up_to_date(r, knobs)) {
        const bool due = r->moving && progress_now() - r->turned > MOVING_SECONDS;
        *done = due;
        return !due || settle(r, live, err);
    }
    *done = true;
    r->moving = true;
    r->turned = progress_now();
    r->version = knobs_read(knobs, &setting);
    live_begin(live, "relit", STEP_SOLVED);
    live_forget(live); /* rays would find other lamps than that light came from */
    return change(r, live->pipeline, &setting, err) && publish(live, NULL, err);
}
