/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/clusters.c -- rounds of spreading light over links and refining them by it. */
#include "radiosity/clusters.h"

#include <assert.h>
#include <math.h>
#include <string.h>
#include <time.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "radiosity/clusters_internal.h"

static const double DEFAULT_TOLERANCE = 0.02;

/* What sweeps leave of light, of the tolerance. */
static const double SWEPT = 0.02;

/* Sweeps of one round at most: 0.99^1000 is below 1e-4. */
enum { SWEEPS_MOST = 1000 };

/* Sweeps that are made all the same when it is to stop: where a half of light is reflected, next
 * to nothing is missing then. */
enum { STOPPED_SWEEPS = 12 };

/* Steps of importance between rounds, and at the end, where none may be missing. */
enum { MEANING_SWEEPS = 8, MEANING_LAST = 4000 };

/* With importance, this share of what counts stays with patches by their areas: what is not seen at
 * all at first may be found to matter as links are refined. */
static const double AREA_SHARE = 0.05;

/* The threshold falls by these at most and at least from round to round, when all links satisfy
 * it. */
static const double FALL_MOST = 0.25, FALL_LEAST = 0.7;

/* The first threshold, in terms of the one that would do if each patch had one link; of a tolerance
 * of this much at least, for the first round not to take all rays. */
static const double FIRST = 4, FIRST_TOLERANCE = 0.05;

/* A round that refines less than this share of all links has satisfied the oracle. */
static const double FEW = 0.02;

/* Another round takes about as many rays as all before: it is not begun where it could not end. */
static const double ROUND_LEFT = 0.5;

/* Links' errors are forgiven, in part, by the last reflection: it gathers from many of them. */
static const double FORGIVEN = 2.5;

/* What is left of links' errors, times what is reflected of light: they differ from node to node.
 * On the Cornell box, 0.44 was found where links were off by 5 %, less where they were by more. */
static const double CANCELLED = 0.5;

/* Last reflections at most: three leave a part in eight of links' errors, and less of what is
 * reflected. */
enum { GATHERS_MOST = 3 };

/* What links have wrong leans one way: where it is below this share of the noise, it is so of means
 * over a few dozen patches as well. */
static const double BELOW_NOISE = 0.2;

enum { ROUNDS_MOST = 200 };

typedef struct {
    const ClustersOptions *options;
    const SolveProblem *problem;
    ClustersReport *report;
    Solution    *solution;
    ClusterTree  tree;
    ClusterLinks links;
    ClusterLight light;
    double      *shine, *weight;   /* [nodes]  of the oracle */
    ClusterOracle oracle;
    double       tolerance, begun;
    double       links_tolerance;  /* of what links leave */
} Run;

static double clock_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double luminance(const double *v)
{
    return rgb_luminance(rgb(v[0], v[1], v[2]));
}

/* --- the oracle ------------------------------------------------------------------------------- */

/* Light that nodes send, and how uneven, over the mean irradiance: in a closed room that is the
 * mean of what is sent. */
static void set_shine(Run *run)
{
    const ClusterLight *l = &run->light;
    const double mean = luminance(l->sent);
    for (uint32_t n = 0; n < run->tree.count; n++)
        run->shine[n] = mean > 0 ? sqrt(luminance(&l->sent[(size_t)n * ROOM_BANDS]) *
                                        luminance(&l->sent[(size_t)n * ROOM_BANDS]) +
                                        l->uneven[n]) / mean : 0;
}

static void set_weights(Run *run)
{
    const ClusterLight *l = &run->light;
    const ClusterNode *node = run->tree.node;
    const bool importance = run->options->seen != NULL;
    if (importance)
        cluster_light_meaning(&run->light, run->options->seen, MEANING_SWEEPS);
    const double all = importance ? luminance(l->meaning) : 0;
    const double by_area = all > 0 ? AREA_SHARE : 1;
    for (uint32_t n = 0; n < run->tree.count; n++)
        run->weight[n] = by_area * node[n].area / node[0].area +
                         (all > 0 ? (1 - by_area) *
                                    luminance(&l->meaning[(size_t)n * ROOM_BANDS]) / all : 0);
}

/* --- rounds ----------------------------------------------------------------------------------- */

static void tell(Run *run, const Monitor *monitor)
{
    const ClustersOptions *o = run->options;
    const double squared = run->links_tolerance / fmax(run->report->error, run->links_tolerance);
    const double spent = (double)run->links.rays / (double)run->links.most_rays;
    const Progress progress = { .stage = "solve", .done = fmin(1, fmax(squared * squared, spent)),
                                .energy_left = run->solution->unshot, .rays = run->links.rays };
    monitor_progress(monitor, &progress);
    if (o->trace == NULL)
        return;
    const SolveStep step = { .step = run->solution->iterations,
                             .seconds = clock_seconds() - run->begun,
                             .residual = run->report->error, .unshot = run->solution->unshot,
                             .error_bound = NAN, .radiosity = run->solution->radiosity,
                             .rays = run->links.rays,
                             .passes = (double)run->links.rays / fmax(1, run->tree.leaves) };
    o->trace(o->trace_user, &step);
}

/* What all further sweeps would move, when this one moved `now` and the one before `before`: a
 * geometric series, for what is left after some sweeps falls by the same share with each. */
static double still_to_come(double now, double before)
{
    return now <= 0 ? 0 : now < before ? now * now / (before - now) : INFINITY;
}

/* Spreads light over the links there are, until a sweep moves less than that. The last time, until
 * all that would follow do not move that much: of bright walls it is far more. */
static void sweep(Run *run, double least, bool last, const Monitor *monitor)
{
    Solution *s = run->solution;
    double before = 0;
    for (uint32_t k = 0; k < SWEEPS_MOST; k++) {
        s->residual = cluster_light_sweep(&run->light, s->radiosity, s->irradiance);
        s->iterations++;
        cluster_light_pull(&run->light, s->radiosity);
        const double left = still_to_come(s->residual, before);
        s->unshot = fmin(left, 1);
        if ((last ? left : s->residual) <= least ||
            (k >= STOPPED_SWEEPS && monitor_stop(monitor)))
            break;
        before = s->residual;
    }
}

/* What is wanted by now. */
static void set_tolerance(Run *run)
{
    const ClustersOptions *o = run->options;
    uint32_t rays = o->rays > 0 ? o->rays : 256;
    run->tolerance = o->tolerance > 0 ? o->tolerance : DEFAULT_TOLERANCE;
    if (o->wish != NULL) {
        o->wish(o->wish_user, &run->tolerance, &rays);
        run->links.most_rays = (uint64_t)rays * run->tree.leaves;
        run->links.spent = run->links.rays >= run->links.most_rays;
    }
    run->links_tolerance = (o->gather > 0 ? FORGIVEN : 1) * run->tolerance;
}

/* One round; false when it is the last one. */
static bool run_round(Run *run, const Monitor *monitor, Error *err)
{
    ClusterLinks *links = &run->links;
    ClusterOracle *oracle = &run->oracle;
    uint64_t refined;
    set_tolerance(run);
    set_shine(run);
    set_weights(run);
    if (!cluster_links_refine(links, oracle, &refined, err))
        return false;
    cluster_light_fill(&run->light);
    sweep(run, SWEPT * run->links_tolerance, false, monitor);
    set_shine(run);
    run->report->rounds++;
    run->report->error = cluster_links_error(links, oracle);
    set_tolerance(run);
    const double error = run->report->error, spent = ROUND_LEFT * (double)links->most_rays;
    if (error <= run->links_tolerance || links->spent || links->full || links->stopped ||
        (double)links->rays > spent)
        return false;
    if ((double)refined <= FEW * (double)links->count)
        oracle->threshold *= fmin(FALL_LEAST, fmax(FALL_MOST, run->links_tolerance / error));
    return run->report->rounds < ROUNDS_MOST && luminance(run->light.sent) > 0;
}

/* --- what is kept ----------------------------------------------------------------------------- */

static ClustersState state_of(Run *run)
{
    const bool guided = run->options->seen != NULL;
    return (ClustersState){ &run->links, run->solution->radiosity, run->light.meaning,
                            guided ? run->weight : NULL };
}

static bool keep(Run *run, bool ended, Error *err)
{
    const ClusterLinks *l = &run->links;
    const ClustersState state = state_of(run);
    const ClustersHead head = { .links = l->count, .rays = l->rays, .most_links = l->most_links,
                                .largest = l->largest, .threshold = run->oracle.threshold,
                                .error = run->report->error, .patches = run->solution->count,
                                .nodes = run->tree.count, .rounds = run->report->rounds,
                                .iterations = run->solution->iterations, .ended = ended,
                                .full = l->full, .guided = state.meaning != NULL };
    return clusters_kept_put(run->options->kept, &head, &state, err);
}

/* Goes on from what was kept; true: there are no more rounds. */
static bool resume(Run *run, Error *err)
{
    const ClustersState state = state_of(run);
    ClustersHead head;
    if (!clusters_kept_get(run->options->kept, &head, &state, err))
        return false;
    run->links.rays = head.rays;
    run->links.most_links = head.most_links;
    run->links.largest = head.largest;
    run->links.full = head.full != 0;
    run->oracle.threshold = head.threshold;
    run->report->error = head.error;
    run->report->rounds = head.rounds;
    run->solution->iterations = head.iterations;
    cluster_light_pull(&run->light, run->solution->radiosity);
    cluster_light_fill(&run->light);
    if (state.weight == NULL)
        set_weights(run);
    return head.ended != 0;
}

/* All rounds. One that was broken off is not kept: it would end otherwise. */
static bool run_rounds(Run *run, const Monitor *monitor, Error *err)
{
    bool more = !resume(run, err) && run->tree.leaves > 0;
    while (more && !error_is_set(err)) {
        more = run_round(run, monitor, err);
        if (run->options->kept != NULL && !error_is_set(err) && !run->links.stopped &&
            !monitor_stop(monitor))
            keep(run, !more, err);
        tell(run, monitor);
    }
    return !error_is_set(err);
}

static void start(Run *run)
{
    const SolveProblem *p = run->problem;
    Solution *s = run->solution;
    for (size_t k = 0; k < (size_t)s->count * ROOM_BANDS; k++) {
        s->irradiance[k] = p->received != NULL ? p->received[k] : 0;
        s->radiosity[k] = p->emission[k] + p->reflectance[k] * s->irradiance[k];
    }
    cluster_light_pull(&run->light, s->radiosity);
    /* As if one link went to each patch, and four times as much. */
    run->oracle = (ClusterOracle){ .light = run->shine, .weight = run->weight,
                                   .threshold = FIRST *
                                                fmax(run->links_tolerance, FIRST_TOLERANCE) /
                                                sqrt(fmax(1, run->tree.leaves)) };
}

/* --- the end ---------------------------------------------------------------------------------- */

/* What the camera receives: by light that came, and by importance of what is sent at first. */
static void check_adjoint(Run *run)
{
    const SolveProblem *p = run->problem;
    const double *seen = run->options->seen;
    cluster_light_meaning(&run->light, seen, MEANING_LAST);
    for (uint32_t n = 0; n < run->tree.count; n++) {
        if (run->tree.node[n].child != 0)
            continue;
        const uint32_t patch = run->tree.patch[run->tree.node[n].begin];
        for (unsigned b = 0; b < ROOM_BANDS; b++) {
            const size_t at = (size_t)patch * ROOM_BANDS + b;
            const double outside = p->received != NULL ? p->received[at] : 0;
            run->report->response[b] += seen[patch] * run->solution->radiosity[at];
            run->report->adjoint[b] += run->light.meaning[(size_t)n * ROOM_BANDS + b] *
                                       (p->emission[at] + p->reflectance[at] * outside);
        }
    }
}

static void report(Run *run)
{
    ClustersReport *r = run->report;
    for (unsigned b = 0; b < ROOM_BANDS; b++)
        r->scale[b] = 1;
    r->rows = run->light.rows;
    r->rays = run->links.rays;
    r->links = run->links.count;
    r->nodes = run->tree.count;
    r->full = run->links.full;
    r->bytes = 2 * run->links.largest * sizeof *run->links.link +
               run->tree.count * (sizeof *run->tree.node + sizeof *run->light.here +
                                  (ROOM_BANDS + 4) * sizeof(double));
    cluster_light_escaped(&run->light, run->solution->radiosity, r->escaped);
    r->guided = run->options->seen != NULL;
    if (run->options->seen != NULL && run->tree.leaves > 0)
        check_adjoint(run);
}

/* What of all light has been reflected: links' errors count in the last reflection by that. */
static double reflected_share(const Run *run)
{
    const double *p = run->problem->emission, *all = run->solution->radiosity;
    double sent = 0, own = 0;
    for (uint32_t k = 0; k < run->tree.leaves; k++) {
        const size_t at = (size_t)run->tree.patch[k] * ROOM_BANDS;
        const double area = run->tree.before[k + 1] - run->tree.before[k];
        sent += area * luminance(&all[at]);
        own += area * luminance(&p[at]);
    }
    return sent > 0 ? 1 - own / sent : 0;
}

/* Gathers once, and again as long as it is the links that keep the error above the tolerance: each
 * time what they have wrong is reflected once more. */
static bool gather_last(Run *run, const Monitor *monitor, Error *err)
{
    ClustersReport *r = run->report;
    ClustersOptions o = *run->options;
    const double share = CANCELLED * reflected_share(run);
    double links = r->error;
    bool gathered = false;
    if (o.gather == 0 || run->links.stopped || run->tree.leaves == 0)
        return true;
    for (uint32_t k = 0; k < GATHERS_MOST; k++) {
        o.seed = k == 0 ? o.seed : sampling_seed(run->options->seed, SEED_ROWS, k, 0);
        o.kept = k == 0 ? o.kept : NULL; /* the others are made again */
        if (!clusters_gather(&run->links, run->problem, &o, run->weight, run->solution, r, monitor,
                             err))
            return false;
        if (!r->gathered)
            break;
        gathered = true;
        links *= share;
        r->error = sqrt(links * links + r->noise * r->noise);
        if (links <= run->tolerance || links <= BELOW_NOISE * r->noise)
            break;
    }
    r->gathered = gathered;
    return true;
}

static bool run_create(Run *run, const Room *room, const OpenPlaces *places,
                       const Monitor *monitor, Error *err)
{
    if (!cluster_tree_create(&run->tree, room, places->links->area, err) ||
        !cluster_links_create(&run->links, room, places, &run->tree, run->options, monitor, err) ||
        !cluster_light_create(&run->light, &run->links, run->problem,
                              run->options->seen != NULL, err))
        return false;
    run->shine = array_create(run->tree.count, sizeof *run->shine, "the oracle", err);
    run->weight = array_create(run->tree.count, sizeof *run->weight, "the oracle", err);
    return !error_is_set(err);
}

static void run_clear(Run *run)
{
    array_free(run->shine);
    array_free(run->weight);
    cluster_light_clear(&run->light);
    cluster_links_clear(&run->links);
    cluster_tree_clear(&run->tree);
}

static Solution *new_solution(uint32_t count, Error *err)
{
    Solution *solution = array_create(1, sizeof *solution, "a solution", err);
    if (solution == NULL)
        return NULL;
    const size_t n = (size_t)count * ROOM_BANDS;
    *solution = (Solution){ .count = count, .bands = ROOM_BANDS, .error_bound = NAN };
    solution->radiosity = array_create(n, sizeof(double), "a solution", err);
    solution->irradiance = array_create(n, sizeof(double), "a solution", err);
    return error_is_set(err) ? solution_destroy(solution) : solution;
}

Solution *clusters_solve(const Room *room, const OpenPlaces *places, const SolveProblem *problem,
                         const ClustersOptions *options, ClustersReport *out,
                         const Monitor *monitor, Error *err)
{
    *out = (ClustersReport){ .error = 0 };
    if (error_is_set(err))
        return NULL;
    assert(problem->bands == ROOM_BANDS && places->links->count == room->patches->count);
    Run run = { .options = options, .problem = problem, .report = out,
                .begun = clock_seconds() };
    run.solution = new_solution(room->patches->count, err);
    if (run.solution != NULL && run_create(&run, room, places, monitor, err)) {
        set_tolerance(&run);
        start(&run);
        if (run_rounds(&run, monitor, err)) {
            sweep(&run, SWEPT * run.links_tolerance, true, monitor);
            report(&run);
            gather_last(&run, monitor, err);
        }
        run.solution->converged = out->error <= run.tolerance;
        run.solution->seconds = clock_seconds() - run.begun;
    }
    run_clear(&run);
    return error_is_set(err) ? solution_destroy(run.solution) : run.solution;
}
