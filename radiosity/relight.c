/* SPDX-License-Identifier: BSD-3-Clause */
/* Relighting. */
#include "radiosity/relight.h"

#include <assert.h>
#include <math.h>
#include <string.h>
#include <time.h>

#include "base/array.h"
#include "base/parallel.h"

/* Bands solved at once: groups times bands. A row of links is read once for all of them, and what
 * it gathers from stays within a cache line or few. */
enum { BANDS_MOST = 24 };

/* Rows that a thread mixes at a time. */
enum { MIX_CHUNK = 1024 };

static const char what[] = "light groups";

/* What the old radiosity makes arrive with the new light from outside. */
static double *start_irradiance(const SolveProblem *problem, const Solution *before,
                                const double *received, Error *err)
{
    const size_t values = (size_t)before->count * before->bands;
    double *h = array_create(values, sizeof *h, "relighting", err);
    for (size_t k = 0; h != NULL && k < values; k++)
        h[k] = before->irradiance[k] - (received != NULL ? received[k] : 0) +
               (problem->received != NULL ? problem->received[k] : 0);
    return h;
}

Solution *relight(const Links *links, const SolveProblem *problem, const Solution *before,
                  const double *received, const SolveOptions *options, const Monitor *monitor,
                  Error *err)
{
    assert(before != NULL && before->count == links->count && before->bands == problem->bands);
    double *h = start_irradiance(problem, before, received, err);
    SolveOptions o = *options;
    o.start = before->radiosity;
    o.start_irradiance = h;
    o.start_drift = before->drift;
    o.reflected = before->reflected;
    o.bound = options->bound || before->reflected != NULL;
    Solution *after = h != NULL ? solve(links, problem, &o, monitor, err) : NULL;
    array_free(h);
    return after;
}

LightGroups *light_groups_destroy(LightGroups *g)
{
    if (g == NULL)
        return NULL;
    array_free(g->radiosity);
    array_free(g->irradiance);
    return array_free(g);
}

/* --- solving ---------------------------------------------------------------------------------- */

/* Some groups beside each other: band b of group k is band k * bands + b. */
typedef struct {
    double *emission, *reflectance, *received;
} Batch;

static void batch_clear(Batch *batch)
{
    array_free(batch->emission);
    array_free(batch->reflectance);
    array_free(batch->received);
}

static void fill(double *wide, const double *narrow, uint32_t count, unsigned bands, uint32_t k,
                 uint32_t groups)
{
    for (uint32_t i = 0; narrow != NULL && i < count; i++)
        memcpy(&wide[((size_t)i * groups + k) * bands], &narrow[(size_t)i * bands],
               bands * sizeof *wide);
}

static bool batch_create(Batch *batch, uint32_t count, unsigned bands, const double *reflectance,
                         const LightGroup *group, uint32_t groups, Error *err)
{
    const size_t values = (size_t)count * bands * groups;
    batch->emission = array_create(values, sizeof(double), what, err);
    batch->reflectance = array_create(values, sizeof(double), what, err);
    batch->received = array_create(values, sizeof(double), what, err);
    for (uint32_t k = 0; k < groups && !error_is_set(err); k++) {
        fill(batch->emission, group[k].emission, count, bands, k, groups);
        fill(batch->reflectance, reflectance, count, bands, k, groups);
        fill(batch->received, group[k].received, count, bands, k, groups);
    }
    return !error_is_set(err);
}

/* One group's share of a batch's values. */
static void take(const double *wide, double *narrow, uint32_t count, unsigned bands, uint32_t k,
                 uint32_t groups)
{
    for (uint32_t i = 0; i < count; i++)
        memcpy(&narrow[(size_t)i * bands], &wide[((size_t)i * groups + k) * bands],
               bands * sizeof *narrow);
}

static bool solve_batch(LightGroups *g, const Links *links, const double *reflectance,
                        const LightGroup *group, uint32_t first, uint32_t groups,
                        const SolveOptions *options, const Monitor *monitor, Error *err)
{
    Batch batch = { 0 };
    Solution *s = NULL;
    if (batch_create(&batch, g->count, g->bands, reflectance, &group[first], groups, err)) {
        const SolveProblem problem = { .bands = g->bands * groups, .emission = batch.emission,
                                       .reflectance = batch.reflectance,
                                       .received = batch.received };
        s = solve(links, &problem, options, monitor, err);
    }
    for (uint32_t k = 0; k < groups && s != NULL; k++) {
        const size_t at = (size_t)(first + k) * g->count * g->bands;
        take(s->radiosity, &g->radiosity[at], g->count, g->bands, k, groups);
        take(s->irradiance, &g->irradiance[at], g->count, g->bands, k, groups);
    }
    if (s != NULL) {
        g->iterations = s->iterations > g->iterations ? s->iterations : g->iterations;
        g->residual = fmax(g->residual, s->residual);
        g->drift = fmax(g->drift, s->drift);
        g->converged = g->converged && s->converged;
        g->seconds += s->seconds;
    }
    if (s != NULL && !s->converged && monitor_stop(monitor))
        error_set(err, ERROR_STOPPED, "stopped while solving for light groups");
    batch_clear(&batch);
    solution_destroy(s);
    return !error_is_set(err);
}

LightGroups *light_groups_solve(const Links *links, unsigned bands, const double *reflectance,
                                const LightGroup *group, uint32_t groups,
                                const SolveOptions *options, const Monitor *monitor, Error *err)
{
    if (error_is_set(err))
        return NULL;
    assert(links != NULL && bands > 0 && (groups == 0 || group != NULL));
    LightGroups *g = array_create(1, sizeof *g, what, err);
    if (g == NULL)
        return NULL;
    *g = (LightGroups){ .count = links->count, .groups = groups, .bands = bands,
                        .converged = true };
    const size_t values = (size_t)groups * links->count * bands;
    g->radiosity = array_create(values, sizeof *g->radiosity, what, err);
    g->irradiance = array_create(values, sizeof *g->irradiance, what, err);
    SolveOptions o = *options;
    o.start = NULL;
    o.trace = NULL;
    const uint32_t batch = bands < BANDS_MOST ? BANDS_MOST / bands : 1;
    for (uint32_t k = 0; k < groups && !error_is_set(err); k += batch)
        solve_batch(g, links, reflectance, group, k, groups - k < batch ? groups - k : batch, &o,
                    monitor, err);
    return error_is_set(err) ? light_groups_destroy(g) : g;
}

/* --- as bytes --------------------------------------------------------------------------------- */

bool light_groups_pack(const LightGroups *groups, void **bytes, size_t *size, Error *err)
{
    const size_t values = (size_t)groups->groups * groups->count * groups->bands * sizeof(double);
    LightGroups  head = *groups;
    head.radiosity = head.irradiance = NULL;
    *size = sizeof head + 2 * values;
    unsigned char *out = array_create(*size, 1, what, err);
    *bytes = out;
    if (out == NULL)
        return false;
    memcpy(out, &head, sizeof head);
    memcpy(out + sizeof head, groups->radiosity, values);
    memcpy(out + sizeof head + values, groups->irradiance, values);
    return true;
}

LightGroups *light_groups_unpack(const void *bytes, size_t size, uint32_t count, Error *err)
{
    LightGroups head;
    assert(bytes != NULL || size == 0);
    if (size < sizeof head)
        return NULL;
    memcpy(&head, bytes, sizeof head);
    const size_t rest = size - sizeof head, each = (size_t)head.count * head.bands;
    if (head.count != count || head.bands < 1 || head.bands > BANDS_MOST ||
        (head.groups > 0) != (rest > 0) || rest % 16 != 0 ||
        (each > 0 && (rest / 16 % each != 0 || rest / 16 / each != head.groups)))
        return NULL;
    LightGroups *g = array_create(1, sizeof *g, what, err);
    if (g == NULL)
        return NULL;
    *g = head;
    g->radiosity = array_create(rest / 16, sizeof(double), what, err);
    g->irradiance = array_create(rest / 16, sizeof(double), what, err);
    if (error_is_set(err))
        return light_groups_destroy(g);
    memcpy(g->radiosity, (const unsigned char *)bytes + sizeof head, rest / 2);
    memcpy(g->irradiance, (const unsigned char *)bytes + sizeof head + rest / 2, rest / 2);
    return g;
}

/* --- mixing ----------------------------------------------------------------------------------- */

typedef struct {
    const LightGroups *groups;
    const double      *dimmer;
    Solution          *out;
} Mix;

static void mix_rows(const LightGroups *g, const double *from, const double *dimmer, uint32_t begin,
                     uint32_t end, double *out)
{
    const size_t stride = (size_t)g->count * g->bands;
    const size_t first = (size_t)begin * g->bands, last = (size_t)end * g->bands;
    memset(&out[first], 0, (last - first) * sizeof *out);
    for (uint32_t k = 0; k < g->groups; k++)
        for (uint32_t i = begin; i < end; i++)
            for (unsigned b = 0; b < g->bands; b++) {
                const size_t at = (size_t)i * g->bands + b;
                out[at] += dimmer[(size_t)k * g->bands + b] * from[k * stride + at];
            }
}

static void mix_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Mix *m = context;
    (void)worker;
    mix_rows(m->groups, m->groups->radiosity, m->dimmer, begin, end, m->out->radiosity);
    mix_rows(m->groups, m->groups->irradiance, m->dimmer, begin, end, m->out->irradiance);
}

/* Each group's own error is within residual / (1 - q) of its own power, so their sum is, too. */
static double mix_bound(const LightGroups *groups, const Solution *out)
{
    if (out->reflected == NULL)
        return NAN;
    if (!isfinite(groups->drift)) /* solved for by other links: see solve.h */
        return INFINITY;
    return out->reflected->most < 1 ? groups->residual / (1 - out->reflected->most) : INFINITY;
}

void light_groups_mix(const LightGroups *groups, const double *dimmer, unsigned threads,
                      Solution *out)
{
    assert(groups != NULL && out != NULL && dimmer != NULL);
    assert(out->count == groups->count && out->bands == groups->bands);
    Mix mix = { groups, dimmer, out };
    struct timespec begin, end;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    parallel_for(groups->count, MIX_CHUNK, threads, mix_chunk, &mix, NULL, NULL);
    clock_gettime(CLOCK_MONOTONIC, &end);
    out->iterations = groups->iterations;
    out->residual = out->unshot = groups->residual;
    /* Dimmers scale what is known of each group's drift; few care, so it is not kept apart. */
    out->drift = groups->drift > 0 ? INFINITY : 0;
    out->error_bound = mix_bound(groups, out);
    out->converged = groups->converged;
    out->seconds = (double)(end.tv_sec - begin.tv_sec) +
                   1e-9 * (double)(end.tv_nsec - begin.tv_nsec);
}
