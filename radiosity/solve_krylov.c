/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/solve_krylov.c -- conjugate gradients and GMRES: few products with the matrix, however
 * bright the room.
 *
 * Both work in the inner product <u, v> = sum A u v, in which power adds up.
 *
 * Conjugate gradients [hestenes52] need a symmetric system: with y = sqrt(rho) H the equation
 * H = H0 + F (E + rho H) becomes (1 - s F s) y = s (H0 + F E), s = sqrt(rho), and s F s is
 * symmetric in that inner product as far as A_i F_ij = A_j F_ji. What links lack of that, the
 * true residual shows: then the iteration starts anew from it, and the rest shrinks by about the
 * lack each time.
 *
 * GMRES [saad86] takes the system 1 - rho F as it is, and starts anew every few steps to save
 * memory.
 */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"
#include "radiosity/internal.h"
#include "radiosity/solve_internal.h"

/* Rows a thread takes at a time, as in solve_apply. */
static const uint32_t ROW_CHUNK = 256;

/* Directions that GMRES keeps; a radiosity system has few eigenvalues far from 1. */
enum { GMRES_KEPT = 30 };

/* A fresh start that leaves more than this share of the residual gains nothing. */
static const double RESTART_GAIN = 0.5;

/* --- vectors ---------------------------------------------------------------------------------- */

typedef struct {
    const SolveSystem *system;
    const double      *u, *v, *factor;
    double            *out;
} Vectors;

static void dot_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Vectors *x = context;
    const unsigned bands = x->system->bands;
    double *sum = &x->system->chunk_sum[(size_t)(begin / ROW_CHUNK) * bands];
    (void)worker;
    for (unsigned b = 0; b < bands; b++)
        sum[b] = 0;
    for (uint32_t i = begin; i < end; i++)
        for (unsigned b = 0; b < bands; b++) {
            const size_t at = (size_t)i * bands + b;
            sum[b] += x->system->links->area[i] * x->u[at] * x->v[at];
        }
}

/* Vectors shorter than this are not worth starting threads for. */
enum { PARALLEL_ROWS = 1 << 14 };

static void over_rows(const Vectors *x, ParallelBody body)
{
    const uint32_t count = x->system->links->count;
    parallel_for(count, ROW_CHUNK, count < PARALLEL_ROWS ? 1 : x->system->threads, body,
                 (void *)x, NULL, NULL);
}

/* out [bands] = <u, v> per band; chunks in order, so that the sum is the same for any threads. */
static void dot(const SolveSystem *system, const double *u, const double *v, double *out)
{
    const unsigned bands = system->bands;
    over_rows(&(Vectors){ .system = system, .u = u, .v = v }, dot_chunk);
    for (unsigned b = 0; b < bands; b++)
        out[b] = 0;
    const size_t chunks = ((size_t)system->links->count + ROW_CHUNK - 1) / ROW_CHUNK;
    for (size_t k = 0; k < chunks * bands; k++)
        out[k % bands] += system->chunk_sum[k];
}

static void add_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Vectors *x = context;
    const unsigned bands = x->system->bands;
    (void)worker;
    for (uint32_t i = begin; i < end; i++)
        for (unsigned b = 0; b < bands; b++)
            x->out[(size_t)i * bands + b] += x->factor[b] * x->u[(size_t)i * bands + b];
}

/* v += factor u, a factor per band. */
static void add_scaled(const SolveSystem *system, const double *factor, const double *u, double *v)
{
    over_rows(&(Vectors){ .system = system, .factor = factor, .u = u, .out = v }, add_chunk);
}

typedef struct {
    const SolveSystem *system;   /* with nothing from outside */
    const double      *before, *after; /* [values]  factors on either side of F; before NULL: 1 */
    const double      *in;       /* [values] */
    double            *scaled;   /* [values]  before * in */
    double            *out;      /* [values]  in - after F before in */
} Product;

static void product_rows(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Product *p = context;
    const unsigned bands = p->system->bands;
    for (uint32_t i = begin; i < end; i++) {
        double *out = &p->out[(size_t)i * bands];
        solve_gather_row(p->system, p->scaled, i, worker, out);
        for (unsigned b = 0; b < bands; b++) {
            const size_t at = (size_t)i * bands + b;
            out[b] = p->in[at] - p->after[at] * out[b];
        }
    }
    links_leave(p->system->links, begin, end);
}

static void product(Product *p, const double *in, double *out)
{
    const size_t values = (size_t)p->system->links->count * p->system->bands;
    double *scaled = p->scaled;
    for (size_t k = 0; p->before != NULL && k < values; k++)
        scaled[k] = p->before[k] * in[k];
    p->in = in;
    p->out = out;
    p->scaled = p->before != NULL ? scaled : (double *)in;
    parallel_for(p->system->links->count, ROW_CHUNK, p->system->threads, product_rows, p, NULL,
                 NULL);
    p->scaled = scaled;
}

/* --- conjugate gradients ---------------------------------------------------------------------- */

typedef struct {
    SolveSystem  inner;          /* the system with nothing from outside */
    SolveProblem problem;
    double      *root;           /* sqrt(rho) */
    double      *y, *r, *p, *q, *next;
    double      *scalar;         /* [5 * bands]  <r,r> before and after, <p,q>, factor, sums */
} Conjugate;

static bool conjugate_create(Conjugate *c, const SolveSystem *system, Error *err)
{
    static const char what[] = "conjugate gradients";
    const size_t values = (size_t)system->links->count * system->bands;
    *c = (Conjugate){ .inner = *system, .problem = *system->problem };
    c->problem.received = NULL;
    c->inner.problem = &c->problem;
    c->root = array_create(values, sizeof *c->root, what, err);
    c->y = array_create(values, sizeof *c->y, what, err);
    c->r = array_create(values, sizeof *c->r, what, err);
    c->p = array_create(values, sizeof *c->p, what, err);
    c->q = array_create(values, sizeof *c->q, what, err);
    c->next = array_create(values, sizeof *c->next, what, err);
    c->scalar = array_create(5 * (size_t)system->bands, sizeof *c->scalar, what, err);
    for (size_t k = 0; c->root != NULL && k < values; k++)
        c->root[k] = sqrt(system->problem->reflectance[k]);
    return !error_is_set(err);
}

static void conjugate_clear(Conjugate *c)
{
    array_free(c->root);
    array_free(c->y);
    array_free(c->r);
    array_free(c->p);
    array_free(c->q);
    array_free(c->next);
    array_free(c->scalar);
}

/* B = E + s y, the true residual of which becomes r = s (H0 + F B) - y; returns its size. */
static double conjugate_restart(Conjugate *c, const SolveSystem *system, Solution *solution)
{
    const size_t values = (size_t)solution->count * solution->bands;
    const double *e = system->problem->emission;
    for (size_t k = 0; k < values; k++)
        solution->radiosity[k] = e[k] + c->root[k] * c->y[k];
    const double residual = solve_apply(system, solution->radiosity, c->next,
                                        solution->irradiance);
    solution->residual = residual;
    for (size_t k = 0; k < values; k++)
        c->r[k] = c->root[k] * solution->irradiance[k] - c->y[k];
    memcpy(c->p, c->r, values * sizeof *c->p);
    dot(system, c->r, c->r, c->scalar);
    return residual;
}

/* What is missing of B, from r: s r. */
static double conjugate_left(const Conjugate *c, const SolveSystem *system)
{
    const unsigned bands = system->bands;
    double *sum = c->scalar + 4 * (size_t)bands;
    for (unsigned b = 0; b < bands; b++)
        sum[b] = 0;
    for (uint32_t i = 0; i < system->links->count; i++)
        for (unsigned b = 0; b < bands; b++) {
            const size_t at = (size_t)i * bands + b;
            sum[b] += system->links->area[i] * c->root[at] * fabs(c->r[at]);
        }
    return solve_relative(system, sum);
}

/* B = E + s y. */
static void conjugate_show(void *context, double *out)
{
    const Conjugate *c = context;
    const size_t values = (size_t)c->inner.links->count * c->inner.bands;
    for (size_t k = 0; k < values; k++)
        out[k] = c->problem.emission[k] + c->root[k] * c->y[k];
}

/* y of the radiosity to start from; where nothing is reflected any will do. */
static void conjugate_start(Conjugate *c, const SolveSystem *system)
{
    const size_t values = (size_t)system->links->count * system->bands;
    const double *start = system->start;
    for (size_t k = 0; start != NULL && k < values; k++)
        if (c->root[k] > 0)
            c->y[k] = (start[k] - system->problem->emission[k]) / c->root[k];
}

/* One step; <r, r> of before is in scalar[0..bands). */
static void conjugate_step(Conjugate *c, Product *m)
{
    const SolveSystem *system = m->system;
    const unsigned bands = system->bands;
    double *rr = c->scalar, *fresh = rr + bands, *pq = fresh + bands, *factor = pq + bands;
    product(m, c->p, c->q);
    dot(system, c->p, c->q, pq);
    for (unsigned b = 0; b < bands; b++)
        factor[b] = pq[b] > 0 ? rr[b] / pq[b] : 0;
    add_scaled(system, factor, c->p, c->y);
    for (unsigned b = 0; b < bands; b++)
        factor[b] = -factor[b];
    add_scaled(system, factor, c->q, c->r);
    dot(system, c->r, c->r, fresh);
    const size_t values = (size_t)system->links->count * bands;
    for (unsigned b = 0; b < bands; b++) {
        factor[b] = rr[b] > 0 ? fresh[b] / rr[b] : 0;
        rr[b] = fresh[b];
    }
    for (size_t k = 0; k < values; k++)
        c->p[k] = c->r[k] + factor[k % bands] * c->p[k];
}

bool solve_conjugate_gradients(const SolveSystem *system, Solution *solution, Error *err)
{
    Conjugate c;
    const bool made = conjugate_create(&c, system, err);
    if (made) {
        Product m = { .system = &c.inner, .before = c.root, .after = c.root, .scaled = c.next };
        conjugate_start(&c, system);
        double before = INFINITY, left = conjugate_restart(&c, system, solution);
        bool stop = false;
        while (!stop && left > system->tolerance && left < RESTART_GAIN * before &&
               solution->iterations < system->max_iterations) {
            before = left;
            SolveStall stall = { 0 };
            while (!stop && left > system->tolerance &&
                   solution->iterations < system->max_iterations && !solve_stalled(&stall, left)) {
                conjugate_step(&c, &m);
                solution->iterations++;
                left = conjugate_left(&c, system);
                solution->unshot = fmin(left, 1);
                stop = solve_report(system, left, solution->iterations, conjugate_show, &c);
            }
            left = conjugate_restart(&c, system, solution);
        }
        solution->unshot = fmin(left, 1);
    }
    conjugate_clear(&c);
    return made;
}

/* --- GMRES ------------------------------------------------------------------------------------ */

typedef struct {
    SolveSystem  inner;
    SolveProblem problem;
    double      *basis[GMRES_KEPT + 1]; /* [values] each */
    double      *h;              /* [bands][kept + 1][kept]  triangular once rotated */
    double      *cosine, *sine;  /* [bands][kept]  rotations */
    double      *g;              /* [bands][kept + 1]  right side, rotated */
    double      *scalar;         /* [2 * bands] */
    double       whole;          /* sum of areas */
} Gmres;

static bool gmres_create(Gmres *m, const SolveSystem *system, Error *err)
{
    static const char what[] = "GMRES";
    const size_t values = (size_t)system->links->count * system->bands, bands = system->bands;
    *m = (Gmres){ .inner = *system, .problem = *system->problem };
    m->problem.received = NULL;
    m->inner.problem = &m->problem;
    for (int k = 0; k <= GMRES_KEPT; k++)
        m->basis[k] = array_create(values, sizeof(double), what, err);
    m->h = array_create(bands * (GMRES_KEPT + 1) * GMRES_KEPT, sizeof *m->h, what, err);
    m->cosine = array_create(bands * GMRES_KEPT, sizeof *m->cosine, what, err);
    m->sine = array_create(bands * GMRES_KEPT, sizeof *m->sine, what, err);
    m->g = array_create(bands * (GMRES_KEPT + 1), sizeof *m->g, what, err);
    m->scalar = array_create(2 * bands, sizeof *m->scalar, what, err);
    for (uint32_t i = 0; i < system->links->count; i++)
        m->whole += system->links->area[i];
    return !error_is_set(err);
}

static void gmres_clear(Gmres *m)
{
    for (int k = 0; k <= GMRES_KEPT; k++)
        array_free(m->basis[k]);
    array_free(m->h);
    array_free(m->cosine);
    array_free(m->sine);
    array_free(m->g);
    array_free(m->scalar);
}

static double *gmres_h(const Gmres *m, unsigned band, int row, int column)
{
    return &m->h[((size_t)band * (GMRES_KEPT + 1) + (size_t)row) * GMRES_KEPT + (size_t)column];
}

/* v = r / |r| per band; the lengths go to scalar. */
static void gmres_unit(Gmres *m, double *v)
{
    const SolveSystem *system = &m->inner;
    const unsigned bands = system->bands;
    dot(system, v, v, m->scalar);
    for (unsigned b = 0; b < bands; b++) {
        m->scalar[b] = sqrt(m->scalar[b]);
        m->scalar[bands + b] = m->scalar[b] > 0 ? 1 / m->scalar[b] : 0;
    }
    const size_t values = (size_t)system->links->count * bands;
    for (size_t k = 0; k < values; k++)
        v[k] *= m->scalar[bands + k % bands];
}

/* Turns column j so that its last entry vanishes, by the rotations so far and a new one. */
static void gmres_rotate(Gmres *m, unsigned band, int j)
{
    double *c = m->cosine + (size_t)band * GMRES_KEPT, *s = m->sine + (size_t)band * GMRES_KEPT;
    double *g = m->g + (size_t)band * (GMRES_KEPT + 1);
    for (int i = 0; i < j; i++) {
        double *upper = gmres_h(m, band, i, j), *lower = gmres_h(m, band, i + 1, j);
        const double u = *upper, l = *lower;
        *upper = c[i] * u + s[i] * l;
        *lower = c[i] * l - s[i] * u;
    }
    double *upper = gmres_h(m, band, j, j), *lower = gmres_h(m, band, j + 1, j);
    const double length = hypot(*upper, *lower);
    c[j] = length > 0 ? *upper / length : 1;
    s[j] = length > 0 ? *lower / length : 0;
    *upper = length;
    *lower = 0;
    g[j + 1] = -s[j] * g[j];
    g[j] *= c[j];
}

/* Adds direction j + 1; returns a bound of what is missing: sum A |r| <= sqrt(sum A) |r|. */
static double gmres_extend(Gmres *m, Product *k, int j)
{
    const SolveSystem *system = &m->inner;
    const unsigned bands = system->bands;
    double *w = m->basis[j + 1];
    product(k, m->basis[j], w);
    for (int i = 0; i <= j; i++) {
        dot(system, w, m->basis[i], m->scalar);
        for (unsigned b = 0; b < bands; b++) {
            *gmres_h(m, b, i, j) = m->scalar[b];
            m->scalar[b] = -m->scalar[b];
        }
        add_scaled(system, m->scalar, m->basis[i], w);
    }
    gmres_unit(m, w);
    for (unsigned b = 0; b < bands; b++) {
        *gmres_h(m, b, j + 1, j) = m->scalar[b];
        gmres_rotate(m, b, j);
    }
    for (unsigned b = 0; b < bands; b++)
        m->scalar[b] = sqrt(m->whole) * fabs(m->g[(size_t)b * (GMRES_KEPT + 1) + (size_t)j + 1]);
    return solve_relative(system, m->scalar);
}

/* Weights of the `kept` directions out of the right side g of a band, in its place: back
 * substitution. */
static void gmres_weights(const Gmres *m, unsigned band, int kept, double *g)
{
    for (int i = kept - 1; i >= 0; i--) {
        for (int k = i + 1; k < kept; k++)
            g[i] -= *gmres_h(m, band, i, k) * g[k];
        const double pivot = *gmres_h(m, band, i, i);
        g[i] = pivot > 0 ? g[i] / pivot : 0;
    }
}

/* radiosity += what the `kept` directions make of the right side. */
static void gmres_collect(Gmres *m, int kept, double *radiosity)
{
    const unsigned bands = m->inner.bands;
    double *weight = m->g;
    for (unsigned b = 0; b < bands; b++)
        gmres_weights(m, b, kept, weight + (size_t)b * (GMRES_KEPT + 1));
    for (int i = 0; i < kept; i++) {
        for (unsigned b = 0; b < bands; b++)
            m->scalar[b] = weight[(size_t)b * (GMRES_KEPT + 1) + (size_t)i];
        add_scaled(&m->inner, m->scalar, m->basis[i], radiosity);
    }
}

typedef struct {
    const Gmres    *gmres;
    const Solution *solution;
    int             kept;
} GmresShow;

/* What the directions so far make, without spoiling the right side. */
static void gmres_show(void *context, double *out)
{
    const GmresShow *show = context;
    const Gmres *m = show->gmres;
    const unsigned bands = m->inner.bands;
    const size_t values = (size_t)m->inner.links->count * bands;
    memcpy(out, show->solution->radiosity, values * sizeof *out);
    for (unsigned b = 0; b < bands; b++) {
        double g[GMRES_KEPT + 1];
        memcpy(g, m->g + (size_t)b * (GMRES_KEPT + 1), sizeof g);
        gmres_weights(m, b, show->kept, g);
        for (int i = 0; i < show->kept; i++)
            for (size_t k = b; k < values; k += bands)
                out[k] += g[i] * m->basis[i][k];
    }
}

/* One run of steps from the residual in basis[0]; true when the caller wants to stop. */
static bool gmres_cycle(Gmres *m, Product *k, const SolveSystem *system, Solution *solution)
{
    const unsigned bands = m->inner.bands;
    bool stop = false;
    int kept = 0;
    gmres_unit(m, m->basis[0]);
    memset(m->g, 0, bands * (GMRES_KEPT + 1) * sizeof *m->g);
    for (unsigned b = 0; b < bands; b++)
        m->g[(size_t)b * (GMRES_KEPT + 1)] = m->scalar[b];
    for (double left = 1; !stop && kept < GMRES_KEPT && left > m->inner.tolerance &&
                          solution->iterations < m->inner.max_iterations; kept++) {
        left = gmres_extend(m, k, kept);
        solution->iterations++;
        solution->unshot = fmin(left, 1);
        GmresShow show = { m, solution, kept + 1 };
        stop = solve_report(system, left, solution->iterations, gmres_show, &show);
    }
    gmres_collect(m, kept, solution->radiosity);
    return stop;
}

/* Residual E + rho (H0 + F B) - B into basis[0]; returns its size. */
static double gmres_residual(Gmres *m, const SolveSystem *system, Solution *solution)
{
    const size_t values = (size_t)solution->count * solution->bands;
    const double left = solve_apply(system, solution->radiosity, m->basis[0],
                                    solution->irradiance);
    solution->residual = left;
    for (size_t i = 0; i < values; i++)
        m->basis[0][i] -= solution->radiosity[i];
    return left;
}

/* The same of what it starts from, without a pass over the links where its irradiance is known. */
static double gmres_first(Gmres *m, const SolveSystem *system, Solution *solution)
{
    const size_t values = (size_t)solution->count * solution->bands;
    const double *h = system->options->start_irradiance;
    double *sum = m->scalar;
    if (h == NULL || system->start == NULL || system->options->start_drift > 0)
        return gmres_residual(m, system, solution);
    memset(sum, 0, solution->bands * sizeof *sum);
    for (size_t k = 0; k < values; k++) {
        solution->irradiance[k] = h[k];
        m->basis[0][k] = system->problem->emission[k] +
                         system->problem->reflectance[k] * h[k] - solution->radiosity[k];
        sum[k % solution->bands] +=
            system->links->area[k / solution->bands] * fabs(m->basis[0][k]);
    }
    solution->residual = solve_relative(system, sum);
    return solution->residual;
}

bool solve_gmres(const SolveSystem *system, Solution *solution, Error *err)
{
    Gmres m;
    const bool made = gmres_create(&m, system, err);
    if (made) {
        Product k = { .system = &m.inner, .after = system->problem->reflectance };
        solve_start(system, system->source, solution->radiosity);
        double before = INFINITY, left = gmres_first(&m, system, solution);
        bool stop = false;
        while (!stop && left > system->tolerance && left < before &&
               solution->iterations < system->max_iterations) {
            before = left;
            stop = gmres_cycle(&m, &k, system, solution);
            left = gmres_residual(&m, system, solution);
        }
        solution->unshot = fmin(left, 1);
    }
    gmres_clear(&m);
    return made;
}
