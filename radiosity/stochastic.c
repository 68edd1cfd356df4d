/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/stochastic.c -- batches of shots, then rounds of gathering, until two halves agree. */
#include "radiosity/stochastic.h"

#include <assert.h>
#include <math.h>
#include <string.h>
#include <time.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "radiosity/stochastic_internal.h"

static const double DEFAULT_TOLERANCE = 0.02;

/* Per patch and batch: rays that lamps shoot, and visibility rays to them; rays that carry what is
 * reflected first (later reflections take as many as they have power). */
enum { LAMP_SHOTS = 1, LAMP_SAMPLES = 2, FIRST_SHOTS = 2 };

/* No pass shoots fewer rays than this, so that the last ones take no colour from another. */
enum { SHOTS_LEAST = 4096 };

/* Shot, before light is gathered by what they brought. */
enum { BATCHES = 4 };

/* Standard deviation of a ray to a lamp that nothing hides, to its mean: a lamp near by is seen
 * under other angles from its one end than from its other one. */
static const double SIGHT_SPREAD = 0.5;

/* Rays of a round for each ray over a hemisphere: two halves, and as many to lamps on average. */
enum { ROUND_KINDS = 4 };

/* A batch leaves this share of what it reflected first to the next one; the last one what rounding
 * of sums leaves. */
static const double LEFT = 0.01, LEFT_AT_LAST = 1e-9;

/* Reflections in one go: 0.99^2000 is below LEFT_AT_LAST. */
enum { REFLECTIONS_MOST = 4000 };

typedef struct {
    Shooter   shooter;
    const StochasticOptions *options;
    double   *power, *left, *arrived;    /* [n = patches * bands]  shot now, left, arrived */
    double   *direct[2], *indirect[2];   /* [n]  power that came in each half */
    double   *even[2];                   /* [n]  direct and indirect, both evened out */
    double   *spare[2];                  /* [n] */
    uint16_t *sights;                    /* [patches]  rays to lamps, in each half of a round */
    EvenTree  tree;
    size_t    n;
    uint32_t  batches, rounds;           /* shot; gathered, rounds of two halves each */
    double    parts;                     /* that direct and indirect are sums of, both halves */
    double    scale[ROOM_BANDS];         /* of irradiance, for power to balance */
    double    quantum;                   /* of power that a ray carries after a reflection */
    double    escaped[ROOM_BANDS];       /* of all batches */
    double    unshot, begun;
    StochasticReport *report;
} Run;

static double clock_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static bool run_create(Run *run, Error *err)
{
    static const char what[] = "light on patches";
    double **all[] = { &run->power, &run->left, &run->arrived, &run->direct[0], &run->direct[1],
                       &run->indirect[0], &run->indirect[1], &run->even[0], &run->even[1],
                       &run->spare[0], &run->spare[1] };
    run->sights = array_create(run->shooter.count, sizeof *run->sights, what, err);
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        *all[k] = array_create(run->n, sizeof **all[k], what, err);
    return !error_is_set(err) && shooter_create(&run->shooter, err) &&
           (run->options->kept == NULL ||
            stochastic_kept_begin(run->options->kept, run->shooter.count, err)) &&
           even_tree_create(run->shooter.room, run->shooter.places->links->area,
                            run->shooter.threads, &run->tree, err);
}

static void run_clear(Run *run)
{
    double *all[] = { run->power, run->left, run->arrived, run->direct[0], run->direct[1],
                      run->indirect[0], run->indirect[1], run->even[0], run->even[1], run->spare[0],
                      run->spare[1] };
    array_free(run->sights);
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        array_free(all[k]);
    shooter_clear(&run->shooter);
    even_tree_clear(&run->tree);
}

static double area_of(const Run *run, size_t at)
{
    return run->shooter.places->links->area[at / ROOM_BANDS];
}

static double sum_bands(const Run *run, const double *value, double sum[ROOM_BANDS])
{
    memset(sum, 0, ROOM_BANDS * sizeof *sum);
    for (size_t k = 0; k < run->n; k++)
        sum[k % ROOM_BANDS] += value[k];
    return sum[0] + sum[1] + sum[2];
}

/* --- one batch -------------------------------------------------------------------------------- */

/* Shoots run->power once; what arrives is reflected into it. `pass` numbers the points. */
static void reflect(Run *run, double *in, uint32_t pass, double all,
                    const double power[ROOM_BANDS])
{
    Shooter *s = &run->shooter;
    const double wanted = fmin(ceil(all / run->quantum), UINT32_MAX / 2);
    ShotPass shots = { .shooter = s, .power = run->power, .all = all, .arrived = run->arrived,
                       .rays = wanted < SHOTS_LEAST ? SHOTS_LEAST : (uint32_t)wanted,
                       .seed = sampling_seed(s->seed, SEED_ROWS, run->batches, pass) };
    double scale[ROOM_BANDS];
    memset(run->arrived, 0, run->n * sizeof *run->arrived);
    shooter_shoot(&shots);
    for (unsigned b = 0; b < ROOM_BANDS; b++) {
        scale[b] = shots.sent[b] > 0 ? power[b] / shots.sent[b] : 0;
        run->escaped[b] += scale[b] * shots.escaped[b];
    }
    for (size_t k = 0; k < run->n; k++) {
        if (!(shots.sent[k % ROOM_BANDS] > 0))
            continue; /* no ray had this colour: it is left to the next pass */
        const double came = run->arrived[k] * scale[k % ROOM_BANDS];
        in[k] += came;
        run->power[k] = s->problem->reflectance[k] * came;
    }
}

/* Reflects run->power until less than `least` is left. */
static void reflect_all(Run *run, double *in, double least, uint32_t first)
{
    double power[ROOM_BANDS];
    for (uint32_t k = 0; k < REFLECTIONS_MOST; k++) {
        const double all = sum_bands(run, run->power, power);
        if (!(all > least) || !(all > 0))
            break;
        reflect(run, in, first + k, all, power);
    }
    double *const swap = run->left;
    run->left = run->power;
    run->power = swap;
}

static void run_batch(Run *run)
{
    Shooter *s = &run->shooter;
    const unsigned half = run->batches % 2;
    const double *received = s->problem->received;
    double escaped[ROOM_BANDS], power[ROOM_BANDS];
    const uint32_t shots = s->count * LAMP_SHOTS;
    shooter_light(s, run->batches, shots < SHOTS_LEAST ? SHOTS_LEAST : shots, run->power,
                  run->arrived, escaped);
    for (unsigned b = 0; b < ROOM_BANDS; b++)
        run->escaped[b] += escaped[b];
    for (size_t k = 0; k < run->n; k++) {
        const double came = run->arrived[k] +
                            (received != NULL ? area_of(run, k) * received[k] : 0);
        run->direct[half][k] += came;
        run->power[k] = s->problem->reflectance[k] * came;
    }
    const double reflected = sum_bands(run, run->power, power);
    for (size_t k = 0; k < run->n; k++)
        run->power[k] += run->left[k];
    const double shot = fmax((double)s->count * FIRST_SHOTS, SHOTS_LEAST);
    run->quantum = reflected / shot;
    if (run->quantum > 0)
        reflect_all(run, run->indirect[half], LEFT * reflected, 0);
    run->batches++;
}

/* --- error ------------------------------------------------------------------------------------ */

/* A patch that is moved by less than this of its light is none of a group: sums of doubles round by
 * less. */
static const double ROUNDED = 1e-12;

static double luminance(const double *v)
{
    return rgb_luminance(rgb(v[0], v[1], v[2]));
}

/* Evens out, each kind of light by itself. */
static void even_out_all(Run *run)
{
    const double *area = run->shooter.places->links->area;
    for (unsigned h = 0; h < 2; h++) {
        memcpy(run->even[h], run->direct[h], run->n * sizeof *run->even[h]);
        memcpy(run->spare[h], run->indirect[h], run->n * sizeof *run->spare[h]);
    }
    if (!run->options->apart) {
        even_tree_fit(&run->tree, area, run->even);
        run->report->groups = even_tree_fit(&run->tree, area, run->spare);
    }
    for (unsigned h = 0; h < 2; h++)
        for (size_t k = 0; k < run->n; k++)
            run->even[h][k] += run->spare[h][k];
}

/* What noise is left, by how far the two halves are apart, and what evening out did to light: as
 * far as that is more than it did to the difference of the halves, in which there is no light.
 * Groups were chosen for looking smooth, so the latter is too little: what they let through of the
 * noise is counted at the price that they were chosen by (EVEN_PENALTY). Noise that was taken for
 * light (EVEN_TAKEN) is missing from the product, and at most as much of it is let through. */
static double estimate_error(Run *run)
{
    double noise = 0, chosen = 0, bias = 0, moved = 0, sum = 0, areas = 0;
    even_out_all(run);
    for (size_t k = 0; k < run->n; k += ROOM_BANDS) {
        const double area = area_of(run, k);
        if (!(area > 0))
            continue;
        const double a = luminance(&run->even[0][k]), b = luminance(&run->even[1][k]);
        const double raw_a = luminance(&run->direct[0][k]) + luminance(&run->indirect[0][k]);
        const double raw_b = luminance(&run->direct[1][k]) + luminance(&run->indirect[1][k]);
        const double moved_a = raw_a - a, moved_b = raw_b - b;
        const double apart = (a - b) * (a - b) / area;
        noise += apart;
        if (!run->options->apart && fabs(moved_a) + fabs(moved_b) > ROUNDED * (raw_a + raw_b))
            chosen += apart;
        bias += 4 * moved_a * moved_b / area;
        moved += 4 * (moved_a * moved_a + moved_b * moved_b) / 2 / area;
        sum += a + b;
        areas += area;
    }
    bias += (EVEN_PENALTY - 2) * chosen + 2 * EVEN_TAKEN * moved;
    return sum > 0 ? sqrt((noise + fmax(bias, 0)) * areas) / sum : 0;
}

/* Power that there is in one batch, of all bands; what is left of all of them, relative to it. */
static double unshot_share(const Run *run)
{
    const SolveProblem *p = run->shooter.problem;
    double power = 0, left[ROOM_BANDS];
    for (size_t k = 0; k < run->n; k++)
        power += area_of(run, k) * (p->emission[k] + (p->received != NULL ? p->received[k] : 0));
    return power > 0 ? sum_bands(run, run->left, left) / run->batches / power : 0;
}

static uint64_t count_rays(const Run *run)
{
    uint64_t rays = 0;
    for (unsigned k = 0; k < run->shooter.threads; k++)
        rays += run->shooter.scratch[k].rays;
    return rays;
}

/* --- gathering -------------------------------------------------------------------------------- */

/* Variance of what one ray to the lamps tells about a patch's power, over its area: by how much
 * those of the shooting differed; and a share of the light itself, for where the lamps' own rays
 * counted instead. */
static double sight_spread(const Run *run, uint32_t i)
{
    const Shooter *s = &run->shooter;
    const double cast = (double)s->samples * run->batches, area = s->places->links->area[i];
    const double squares = fmax(0, s->square[i] - s->seen[i] * (double)s->seen[i] / cast);
    double power = 0;
    for (unsigned k = 0; k < 2 * ROOM_BANDS; k++)
        power += run->direct[k / ROOM_BANDS][(size_t)i * ROOM_BANDS + k % ROOM_BANDS];
    power *= SIGHT_SPREAD / run->batches;
    return area > 0 ? (squares * s->samples * s->samples / cast + power * power) / area : 0;
}

/* Rays to lamps where they differ: in each half of a round, in proportion to the root of area times
 * variance; powers of 2, as nets have them. */
static void deal_sights(Run *run, uint32_t rays)
{
    const EvenTree *tree = &run->tree;
    double *spread = run->arrived, all = 0;
    for (uint32_t i = 0; i < run->shooter.count; i++)
        spread[i] = sight_spread(run, i);
    even_tree_pool(tree, spread, run->shooter.square);
    for (uint32_t k = 0; k < tree->count; k++)
        all += sqrt(run->shooter.square[tree->order[k]]);
    for (uint32_t k = 0; k < tree->count; k++) {
        const uint32_t i = tree->order[k];
        const double root = sqrt(run->shooter.square[i]);
        const double wanted = all > 0 ? root / all * tree->count * rays : 1;
        uint32_t sights = 1;
        while (sights < GATHER_SIGHTS && sights * M_SQRT2 < wanted)
            sights *= 2;
        run->sights[i] = (uint16_t)sights;
    }
}

typedef struct {
    Run   *run;
    Gather gather;
    double *direct, *indirect; /* [n]  power that comes in this half and round */
} GatherPass;

static void gather_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const GatherPass *pass = context;
    Shooter *s = &pass->run->shooter;
    ShotScratch *c = &s->scratch[worker];
    const double *received = s->problem->received;
    gather_patches(&pass->gather, c, begin, end, c->gathered);
    for (uint32_t k = begin; k < end; k++) {
        const Gathered *g = &c->gathered[k - begin];
        const uint32_t i = pass->run->tree.order[k];
        s->missed[i] += (float)g->missed;
        s->told[i] += (float)g->rays;
        for (unsigned b = 0; b < ROOM_BANDS; b++) {
            const size_t at = (size_t)i * ROOM_BANDS + b;
            const double area = area_of(pass->run, at);
            pass->direct[at] = area * (g->direct[b] + (received != NULL ? received[at] : 0));
            pass->indirect[at] = area * g->indirect[b];
        }
    }
}

/* Gathers once in each half what patches send by what that half knows of them; into even and
 * spare. False: stopped. */
static bool gather_halves(Run *run, uint32_t rays, const Monitor *monitor)
{
    Shooter *s = &run->shooter;
    const double *rho = s->problem->reflectance;
    uint32_t sights = 0;
    for (uint32_t k = 0; k < run->tree.count; k++) {
        const uint32_t own = run->sights[run->tree.order[k]];
        sights = (sights + own - 1) / own * own; /* a net begins at a multiple of its size */
        s->first_ray[k] = sights;
        sights += own;
    }
    double *const reflected[2] = { run->power, run->left };
    for (unsigned h = 0; h < 2; h++)
        for (size_t k = 0; k < run->n; k++) {
            const double area = area_of(run, k);
            const double power = 2 * run->even[h][k] / run->parts;
            reflected[h][k] = area > 0 ? rho[k] * run->scale[k % ROOM_BANDS] * power / area : 0;
        }
    for (unsigned h = 0; h < 2; h++) {
        GatherPass pass = { .run = run, .direct = run->even[h], .indirect = run->spare[h],
                            .gather = { .shooter = s, .reflected = reflected[h],
                                        .order = run->tree.order, .sights = run->sights,
                                        .first_sight = s->first_ray, .rays = rays,
                                        .hemisphere_seed = sampling_seed(s->seed, SEED_POINTS,
                                                                         run->rounds, h),
                                        .sight_seed = sampling_seed(s->seed, SEED_POINTS,
                                                                    run->rounds, 2 + h) } };
        if (!parallel_for(run->tree.count, GATHER_CHUNK, s->threads, gather_chunk, &pass, monitor,
                          NULL))
            return false;
    }
    return true;
}

/* How irradiance must be scaled for what is absorbed or escapes to be what is sent; what escapes
 * from each patch, its rays have told. */
static void find_scale(Run *run)
{
    const Shooter *s = &run->shooter;
    const SolveProblem *p = s->problem;
    double sent[ROOM_BANDS] = { 0 }, away[ROOM_BANDS] = { 0 }, gone[ROOM_BANDS] = { 0 };
    for (size_t k = 0; k < run->n; k++) {
        const uint32_t i = (uint32_t)(k / ROOM_BANDS);
        const double area = area_of(run, k), rho = p->reflectance[k];
        const double open = s->told[i] > 0 ? s->missed[i] / (double)s->told[i] : 0;
        const double power = (run->even[0][k] + run->even[1][k]) / run->parts;
        sent[k % ROOM_BANDS] += area * (p->emission[k] * (1 - open) +
                                        (p->received != NULL ? p->received[k] : 0));
        away[k % ROOM_BANDS] += area * p->emission[k] * open;
        gone[k % ROOM_BANDS] += power * (1 - rho + rho * open);
        run->arrived[k] = power * rho * open;
    }
    memset(run->escaped, 0, sizeof run->escaped);
    for (size_t k = 0; k < run->n; k++)
        run->escaped[k % ROOM_BANDS] += run->arrived[k];
    for (unsigned b = 0; b < ROOM_BANDS; b++) {
        run->scale[b] = gone[b] > 0 ? sent[b] / gone[b] : 1;
        run->escaped[b] = away[b] + run->scale[b] * run->escaped[b];
    }
}

/* Adds what a round brought. */
static void add_round(Run *run)
{
    const bool first = run->rounds == 0;
    for (unsigned h = 0; h < 2; h++)
        for (size_t k = 0; k < run->n; k++) {
            run->direct[h][k] = (first ? 0 : run->direct[h][k]) + run->even[h][k];
            run->indirect[h][k] = (first ? 0 : run->indirect[h][k]) + run->spare[h][k];
        }
    run->rounds++;
    run->parts = 2 * run->rounds;
}

/* --- all of it -------------------------------------------------------------------------------- */

static void fill_solution(Run *run, Solution *solution)
{
    const SolveProblem *p = run->shooter.problem;
    for (size_t k = 0; k < run->n; k++) {
        const double area = area_of(run, k);
        const double scale = run->scale[k % ROOM_BANDS];
        const double power = (run->even[0][k] + run->even[1][k]) * scale;
        const double direct = power - run->spare[0][k] * scale - run->spare[1][k] * scale;
        solution->irradiance[k] = area > 0 ? power / run->parts / area : 0;
        solution->direct[k] = area > 0 ? direct / run->parts / area : 0;
        solution->radiosity[k] = p->emission[k] + p->reflectance[k] * solution->irradiance[k];
    }
    solution->unshot = solution->residual = run->unshot;
    solution->iterations = run->batches + 2 * run->rounds;
    memcpy(run->report->escaped, run->escaped, sizeof run->escaped);
    memcpy(run->report->scale, run->scale, sizeof run->scale);
    run->report->rays = count_rays(run);
}

static void tell(Run *run, Solution *solution, double share, const Monitor *monitor)
{
    const Progress progress = { .stage = "solve", .done = share, .energy_left = -1,
                                .rays = count_rays(run) };
    monitor_progress(monitor, &progress);
    if (run->options->trace == NULL)
        return;
    fill_solution(run, solution);
    const SolveStep step = { .step = solution->iterations,
                             .seconds = clock_seconds() - run->begun,
                             .residual = run->report->error, .unshot = solution->unshot,
                             .error_bound = NAN, .radiosity = solution->radiosity,
                             .rays = count_rays(run),
                             .passes = (double)count_rays(run) / run->shooter.count };
    run->options->trace(run->options->trace_user, &step);
}

/* Shoots all there is, in two halves. */
static void shoot_all(Run *run, Solution *solution, double most, const Monitor *monitor)
{
    bool stopped = false, spent = false;
    while (run->batches < BATCHES && !spent && !stopped) {
        run_batch(run);
        run_batch(run);
        const double rays = (double)count_rays(run);
        spent = rays + 2 * rays / run->batches > most;
        stopped = monitor_stop(monitor);
    }
    if (run->quantum > 0) {
        double *const swap = run->left;
        run->left = run->power;
        run->power = swap;
        reflect_all(run, run->indirect[0], LEFT_AT_LAST * run->quantum * FIRST_SHOTS
                    * run->shooter.count, REFLECTIONS_MOST);
    }
    run->parts = run->batches;
    for (unsigned b = 0; b < ROOM_BANDS; b++)
        run->escaped[b] /= run->batches;
    run->unshot = unshot_share(run);
    run->report->error = estimate_error(run);
    tell(run, solution, fmin(1, (double)count_rays(run) / most), monitor);
}

/* Rays of a half of a round: fewer where a whole round would be too many. */
static uint32_t round_rays(const Run *run, double most)
{
    const double left = (most - (double)count_rays(run)) / run->shooter.count;
    uint32_t rays = GATHER_RAYS / 2;
    while (rays > 1 && ROUND_KINDS * rays > left)
        rays /= 2;
    return ROUND_KINDS * rays > left ? 0 : rays;
}

static StochasticPlaces run_places(const Run *run)
{
    return (StochasticPlaces){ .power = { run->direct[0], run->direct[1], run->indirect[0],
                                          run->indirect[1] },
                               .missed = run->shooter.missed, .told = run->shooter.told,
                               .sights = run->sights };
}

/* For a later run to go on from here. */
static void keep(const Run *run, uint32_t rays)
{
    const StochasticPlaces places = run_places(run);
    StochasticHead head = { .rays = count_rays(run), .unshot = run->unshot,
                            .quantum = run->quantum, .count = run->shooter.count,
                            .batches = run->batches, .rounds = run->rounds, .round_rays = rays };
    memcpy(head.escaped, run->escaped, sizeof head.escaped);
    if (run->options->kept != NULL)
        stochastic_kept_put(run->options->kept, &head, &places);
}

/* Goes on from where an earlier run was, with `rays` of each half of a round; false: there is
 * none. */
static bool take_up(Run *run, uint32_t *rays)
{
    const StochasticPlaces places = run_places(run);
    StochasticHead head;
    if (run->options->kept == NULL || !stochastic_kept_get(run->options->kept, &head, &places))
        return false;
    assert(head.count == run->shooter.count);
    run->shooter.scratch[0].rays = head.rays;
    run->unshot = head.unshot;
    run->quantum = head.quantum;
    run->batches = head.batches;
    run->rounds = head.rounds;
    run->parts = head.rounds > 0 ? 2 * head.rounds : head.batches;
    memcpy(run->escaped, head.escaped, sizeof run->escaped);
    for (uint32_t k = 0; k < run->tree.count; k++)
        run->sights[run->tree.order[k]] |= run->sights[run->tree.order[k]] == 0;
    run->report->error = estimate_error(run);
    if (run->rounds > 0)
        find_scale(run);
    *rays = head.round_rays;
    return true;
}

/* Whether the error is small enough by now; *most: rays that may be cast in all. */
static bool is_reached(Run *run, double *tolerance, double *most)
{
    const StochasticOptions *o = run->options;
    uint32_t rays = o->rays > 0 ? o->rays : 256;
    *tolerance = o->tolerance > 0 ? o->tolerance : DEFAULT_TOLERANCE;
    if (o->wish != NULL)
        o->wish(o->wish_user, tolerance, &rays);
    *most = (double)rays * run->shooter.count;
    return run->report->error <= *tolerance;
}

static void solve_all(Run *run, Solution *solution, const Monitor *monitor)
{
    double tolerance, most;
    is_reached(run, &tolerance, &most);
    for (unsigned b = 0; b < ROOM_BANDS; b++)
        run->scale[b] = 1;
    uint32_t rays;
    if (!take_up(run, &rays)) {
        shoot_all(run, solution, most, monitor);
        is_reached(run, &tolerance, &most);
        rays = run->quantum > 0 || run->shooter.lamp_power > 0 ? round_rays(run, most) : 0;
        deal_sights(run, rays);
        if (!monitor_stop(monitor))
            keep(run, rays);
    }
    bool reached = rays == 0 || (run->rounds > 0 && run->report->error <= tolerance);
    while (!reached && round_rays(run, most) >= rays && !monitor_stop(monitor)) {
        if (!gather_halves(run, rays, monitor)) {
            run->report->error = estimate_error(run);
            break;
        }
        add_round(run);
        run->report->error = estimate_error(run);
        find_scale(run);
        keep(run, rays);
        const double squared = tolerance / fmax(run->report->error, tolerance);
        tell(run, solution, fmin(1, fmax(squared * squared, (double)count_rays(run) / most)),
             monitor);
        reached = is_reached(run, &tolerance, &most); /* whoever looked may have asked for more */
    }
    solution->converged = run->report->error <= tolerance;
}

Solution *stochastic_solve(const Room *room, const OpenPlaces *places, const SolveProblem *problem,
                           const StochasticOptions *options, StochasticReport *report,
                           const Monitor *monitor, Error *err)
{
    *report = (StochasticReport){ .error = 0 };
    if (error_is_set(err))
        return NULL;
    assert(problem->bands == ROOM_BANDS && places->links->count == room->patches->count);
    const uint32_t count = room->patches->count;
    Run run = { .options = options, .report = report, .n = (size_t)count * ROOM_BANDS,
                .shooter = { .room = room, .places = places, .problem = problem, .count = count,
                             .threads = parallel_threads(options->threads),
                             .seed = options->seed, .samples = LAMP_SAMPLES },
                .begun = clock_seconds() };
    Solution *solution = array_create(1, sizeof *solution, "a solution", err);
    if (solution != NULL) {
        *solution = (Solution){ .count = count, .bands = ROOM_BANDS, .error_bound = NAN };
        solution->radiosity = array_create(run.n, sizeof(double), "a solution", err);
        solution->irradiance = array_create(run.n, sizeof(double), "a solution", err);
        solution->direct = array_create(run.n, sizeof(double), "a solution", err);
    }
    const bool done = !error_is_set(err) && run_create(&run, err);
    if (done) {
        solve_all(&run, solution, monitor);
        fill_solution(&run, solution);
        solution->seconds = clock_seconds() - run.begun;
    }
    run_clear(&run);
    return done ? solution : solution_destroy(solution);
}
