/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/solve_progressive.c -- progressive refinement [cohen88], which is Southwell's
 * relaxation [gortler94]: the patch with the greatest unshot power sends it to all that see it,
 * until little is left. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "radiosity/internal.h"

/* Shots between two looks at the clock and the monitor. */
static const uint32_t SHOTS_PER_REPORT = 256;

/* All that shooting keeps: B = E + rho H0 + rho F (B - unshot) holds after each shot, so the
 * residual of B is rho F unshot, and its sum is weight . unshot. */
typedef struct {
    const SolveSystem *system;
    LinkColumns        columns;
    double            *radiosity;    /* [count * bands]  the solution's */
    double            *unshot;       /* [count * bands] */
    double            *weight;       /* [count * bands]  sum_i A_i rho_i F_ij */
    double            *residual;     /* [bands]  weight . unshot */
    double            *left;         /* [bands]  sum of A unshot */
    double            *key;          /* [count]  A_i sum over bands of unshot_i */
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
        sum += s->unshot[(size_t)patch * s->system->bands + b];
    s->key[patch] = s->system->links->area[patch] * sum;
}

/* Sums that shots change a little each, formed anew so that rounding does not pile up. */
static void sum_anew(Shooting *s)
{
    const unsigned bands = s->system->bands;
    for (unsigned b = 0; b < bands; b++)
        s->residual[b] = s->left[b] = 0;
    for (uint32_t i = 0; i < s->system->links->count; i++)
        for (unsigned b = 0; b < bands; b++) {
            const size_t at = (size_t)i * bands + b;
            s->residual[b] += s->weight[at] * s->unshot[at];
            s->left[b] += s->system->links->area[i] * s->unshot[at];
        }
}

static void fill_weights(Shooting *s)
{
    const Links *links = s->system->links;
    const unsigned bands = s->system->bands;
    for (uint32_t i = 0; i < links->count; i++)
        for (uint64_t k = links->first[i]; k < links->first[i + 1]; k++)
            for (unsigned b = 0; b < bands; b++)
                s->weight[(size_t)links->source[k] * bands + b] +=
                    links->area[i] * links->form_factor[k] *
                    s->system->problem->reflectance[(size_t)i * bands + b];
}

/* Adds `gain` in band b to a patch; a patch without visible area stays as it is. */
static void receive(Shooting *s, uint32_t patch, unsigned b, double gain)
{
    const size_t at = (size_t)patch * s->system->bands + b;
    s->radiosity[at] += gain;
    s->unshot[at] += gain;
    s->residual[b] += s->weight[at] * gain;
    s->left[b] += s->system->links->area[patch] * gain;
}

static void shoot(Shooting *s, uint32_t shooter, double *sent)
{
    const unsigned bands = s->system->bands;
    const double *reflectance = s->system->problem->reflectance;
    for (unsigned b = 0; b < bands; b++) {
        const size_t at = (size_t)shooter * bands + b;
        sent[b] = s->unshot[at];
        s->residual[b] -= s->weight[at] * sent[b];
        s->left[b] -= s->system->links->area[shooter] * sent[b];
        s->unshot[at] = 0;
    }
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
}

/* Light not yet shot will be spread over the whole room in the end: its mean irradiance
 * R sum A unshot / sum A, with R = 1 + rho + rho^2 ... for mean reflectance rho [cohen88]. What
 * escapes is taken off each time round, which the source leaves out. */
static void add_ambient(Shooting *s)
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
        const double ambient = (stays / area) * (s->left[b] / area) / (1 - loop);
        for (uint32_t i = 0; i < links->count; i++)
            if (links->area[i] > 0)
                s->radiosity[(size_t)i * bands + b] +=
                    reflectance[(size_t)i * bands + b] * ambient;
    }
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
    s->key = array_create(count, sizeof *s->key, "unshot power", err);
    s->best = array_create(2 * (size_t)s->leaves, sizeof *s->best, "a tournament", err);
    if (!link_columns_create(system->links, &s->columns, err) || error_is_set(err))
        return false;
    memcpy(s->radiosity, system->source, values * sizeof *s->radiosity);
    memcpy(s->unshot, system->source, values * sizeof *s->unshot);
    fill_weights(s);
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
    array_free(s->key);
    array_free(s->best);
}

bool solve_progressive(const SolveSystem *system, bool ambient, Solution *solution, Error *err)
{
    Shooting s;
    double *sent = array_create(solution->bands, sizeof *sent, "a shot", err);
    const bool made = shooting_init(&s, system, solution, err);
    SolveStall stall = { 0 };
    while (made && solution->count > 0) {
        if (solution->iterations % solution->count == 0) {
            sum_anew(&s);
            if (solve_stalled(&stall, solve_relative(system, s.residual)))
                break;
        }
        if (solve_relative(system, s.residual) <= system->tolerance) {
            sum_anew(&s);
            if (solve_relative(system, s.residual) <= system->tolerance) {
                ambient = false; /* not stopped early */
                break;
            }
        }
        if (solution->iterations >= system->max_iterations || s.key[s.best[1]] <= 0)
            break;
        solution->unshot = fmin(solve_relative(system, s.left), 1);
        if (solution->iterations % SHOTS_PER_REPORT == 0 &&
            solve_report(system, solve_relative(system, s.residual)))
            break;
        shoot(&s, s.best[1], sent);
        solution->iterations++;
    }
    if (made) {
        sum_anew(&s);
        solution->unshot = fmin(solve_relative(system, s.left), 1);
        if (ambient)
            add_ambient(&s);
    }
    shooting_clear(&s);
    array_free(sent);
    return made;
}
