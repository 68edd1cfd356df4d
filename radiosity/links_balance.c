/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links_balance.c -- scales a symmetric matrix until its rows sum to the patches' areas.
 *
 * Wanted is S'_ij = S_ij exp(v_ij (x_i + x_j)) whose row, together with what escapes from it,
 * e_i exp(x_i), sums to A_i: of all symmetric matrices with such rows and the same zeros, the one
 * nearest to S when entry ij is uncertain by v_ij S_ij (the relative entropy's minimum;
 * [sinkhorn67] for v = 1 and e = 0). v is 1, and less between a lamp and another patch: such pairs
 * were sampled by visibility rays and must not take on the noise of the rest. Escape was counted by
 * the same rays as the rest, so it gives way too; were it fixed, two walls that see each other and
 * the sky only could not be balanced, because both sums are given and differ by chance.
 * x minimises a convex function with gradient (row sums - A) and Hessian D + M, M_ij = v_ij S'_ij,
 * D the row sums of M and e exp(x). Far off, Sinkhorn's fixed point steps; near, Newton steps by
 * preconditioned conjugate gradients [knight13]. */
#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"
#include "radiosity/internal.h"

enum { BALANCE_CHUNK = 512 };

/* Rows are stored in float in the end, each entry rounded by up to 2^-24 of itself: half of that is
 * as far as it pays to go. */
static const double BALANCE_GOAL = 0x1p-25;

/* Variance of a pair with a lamp, relative to what counting rays would give: visibility rays leave
 * the variation of the geometry term within the pair, a tenth and less in the standard deviation,
 * where counted rays have that of rare events, 1 and more. */
static const double LAMP_VARIANCE = 1.0 / 64;

/* Newton's region: row sums off by less than this. Else, or after a failed step, Sinkhorn. */
static const double NEWTON_BELOW = 0.1;

/* No step multiplies an entry by more than e^2. */
static const double LONGEST_STEP = 1;

/* Curvature, relative to D's, that is nothing but what rounding leaves of sums over 10^4 terms. */
static const double ROUNDED_TO_ZERO = 1e4 * DBL_EPSILON;

enum { STEPS_MAX = 100, GRADIENT_STEPS_MAX = 200 };

/* Steps without a gain of a tenth after which rows that no scaling can balance are given up. */
enum { PATIENCE = 8 };
static const double GAIN = 0.9;

/* A row is stuck when it is off by this share of what the worst is; the escape it then gets is
 * about as much as chance leaves of a row's visible area. */
static const double STUCK = 1e-3, WAY_OUT = 1.0 / 64;

/* A conjugate gradient solve goes on until its residual is this share of the first, between these
 * two: as far as Newton's step, whose own error is about the square of the rows', can make use of,
 * and no further than the goal. */
static const double GRADIENT_GOAL_MIN = 0.01, GRADIENT_GOAL_MAX = 0.1;

/* What a patch contributes to the sums of its partners: by the kind of the pair. */
typedef struct {
    double plain, thin;
} Term;

typedef struct {
    const Links *pairs;      /* form_factor holds S */
    const bool  *alone;      /* [count]  the row is empty and left as it is */
    unsigned threads;
    uint32_t count;
    uint32_t opened;         /* rows given a way out */
    Term   *term[2];         /* [count]  as seen by a row that is no lamp, and by a lamp's */
    double *plain, *thin;    /* [count]  exp(x), exp(v x) */
    double *x;               /* [count] */
    double *sky;             /* [count]  e exp(x) */
    double *sum_plain, *sum_thin; /* [count]  results of multiply */
    double *weight;          /* [count]  D */
    double *gradient;        /* [count]  A - row sums, then CG's residual */
    double *step, *direction, *image; /* [count] */
} Balance;

static void multiply_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Balance *b = context;
    const Links *pairs = b->pairs;
    (void)worker;
    for (uint32_t i = begin; i < end; i++) {
        const Term *term = b->term[pairs->lamp[i]];
        double plain = 0, thin = 0;
        for (uint64_t k = pairs->first[i]; k < pairs->first[i + 1]; k++) {
            const Term from = term[pairs->source[k]];
            plain += pairs->form_factor[k] * from.plain;
            thin += pairs->form_factor[k] * from.thin;
        }
        b->sum_plain[i] = plain * b->plain[i];
        b->sum_thin[i] = thin * b->thin[i];
    }
    links_leave(pairs, begin, end);
}

/* Row sums of S' with each column scaled by `by` (NULL: 1), pairs of the two kinds apart. */
static void multiply(Balance *b, const double *by)
{
    for (uint32_t j = 0; j < b->count; j++) {
        const double scale = by != NULL ? by[j] : 1;
        const unsigned own = b->pairs->lamp[j];
        b->term[own][j] = (Term){ .plain = b->plain[j] * scale };
        b->term[1 - own][j] = (Term){ .thin = b->thin[j] * scale };
    }
    parallel_for(b->count, BALANCE_CHUNK, b->threads, multiply_chunk, b, NULL, NULL);
}

/* How far rows are from their sums: the greatest error, and the sum of all, as shares of area. */
typedef struct {
    double worst, sum;
} RowError;

/* Row sums at x: fills gradient, sky and weight. */
static RowError measure(Balance *b)
{
    RowError error = { 0 };
    const Links *pairs = b->pairs;
    for (uint32_t i = 0; i < b->count; i++) {
        b->plain[i] = exp(b->x[i]);
        b->thin[i] = exp(LAMP_VARIANCE * b->x[i]);
        b->sky[i] = pairs->area[i] * pairs->escape[i] * b->plain[i];
    }
    multiply(b, NULL);
    for (uint32_t i = 0; i < b->count; i++) {
        b->weight[i] = b->sum_plain[i] + LAMP_VARIANCE * b->sum_thin[i] + b->sky[i];
        b->gradient[i] = 0;
        if (b->alone[i])
            continue;
        b->gradient[i] = pairs->area[i] - b->sum_plain[i] - b->sum_thin[i] - b->sky[i];
        error.worst = fmax(error.worst, fabs(b->gradient[i]) / pairs->area[i]);
        error.sum += fabs(b->gradient[i]);
    }
    return error;
}

/* Half of what would set the row right alone, because its partners do as much; all of the sky's. */
static void sinkhorn_step(Balance *b)
{
    for (uint32_t i = 0; i < b->count; i++) {
        const double area = b->pairs->area[i], sum = area - b->gradient[i];
        b->step[i] = 0;
        if (!b->alone[i] && sum > 0)
            b->step[i] = log(area / sum) * sum / (2 * b->weight[i] - b->sky[i]);
    }
}

static double dot(const Balance *b, const double *p, const double *q)
{
    double sum = 0;
    for (uint32_t i = 0; i < b->count; i++)
        sum += p[i] * q[i];
    return sum;
}

/* dot(p, p / weight), and p / weight into q. */
static double precondition(const Balance *b, const double *p, double *q)
{
    for (uint32_t i = 0; i < b->count; i++)
        q[i] = !b->alone[i] && b->weight[i] > 0 ? p[i] / b->weight[i] : 0;
    return dot(b, p, q);
}

/* image = (D + M) direction; returns direction . D direction. */
static double hessian_product(Balance *b)
{
    double scale = 0;
    multiply(b, b->direction);
    for (uint32_t i = 0; i < b->count; i++) {
        const double own = b->weight[i] * b->direction[i];
        b->image[i] = own + b->sum_plain[i] + LAMP_VARIANCE * b->sum_thin[i];
        scale += own * b->direction[i];
    }
    return scale;
}

/* step = (D + M)^-1 gradient, preconditioned by D, for rows off by `error`. Uses up the
 * gradient. */
static void newton_step(Balance *b, double error)
{
    const double enough = fmax(error, BALANCE_GOAL / (2 * error));
    const double share = fmin(fmax(enough, GRADIENT_GOAL_MIN), GRADIENT_GOAL_MAX);
    for (uint32_t i = 0; i < b->count; i++)
        b->step[i] = 0;
    double rho = precondition(b, b->gradient, b->direction);
    const double goal = share * share * rho;
    for (int k = 0; k < GRADIENT_STEPS_MAX && rho > goal; k++) {
        const double scale = hessian_product(b);
        const double curvature = dot(b, b->direction, b->image);
        if (!(curvature > ROUNDED_TO_ZERO * scale))
            return; /* along the null space of two groups that see only each other */
        const double alpha = rho / curvature;
        for (uint32_t i = 0; i < b->count; i++) {
            b->step[i] += alpha * b->direction[i];
            b->gradient[i] -= alpha * b->image[i];
        }
        const double old = rho;
        rho = precondition(b, b->gradient, b->image);
        for (uint32_t i = 0; i < b->count; i++)
            b->direction[i] = b->image[i] + rho / old * b->direction[i];
    }
}

/* Each entry of its own: rows that run away for want of a balance must not hold up the others. */
static void take_step(Balance *b)
{
    for (uint32_t i = 0; i < b->count; i++)
        b->x[i] += fmin(fmax(b->step[i], -LONGEST_STEP), LONGEST_STEP);
}

/* Two groups of patches that see only each other have no balance when their areas differ by the
 * chance of what is hidden. Rows still far off are given a small way out, which adapts like all
 * escape: light that no scaling can place then leaves the scene, where it is counted. */
static uint32_t open_rows(Balance *b, double worst)
{
    uint32_t opened = 0;
    for (uint32_t i = 0; i < b->count; i++)
        if (!b->alone[i] && b->pairs->escape[i] < WAY_OUT &&
            fabs(b->gradient[i]) > STUCK * worst * b->pairs->area[i]) {
            b->pairs->escape[i] = WAY_OUT;
            opened++;
        }
    return opened;
}

/* Keeps the best x seen, and tells when there is no more to be gained. */
typedef struct {
    double *x;
    double  sum, worst, milestone;
    int     patience;
} BestRows;

static bool keep_best(const Balance *b, RowError error, BestRows *best)
{
    if (error.sum < best->sum) {
        best->sum = error.sum;
        best->worst = error.worst;
        memcpy(best->x, b->x, b->count * sizeof *best->x);
    }
    if (error.sum < GAIN * best->milestone) {
        best->milestone = error.sum;
        best->patience = PATIENCE;
    }
    return best->patience-- > 0;
}

static bool iterate(Balance *b, BestRows *best, const Monitor *monitor)
{
    RowError error = measure(b);
    double before = INFINITY;
    bool may_open = true;
    for (int k = 0;; k++) {
        const bool gaining = keep_best(b, error, best) && k < STEPS_MAX;
        if (error.worst <= BALANCE_GOAL)
            return true;
        if (monitor_stop(monitor))
            return false;
        if (!gaining) {
            if (!may_open)
                return true;
            memcpy(b->x, best->x, b->count * sizeof *b->x);
            b->opened = open_rows(b, measure(b).worst);
            *best = (BestRows){ .x = best->x, .sum = INFINITY, .milestone = INFINITY };
            may_open = false;
            before = INFINITY;
            k = 0;
            error = measure(b);
        }
        if (error.worst < NEWTON_BELOW && error.sum < before)
            newton_step(b, error.worst);
        else
            sinkhorn_step(b);
        take_step(b);
        before = error.sum;
        error = measure(b);
    }
}

static void scale_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Balance *b = context;
    const Links *pairs = b->pairs;
    (void)worker;
    for (uint32_t i = begin; i < end; i++)
        for (uint64_t k = pairs->first[i]; k < pairs->first[i + 1]; k++) {
            const uint32_t j = pairs->source[k];
            const bool same = pairs->lamp[i] == pairs->lamp[j];
            const double factor = same ? b->plain[i] * b->plain[j] : b->thin[i] * b->thin[j];
            pairs->form_factor[k] =
                (float)fmin(pairs->form_factor[k] * factor / pairs->area[i], 1);
        }
    links_leave(pairs, begin, end);
}

static bool balance_init(Balance *b, Error *err)
{
    double **const arrays[] = { &b->plain, &b->thin, &b->x, &b->sky, &b->sum_plain, &b->sum_thin,
                                &b->weight, &b->gradient, &b->step, &b->direction, &b->image };
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        *arrays[k] = array_create(b->count, sizeof(double), "the closure", err);
    b->term[0] = array_create(b->count, sizeof *b->term[0], "the closure", err);
    b->term[1] = array_create(b->count, sizeof *b->term[1], "the closure", err);
    return !error_is_set(err);
}

static void balance_clear(Balance *b)
{
    double *const arrays[] = { b->plain, b->thin, b->x, b->sky, b->sum_plain, b->sum_thin,
                               b->weight, b->gradient, b->step, b->direction, b->image };
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        array_free(arrays[k]);
    array_free(b->term[0]);
    array_free(b->term[1]);
}

bool links_balance(Links *pairs, const bool *alone, unsigned threads, const Monitor *monitor,
                   BalanceReport *report, Error *err)
{
    assert(pairs != NULL && pairs->lamp != NULL && alone != NULL);
    Balance b = { .pairs = pairs, .alone = alone, .threads = threads, .count = pairs->count };
    BestRows best = { .sum = INFINITY, .milestone = INFINITY };
    best.x = array_create(pairs->count, sizeof *best.x, "the closure", err);
    bool done = best.x != NULL && balance_init(&b, err);
    *report = (BalanceReport){ 0 };
    if (done) {
        done = iterate(&b, &best, monitor) ||
               error_set(err, ERROR_STOPPED, "stopped while closing form factors");
        for (uint32_t i = 0; i < b.count; i++) {
            b.plain[i] = exp(best.x[i]);
            b.thin[i] = exp(LAMP_VARIANCE * best.x[i]);
            pairs->escape[i] = (float)fmin(pairs->escape[i] * b.plain[i], 1);
        }
        parallel_for(b.count, BALANCE_CHUNK, threads, scale_chunk, &b, NULL, NULL);
        *report = (BalanceReport){ .missed = best.worst, .opened = b.opened };
    }
    balance_clear(&b);
    array_free(best.x);
    return done;
}
