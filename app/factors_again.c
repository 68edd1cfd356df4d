/* SPDX-License-Identifier: BSD-3-Clause */
/* Form factors between patches cast again by independent scramblings: their standard errors, pair
 * by pair and summed over groups or materials. */
#include "app/factors_again.h"

#include <assert.h>

#include "app/classes.h"
#include "base/array.h"

/* Links as they were cast, before anything was enforced. */
static const Links *raw_links(const Pipeline *pipeline)
{
    return pipeline->raw_links != NULL ? pipeline->raw_links : pipeline->links;
}

/* Half of what --max-memory leaves: for a cast, and for what is taken of it. */
static uint64_t half_left(const Pipeline *pipeline)
{
    const uint64_t limit = pipeline->session->options.max_memory, used = progress_peak_bytes();
    return limit == 0 ? 0 : limit > used + 1 ? (limit - used) / 2 : 1;
}

bool factors_again(const Pipeline *pipeline, FactorsTake take, void *context, Error *err)
{
    const Session *session = pipeline->session;
    const Settings *settings = &session->settings;
    const LinksOptions lo = { .rays = settings->rays, .lamp_rays = settings->lamp_rays,
                              .seed = settings->seed, .threads = settings->threads,
                              .max_bytes = half_left(pipeline) };
    if (session->hurry)
        return error_set(err, ERROR_STOPPED, "stopped before standard errors were known");
    for (uint32_t k = 1; k < LINKS_CASTS; k++) {
        Links *cast = links_cast_again(&pipeline->room, &lo, k, &session->monitor, err);
        if (cast == NULL)
            return false;
        const bool taken = take(context, cast, lo.max_bytes, err);
        links_destroy(cast);
        if (!taken)
            return false;
    }
    return true;
}

/* --- by patch --------------------------------------------------------------------------------- */

static bool take_pairs(void *context, const Links *cast, uint64_t max_bytes, Error *err)
{
    return links_errors_add(context, cast, max_bytes, err);
}

LinksErrors *factors_patch_errors(const Pipeline *pipeline, Error *err)
{
    LinksErrors *errors = links_errors_create(raw_links(pipeline), err);
    if (errors != NULL && !factors_again(pipeline, take_pairs, errors, err))
        errors = links_errors_destroy(errors);
    return errors;
}

/* --- by group or material --------------------------------------------------------------------- */

typedef struct {
    const Classes  *classes;
    const uint32_t *class_of; /* [patches] */
    Spread         *spread;   /* [count * count] */
    double         *factor;   /* [count * count]  of one cast */
    double         *area;     /* [count]  of one cast */
} ClassSpread;

/* The matrix of classes of one cast. */
static bool sum_cast(ClassSpread *s, const Links *cast, Error *err)
{
    const size_t n = s->classes->count;
    LinksScratch scratch;
    if (!links_scratch_create(cast, &scratch, err))
        return false;
    for (size_t k = 0; k < n * n; k++)
        s->factor[k] = 0;
    for (size_t r = 0; r < n; r++)
        s->area[r] = 0;
    for (uint32_t i = 0; i < cast->count; i++) {
        const uint32_t r = s->classes->row[s->class_of[i]];
        if (!(cast->area[i] > 0) || r == PATCH_NONE)
            continue;
        const LinksRow row = links_row(cast, i, &scratch);
        for (uint64_t k = 0; k < row.count; k++) {
            const uint32_t c = s->classes->row[s->class_of[row.source[k]]];
            if (c != PATCH_NONE)
                s->factor[r * n + c] += cast->area[i] * row.form_factor[k];
        }
        s->area[r] += cast->area[i];
        links_leave(cast, i, i + 1);
    }
    for (size_t k = 0; k < n * n; k++)
        s->factor[k] /= s->area[k / n] > 0 ? s->area[k / n] : 1;
    links_scratch_clear(&scratch);
    return true;
}

static bool take_classes(void *context, const Links *cast, uint64_t max_bytes, Error *err)
{
    ClassSpread *s = context;
    const size_t n = s->classes->count;
    (void)max_bytes; /* what this needs is there */
    if (!sum_cast(s, cast, err))
        return false;
    for (size_t k = 0; k < n * n; k++)
        spread_add(&s->spread[k], s->factor[k]);
    return true;
}

bool classes_errors(const Pipeline *pipeline, FactorsBy by, Classes *classes, Error *err)
{
    static const char what[] = "standard errors";
    const size_t n = classes->count;
    assert(by != BY_PATCH && pipeline->groups == NULL && classes->error == NULL);
    if (!pipeline_fits(pipeline, n * n * (sizeof(Spread) + 2 * sizeof(double)), what, err))
        return false;
    ClassSpread s = { .classes = classes,
                      .class_of = by == BY_GROUP ? pipeline->patches->group
                                                 : pipeline->patches->material };
    s.spread = array_create(n * n, sizeof *s.spread, what, err);
    s.factor = array_create(n * n, sizeof *s.factor, what, err);
    s.area = array_create(n, sizeof *s.area, what, err);
    bool good = !error_is_set(err) && sum_cast(&s, raw_links(pipeline), err);
    for (size_t k = 0; good && k < n * n; k++)
        s.spread[k].first = s.factor[k];
    good = good && factors_again(pipeline, take_classes, &s, err);
    for (size_t k = 0; good && k < n * n; k++)
        s.factor[k] = spread_error(&s.spread[k], LINKS_CASTS);
    if (good)
        classes->error = s.factor;
    else
        array_free(s.factor);
    array_free(s.spread);
    array_free(s.area);
    return good;
}
