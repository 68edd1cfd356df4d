/* SPDX-License-Identifier: BSD-3-Clause */
/* Solve roughly, divide the patches that are worst off, cast their parts, again. */
#include "app/pipeline_adapt.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "app/saving.h"
#include "base/array.h"
#include "radiosity/mirrors.h"
#include "radiosity/adapt.h"

/* Patches at the beginning for one wanted. Where light changes little they stay as they are;
 * coarser ones would have the shapes that happen to fit, not square ones. */
static const double START_SHARE = 1.0 / 4;

/* A pass divides patches whose error is above this many times the mean; the last one as many as are
 * wanted. Where a few patches have most of the error it takes many passes. */
static const double WORTH_DIVIDING = 4, WORTH_AT_LAST = 1e-3;

/* Share of the patches still wanted that a pass may add, but for the last. */
static const double PASS_SHARE = 0.5;

/* In between, light need not be known better than this, in power: far below what patches that large
 * leave out. */
static const double ROUGH_TOLERANCE = 1e-3;

/* Neighbours of divided patches may have to be divided too: how many is found by trying. */
enum { SPLIT_TRIES = 4 };
static const double COUNT_TOLERANCE = 0.05;

/* Shortest edge, of the greatest one, when none is given. */
static const double LEAST_SHARE = 1.0 / 64;

typedef struct {
    Pipeline    *pipeline;
    AdaptReport *report;
    Monitor      monitor;    /* progress over all passes */
    double       begin, end; /* share of all work of the pass under way */
    const LinksOptions *links;
    uint32_t     wanted;
    double       least_size;
} Adaption;

/* What one pass works with; freed after it. */
typedef struct {
    Links        *closed;
    Direct        direct;
    double       *emission, *reflectance;
    Solution     *solution;
    double       *error;     /* [patches] */
    uint8_t      *split;     /* [patches] */
} Pass;

uint32_t pipeline_adapt_start(const Settings *settings)
{
    const double start = ceil(START_SHARE * settings->patches);
    return start > 1 ? (uint32_t)start : 1;
}

static void pass_progress(void *user, const Progress *progress)
{
    const Adaption *a = user;
    Progress all = *progress;
    all.done = a->begin + (a->end - a->begin) * progress->done;
    monitor_progress(&a->pipeline->session->monitor, &all);
}

static bool pass_stop(void *user)
{
    const Adaption *a = user;
    return monitor_stop(&a->pipeline->session->monitor);
}

/* Where a stop came in the middle of a pass, what was there before it is what there is. */
static bool stopped(Adaption *a, Error *err)
{
    Session *session = a->pipeline->session;
    if (err->code != ERROR_STOPPED || session->broken || session->abrupt)
        return false;
    saving_tick(a->pipeline->saving);
    *err = (Error){ 0 };
    session->hurry = true;
    a->report->stopped = true;
    monitor_warn(&session->monitor, "hurried", session->options.scene, "%s: finishing roughly",
                 session_stop_reason());
    return true;
}

/* --- light in between ------------------------------------------------------------------------- */

static void pass_clear(Pass *pass)
{
    links_destroy(pass->closed);
    array_free(pass->direct.irradiance);
    array_free(pass->emission);
    array_free(pass->reflectance);
    solution_destroy(pass->solution);
    array_free(pass->error);
    array_free(pass->split);
}

static bool set_problem(const Room *room, Pass *pass, Error *err)
{
    const uint32_t count = room->patches->count;
    const size_t n = (size_t)count * ROOM_BANDS;
    pass->emission = array_create(n, sizeof *pass->emission, "emission", err);
    pass->reflectance = array_create(n, sizeof *pass->reflectance, "reflectance", err);
    for (uint32_t i = 0; i < count && !error_is_set(err); i++) {
        Rgb e, rho;
        mirrors_problem(room, i, &e, &rho);
        memcpy(pass->emission + (size_t)ROOM_BANDS * i, (double[]){ e.r, e.g, e.b },
               sizeof(double[ROOM_BANDS]));
        memcpy(pass->reflectance + (size_t)ROOM_BANDS * i, (double[]){ rho.r, rho.g, rho.b },
               sizeof(double[ROOM_BANDS]));
    }
    return !error_is_set(err);
}

static bool light_roughly(Adaption *a, Pass *pass, Error *err)
{
    Pipeline *pipeline = a->pipeline;
    const Settings *settings = &pipeline->session->settings;
    const Monitor quiet = { .user = a, .stop = pass_stop };
    const DirectOptions direct = { .seed = settings->seed, .threads = settings->threads };
    const SolveOptions so = { .tolerance = ROUGH_TOLERANCE, .threads = settings->threads };
    pass->closed = links_close(pipeline->links, pipeline->patches, CLOSURE_ROWS, settings->threads,
                               &quiet, err);
    if (pass->closed == NULL || !set_problem(&pipeline->room, pass, err) ||
        !direct_create(&pipeline->room, pass->closed, &direct, &pass->direct, &quiet, err))
        return false;
    const SolveProblem problem = { .bands = ROOM_BANDS, .emission = pass->emission,
                                   .reflectance = pass->reflectance,
                                   .received = pass->direct.irradiance };
    pass->solution = solve(pass->closed, &problem, &so, &quiet, err);
    return pass->solution != NULL;
}

/* Errors of all patches, and what they come to in all. */
static bool find_errors(Adaption *a, Pass *pass, double *relative, Error *err)
{
    const Pipeline *pipeline = a->pipeline;
    const Settings *settings = &pipeline->session->settings;
    const Patches *patches = pipeline->patches;
    const Monitor quiet = { .user = a, .stop = pass_stop };
    const AdaptOptions options = { .least_size = a->least_size, .row_rays = settings->rays,
                                   .seed = settings->seed + a->report->passes,
                                   .threads = settings->threads };
    pass->error = array_create(patches->count, sizeof *pass->error, "errors", err);
    pass->split = array_create(patches->count, sizeof *pass->split, "errors", err);
    if (pass->error == NULL || pass->split == NULL ||
        !adapt_errors(&pipeline->room, pass->closed, pass->solution->irradiance, &options,
                      pass->error, &quiet, err))
        return false;
    double squares = 0, light = 0, area = 0;
    for (uint32_t i = 0; i < patches->count; i++) {
        const double *h = &pass->solution->irradiance[(size_t)i * ROOM_BANDS];
        squares += pass->error[i] * pass->error[i] * patches->area[i];
        light += rgb_luminance(rgb(h[0], h[1], h[2])) * pass->closed->area[i];
        area += pass->closed->area[i];
    }
    *relative = light > 0 ? sqrt(squares * area) / light : 0;
    return true;
}

/* --- dividing --------------------------------------------------------------------------------- */

/* A merged patch gives way to two: to keep up with cells, which give way to four, its parts are
 * divided once more. */
static bool divide_parts(const Pipeline *pipeline, const uint8_t *split, Patches **finer,
                         uint32_t **parent, Error *err)
{
    const Patches *old = pipeline->patches, *parts = *finer;
    uint8_t *again = array_create(parts->count, 1, "patches to divide", err);
    uint32_t *within = NULL, count = 0;
    Patches *finest = NULL;
    for (uint32_t i = 0; again != NULL && i < parts->count; i++) {
        const uint32_t p = (*parent)[i];
        again[i] = split[p] != 0 && old->first_piece[p + 1] > old->first_piece[p] &&
                   parts->first_piece[i + 1] > parts->first_piece[i];
        count += again[i];
    }
    if (count > 0)
        finest = patches_split(parts, pipeline->surfaces, again, &within, err);
    if (finest != NULL) {
        for (uint32_t i = 0; i < finest->count; i++)
            within[i] = (*parent)[within[i]];
        patches_destroy(*finer);
        array_free(*parent);
        *finer = finest;
        *parent = within;
    }
    array_free(again);
    return !error_is_set(err);
}

/* Divides the patches that an earlier run had chosen. */
static bool divide_as(const Pipeline *pipeline, const uint8_t *split, Patches **finer,
                      uint32_t **parent, Error *err)
{
    *finer = patches_split(pipeline->patches, pipeline->surfaces, split, parent, err);
    return *finer != NULL && divide_parts(pipeline, split, finer, parent, err);
}

bool pipeline_adapt_again(Pipeline *pipeline, const uint8_t *split, Error *err)
{
    Patches *finer = NULL;
    uint32_t *parent = NULL;
    const bool done = divide_as(pipeline, split, &finer, &parent, err);
    array_free(parent);
    if (!done) {
        patches_destroy(finer);
        return false;
    }
    patches_destroy(pipeline->patches);
    pipeline->room.patches = pipeline->patches = finer;
    return true;
}

static bool can_divide(const Adaption *a, uint32_t i)
{
    const Pipeline *pipeline = a->pipeline;
    const Patches *p = pipeline->patches;
    const bool merged = p->first_piece[i + 1] > p->first_piece[i];
    return pipeline->links->area[i] > 0 && (merged || p->cell[i].level < PATCH_LEVELS) &&
           patches_extent(p, pipeline->surfaces, i) >= 2 * a->least_size;
}

/* Patches without an error that rays could tell come after all that have one, the largest first:
 * who asks for so many patches is to get them. */
static void errors_by_size(const Adaption *a, Pass *pass)
{
    const Patches *patches = a->pipeline->patches;
    double least = 0, largest = 0;
    for (uint32_t i = 0; i < patches->count; i++) {
        const double gain = pass->error[i] * pass->error[i] * patches->area[i];
        if (gain > 0 && (least == 0 || gain < least))
            least = gain;
        largest = fmax(largest, patches->area[i]);
    }
    least = least > 0 ? least : 1;
    for (uint32_t i = 0; i < patches->count; i++)
        if (!(pass->error[i] > 0) && can_divide(a, i))
            pass->error[i] = sqrt(least * patches->area[i]) / largest;
}

/* Divides the worst patches so that about `goal` result, and at most about as many as are wanted in
 * all. Where errors tell of too few, size does. *finer is NULL when none can be divided. */
static bool divide(Adaption *a, Pass *pass, double goal, double worth, Patches **finer,
                   uint32_t **parent, Error *err)
{
    const Pipeline *pipeline = a->pipeline;
    const double count = pipeline->patches->count, more = goal - count;
    const bool last = worth <= WORTH_AT_LAST;
    double aim = more;
    bool filled = false;
    for (int k = 0; k < SPLIT_TRIES; k++) {
        uint32_t chosen = 0;
        if (!adapt_choose(&pipeline->room, pass->error, (uint32_t)(count + aim),
                          filled ? 0 : worth, pass->split, &chosen, err))
            return false;
        if (chosen == 0) {
            if (filled)
                return true;
            filled = true;
            errors_by_size(a, pass);
            continue;
        }
        *finer = patches_destroy(*finer);
        *parent = array_free(*parent);
        *finer = patches_split(pipeline->patches, pipeline->surfaces, pass->split, parent, err);
        if (*finer == NULL || !divide_parts(pipeline, pass->split, finer, parent, err) ||
            !saving_pass(pipeline->saving, pass->split, err))
            return false;
        const double got = (*finer)->count - count;
        if (last && !filled && count + got < (1 - COUNT_TOLERANCE) * a->wanted) {
            filled = true;
            errors_by_size(a, pass);
            continue;
        }
        if (count + got <= (1 + COUNT_TOLERANCE) * a->wanted)
            return true;
        aim *= more / got;
    }
    return true;
}

/* Takes the finer patches with the rows of their parts in place of the coarser ones. */
static bool take(Adaption *a, Patches *finer, const uint32_t *parent, Error *err)
{
    Pipeline *pipeline = a->pipeline;
    LinksOptions lo = *a->links;
    lo.kept = saving_rows(pipeline->saving);
    Room room = pipeline->room;
    room.patches = finer;
    Links *links = links_refine(pipeline->links, &room, parent, &lo, &a->monitor, err);
    if (links == NULL) {
        patches_destroy(finer);
        return false;
    }
    links_destroy(pipeline->links);
    patches_destroy(pipeline->patches);
    pipeline->links = links;
    pipeline->patches = finer;
    pipeline->room = room;
    return true;
}

/* For who looks on. */
static bool watch(const Adaption *a, const Pass *pass)
{
    const Pipeline *pipeline = a->pipeline;
    if (pipeline->watch != NULL)
        pipeline->watch(pipeline->watch_user, pass->closed, pass->solution, pass->error);
    return true;
}

/* One pass; *more is false when there is nothing left to divide. */
static bool run_pass(Adaption *a, double goal, double worth, bool *more, Error *err)
{
    AdaptReport *report = a->report;
    Pass pass = { 0 };
    Patches *finer = NULL;
    uint32_t *parent = NULL;
    const double begin = progress_now();
    const uint8_t *chosen = saving_chosen(a->pipeline->saving);
    bool done;
    if (chosen != NULL)
        done = divide_as(a->pipeline, chosen, &finer, &parent, err);
    else
        done = light_roughly(a, &pass, err) &&
               find_errors(a, &pass, &report->error[report->passes], err) && watch(a, &pass) &&
               divide(a, &pass, goal, worth, &finer, &parent, err);
    report->seconds += progress_now() - begin;
    *more = done && finer != NULL && finer->count > a->pipeline->patches->count;
    pass_clear(&pass);
    if (*more)
        done = take(a, finer, parent, err);
    else
        patches_destroy(finer);
    array_free(parent);
    if (done && *more)
        report->patches[++report->passes] = a->pipeline->patches->count;
    return done;
}

bool pipeline_adapt(Pipeline *pipeline, const LinksOptions *links, AdaptReport *report, Error *err)
{
    assert(pipeline->links != NULL && pipeline->patches != NULL);
    const Settings *settings = &pipeline->session->settings;
    if (report->patches[0] == 0)
        report->patches[0] = pipeline->patches->count;
    const uint32_t start = report->patches[0];
    Adaption a = { .pipeline = pipeline, .report = report, .links = links,
                   .least_size = settings->least_size, .wanted = settings->patches };
    a.monitor = pipeline->session->monitor;
    a.monitor.user = &a;
    a.monitor.progress = pass_progress;
    a.monitor.stop = pass_stop;
    a.monitor.warn = NULL;
    if (a.wanted == 0)
        a.wanted = (uint32_t)(start / START_SHARE);
    if (!(a.least_size > 0))
        a.least_size = LEAST_SHARE * pipeline->patches->size;
    bool more = true;
    for (unsigned k = report->passes + 1; more && k <= ADAPT_PASSES; k++) {
        const double count = pipeline->patches->count;
        const bool last = k == ADAPT_PASSES;
        const double goal = count + (last ? 1 : PASS_SHARE) * (a.wanted - count);
        if (count >= (1 - COUNT_TOLERANCE) * a.wanted)
            break;
        a.begin = count / a.wanted;
        a.end = goal / a.wanted;
        if (!run_pass(&a, goal, last ? WORTH_AT_LAST : WORTH_DIVIDING, &more, err)) {
            if (!stopped(&a, err))
                return false;
            more = false;
        }
    }
    return true;
}
