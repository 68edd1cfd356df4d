/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/stochastic.c -- batches of shots, until two halves of them agree. */
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

/* Two pairs tell the error better than one. */
enum { BATCHES_LEAST = 4 };

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
    float    *noise;                     /* [patches]  variance of direct power */
    EvenTree  tree;
    size_t    n;
    uint32_t  batches;
    double    quantum;                   /* of power that a ray carries after a reflection */
    double    escaped[ROOM_BANDS];       /* of all batches */
    double    begun;
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
    run->noise = array_create(run->shooter.count, sizeof *run->noise, what, err);
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        *all[k] = array_create(run->n, sizeof **all[k], what, err);
    return !error_is_set(err) && shooter_create(&run->shooter, err) &&
           (run->options->apart ||
            even_tree_create(run->shooter.room, run->shooter.places->links->area,
                             run->shooter.threads, &run->tree, err));
}

static void run_clear(Run *run)
{
    double *all[] = { run->power, run->left, run->arrived, run->direct[0], run->direct[1],
                      run->indirect[0], run->indirect[1], run->even[0], run->even[1], run->spare[0],
                      run->spare[1] };
    array_free(run->noise);
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

static double luminance(const double *v)
{
    return rgb_luminance(rgb(v[0], v[1], v[2]));
}

/* Evens out, light straight from lamps by how much their visibility rays differed. */
static void even_out_all(Run *run)
{
    const Shooter *s = &run->shooter;
    const double *area = s->places->links->area, rays = (double)s->samples * run->batches;
    for (unsigned h = 0; h < 2; h++) {
        memcpy(run->even[h], run->direct[h], run->n * sizeof *run->even[h]);
        memcpy(run->spare[h], run->indirect[h], run->n * sizeof *run->spare[h]);
    }
    for (uint32_t i = 0; i < s->count; i++)
        run->noise[i] = (float)fmax(0, s->square[i] - s->seen[i] * (double)s->seen[i] / rays);
    if (!run->options->apart)
        even_tree_apply(&run->tree, area, 0, run->noise, run->even);
    if (!run->options->apart && run->quantum > 0)
        run->report->groups = even_tree_apply(&run->tree, area, run->quantum, NULL, run->spare);
    for (unsigned h = 0; h < 2; h++)
        for (size_t k = 0; k < run->n; k++)
            run->even[h][k] += run->spare[h][k];
}

/* How far the two halves are apart. */
static double estimate_error(Run *run)
{
    double off = 0, sum = 0, areas = 0;
    even_out_all(run);
    for (size_t k = 0; k < run->n; k += ROOM_BANDS) {
        const double area = area_of(run, k);
        if (!(area > 0))
            continue;
        const double a = luminance(&run->even[0][k]), b = luminance(&run->even[1][k]);
        off += (a - b) * (a - b) / area;
        sum += a + b;
        areas += area;
    }
    return sum > 0 ? sqrt(off * areas) / sum : 0;
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

/* --- all of it -------------------------------------------------------------------------------- */

static void fill_solution(Run *run, Solution *solution)
{
    const SolveProblem *p = run->shooter.problem;
    for (size_t k = 0; k < run->n; k++) {
        const double area = area_of(run, k);
        const double power = run->even[0][k] + run->even[1][k];
        solution->irradiance[k] = area > 0 ? power / run->batches / area : 0;
        solution->radiosity[k] = p->emission[k] + p->reflectance[k] * solution->irradiance[k];
    }
    solution->unshot = solution->residual = unshot_share(run);
    solution->iterations = run->batches;
    for (unsigned b = 0; b < ROOM_BANDS; b++)
        run->report->escaped[b] = run->escaped[b] / run->batches;
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
    const SolveStep step = { .step = run->batches, .seconds = clock_seconds() - run->begun,
                             .residual = run->report->error, .unshot = solution->unshot,
                             .error_bound = NAN, .radiosity = solution->radiosity,
                             .passes = (double)count_rays(run) / run->shooter.count };
    run->options->trace(run->options->trace_user, &step);
}

static void run_batches(Run *run, Solution *solution, const Monitor *monitor)
{
    const StochasticOptions *o = run->options;
    const double tolerance = o->tolerance > 0 ? o->tolerance : DEFAULT_TOLERANCE;
    const double most = (double)(o->rays > 0 ? o->rays : 256) * run->shooter.count;
    bool stopped = false, reached = false, spent = false;
    while (!reached && !spent && !stopped) {
        run_batch(run);
        run_batch(run);
        run->report->error = estimate_error(run);
        reached = run->batches >= BATCHES_LEAST && run->report->error <= tolerance;
        const double rays = (double)count_rays(run);
        spent = rays + 2 * rays / run->batches > most;
        stopped = monitor_stop(monitor);
        const double squared = tolerance / fmax(run->report->error, tolerance);
        tell(run, solution, fmin(1, fmax(squared * squared, rays / most)), monitor);
    }
    if (run->quantum > 0) {
        double *const swap = run->left;
        run->left = run->power;
        run->power = swap;
        reflect_all(run, run->indirect[0], LEFT_AT_LAST * run->quantum * FIRST_SHOTS
                    * run->shooter.count, REFLECTIONS_MOST);
        run->report->error = estimate_error(run);
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
    }
    const bool done = !error_is_set(err) && run_create(&run, err);
    if (done) {
        run_batches(&run, solution, monitor);
        fill_solution(&run, solution);
        solution->seconds = clock_seconds() - run.begun;
    }
    run_clear(&run);
    return done ? solution : solution_destroy(solution);
}
