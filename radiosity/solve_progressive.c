/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/solve_progressive.c -- progressive refinement [cohen88], which is Southwell's
 * relaxation [gortler94]: the patch with the greatest unshot power sends it to all that see it,
 * until little is left. Overshooting, and starts that were too bright, leave unshot light below 0,
 * which is sent like any other. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "radiosity/internal.h"

/* Shots between two looks at the clock and the monitor. */
static const uint32_t SHOTS_PER_REPORT = 256;

/* All that shooting keeps: B = E + rho H0 + rho F (B - unshot) holds after each shot, so the
 * residual of B is rho F unshot, and its sum is at most weight . |unshot|. */
typedef struct {
    const SolveSystem *system;
    LinkColumns        columns;
    double            *radiosity;    /* [count * bands]  the solution's */
    double            *unshot;       /* [count * bands] */
    double            *weight;       /* [count * bands]  sum_i A_i rho_i F_ij */
    double            *residual;     /* [bands]  weight . |unshot| */
    double            *left;         /* [bands]  sum of A unshot */
    double            *size;         /* [bands]  sum of A |unshot| */
    double            *ambient;      /* [bands]  mean irradiance in the end for each of left */
    double            *sent;         /* [bands]  a shot */
    double            *key;          /* [count]  A_i sum over bands of |unshot_i| */
    uint32_t          *best;         /* [2 * leaves]  tournament: index of the greatest key below */
    uint32_t           leaves;       /* power of two >= count */
} Shooting;

/* --- the tournament --------------------------------------------------------------------------- */

/* Equal keys: the lower index wins, so the order does not depend on history. */
static uint32_t better(const Shooting *s, uint32_t a, uint32_t b)
{
    if (a == PATCH_NONE || b == PATCH_NONE)
        return a == PATCH_NONE ? b : a;
    return s->key[b] > s->key[a] || (s->key[b] == s->key[a] && b < a) ? b : a;
}

static void tournament_fill(Shooting *s)
{
    for (uint32_t i = 0; i < s->leaves; i++)
        s->best[s->leaves + i] = i < s->system->links->count ? i : PATCH_NONE;
    for (uint32_t node = s->leaves - 1; node > 0; node--)
        s->best[node] = better(s, s->best[2 * node], s->best[2 * node + 1]);
}

static void tournament_update(Shooting *s, uint32_t patch)
{
    for (uint32_t node = (s->leaves + patch) / 2; node > 0; node /= 2) {
        const uint32_t old = s->best[node];
        s->best[node] = better(s, s->best[2 * node], s->best[2 * node + 1]);
        /* Another patch won here before and still does: nothing changes further up. */
        if (old != patch && s->best[node] == old)
            return;
    }
}

/* --- shooting --------------------------------------------------------------------------------- */

static void set_key(Shooting *s, uint32_t patch)
{
    double sum = 0;
    for (unsigned b = 0; b < s->system->bands; b++)
        sum += fabs(s->unshot[(size_t)patch * s->system->bands + b]);
    s->key[patch] = s->system->links->area[patch] * sum;
}

/* Sums that shots change a little each, formed anew so that rounding does not pile up. */
static void sum_anew(Shooting *s)
{
    const unsigned bands = s->system->bands;
    for (unsigned b = 0; b < bands; b++)
        s->residual[b] = s->left[b] = s->size[b] = 0;
    for (uint32_t i = 0; i < s->system->links->count; i++)
        for (unsigned b = 0; b < bands; b++) {
            const size_t at = (size_t)i * bands + b;
            s->residual[b] += s->weight[at] * fabs(s->unshot[at]);
            s->left[b] += s->system->links->area[i] * s->unshot[at];
            s->size[b] += s->system->links->area[i] * fabs(s->unshot[at]);
        }
}

static void fill_weights(Shooting *s)
{
    const Links *links = s->system->links;
    const unsigned bands = s->system->bands;
    for (uint32_t i = 0; i < links->count; i++) {
        const LinksRow row = links_row(links, i, &s->system->scratch[0]);
        for (uint64_t k = 0; k < row.count; k++)
            for (unsigned b = 0; b < bands; b++)
                s->weight[(size_t)row.source[k] * bands + b] +=
                    links->area[i] * row.form_factor[k] *
                    s->system->problem->reflectance[(size_t)i * bands + b];
        links_pass(links, i);
    }
}

/* Adds `gain` to what a patch has not shot in band b, and keeps the sums. */
static void add_unshot(Shooting *s, uint32_t patch, unsigned b, double gain)
{
    const size_t at = (size_t)patch * s->system->bands + b;
    const double area = s->system->links->area[patch];
    const double before = fabs(s->unshot[at]);
    s->unshot[at] += gain;
    s->residual[b] += s->weight[at] * (fabs(s->unshot[at]) - before);
    s->left[b] += area * gain;
    s->size[b] += area * (fabs(s->unshot[at]) - before);
}

/* A patch without visible area stays as it is. */
static void receive(Shooting *s, uint32_t patch, unsigned b, double gain)
{
    s->radiosity[(size_t)patch * s->system->bands + b] += gain;
    add_unshot(s, patch, b, gain);
}

/* With overshooting, what will come back to the shooter is sent at once: the ambient estimate of it
 * [feda92]. It is owed from then on. */
static void take_shot(Shooting *s, uint32_t shooter)
{
    const unsigned bands = s->system->bands;
    const double *reflectance = s->system->problem->reflectance;
    for (unsigned b = 0; b < bands; b++) {
        const size_t at = (size_t)shooter * bands + b;
        s->sent[b] = s->unshot[at];
        if (s->system->options->overshoot && s->sent[b] > 0 && s->left[b] > 0)
            s->sent[b] += reflectance[at] * s->ambient[b] * s->left[b];
        add_unshot(s, shooter, b, -s->sent[b]);
    }
}

static void shoot(Shooting *s, uint32_t shooter)
{
    const unsigned bands = s->system->bands;
    const double *reflectance = s->system->problem->reflectance;
    const double *sent = s->sent;
    take_shot(s, shooter);
    set_key(s, shooter);
    tournament_update(s, shooter);
    for (uint64_t k = s->columns.first[shooter]; k < s->columns.first[shooter + 1]; k++) {
        const uint32_t i = s->columns.receiver[k];
        for (unsigned b = 0; b < bands; b++)
            receive(s, i, b, reflectance[(size_t)i * bands + b] * s->columns.form_factor[k] *
                                 sent[b]);
        set_key(s, i);
        tournament_update(s, i);
    }
    link_columns_leave(&s->columns, shooter);
}

/* Light not yet shot will be spread over the whole room in the end: its mean irradiance
 * R sum A unshot / sum A, with R = 1 + rho + rho^2 ... for mean reflectance rho [cohen88]. What
 * escapes is taken off each time round, which the source leaves out. */
static void find_ambient(Shooting *s)
{
    const Links *links = s->system->links;
    const unsigned bands = s->system->bands;
    const double *reflectance = s->system->problem->reflectance;
    double area = 0, stays = 0;
    for (uint32_t i = 0; i < links->count; i++) {
        area += links->area[i];
        stays += links->area[i] * (1 - links->escape[i]);
    }
    for (unsigned b = 0; b < bands && area > 0; b++) {
        double reflected = 0;
        for (uint32_t i = 0; i < links->count; i++)
            reflected += links->area[i] * reflectance[(size_t)i * bands + b];
        const double loop = (stays / area) * (reflected / area);
        s->ambient[b] = (stays / area) / area / (1 - loop);
    }
}

/* The solution so far with the ambient estimate, unless that is switched off. */
static void show_ambient(void *context, double *out)
{
    const Shooting *s = context;
    const Links *links = s->system->links;
    const unsigned bands = s->system->bands;
    const double *reflectance = s->system->problem->reflectance;
    for (size_t k = 0; k < (size_t)links->count * bands; k++) {
        const bool gets = !s->system->options->no_ambient && links->area[k / bands] > 0;
        const double more = reflectance[k] * s->ambient[k % bands] * s->left[k % bands];
        out[k] = s->radiosity[k] + (gets ? more : 0);
    }
}

/* All columns; where the links lie in a file, so do these. */
static bool make_columns(Shooting *s, Error *err)
{
    const Links *links = s->system->links;
    uint64_t *total = links_column_totals(links, err);
    const bool made = total != NULL && link_columns_create(links, total, 0, links->count, true,
                                                           &s->columns, err);
    array_free(total);
    return made;
}

/* A start that was given counts as shot: what it lacks of the solution, or has too much, is
 * unshot. */
static void shooting_start(Shooting *s)
{
    const SolveSystem *system = s->system;
    const size_t values = (size_t)system->links->count * system->bands;
    const double *start = system->start;
    memcpy(s->radiosity, system->source, values * sizeof *s->radiosity);
    memcpy(s->unshot, system->source, values * sizeof *s->unshot);
    if (start == NULL)
        return;
    solve_apply(system, start, s->radiosity, NULL);
    for (size_t k = 0; k < values; k++)
        s->unshot[k] = s->radiosity[k] - start[k];
}

static bool shooting_init(Shooting *s, const SolveSystem *system, Solution *solution, Error *err)
{
    const size_t count = solution->count, values = count * solution->bands;
    *s = (Shooting){ .system = system, .radiosity = solution->radiosity, .leaves = 1 };
    while (s->leaves < count)
        s->leaves *= 2;
    s->unshot = array_create(values, sizeof *s->unshot, "unshot radiosity", err);
    s->weight = array_create(values, sizeof *s->weight, "weights of unshot radiosity", err);
    s->residual = array_create(solution->bands, sizeof *s->residual, "sums", err);
    s->left = array_create(solution->bands, sizeof *s->left, "sums", err);
    s->size = array_create(solution->bands, sizeof *s->size, "sums", err);
    s->ambient = array_create(solution->bands, sizeof *s->ambient, "sums", err);
    s->sent = array_create(solution->bands, sizeof *s->sent, "a shot", err);
    s->key = array_create(count, sizeof *s->key, "unshot power", err);
    s->best = array_create(2 * (size_t)s->leaves, sizeof *s->best, "a tournament", err);
    if (!make_columns(s, err) || error_is_set(err))
        return false;
    shooting_start(s);
    fill_weights(s);
    find_ambient(s);
    sum_anew(s);
    for (uint32_t i = 0; i < count; i++)
        set_key(s, i);
    tournament_fill(s);
    return true;
}

static void shooting_clear(Shooting *s)
{
    link_columns_clear(&s->columns);
    array_free(s->unshot);
    array_free(s->weight);
    array_free(s->residual);
    array_free(s->left);
    array_free(s->size);
    array_free(s->ambient);
    array_free(s->sent);
    array_free(s->key);
    array_free(s->best);
}

/* Whether so little is left that shooting may end. */
static bool shot_enough(Shooting *s)
{
    if (solve_relative(s->system, s->residual) > s->system->tolerance)
        return false;
    sum_anew(s);
    return solve_relative(s->system, s->residual) <= s->system->tolerance;
}

/* Shoots until little is left, returning true, or something ends it early. */
static bool run_shots(Shooting *s, Solution *solution)
{
    const SolveSystem *system = s->system;
    const uint64_t links = system->links->first[solution->count];
    SolveStall stall = { 0 };
    uint64_t read = 0;
    while (!shot_enough(s)) {
        const uint32_t shooter = s->best[1];
        if (solution->iterations % solution->count == 0) {
            sum_anew(s);
            if (solve_stalled(&stall, solve_relative(system, s->residual)))
                return false;
        }
        if (solution->iterations >= system->max_iterations || !(s->key[shooter] > 0))
            return false;
        solution->unshot = fmin(solve_relative(system, s->size), 1);
        if (solution->iterations % SHOTS_PER_REPORT == 0 &&
            solve_report(system, solve_relative(system, s->residual),
                         links > 0 ? (double)read / (double)links : 0, show_ambient, s))
            return false;
        read += s->columns.first[shooter + 1] - s->columns.first[shooter];
        shoot(s, shooter);
        solution->iterations++;
    }
    return true;
}

bool solve_progressive(const SolveSystem *system, Solution *solution, Error *err)
{
    Shooting s;
    const bool made = shooting_init(&s, system, solution, err);
    if (made && solution->count > 0) {
        const bool whole = run_shots(&s, solution);
        sum_anew(&s);
        solution->unshot = fmin(solve_relative(system, s.size), 1);
        if (!whole)
            show_ambient(&s, solution->radiosity);
    }
    shooting_clear(&s);
    return made;
}
