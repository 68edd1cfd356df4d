/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/group_factors.c -- the parts put together, and rays added where errors are large. */
#include "radiosity/group_factors.h"

#include <assert.h>
#include <float.h>
#include <string.h>
#include <time.h>

#include "base/array.h"
#include "base/parallel.h"
#include "radiosity/group_internal.h"

/* Most rays of each patch and scrambling. */
enum { RAYS_LARGEST = 1 << 16 };

/* What polygon_factor_area is known to, of the smaller area. */
static const double EXACT_ERROR = 1e-10;

/* Of two directions one may find that all of its rays arrive: its weight stays finite. */
static const double FULL_SHARE = 1e-6;

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* --- sums ------------------------------------------------------------------------------------ */

/* Everything that was found exactly, and which kinds there are. */
static void add_exact(Grouping *g)
{
    const size_t n = g->options->count, sides = g->sides;
    GroupFactors *out = g->out;
    memset(out->pairs, 0, sizeof out->pairs);
    for (size_t i = 0; g->kind != NULL && i < sides; i++)
        for (size_t j = i; j < sides; j++) {
            const GroupKind kind = (GroupKind)g->kind[i * sides + j];
            const size_t a = g->side[i].class, b = g->side[j].class;
            const double value = kind == GROUP_EXACT ? g->value[i * sides + j] : 0;
            out->pairs[kind]++;
            out->kinds[a * n + b] |= (uint8_t)(1u << kind);
            out->kinds[b * n + a] = out->kinds[a * n + b] |= out->kinds[b * n + a];
            /* Within a class both directions count. */
            g->fixed[a * n + b] += a == b ? 2 * value : value;
            if (a != b)
                g->fixed[b * n + a] += value;
        }
    if (g->kind == NULL)
        memset(out->kinds, 1 << GROUP_RAYS, n * n);
}

/* Clipped pairs, scrambling by scrambling, in the place of rays from the lower class to the higher;
 * their least errors go to error[]. */
static void add_clipped(const Grouping *g, double *sum, double *least)
{
    const size_t n = g->options->count;
    for (uint32_t k = 0; k < g->clipped_count; k++) {
        const ClippedPair *pair = &g->clipped[k];
        if (pair->given_up)
            continue;
        const size_t i = g->side[pair->i].class, j = g->side[pair->j].class;
        const size_t a = i < j ? i : j, b = i < j ? j : i;
        const double both = a == b ? 2 : 1;
        for (size_t r = 0; r < GROUP_SCRAMBLES; r++)
            sum[(r * n + a) * n + b] += both * pair->exchange[r];
        least[a * n + b] += both * both * pair->least_error * pair->least_error;
    }
}

/* Mean and standard error of the mean of what the scramblings say. */
static double mean_of(const double *x, double *error)
{
    double mean = 0, squares = 0;
    for (int r = 0; r < GROUP_SCRAMBLES; r++)
        mean += x[r] / GROUP_SCRAMBLES;
    for (int r = 0; r < GROUP_SCRAMBLES; r++)
        squares += (x[r] - mean) * (x[r] - mean);
    *error = sqrt(squares / (GROUP_SCRAMBLES * (GROUP_SCRAMBLES - 1.0)));
    return mean;
}

static void sum_areas(Grouping *g)
{
    const size_t n = g->options->count;
    for (size_t c = 0; c < n; c++) {
        double seen[GROUP_SCRAMBLES];
        for (size_t r = 0; r < GROUP_SCRAMBLES; r++)
            seen[r] = g->seen[r * n + c];
        g->out->area[c] = fmin(mean_of(seen, &g->out->area_error[c]), g->class_area[c]);
    }
}

/* Rays of class a per area: of so many rays, each worth A_a / rays of an A F, a share S / A_a
 * arrives at b, so S has the variance S (A_a - S) / rays, and each direction of a pair the weight
 * rays / (A_a - S). The means of both directions over the rays of all scramblings stand for S. */
static double ray_weight(const Grouping *g, size_t a, size_t b)
{
    const size_t n = g->options->count;
    double s = 0;
    for (size_t r = 0; r < GROUP_SCRAMBLES; r++)
        s += (g->sum[(r * n + a) * n + b] + g->sum[(r * n + b) * n + a]) / (2 * GROUP_SCRAMBLES);
    const double area = g->out->area[a];
    return area > 0 ? (double)g->cast[a] / fmax(area - s, FULL_SHARE * area) : 0;
}

/* A F of a pair of classes: what is exact, and the rest by scramblings. */
static void sum_pair(Grouping *g, const double *clipped, const double *least, size_t a, size_t b)
{
    const size_t n = g->options->count;
    GroupFactors *out = g->out;
    double sample[GROUP_SCRAMBLES], error;
    const double da = ray_weight(g, a, b), db = ray_weight(g, b, a);
    const double wa = da + db > 0 ? da / (da + db) : 0, wb = 1 - wa;
    for (size_t r = 0; r < GROUP_SCRAMBLES; r++)
        sample[r] = clipped[(r * n + a) * n + b] + wa * g->sum[(r * n + a) * n + b] +
                    wb * g->sum[(r * n + b) * n + a];
    const double mean = mean_of(sample, &error);
    const double small = fmin(out->area[a], out->area[b]);
    const bool rays = (out->kinds[a * n + b] >> GROUP_RAYS & 1) != 0;
    /* No better known than by what one ray carries. */
    const double one = rays && da + db > 0 ? 1 / (da + db) : 0;
    const bool exact = (out->kinds[a * n + b] >> GROUP_EXACT & 1) != 0;
    error = sqrt(fmax(error * error, fmax(one * one, least[a * n + b])));
    error = fmax(error, exact ? EXACT_ERROR * small : 0);
    out->exchange[a * n + b] = fmin(fmax(g->fixed[a * n + b] + mean, 0), small);
    out->error[a * n + b] = small > 0 ? error : 0;
    out->exchange[b * n + a] = out->exchange[a * n + b];
    out->error[b * n + a] = out->error[a * n + b];
}

/* What rays say escapes, or what the row lacks to 1: whichever is known better. Where no ray found
 * a way out, there is none. */
static void sum_escape(Grouping *g, size_t c)
{
    const size_t n = g->options->count;
    GroupFactors *out = g->out;
    double away[GROUP_SCRAMBLES], error;
    for (size_t r = 0; r < GROUP_SCRAMBLES; r++)
        away[r] = g->away[r * n + c];
    const double area = out->area[c];
    const double mean = mean_of(away, &error);
    out->escape[c] = out->escape_error[c] = 0;
    if (!(area > 0 && mean > 0))
        return;
    double row = 0, squares = 0;
    for (size_t j = 0; j < n; j++) {
        row += out->exchange[c * n + j];
        squares += out->error[c * n + j] * out->error[c * n + j];
    }
    const bool rest = sqrt(squares) < error;
    out->escape[c] = fmin(fmax((rest ? area - row : mean) / area, 0), 1);
    out->escape_error[c] = (rest ? sqrt(squares) : error) / area;
}

static bool sum_all(Grouping *g, Error *err)
{
    const size_t n = g->options->count;
    double *clipped = array_create(GROUP_SCRAMBLES * n * n, sizeof *clipped, "group factors", err);
    double *least = array_create(n * n, sizeof *least, "group factors", err);
    if (clipped != NULL && least != NULL) {
        add_clipped(g, clipped, least);
        sum_areas(g);
        g->out->reached = 0;
        for (size_t a = 0; a < n; a++)
            for (size_t b = a; b < n; b++)
                sum_pair(g, clipped, least, a, b);
        for (size_t a = 0; a < n; a++)
            sum_escape(g, a);
    }
    array_free(clipped);
    array_free(least);
    return !error_is_set(err);
}

/* --- rounds ----------------------------------------------------------------------------------- */

double group_factor(const GroupFactors *f, uint32_t i, uint32_t j)
{
    assert(i < f->count && j < f->count);
    const double area = f->area[i];
    return area > 0 ? fmin(f->exchange[(size_t)i * f->count + j] / area, 1) : 0;
}

double group_factor_error(const GroupFactors *f, uint32_t i, uint32_t j)
{
    assert(i < f->count && j < f->count);
    const double area = f->area[i];
    if (!(area > 0))
        return 0;
    const double own = f->error[(size_t)i * f->count + j] / area;
    const double factor = group_factor(f, i, j), by_area = factor * f->area_error[i] / area;
    const double rounding = factor * FLT_EPSILON / 2;
    return sqrt(own * own + by_area * by_area + rounding * rounding);
}

/* Takes the most expensive classes off the list until the rest fits; whether any is left. */
static bool cut_to_budget(Grouping *g, uint64_t budget)
{
    const uint32_t n = g->options->count;
    for (;;) {
        uint64_t rays = 0;
        uint32_t most = n;
        for (uint32_t c = 0; c < n; c++)
            if (g->again[c] != 0) {
                rays += g->cast[c];
                most = most == n || g->cast[c] > g->cast[most] ? c : most;
            }
        if (most == n || g->out->rays + rays <= budget)
            return most < n;
        g->again[most] = 0;
    }
}

/* Marks the classes of pairs whose errors are larger than `accuracy` and that rays can help, for
 * twice the rays, as far as the budget goes; whether there are any. */
static bool mark(Grouping *g, double accuracy, uint64_t budget)
{
    const uint32_t n = g->options->count;
    GroupFactors *out = g->out;
    out->reached = 0;
    memset(g->again, 0, n);
    for (uint32_t a = 0; a < n; a++)
        for (uint32_t b = 0; b < n; b++) {
            const double error = group_factor_error(out, a, b);
            out->reached = fmax(out->reached, error);
            if (!(error > accuracy) ||
                (out->kinds[(size_t)a * n + b] >> GROUP_RAYS & 1) == 0)
                continue;
            /* A ray of the smaller class tells more, until it has no more to cast. */
            const bool own = out->area[a] <= out->area[b];
            const uint32_t small = own ? a : b, large = own ? b : a;
            g->again[g->rays[small] < RAYS_LARGEST ? small : large] = 1;
        }
    for (uint32_t c = 0; c < n; c++)
        g->again[c] = g->again[c] != 0 && g->rays[c] < RAYS_LARGEST;
    return cut_to_budget(g, budget);
}

static bool run(Grouping *g, Error *err)
{
    const uint32_t n = g->options->count;
    if (!group_sides_create(g, err) || !group_pairs_find(g, err) || !group_clipped_run(g, err))
        return false;
    add_exact(g);
    for (uint32_t c = 0; c < n; c++) {
        g->rays[c] = GROUP_RAYS_FIRST;
        g->again[c] = 1;
    }
    for (;;) {
        if (!group_rays_run(g, err) || !sum_all(g, err))
            return false;
        if (!mark(g, g->options->accuracy, g->options->most_rays) &&
            !(g->options->trusted > 0 && mark(g, g->options->trusted, g->options->trusted_rays)))
            return true;
        for (uint32_t c = 0; c < n; c++)
            g->rays[c] *= g->again[c] != 0 ? 2 : 1;
    }
}

static bool allocate(Grouping *g, Error *err)
{
    static const char what[] = "group factors";
    const size_t n = g->options->count;
    GroupFactors *out = g->out;
    out->exchange = array_create(n * n, sizeof *out->exchange, what, err);
    out->error = array_create(n * n, sizeof *out->error, what, err);
    out->kinds = array_create(n * n, 1, what, err);
    out->area = array_create(n, sizeof *out->area, what, err);
    out->area_error = array_create(n, sizeof *out->area_error, what, err);
    out->escape = array_create(n, sizeof *out->escape, what, err);
    out->escape_error = array_create(n, sizeof *out->escape_error, what, err);
    g->crowd = array_create(n * n, sizeof *g->crowd, what, err);
    g->fixed = array_create(n * n, sizeof *g->fixed, what, err);
    g->sum = array_create(GROUP_SCRAMBLES * n * n, sizeof *g->sum, what, err);
    g->away = array_create(GROUP_SCRAMBLES * n, sizeof *g->away, what, err);
    g->seen = array_create(GROUP_SCRAMBLES * n, sizeof *g->seen, what, err);
    g->class_area = array_create(n, sizeof *g->class_area, what, err);
    g->rays = array_create(n, sizeof *g->rays, what, err);
    g->cast = array_create(n, sizeof *g->cast, what, err);
    g->again = array_create(n, 1, what, err);
    if (error_is_set(err))
        return false;
    for (uint32_t i = 0; i < g->room->patches->count; i++)
        g->class_area[g->options->patch_class[i]] += g->room->patches->area[i];
    return true;
}

static void clear(Grouping *g)
{
    void *const arrays[] = { g->side, g->side_of, g->kind, g->value, g->between, g->clipped,
                             g->crowd, g->class_area, g->fixed, g->sum, g->away, g->seen, g->rays,
                             g->cast, g->again };
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        array_free(arrays[k]);
}

GroupFactors *group_factors_create(const Room *room, const GroupOptions *options,
                                   const Monitor *monitor, Error *err)
{
    if (error_is_set(err))
        return NULL;
    assert(room != NULL && options != NULL && options->accuracy > 0);
    assert(options->count > 0 && options->count <= GROUP_CLASSES_MOST);
    GroupFactors *out = array_create(1, sizeof *out, "group factors", err);
    if (out == NULL)
        return NULL;
    const double begin = now();
    *out = (GroupFactors){ .count = options->count, .asked = options->accuracy };
    Grouping g = { .room = room, .options = options, .monitor = monitor, .out = out,
                   .threads = parallel_threads(options->threads) };
    if (!allocate(&g, err) || !run(&g, err))
        out = group_factors_destroy(out);
    else
        out->seconds = now() - begin;
    clear(&g);
    return out;
}

GroupFactors *group_factors_destroy(GroupFactors *f)
{
    if (f == NULL)
        return NULL;
    array_free(f->exchange);
    array_free(f->error);
    array_free(f->kinds);
    array_free(f->area);
    array_free(f->area_error);
    array_free(f->escape);
    array_free(f->escape_error);
    return array_free(f);
}
