/* SPDX-License-Identifier: BSD-3-Clause */
/* Knobs that are turned: the problem scaled, solved from the last solution on. */
#include "app/live_relight.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "app/json.h"
#include "app/output.h"
#include "base/array.h"
#include "math/tolerance.h"
#include "radiosity/relight.h"

/* While a slider moves, light need not be known better than is seen: a two-hundredth of a stop. */
static const double MOVING_TOLERANCE = 1e-3;

static double *copy(const double *value, size_t n, Error *err)
{
    double *out = array_create(n, sizeof *out, "knobs", err);
    if (out != NULL)
        memcpy(out, value, n * sizeof *out);
    return out;
}

bool relighting_begin(Relighting *relighting, Live *live, Error *err)
{
    const Pipeline *p = live->pipeline;
    const size_t n = (size_t)ROOM_BANDS * p->patches->count;
    *relighting = (Relighting){ 0 };
    relighting->emission = copy(p->emission, n, err);
    relighting->reflectance = copy(p->reflectance, n, err);
    relighting->direct = copy(p->direct.irradiance, n, err);
    return !error_is_set(err) &&
           knobs_list(p->scene, &relighting->knob, &relighting->knob_count, err);
}

void relighting_end(Relighting *relighting)
{
    array_free(relighting->emission);
    array_free(relighting->reflectance);
    array_free(relighting->direct);
    knobs_free(relighting->knob, relighting->knob_count);
    *relighting = (Relighting){ 0 };
}

/* Factors of all materials' emission and reflectance [2 * materials]; lights in *lights. */
static double *factors(const Relighting *relighting, const Pipeline *p, const double *value,
                       double *lights, Error *err)
{
    const size_t materials = p->scene->polygons.material_count;
    double *factor = array_create(2 * materials, sizeof *factor, "knobs", err);
    *lights = 1;
    for (size_t i = 0; factor != NULL && i < 2 * materials; i++)
        factor[i] = 1;
    for (uint32_t k = 0; factor != NULL && k < relighting->knob_count; k++) {
        const Knob *knob = &relighting->knob[k];
        if (knob->kind == KNOB_LIGHTS)
            *lights = value[k];
        else
            factor[2 * (size_t)knob->index + (knob->kind == KNOB_PAINT)] = value[k];
    }
    return factor;
}

static void scale_problem(const Relighting *relighting, Pipeline *p, const double *factor,
                          double lights)
{
    for (uint32_t i = 0; i < p->patches->count; i++) {
        const double *f = factor + 2 * (size_t)p->patches->material[i];
        for (size_t k = ROOM_BANDS * (size_t)i; k < ROOM_BANDS * ((size_t)i + 1); k++) {
            p->emission[k] = f[0] * relighting->emission[k];
            p->reflectance[k] = fmin(f[1] * relighting->reflectance[k],
                                     TOLERANCE_REFLECTANCE_MAX);
            p->direct.irradiance[k] = lights * relighting->direct[k];
        }
    }
}

/* As isolux solve --changes reads it. A material that nobody can name keeps its light. */
static bool save(const Relighting *relighting, const Live *live, const double *value, Error *err)
{
    const Pipeline *p = live->pipeline;
    char path[4096];
    if (!output_name(output_base(p->session->options.scene), "-changes.json", path, sizeof path,
                     err))
        return false;
    Json json = { .out = fopen(path, "w") };
    if (json.out == NULL)
        return error_set(err, ERROR_FAILED, "%s: cannot be written", path);
    json_open(&json, NULL, '{');
    for (uint32_t k = 0; k < relighting->knob_count; k++) {
        const Knob *knob = &relighting->knob[k];
        char text[40];
        snprintf(text, sizeof text, "*%.6g", value[k]);
        if (!(fabs(value[k] - 1) > 0) || knob->name[0] == '\0')
            continue;
        for (size_t i = 0; i < (knob->kind == KNOB_LIGHTS ? p->scene->light_count : 1); i++) {
            json_open(&json, knob->kind == KNOB_LIGHTS ? p->scene->lights[i].name : knob->name,
                      '{');
            json_text(&json, knob->kind == KNOB_PAINT ? "reflectance" : "emission", text);
            json_close(&json, '}');
        }
    }
    json_close(&json, '}');
    const bool bad = json.failed || ferror(json.out) != 0;
    return (fclose(json.out) == 0 && !bad) ||
           error_set(err, ERROR_FAILED, "%s: cannot be written", path);
}

static bool solve_again(Relighting *relighting, Live *live, const double *value, Error *err)
{
    Pipeline *p = live->pipeline;
    const size_t n = (size_t)ROOM_BANDS * p->patches->count;
    const SolveOptions so = { .solver = SOLVER_TWO_LEVEL, .tolerance = MOVING_TOLERANCE,
                              .threads = p->session->settings.threads,
                              .centre = p->patches->centre, .normal = p->patches->normal };
    double lights;
    double *factor = factors(relighting, p, value, &lights, err);
    double *before = copy(p->direct.irradiance, n, err);
    Solution *after = NULL;
    if (!error_is_set(err)) {
        scale_problem(relighting, p, factor, lights);
        after = relight(p->links, &p->problem, p->solution, before, &so, &p->session->monitor,
                        err);
    }
    array_free(factor);
    array_free(before);
    if (after == NULL)
        return false;
    solution_destroy(p->solution);
    p->solution = after;
    return true;
}

bool relighting_follow(Relighting *relighting, Live *live, bool *done, Error *err)
{
    double value[KNOBS_MOST];
    Pipeline *p = live->pipeline;
    Knobs *knobs = &live->control->knobs;
    *done = false;
    assert(p->solution != NULL && relighting->emission != NULL);
    if (atomic_load(&knobs->save)) {
        Error failed = { 0 };
        knobs_read(knobs, value);
        if (!save(relighting, live, value, &failed))
            monitor_warn(&p->session->monitor, "not-saved", "", "%s", failed.text);
        atomic_store(&knobs->save, false);
    }
    if (atomic_load(&knobs->version) == relighting->version)
        return true;
    *done = true;
    relighting->version = knobs_read(knobs, value);
    live_begin(live, "relit", STEP_SOLVED);
    if (!solve_again(relighting, live, value, err))
        return false;
    live->report.residual = p->solution->residual;
    live->report.steps = p->solution->iterations;
    live->report.done = 1;
    live_report(live);
    const LiveLight light = { .radiosity = p->solution->radiosity,
                              .irradiance = p->solution->irradiance,
                              .direct = p->direct.irradiance, .visible_area = p->links->area,
                              .shooter = PATCH_NONE };
    return live_publish(live, &light, err);
}
