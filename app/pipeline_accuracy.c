/* SPDX-License-Identifier: BSD-3-Clause */
/* Light found from more and more rays. */
#include "app/pipeline_accuracy.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "math/sampling.h"

/* Rays of a patch at first, and the least that can be halved. */
enum { RAYS_FIRST = 64, RAYS_LEAST = 16 };
/* Without --rays, so many times those of the quality are allowed. */
enum { BUDGET_TIMES = 64 };
/* Errors fall about so fast with rays: how many more to try with. Never more than 8 times as many,
 * for a first estimate may be far off. */
static const double SLOPE = 0.7;
enum { STEP_MOST = 8 };

/* Means of both halves, of the last round that had both. */
typedef struct {
    size_t  count;
    double *radiosity, *irradiance; /* [count]  of a round's first half */
    double *whole_radiosity, *whole_irradiance;
    bool    whole;
} Mean;

bool pipeline_accuracy_allowed(const Options *options, Error *err)
{
    static const OptionId refused[] = { OPTION_FACTORS, OPTION_CHECKPOINT, OPTION_RESUME,
                                        OPTION_SET, OPTION_CHANGES, OPTION_LIGHT_GROUPS,
                                        OPTION_TRACE, OPTION_COMPARE };
    if (!options_given(options, OPTION_ACCURACY) || options->command == COMMAND_FACTORS)
        return true;
    if (options->solver == SOLVER_COUNT || options->solver == SOLVER_HIERARCHICAL)
        return error_set(err, ERROR_USAGE, "--accuracy needs a solver with factors of patches, not "
                         "--solver %s", options->solver == SOLVER_COUNT ? "stochastic"
                                                                        : "hierarchical");
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
        if (options_given(options, refused[i]))
            return error_set(err, ERROR_USAGE, "--accuracy casts factors several times; %s does "
                             "not go with it", options_table()[refused[i]].name);
    return true;
}

static uint32_t most(uint32_t rays, const Options *options, OptionId id)
{
    return options_given(options, id) || rays > UINT32_MAX / BUDGET_TIMES ? rays
                                                                          : BUDGET_TIMES * rays;
}

uint32_t pipeline_accuracy_point_rays(const Pipeline *pipeline)
{
    return most(pipeline->session->settings.gather_rays, &pipeline->session->options,
                OPTION_GATHER_RAYS);
}

/* All that comes after patches. */
static void forget_light(Pipeline *pipeline)
{
    pipeline->solution = solution_destroy(pipeline->solution);
    pipeline->links = links_destroy(pipeline->links);
    pipeline->raw_links = links_destroy(pipeline->raw_links);
    pipeline->emission = array_free(pipeline->emission);
    pipeline->reflectance = array_free(pipeline->reflectance);
    array_free(pipeline->direct.irradiance);
    pipeline->direct = (Direct){ 0 };
    pipeline->problem = (SolveProblem){ 0 };
}

static bool find_light(Pipeline *pipeline, uint32_t rays, uint32_t seed, Error *err)
{
    Settings *settings = &pipeline->session->settings;
    if (pipeline->links != NULL)
        forget_light(pipeline);
    settings->rays = rays;
    settings->lamp_rays = rays / 4;
    settings->seed = seed;
    const bool done = pipeline_factors(pipeline, err) && pipeline_solve(pipeline, err);
    settings->adapt = false; /* patches stay as they are from now on */
    return done;
}

static double luminance(const double *v)
{
    return rgb_luminance(rgb(v[0], v[1], v[2]));
}

/* Takes the second half, makes the mean of both and its error. */
static double join_halves(const Pipeline *pipeline, Mean *mean)
{
    const Solution *second = pipeline->solution;
    double squares = 0, all = 0;
    for (uint32_t i = 0; i < second->count; i++) {
        const size_t at = (size_t)ROOM_BANDS * i;
        const double a = luminance(mean->irradiance + at), b = luminance(second->irradiance + at);
        squares += pipeline->links->area[i] * (a - b) * (a - b) / 4;
        all += pipeline->links->area[i] * (a + b) * (a + b) / 4;
    }
    for (size_t k = 0; k < mean->count; k++) {
        mean->whole_radiosity[k] = (mean->radiosity[k] + second->radiosity[k]) / 2;
        mean->whole_irradiance[k] = (mean->irradiance[k] + second->irradiance[k]) / 2;
    }
    mean->whole = true;
    return all > 0 ? sqrt(squares / all) : 0;
}

static bool make_mean(const Solution *first, Mean *mean, Error *err)
{
    const size_t n = (size_t)first->count * ROOM_BANDS;
    double **arrays[] = { &mean->radiosity, &mean->irradiance, &mean->whole_radiosity,
                          &mean->whole_irradiance };
    if (mean->count == 0)
        for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
            if ((*arrays[k] = array_create(n, sizeof(double), "light", err)) == NULL)
                return false;
    mean->count = n;
    memcpy(mean->radiosity, first->radiosity, n * sizeof(double));
    memcpy(mean->irradiance, first->irradiance, n * sizeof(double));
    return true;
}

/* Rays of the next round's halves, or 0 when this one was the last. */
static uint32_t more_rays(const LightAccuracy *a, uint32_t rays)
{
    if (!(a->reached > a->asked) || rays > a->most / 4)
        return 0;
    const double times = pow(a->reached / a->asked, 1 / SLOPE);
    uint32_t step = 2;
    while (step < STEP_MOST && step < times && rays <= a->most / 4 / step)
        step *= 2;
    return rays * step;
}

/* Round by round; stopped in one, what the last one found remains. */
static bool run_rounds(Pipeline *pipeline, Mean *mean, Error *err)
{
    Session *session = pipeline->session;
    LightAccuracy *a = &pipeline->accuracy;
    const uint32_t seed = session->settings.seed;
    uint32_t rays = RAYS_FIRST;
    while (rays > RAYS_LEAST && rays > a->most / 2)
        rays /= 2;
    for (uint32_t round = 0; rays > 0; round++) {
        /* The first half of the first round is what would be found without --accuracy. */
        const uint32_t first = round == 0 ? seed : sampling_seed(seed, 1, 2 * round, 0);
        const uint32_t second = sampling_seed(seed, 1, 2 * round + 1, 0);
        if (!find_light(pipeline, rays, first, err) ||
            !make_mean(pipeline->solution, mean, err))
            return false;
        if (session->hurry)
            break;
        if (!find_light(pipeline, rays, second, err))
            return false;
        if (session->hurry)
            break;
        a->reached = join_halves(pipeline, mean);
        a->rays = 2 * rays;
        rays = more_rays(a, rays);
    }
    session->settings.seed = seed;
    return true;
}

bool pipeline_accurate(Pipeline *pipeline, Error *err)
{
    const Session *session = pipeline->session;
    if (!options_given(&session->options, OPTION_ACCURACY))
        return pipeline_factors(pipeline, err) && pipeline_solve(pipeline, err);
    pipeline->accuracy = (LightAccuracy){
        .asked = session->settings.accuracy, .reached = INFINITY,
        .most = most(session->settings.rays, &session->options, OPTION_RAYS) };
    Mean mean = { 0 };
    const bool done = run_rounds(pipeline, &mean, err);
    if (done && mean.whole) {
        memcpy(pipeline->solution->radiosity, mean.whole_radiosity, mean.count * sizeof(double));
        memcpy(pipeline->solution->irradiance, mean.whole_irradiance,
               mean.count * sizeof(double));
        pipeline->solution->direct = array_free(pipeline->solution->direct); /* of one half */
    }
    array_free(mean.radiosity);
    array_free(mean.irradiance);
    array_free(mean.whole_radiosity);
    array_free(mean.whole_irradiance);
    return done;
}
