/* SPDX-License-Identifier: BSD-3-Clause */
/* Options that say nothing beside others of the same line. */
#include "app/options_agree.h"

#include <assert.h>
#include <string.h>

#include "app/film.h"
#include "radiosity/solve.h"

static bool together(const Options *options, Error *err)
{
    if (options->output != NULL && options->json != NULL && strcmp(options->output, "-") == 0 &&
        strcmp(options->json, "-") == 0)
        return error_set(err, ERROR_USAGE, "-o - and --json - cannot share standard output");
    if (options_given(options, OPTION_PATCH_SIZE) && options_given(options, OPTION_PATCHES) &&
        !options->adapt)
        return error_set(err, ERROR_USAGE, "give --patch-size or --patches, not both, but for "
                         "--adapt, which takes the greatest size and the total");
    if (options->adapt && options->no_adapt)
        return error_set(err, ERROR_USAGE, "give --adapt or --no-adapt, not both");
    if (options->camera != NULL && options_given(options, OPTION_EYE))
        return error_set(err, ERROR_USAGE, "give --camera or --eye, not both");
    if (options_given(options, OPTION_TARGET) && !options_given(options, OPTION_EYE))
        return error_set(err, ERROR_USAGE, "--target belongs to --eye");
    if ((options->logarithmic || options->isolines) && options->false_colour == FILM_NONE)
        return error_set(err, ERROR_USAGE, "--log and --isolines belong to --false-colour");
    if (options->error > 0 && options_given(options, OPTION_ACCURACY) &&
        options->renderer != RENDERER_GATHER)
        return error_set(err, ERROR_USAGE, "paths have one error: give --error or --accuracy");
    if (options->light_groups && options->command != COMMAND_SOLVE &&
        options->command != COMMAND_RENDER && options->set.count == 0 && options->changes == NULL)
        return error_set(err, ERROR_USAGE, "--light-groups mixes lamps that --set or --changes "
                         "dims: give one of them");
    if (options->mix.count > 0 && (options->layer != NULL ||
                                   options->false_colour == FILM_ILLUMINANCE))
        return error_set(err, ERROR_USAGE, "--mix is of the picture's light: not with --layer or "
                         "--false-colour illuminance");
    if (options->layer != NULL && options->false_colour == FILM_ILLUMINANCE)
        return error_set(err, ERROR_USAGE, "--false-colour illuminance has a layer of its own: not "
                         "with --layer");
    const bool shutter = options_given(options, OPTION_SHUTTER);
    if (shutter && options_given(options, OPTION_TIME))
        return error_set(err, ERROR_USAGE, "give --time or --shutter, not both");
    if (shutter && (options_given(options, OPTION_CHECKPOINT) || options->resume != NULL))
        return error_set(err, ERROR_USAGE, "--checkpoint and --resume do not go with --shutter");
    if (shutter && options->factors != NULL)
        return error_set(err, ERROR_USAGE, "--factors holds those of one moment, not of --shutter");
    if (options->logarithmic && options_given(options, OPTION_RANGE) && !(options->range[0] > 0))
        return error_set(err, ERROR_USAGE, "--log needs a --range above 0");
    if (options_given(options, OPTION_UP) && !(vec3_length(options->up) > 0))
        return error_set(err, ERROR_USAGE, "--up must not be 0,0,0");
    return true;
}

/* What of an option another one must be for it to be read at all. */
typedef struct {
    OptionId    option;
    unsigned    commands; /* of these commands */
    bool      (*read)(const Options *options);
    const char *owner;
} Belonging;

static bool of_sor(const Options *o)
{
    return o->solver == SOLVER_SOR || o->compare;
}

static bool of_progressive(const Options *o)
{
    return o->solver == SOLVER_PROGRESSIVE || o->compare;
}

static bool of_hierarchical(const Options *o)
{
    return o->solver == SOLVER_HIERARCHICAL && !o->compare;
}

static bool of_importance(const Options *o)
{
    return o->importance;
}

static bool of_adapting(const Options *o)
{
    return !o->no_adapt;
}

static bool of_false_colour(const Options *o)
{
    return o->false_colour != FILM_NONE;
}

static bool of_plain_colour(const Options *o)
{
    return o->false_colour == FILM_NONE;
}

static bool of_difference(const Options *o)
{
    return o->output != NULL;
}

static bool of_perspective(const Options *o)
{
    return !options_given(o, OPTION_VIEW_HEIGHT);
}

static bool of_shutter(const Options *o)
{
    return options_given(o, OPTION_SHUTTER);
}

static bool of_one_solver(const Options *o)
{
    return !o->compare;
}

static bool belongings(const Options *options, Error *err)
{
    static const unsigned SOLVING = COMMAND_SOLVE | COMMAND_RENDER | COMMAND_MEASURE |
                                    COMMAND_BENCH;
    const Belonging rows[] = {
        { OPTION_RELAXATION, SOLVING, of_sor, "belongs to --solver sor" },
        { OPTION_OVERSHOOT, SOLVING, of_progressive, "belongs to --solver progressive" },
        { OPTION_NO_AMBIENT, SOLVING, of_progressive, "belongs to --solver progressive" },
        { OPTION_IMPORTANCE, SOLVING, of_hierarchical, "belongs to --solver hierarchical" },
        { OPTION_NO_LAST_GATHER, SOLVING, of_hierarchical, "belongs to --solver hierarchical" },
        { OPTION_CAMERA, COMMAND_SOLVE, of_importance, "belongs to --importance" },
        { OPTION_EYE, COMMAND_SOLVE, of_importance, "belongs to --importance" },
        { OPTION_FOV, COMMAND_SOLVE, of_importance, "belongs to --importance" },
        { OPTION_SOLVER, COMMAND_SOLVE, of_one_solver, "does not go with --compare, which runs "
          "them all" },
        { OPTION_LIGHT_CHECK, COMMAND_SOLVE, of_one_solver, "does not go with --compare" },
        { OPTION_LEAST_SIZE, SOLVING, of_adapting, "belongs to --adapt, not to --no-adapt" },
        { OPTION_RANGE, COMMAND_RENDER | COMMAND_DEVELOP, of_false_colour,
          "belongs to --false-colour" },
        { OPTION_RANGE, COMMAND_COMPARE, of_difference, "belongs to the difference that -o draws" },
        { OPTION_TONE, COMMAND_DEVELOP, of_plain_colour, "does not go with --false-colour" },
        { OPTION_EXPOSURE, COMMAND_DEVELOP, of_plain_colour, "does not go with --false-colour" },
        { OPTION_TIME_SAMPLES, COMMAND_RENDER, of_shutter, "belongs to --shutter" },
        { OPTION_FOV, COMMAND_RENDER, of_perspective, "and --view-height say the same twice" },
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (options_given(options, rows[i].option) &&
            (rows[i].commands & (unsigned)options->command) != 0 && !rows[i].read(options))
            return error_set(err, ERROR_USAGE, "%s %s",
                             options_table()[rows[i].option].name, rows[i].owner);
    return true;
}

/* Paths and plain rays make no patches and no solution: what is said of those would be ignored. */
static bool renderer_reads(const Options *options, Error *err)
{
    static const OptionId of_solutions[] = {
        OPTION_CHECKPOINT, OPTION_RESUME, OPTION_FACTORS, OPTION_SET, OPTION_CHANGES,
        OPTION_LIGHT_GROUPS, OPTION_TRACE, OPTION_PATCH_SIZE, OPTION_PATCHES, OPTION_ADAPT,
        OPTION_NO_ADAPT, OPTION_LEAST_SIZE, OPTION_RAYS, OPTION_LAMP_RAYS, OPTION_CLOSURE,
        OPTION_STORAGE, OPTION_SOLVER, OPTION_TOLERANCE, OPTION_MAX_ITERATIONS,
        OPTION_RELAXATION, OPTION_OVERSHOOT, OPTION_NO_AMBIENT, OPTION_GATHER_RAYS,
        OPTION_RECORD_RAYS, OPTION_IMPORTANCE, OPTION_NO_LAST_GATHER
    };
    char word[32];
    if (options->command != COMMAND_RENDER)
        return true;
    if (options_given(options, OPTION_DEPTH) && options->renderer != RENDERER_WHITTED)
        return error_set(err, ERROR_USAGE, "--depth belongs to --renderer whitted");
    if (options->renderer == RENDERER_GATHER)
        return true;
    if (options->renderer == RENDERER_WHITTED && (options_given(options, OPTION_ACCURACY) ||
                                                  options_given(options, OPTION_ERROR)))
        return error_set(err, ERROR_USAGE, "--renderer whitted has no error to be told or reached");
    if (options->renderer == RENDERER_WHITTED && options->diffuse)
        return error_set(err, ERROR_USAGE, "--renderer whitted is about mirrors and glass; "
                         "--diffuse leaves them out");
    value_word(options_table()[OPTION_RENDERER].words, options->renderer, word, sizeof word);
    if (options->false_colour == FILM_ILLUMINANCE)
        return error_set(err, ERROR_USAGE, "--false-colour illuminance is of a solution; "
                         "--renderer %s makes none", word);
    for (size_t i = 0; i < sizeof of_solutions / sizeof *of_solutions; i++) {
        if (!options_given(options, of_solutions[i]))
            continue;
        return error_set(err, ERROR_USAGE, "%s is of a solution; --renderer %s makes none",
                         options_table()[of_solutions[i]].name, word);
    }
    return true;
}

bool options_agree(const Options *options, Error *err)
{
    assert(options != NULL && err != NULL);
    return together(options, err) && renderer_reads(options, err) && belongings(options, err);
}
