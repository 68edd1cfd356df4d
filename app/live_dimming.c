/* SPDX-License-Identifier: BSD-3-Clause */
/* Light of one knob's lamps alone, and sums of it. */
#include "app/live_dimming.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"

/* Of one knob's light by itself, relative to that knob's power. Turns add up their errors; when the
 * slider rests all is solved for again. */
static const double ALONE_TOLERANCE = 1e-4;

static const Rgb black = { 0, 0, 0 };

/* Where a knob's light alone is solved for: as in the scene, and 1 where that is black. */
static Rgb unit_of(const Knob *knob)
{
    return rgb(knob->base.r > 0 ? knob->base.r : 1, knob->base.g > 0 ? knob->base.g : 1,
               knob->base.b > 0 ? knob->base.b : 1);
}

static Rgb value_of(const Relighting *r, const KnobSetting *s, uint32_t k)
{
    return s->turned[k] ? s->value[k] : r->knob[k].base;
}

static bool same(Rgb a, Rgb b)
{
    return a.r == b.r && a.g == b.g && a.b == b.b;
}

/* What patches emit with knob k at `value`, all else as it stands; the scene is left like that. */
static bool emission_at(Relighting *r, Pipeline *p, uint32_t k, Rgb value, Error *err)
{
    KnobSetting s = r->setting;
    s.turned[k] = true;
    s.value[k] = value;
    return relighting_turn(r, p, &s, err);
}

/* The light of knob k at its unit, by itself. */
static bool solve_alone(Relighting *r, Pipeline *p, uint32_t k, Error *err)
{
    const size_t n = (size_t)ROOM_BANDS * p->patches->count;
    const bool   lights = r->knob[k].kind == KNOB_LIGHT || r->knob[k].kind == KNOB_LIGHTS;
    if (!emission_at(r, p, k, unit_of(&r->knob[k]), err))
        return false;
    double *emission = p->emission;
    p->emission = NULL;
    if (!emission_at(r, p, k, black, err)) {
        array_free(emission);
        return false;
    }
    for (size_t i = 0; i < n; i++)
        emission[i] = fmax(0, emission[i] - p->emission[i]);
    assert(!lights || r->alone[k] != NULL);
    const SolveProblem problem = { .bands = ROOM_BANDS, .emission = emission,
                                   .reflectance = p->reflectance,
                                   .received = lights ? r->alone[k] : NULL };
    const SolveOptions options = { .solver = SOLVER_TWO_LEVEL, .tolerance = ALONE_TOLERANCE,
                                   .threads = p->session->settings.threads,
                                   .centre = p->patches->centre, .normal = p->patches->normal };
    r->brings[k] = solve(p->links, &problem, &options, &p->session->monitor, err);
    array_free(emission);
    return r->brings[k] != NULL;
}

static void add(const Solution *brings, const double *factor, Solution *sum)
{
    const size_t n = (size_t)sum->count * sum->bands;
    for (size_t i = 0; i < n; i++) { /* rounding may leave less than nothing */
        const double f = factor[i % ROOM_BANDS];
        sum->radiosity[i] = fmax(0, sum->radiosity[i] + f * brings->radiosity[i]);
        sum->irradiance[i] = fmax(0, sum->irradiance[i] + f * brings->irradiance[i]);
    }
    sum->residual = fmax(sum->residual, brings->residual);
    sum->drift = INFINITY;
}

static bool paint_turned(const Relighting *r, const KnobSetting *setting)
{
    for (uint32_t k = 0; k < r->knob_count; k++)
        if (!knob_shines(&r->knob[k]) &&
            !same(value_of(r, &r->setting, k), value_of(r, setting, k)))
            return true;
    return false;
}

void dimming_forget(Relighting *r)
{
    for (uint32_t k = 0; r->brings != NULL && k < r->knob_count; k++)
        r->brings[k] = solution_destroy(r->brings[k]);
}

bool dimming_follow(Relighting *r, Pipeline *p, const KnobSetting *setting, bool *could, Error *err)
{
    *could = false;
    if (p->session->settings.stochastic || paint_turned(r, setting))
        return true;
    *could = true;
    for (uint32_t k = 0; k < r->knob_count; k++) {
        const Rgb now = value_of(r, setting, k), before = value_of(r, &r->setting, k);
        if (same(now, before))
            continue;
        if (r->brings[k] == NULL && !solve_alone(r, p, k, err))
            return false;
        const Rgb unit = unit_of(&r->knob[k]);
        const double factor[ROOM_BANDS] = { (now.r - before.r) / unit.r,
                                            (now.g - before.g) / unit.g,
                                            (now.b - before.b) / unit.b };
        add(r->brings[k], factor, p->solution);
    }
    return relighting_turn(r, p, setting, err);
}
