/* SPDX-License-Identifier: BSD-3-Clause */
/* The two-level solver: few passes over the links.
 *
 * What is missing, r, has been sent out once more and is then mostly smooth, for each patch gathers
 * from many. So what comes of it is found on a small system of patches taken together, and carried
 * back to patches by one more reflection, each by its own rho: the two-grid method for integral
 * equations of the second kind [atkinson97, 6.2]. The corrections d so found are directions of a
 * method of generalised conjugate residuals [eisenstat83], which takes the best sum of them and
 * converges where the small system is poor, too.
 *
 * One pass gives F d, and with it irradiance, in single precision; the residual is formed from both
 * in double. What rounding may have done to F d is bounded and counted as missing (drift); where
 * that is too much for the tolerance, a pass in double makes it exact, and the iteration goes on.
 */
#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/tolerance.h"
#include "radiosity/aggregates.h"
#include "radiosity/four.h"
#include "radiosity/solve_internal.h"

/* Rows a thread takes at a time, as in solve_apply. */
static const uint32_t ROW_CHUNK = 256;

/* Directions that are kept; then it starts anew. */
enum { KEPT = 12 };

/* The small system is solved until a sweep moves less than this share of the first: the rest is no
 * more than what aggregates have wrong anyway. */
static const double COARSE_ENOUGH = 1e-2;
enum { COARSE_SWEEPS = 40 };

/* Share of the tolerance that rounding may use up before a pass in double is worth it. */
static const double DRIFT_SHARE = 0.25;

static const char what[] = "the two-level solver";

typedef struct {
    const SolveSystem *system;
    Aggregates agg;
    unsigned   quads;      /* fours of bands */
    Four      *mean;       /* [quads * aggregates]  rho */
    Four      *right, *z;  /* [quads * aggregates]  of the small system; later what arrives in it */
    Four      *d[KEPT], *h[KEPT]; /* [quads * count]  directions, F times them; NULL: not yet */
    double    *length;     /* [KEPT * bands]  <q, q> of each, q = d - rho h */
    double    *sums;       /* [chunks * (KEPT + 2) * bands] */
    double    *beta;       /* [KEPT * bands] */
    double    *alpha;      /* [bands] */
    double    *residual;   /* [count * bands]  E + rho H - B */
    double    *radiosity, *irradiance; /* the solution's */
    double    *moved;      /* [bands]  power that directions have moved since H was exact */
    double     rounding;   /* largest relative error of a row's sum in single precision */
    unsigned   kept;       /* directions there are */
    bool       bounded;    /* the columns of F are known, and not for a trace's sake alone: that
                              must change nothing */
} TwoLevel;

static size_t chunks_of(const TwoLevel *t)
{
    return ((size_t)t->system->links->count + ROW_CHUNK - 1) / ROW_CHUNK;
}

/* Which of the sums of a chunk. */
static double *sums_of(const TwoLevel *t, size_t chunk, unsigned which)
{
    return &t->sums[(chunk * (KEPT + 2) + which) * t->system->bands];
}

/* sums of the first `count` kinds, over chunks in their order, into those of chunk 0. */
static void join_sums(const TwoLevel *t, unsigned count)
{
    for (size_t c = 1; c < chunks_of(t); c++)
        for (unsigned k = 0; k < count * t->system->bands; k++)
            sums_of(t, 0, 0)[k] += sums_of(t, c, 0)[k];
}

static void clear_sums(const TwoLevel *t, size_t chunk)
{
    memset(sums_of(t, chunk, 0), 0, (KEPT + 2) * (size_t)t->system->bands * sizeof *t->sums);
}

static double read_four(const Four *of, size_t count, uint32_t i, unsigned band)
{
    return (double)of[(band / FOUR) * count + i][band % FOUR];
}

/* --- the small system ------------------------------------------------------------------------- */

/* Sums over patches of A times a value, per aggregate and band, as means. */
static void restrict_to(const TwoLevel *t, const double *value, Four *out)
{
    const unsigned bands = t->system->bands;
    memset(out, 0, (size_t)t->quads * t->agg.count * sizeof *out);
    for (uint32_t i = 0; i < t->system->links->count; i++) {
        const uint32_t n = t->agg.of[i];
        const double weight = t->agg.area[n] > 0 ? t->system->links->area[i] / t->agg.area[n] : 0;
        for (unsigned b = 0; b < bands; b++)
            out[(size_t)(b / FOUR) * t->agg.count + n][b % FOUR] +=
                (float)(weight * value[(size_t)i * bands + b]);
    }
}

/* One row of the small system times z, with four sums as in four_gather. */
static Four coarse_gather(const float *factor, const Four *z, uint32_t count)
{
    Four sum[4] = { { 0 } };
    uint32_t k = 0;
    for (; k + 4 <= count; k += 4)
        for (uint32_t s = 0; s < 4; s++)
            sum[s] += factor[k + s] * z[k + s];
    for (; k < count; k++)
        sum[0] += factor[k] * z[k];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* A sweep of Gauss-Seidel of z = right + mean F z; returns the most that an entry moved. */
static float coarse_sweep(const TwoLevel *t, unsigned quad)
{
    const uint32_t count = t->agg.count;
    const Four *right = &t->right[(size_t)quad * count], *mean = &t->mean[(size_t)quad * count];
    Four *z = &t->z[(size_t)quad * count];
    float most = 0;
    for (uint32_t n = 0; n < count; n++) {
        const float *row = &t->agg.factor[(size_t)n * count];
        const Four others = coarse_gather(row, z, count) - row[n] * z[n];
        const Four now = (right[n] + mean[n] * others) / (1 - mean[n] * row[n]);
        for (int s = 0; s < FOUR; s++)
            most = fmaxf(most, fabsf(now[s] - z[n][s]));
        z[n] = now;
    }
    return most;
}

/* Leaves in `right` what arrives at aggregates after all reflections there. */
static void coarse_solve(const TwoLevel *t)
{
    const uint32_t count = t->agg.count;
    memcpy(t->z, t->right, (size_t)t->quads * count * sizeof *t->z);
    for (unsigned quad = 0; quad < t->quads; quad++) {
        const float first = coarse_sweep(t, quad);
        for (int k = 1; k < COARSE_SWEEPS && coarse_sweep(t, quad) > COARSE_ENOUGH * first; k++)
            ;
        for (uint32_t n = 0; n < count; n++)
            t->right[(size_t)quad * count + n] =
                coarse_gather(&t->agg.factor[(size_t)n * count], &t->z[(size_t)quad * count],
                              count);
    }
}

/* The next direction: what is missing and, of each patch, what it reflects of what comes of it. */
static void find_direction(const TwoLevel *t, Four *d)
{
    const uint32_t count = t->system->links->count;
    const unsigned bands = t->system->bands;
    const double *rho = t->system->problem->reflectance;
    restrict_to(t, t->residual, t->right);
    coarse_solve(t);
    for (uint32_t i = 0; i < count; i++) {
        const bool lit = t->system->links->area[i] > 0; /* nothing arrives where no ray does */
        for (unsigned b = 0; b < bands; b++) {
            const size_t at = (size_t)i * bands + b;
            const double more = lit ? read_four(t->right, t->agg.count, t->agg.of[i], b) : 0;
            d[(b / FOUR) * (size_t)count + i][b % FOUR] =
                (float)(t->residual[at] + rho[at] * more);
        }
    }
}

/* --- passes ----------------------------------------------------------------------------------- */

/* Of the newest direction: h = F d, and <q, q>, <q, r> and <q, q of each kept> of the chunk. */
static void pass_rows(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const TwoLevel *t = context;
    const SolveSystem *system = t->system;
    const size_t count = system->links->count;
    const unsigned bands = system->bands, k = t->kept;
    const size_t chunk = begin / ROW_CHUNK;
    clear_sums(t, chunk);
    for (uint32_t i = begin; i < end; i++) {
        const LinksRow row = links_row(system->links, i, &system->scratch[worker]);
        for (unsigned quad = 0; quad < t->quads; quad++)
            t->h[k][quad * count + i] = four_gather(&row, &t->d[k][quad * count]);
        for (unsigned b = 0; b < bands; b++) {
            const size_t at = (size_t)i * bands + b;
            const double rho = system->problem->reflectance[at];
            const double q = read_four(t->d[k], count, i, b) -
                             rho * read_four(t->h[k], count, i, b);
            const double weighed = system->links->area[i] * q;
            sums_of(t, chunk, 0)[b] += weighed * q;
            sums_of(t, chunk, 1)[b] += weighed * t->residual[at];
            for (unsigned j = 0; j < k; j++)
                sums_of(t, chunk, 2 + j)[b] +=
                    weighed * (read_four(t->d[j], count, i, b) -
                               rho * read_four(t->h[j], count, i, b));
        }
    }
    links_leave(system->links, begin, end);
}

/* Makes the newest direction's q orthogonal to the others, takes the best step along it; sums get
 * what is missing then, and what was moved. */
static void step_rows(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const TwoLevel *t = context;
    const SolveProblem *problem = t->system->problem;
    const size_t count = t->system->links->count;
    const unsigned bands = t->system->bands, k = t->kept;
    const size_t chunk = begin / ROW_CHUNK;
    (void)worker;
    clear_sums(t, chunk);
    for (uint32_t i = begin; i < end; i++)
        for (unsigned b = 0; b < bands; b++) {
            const size_t at = (size_t)i * bands + b, quad = (b / FOUR) * count;
            const double area = t->system->links->area[i];
            double d = read_four(t->d[k], count, i, b), h = read_four(t->h[k], count, i, b);
            double size = fabs(d); /* of what goes into d: what roundings are relative to */
            for (unsigned j = 0; j < k; j++) {
                const double part = t->beta[j * bands + b] * read_four(t->d[j], count, i, b);
                d -= part;
                size += fabs(part);
                h -= t->beta[j * bands + b] * read_four(t->h[j], count, i, b);
            }
            t->d[k][quad + i][b % FOUR] = (float)d;
            t->h[k][quad + i][b % FOUR] = (float)h;
            t->radiosity[at] += t->alpha[b] * d;
            t->irradiance[at] += t->alpha[b] * h;
            t->residual[at] = problem->emission[at] +
                              problem->reflectance[at] * t->irradiance[at] - t->radiosity[at];
            sums_of(t, chunk, 0)[b] += area * fabs(t->residual[at]);
            sums_of(t, chunk, 1)[b] += area * fabs(t->alpha[b]) * size;
        }
}

/* Lengths along the newest direction from its products: q less its parts along the others. */
static void find_step(const TwoLevel *t)
{
    const unsigned bands = t->system->bands;
    for (unsigned b = 0; b < bands; b++) {
        double length = sums_of(t, 0, 0)[b];
        for (unsigned j = 0; j < t->kept; j++) {
            const double along = sums_of(t, 0, 2 + j)[b], other = t->length[j * bands + b];
            t->beta[j * bands + b] = other > 0 ? along / other : 0;
            length -= other > 0 ? along * along / other : 0;
        }
        /* What is left of q may be rounding alone: then it is no direction. */
        const bool real = length > (double)FLT_EPSILON * sums_of(t, 0, 0)[b];
        t->length[t->kept * bands + b] = real ? length : 0;
        t->alpha[b] = real ? sums_of(t, 0, 1)[b] / length : 0;
    }
}

/* --- the iteration ---------------------------------------------------------------------------- */

/* What rounding may have done to irradiance, as power of the band with the most: a bound where the
 * columns of F are known, else an estimate. */
static double drift_of(const TwoLevel *t)
{
    double most = 0;
    for (unsigned b = 0; b < t->system->bands; b++)
        most = fmax(most, t->moved[b]);
    return most * t->rounding * (t->bounded ? t->system->reflected->plain : 1);
}

/* Irradiance of the radiosity as it is, exactly, and what is missing. */
static double look(TwoLevel *t, Solution *solution)
{
    const size_t values = (size_t)solution->count * solution->bands;
    const double left = solve_apply(t->system, t->radiosity, t->residual, t->irradiance);
    for (size_t k = 0; k < values; k++)
        t->residual[k] -= t->radiosity[k];
    memset(t->moved, 0, solution->bands * sizeof *t->moved);
    solution->drift = 0;
    return left;
}

/* The same without a pass, where irradiance is known well enough. */
static double look_first(TwoLevel *t, Solution *solution)
{
    const SolveSystem *system = t->system;
    const SolveOptions *o = system->options;
    const unsigned bands = system->bands;
    if (o->start_irradiance == NULL || system->start == NULL ||
        !(solve_share(system, o->start_drift) <= DRIFT_SHARE * system->tolerance))
        return look(t, solution);
    double *sum = system->chunk_sum;
    memset(sum, 0, bands * sizeof *sum);
    for (size_t k = 0; k < (size_t)solution->count * bands; k++) {
        t->irradiance[k] = system->power[k % bands] > 0 ? o->start_irradiance[k] : 0;
        t->residual[k] = system->problem->emission[k] +
                         system->problem->reflectance[k] * t->irradiance[k] - t->radiosity[k];
        sum[k % bands] += system->links->area[k / bands] * fabs(t->residual[k]);
    }
    solution->drift = o->start_drift;
    return solve_relative(system, sum);
}

/* One direction more, and the best step along it; returns what is missing then. */
static bool advance(TwoLevel *t, double *left, Error *err)
{
    const uint32_t count = t->system->links->count;
    const unsigned threads = t->system->threads, bands = t->system->bands;
    if (t->kept == KEPT)
        t->kept = 0;
    if (t->d[t->kept] == NULL) {
        const size_t fours = (size_t)t->quads * count;
        t->d[t->kept] = array_create(fours, sizeof(Four), what, err);
        t->h[t->kept] = array_create(fours, sizeof(Four), what, err);
        if (error_is_set(err))
            return false;
    }
    find_direction(t, t->d[t->kept]);
    parallel_for(count, ROW_CHUNK, threads, pass_rows, t, NULL, NULL);
    join_sums(t, 2 + t->kept);
    find_step(t);
    parallel_for(count, ROW_CHUNK, threads, step_rows, t, NULL, NULL);
    join_sums(t, 2);
    *left = solve_relative(t->system, sums_of(t, 0, 0));
    for (unsigned b = 0; b < bands; b++)
        t->moved[b] += sums_of(t, 0, 1)[b];
    t->kept++;
    return true;
}

/* Whether a pass in double is due: rounding alone keeps it from the tolerance, hides how far it is,
 * or may do so unseen. */
static bool look_due(const TwoLevel *t, double left, double drift)
{
    const double tolerance = t->system->tolerance;
    const bool there = left + drift <= tolerance;
    if (!(drift > 0))
        return false;
    return there ? !t->bounded && drift_of(t) > 0
                 : left < DRIFT_SHARE * tolerance || drift > left;
}

/* Takes directions until little enough is missing; *left gets how much. */
static bool iterate(TwoLevel *t, Solution *solution, double *left, Error *err)
{
    const SolveSystem *system = t->system;
    SolveStall stall = { 0 };
    double begun = solution->drift;
    for (bool stop = false; !stop;) {
        solution->drift = begun + drift_of(t);
        const double drift = solve_share(system, solution->drift);
        if (look_due(t, *left, drift)) {
            *left = look(t, solution);
            begun = 0;
            t->kept = 0;
        } else if (*left + drift <= system->tolerance ||
                   solution->iterations >= system->max_iterations ||
                   solve_stalled(&stall, *left)) {
            break;
        } else if (!advance(t, left, err)) {
            return false;
        } else {
            solution->iterations++;
            solution->unshot = fmin(*left, 1);
            stop = solve_report(system, *left, solution->iterations, NULL, NULL);
        }
    }
    return true;
}

static bool run(TwoLevel *t, Solution *solution, Error *err)
{
    double left = look_first(t, solution);
    if (!iterate(t, solution, &left, err))
        return false;
    if (left + solve_share(t->system, solution->drift) > t->system->tolerance && drift_of(t) > 0)
        left = look(t, solution);
    solution->residual = left + solve_share(t->system, solution->drift);
    solution->unshot = fmin(solution->residual, 1);
    return true;
}

static bool two_level_create(TwoLevel *t, const SolveSystem *system, Solution *solution,
                             Error *err)
{
    const size_t count = system->links->count, bands = system->bands;
    *t = (TwoLevel){ .system = system, .bounded = system->options->bound,
                     .quads = (system->bands + FOUR - 1) / FOUR,
                     .radiosity = solution->radiosity, .irradiance = solution->irradiance };
    if (!aggregates_create(&t->agg, system, err))
        return false;
    const size_t fours = (size_t)t->quads * t->agg.count;
    t->mean = array_create(fours, sizeof(Four), what, err);
    t->right = array_create(fours, sizeof(Four), what, err);
    t->z = array_create(fours, sizeof(Four), what, err);
    t->length = array_create(KEPT * bands, sizeof *t->length, what, err);
    t->sums = array_create((chunks_of(t) + 1) * (KEPT + 2) * bands, sizeof *t->sums, what, err);
    t->beta = array_create(KEPT * bands, sizeof *t->beta, what, err);
    t->alpha = array_create(bands, sizeof *t->alpha, what, err);
    t->moved = array_create(bands, sizeof *t->moved, what, err);
    t->residual = array_create(count * bands, sizeof *t->residual, what, err);
    uint64_t longest = 0;
    for (uint32_t i = 0; i < count; i++) {
        const uint64_t length = system->links->first[i + 1] - system->links->first[i];
        longest = length > longest ? length : longest;
    }
    t->rounding = four_rounding(longest);
    if (!error_is_set(err))
        restrict_to(t, system->problem->reflectance, t->mean);
    return !error_is_set(err);
}

static void two_level_clear(TwoLevel *t)
{
    aggregates_clear(&t->agg);
    array_free(t->mean);
    array_free(t->right);
    array_free(t->z);
    for (int k = 0; k < KEPT; k++) {
        array_free(t->d[k]);
        array_free(t->h[k]);
    }
    array_free(t->length);
    array_free(t->sums);
    array_free(t->beta);
    array_free(t->alpha);
    array_free(t->moved);
    array_free(t->residual);
}

bool solve_two_level(const SolveSystem *system, Solution *solution, Error *err)
{
    TwoLevel t;
    bool good = two_level_create(&t, system, solution, err);
    if (good) {
        solve_start(system, system->source, solution->radiosity);
        good = run(&t, solution, err);
    }
    two_level_clear(&t);
    return good;
}
