/* SPDX-License-Identifier: BSD-3-Clause */
/* What draft, medium, high and final stand for. */
#include "app/quality.h"

#include <assert.h>

#include "base/parallel.h"

typedef struct {
    uint32_t patches, rays, lamp_rays, spp, gather_rays, point_rays;
    double   tolerance, accuracy;
} Level;

/* What a picture has of its own. Its patches and factors are those of a level, mostly of a coarser
 * one: they are seen a bounce away from the eye only. */
typedef struct {
    QualityLevel patches;
    uint32_t record_rays;
    uint32_t gather_rays; /* of the few camera rays that end where no record is near */
    uint32_t most;  /* samples of a pixel where noise decides */
    double   error; /* 0: spp for each pixel */
} Picture;

/* Each step takes about four times as long as the one before and halves the noise. Light is read
 * off the patches one bounce away from the eye, so they may be coarse; pixels may not be noisy.
 * The tolerance bounds the error of the energy balance; sweeps over stored links cost next to
 * nothing, so it is far below what rays can do. */
static const Level levels[] = {
    [QUALITY_DRAFT] = { 2500, 128, 32, 16, 2, 1024, 1e-4, 5e-4 },
    [QUALITY_MEDIUM] = { 10000, 256, 64, 64, 4, 4096, 1e-7, 1e-4 },
    [QUALITY_HIGH] = { 20000, 512, 128, 256, 4, 16384, 1e-8, 3e-5 },
    [QUALITY_FINAL] = { 40000, 1024, 256, 1024, 4, 65536, 1e-8, 1e-5 },
};

static const Picture pictures[] = {
    [QUALITY_DRAFT] = { QUALITY_DRAFT, 384, 16, 64, 0.02 },
    [QUALITY_MEDIUM] = { QUALITY_DRAFT, 1536, 16, 256, 0.008 },
    [QUALITY_HIGH] = { QUALITY_MEDIUM, 2048, 32, 1024, 0.004 },
    [QUALITY_FINAL] = { QUALITY_FINAL, 0, 4, 1024, 0 },
};

/* Whether the command gathers pictures: the window does when it is asked to. */
static bool gathers(const Options *options)
{
    return options->command == COMMAND_VIEW ||
           (options->command == COMMAND_RENDER && options->renderer == RENDERER_GATHER);
}

/* Whether pictures are made with records of indirect light. */
static bool has_records(const Options *options)
{
    const uint32_t rays = options_given(options, OPTION_RECORD_RAYS)
                              ? options->record_rays : pictures[options->quality].record_rays;
    return gathers(options) && rays > 0 && !(options->gather_rays > 0);
}

/* Whether that is all that patches are for: the window shows them. */
static bool uses_records(const Options *options)
{
    return options->command == COMMAND_RENDER && has_records(options);
}

/* By default only where the number of patches is free: who asks for a size means it. Factors that
 * are kept must serve other light as well, so they are those before any division. */
static bool adapts(const Options *options)
{
    const bool can = (options_table()[OPTION_ADAPT].commands & (unsigned)options->command) != 0;
    const bool by_default = options->quality >= QUALITY_MEDIUM && !(options->patch_size > 0) &&
                            !uses_records(options) &&
                            options->factors == NULL;
    return can && !options->no_adapt && (options->adapt || by_default);
}

static SurfaceOptions repair_options(const Options *options)
{
    const uint32_t repair = options->repair;
    return (SurfaceOptions){ .keep_apart = (repair >> REPAIR_WELD & 1) == 0,
                             .weld = options->weld,
                             .keep_duplicates = (repair >> REPAIR_DUPLICATES & 1) == 0,
                             .keep_junctions = (repair >> REPAIR_JUNCTIONS & 1) == 0,
                             .keep_nonmanifold = (repair >> REPAIR_NONMANIFOLD & 1) == 0,
                             .keep_winding = (repair >> REPAIR_WINDING & 1) == 0 };
}

/* Noise decides how many samples a pixel gets, unless their number was asked for and no error; and
 * records hold the indirect light, unless each camera ray shall gather. */
static void picture_settings(const Options *options, Settings *s)
{
    const Picture *picture = &pictures[options->quality];
    const bool     gather = gathers(options);
    s->error = gather && options->spp == 0 && options->gather_rays == 0 ? picture->error : 0;
    if (options->error > 0 && gather)
        s->error = options->error;
    if (options->error > 0 && !gather) /* paths know one error */
        s->accuracy = options->error;
    if (options->spp == 0 && s->error > 0)
        s->spp = picture->most;
    if (!has_records(options))
        return;
    s->record_rays = options_given(options, OPTION_RECORD_RAYS) ? options->record_rays
                                                                : picture->record_rays;
    s->gather_rays = picture->gather_rays;
}

Settings quality_settings(const Options *options)
{
    assert(options->quality >= QUALITY_DRAFT && options->quality <= QUALITY_FINAL);
    const QualityLevel own = (QualityLevel)options->quality;
    const Level *level = &levels[uses_records(options) ? pictures[own].patches : own];
    const bool points = options->command == COMMAND_MEASURE ||
                        options->command == COMMAND_FACTORS;
    Settings s = { .patches = level->patches, .rays = level->rays, .lamp_rays = level->lamp_rays,
                   .closure = (Closure)options->closure, .solver = (Solver)options->solver,
                   .tolerance = level->tolerance, .max_iterations = options->max_iterations,
                   .spp = level->spp, .threads = options->threads, .seed = options->seed,
                   .gather_rays = points ? level->point_rays : level->gather_rays };
    s.tree = options->tree == TREE_HIGH || (options->tree == TREE_AUTO && own >= QUALITY_HIGH)
                 ? BVH_HIGH
                 : BVH_MEDIUM;
    if (options->solver == SOLVER_COUNT) { /* the word after those of solvers with links */
        s.stochastic = true;
        s.solver = SOLVER_GAUSS_SEIDEL;
    }
    s.clusters = options->solver == SOLVER_HIERARCHICAL;
    s.stochastic = s.stochastic || s.clusters;
    if (options->patches > 0)
        s.patches = options->patches;
    if (options->patch_size > 0) {
        s.patch_size = options->patch_size;
        s.patches = options->patches;
    }
    s.accuracy = options->accuracy > 0                 ? options->accuracy
                 : options->command == COMMAND_FACTORS ? level->accuracy
                                                       : 0;
    s.adapt = adapts(options) && !s.stochastic;
    s.least_size = options->least_size;
    s.repair = repair_options(options);
    s.imprint = (ImprintOptions){ .keep_whole = (options->repair >> REPAIR_CUTS & 1) == 0,
                                  .keep_covered = (options->repair >> REPAIR_COVERED & 1) == 0 };
    if (options->rays > 0) {
        s.rays = options->rays;
        s.lamp_rays = options->rays / 4 > 0 ? options->rays / 4 : 1;
    }
    if (options->lamp_rays > 0)
        s.lamp_rays = options->lamp_rays;
    if (options->tolerance > 0)
        s.tolerance = options->tolerance;
    if (options->spp > 0)
        s.spp = options->spp;
    else if (options->renderer == RENDERER_WHITTED)
        s.spp = 1; /* through the pixels' centres */
    if (options->gather_rays > 0)
        s.gather_rays = options->gather_rays;
    picture_settings(options, &s);
    return s;
}

static void print_choice(FILE *out, const Options *options, OptionId id, int value)
{
    const OptionRow *row = &options_table()[id];
    char word[32];
    if ((row->commands & (unsigned)options->command) == 0)
        return;
    value_word(row->words, value, word, sizeof word);
    fprintf(out, "%s %s\n", row->name + 2, word);
}

static void print_repair(FILE *out, const Options *options)
{
    const OptionRow *row = &options_table()[OPTION_REPAIR];
    char word[32];
    if ((row->commands & (unsigned)options->command) == 0)
        return;
    fprintf(out, "%s ", row->name + 2);
    bool any = false;
    for (int k = 0; k < REPAIR_COUNT; k++)
        if ((options->repair >> k & 1) != 0) {
            value_word(row->words, k, word, sizeof word);
            fprintf(out, "%s%s", any ? "," : "", word);
            any = true;
        }
    fputs(any ? "\n" : "none\n", out);
}

static void print_value(FILE *out, const Options *options, OptionId id, double value)
{
    const OptionRow *row = &options_table()[id];
    if ((row->commands & (unsigned)options->command) != 0 && value > 0)
        fprintf(out, "%s %.12g\n", row->name + 2, value);
}

static void print_picture(FILE *out, const Options *options, const Settings *s)
{
    if ((options_table()[OPTION_RECORD_RAYS].commands & (unsigned)options->command) != 0)
        fprintf(out, "record-rays %u\n", s->record_rays);
    print_value(out, options, OPTION_ERROR, s->error);
}

void quality_print(FILE *out, const Options *options, const Settings *s)
{
    print_choice(out, options, OPTION_QUALITY, options->quality);
    print_value(out, options, OPTION_PATCH_SIZE, s->patch_size);
    print_value(out, options, OPTION_PATCHES, s->patches);
    if ((options_table()[OPTION_ADAPT].commands & (unsigned)options->command) != 0)
        fprintf(out, "%s\n", s->adapt ? "adapt" : "no-adapt");
    print_value(out, options, OPTION_LEAST_SIZE, s->least_size);
    print_repair(out, options);
    print_value(out, options, OPTION_WELD, options->weld);
    print_choice(out, options, OPTION_TREE, s->tree == BVH_HIGH ? TREE_HIGH : TREE_MEDIUM);
    print_value(out, options, OPTION_RAYS, s->rays);
    print_value(out, options, OPTION_LAMP_RAYS, s->lamp_rays);
    print_value(out, options, OPTION_ACCURACY, s->accuracy);
    print_choice(out, options, OPTION_CLOSURE, (int)s->closure);
    print_choice(out, options, OPTION_STORAGE, options->storage);
    print_choice(out, options, OPTION_SOLVER, s->stochastic && !s->clusters ? SOLVER_COUNT
                                                                              : (int)s->solver);
    print_value(out, options, OPTION_TOLERANCE, s->tolerance);
    print_value(out, options, OPTION_MAX_ITERATIONS, s->max_iterations);
    print_value(out, options, OPTION_SPP, s->spp);
    print_value(out, options, OPTION_GATHER_RAYS, s->gather_rays);
    print_picture(out, options, s);
    print_choice(out, options, OPTION_EMIT, options->emit);
    print_choice(out, options, OPTION_SIDES, options->sides);
    print_choice(out, options, OPTION_UNITS, options->units);
    print_choice(out, options, OPTION_LIGHT, options->light);
    print_value(out, options, OPTION_UNIT_M, options->unit_m);
    fprintf(out, "threads %u\nseed %u\n", parallel_threads(s->threads), s->seed);
}
