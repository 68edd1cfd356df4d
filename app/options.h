/* SPDX-License-Identifier: BSD-3-Clause */
/* app/options.h -- the command line: one table of options, parsed into one struct.
 *
 * Zero in a field means "not given"; quality.h fills in what the chosen quality says.
 */
#ifndef APP_OPTIONS_H
#define APP_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "base/error.h"
#include "math/vec3.h"

/* One bit each, so that an option can say where it belongs. */
typedef enum {
    COMMAND_NONE = 0,
    COMMAND_RENDER = 1 << 0,
    COMMAND_SOLVE = 1 << 1,
    COMMAND_FACTORS = 1 << 2,
    COMMAND_MEASURE = 1 << 3,
    COMMAND_CHECK = 1 << 4,
    COMMAND_VALIDATE = 1 << 5,
    COMMAND_BENCH = 1 << 6,
    COMMAND_COMPARE = 1 << 7,
    COMMAND_DEVELOP = 1 << 8,
    COMMAND_VIEW = 1 << 12
} Command;

/* The order of these is the order of the words in the option's table row. */
typedef enum { QUALITY_DRAFT, QUALITY_MEDIUM, QUALITY_HIGH, QUALITY_FINAL } QualityLevel;
typedef enum { PROGRESS_AUTO, PROGRESS_PLAIN, PROGRESS_JSON, PROGRESS_NONE } ProgressStyle;
typedef enum { BY_GROUP, BY_MATERIAL, BY_PATCH } FactorsBy;
typedef enum { RENDERER_GATHER, RENDERER_PATH, RENDERER_WHITTED } Renderer;
typedef enum { EXCHANGE_NONE, EXCHANGE_GEBHART, EXCHANGE_HOTTEL, EXCHANGE_FLUX } ExchangeTable;
typedef enum { STORAGE_32, STORAGE_16 } StorageBits;
typedef enum { UNITS_PHOTOMETRIC, UNITS_RADIOMETRIC } Units;
typedef enum { TREE_AUTO, TREE_MEDIUM, TREE_HIGH } TreeChoice;
typedef enum { KEEP_AUTO, KEEP_FLAT, KEEP_REFERENCES } InstancesChoice;
typedef enum { USE_AUTO, USE_FRONT, USE_BOTH } UseSides;
/* The order of the words of --repair. */
typedef enum {
    REPAIR_WELD,
    REPAIR_DUPLICATES,
    REPAIR_JUNCTIONS,
    REPAIR_NONMANIFOLD,
    REPAIR_WINDING,
    REPAIR_CUTS,
    REPAIR_COVERED,
    REPAIR_COUNT
} RepairBit;

typedef enum {
    OPTION_OUTPUT,
    OPTION_JSON,
    OPTION_QUALITY,
    OPTION_PRINT_CONFIG,
    OPTION_THREADS,
    OPTION_SEED,
    OPTION_PROGRESS,
    OPTION_MAX_MEMORY,
    OPTION_TIME_LIMIT,
    OPTION_PATCH_SIZE,
    OPTION_PATCHES,
    OPTION_ADAPT,
    OPTION_NO_ADAPT,
    OPTION_LEAST_SIZE,
    OPTION_TREE,
    OPTION_REPAIR,
    OPTION_WELD,
    OPTION_INSTANCES,
    OPTION_TIME,
    OPTION_RAYS,
    OPTION_LAMP_RAYS,
    OPTION_ACCURACY,
    OPTION_CLOSURE,
    OPTION_STORAGE,
    OPTION_FACTORS,
    OPTION_SOLVER,
    OPTION_TOLERANCE,
    OPTION_MAX_ITERATIONS,
    OPTION_TRACE,
    OPTION_RELAXATION,
    OPTION_OVERSHOOT,
    OPTION_NO_AMBIENT,
    OPTION_IMPORTANCE,
    OPTION_NO_LAST_GATHER,
    OPTION_COMPARE,
    OPTION_LIGHT_CHECK,
    OPTION_SET,
    OPTION_CHANGES,
    OPTION_LIGHT_GROUPS,
    OPTION_CHECKPOINT,
    OPTION_RESUME,
    OPTION_SIZE,
    OPTION_SPP,
    OPTION_GATHER_RAYS,
    OPTION_RECORD_RAYS,
    OPTION_ERROR,
    OPTION_EXPOSURE,
    OPTION_TONE,
    OPTION_FALSE_COLOUR,
    OPTION_RANGE,
    OPTION_LOG,
    OPTION_ISOLINES,
    OPTION_LAYER,
    OPTION_MIX,
    OPTION_CROP,
    OPTION_PIXEL_FILTER,
    OPTION_CAMERA,
    OPTION_EYE,
    OPTION_TARGET,
    OPTION_UP,
    OPTION_FOV,
    OPTION_PROJECTION,
    OPTION_VIEW_HEIGHT,
    OPTION_APERTURE,
    OPTION_FOCUS,
    OPTION_SHUTTER,
    OPTION_TIME_SAMPLES,
    OPTION_DIFFUSE,
    OPTION_RENDERER,
    OPTION_DEPTH,
    OPTION_BY,
    OPTION_ROWS,
    OPTION_ERRORS,
    OPTION_EXCHANGE,
    OPTION_EMISSIVITY,
    OPTION_TEMPERATURE,
    OPTION_SURROUNDINGS,
    OPTION_POINTS,
    OPTION_LIGHT,
    OPTION_EMIT,
    OPTION_SIDES,
    OPTION_UNITS,
    OPTION_UNIT_M,
    OPTION_FILTER,
    OPTION_LAMP,
    OPTION_SAMPLES,
    OPTION_CONSTANT,
    OPTION_SCRIPT,
    OPTION_SCREENSHOT,
    OPTION_FRAMES,
    OPTION_RATE,
    OPTION_NO_PANELS,
    OPTION_LIST_BINDINGS,
    OPTION_HELP,
    OPTION_COUNT
} OptionId;

/* An option that may be given several times. */
enum { TEXTS_MOST = 64 };
typedef struct {
    const char *text[TEXTS_MOST];
    uint32_t    count;
} TextList;

typedef struct Options {
    Command     command;
    const char *scene;       /* NULL: none given; compare: the reference */
    const char *other;       /* compare: the picture */
    bool        given[OPTION_COUNT]; /* it was on the command line */
    const char *output, *json, *camera, *points, *filter, *trace, *emissivity, *temperature;
    const char *resume;
    const char *layer;       /* develop, compare: of the EXR; NULL: R G B */
    TextList    mix;         /* develop: factors of light groups */
    const char *factors;     /* file of factors as cast */
    const char *rows;        /* file of what rows sum to */
    const char *errors;      /* file of standard errors */
    int         quality, progress, closure, storage, solver, by, exchange, emit, sides, units;
    int         light;
    int         instances;   /* InstancesChoice */
    int         tree;        /* TreeChoice */
    int         tone;        /* ToneCurve */
    int         false_colour; /* FilmQuantity */
    int         projection;  /* Projection */
    int         pixel_filter; /* PixelFilter */
    bool        logarithmic, isolines;
    double      range[2];    /* of false colours; only when given */
    double      crop[4];     /* left, top, right, bottom; only when given */
    double      view_height, aperture, focus;
    bool        print_config, diffuse, help, adapt, no_adapt, constant;
    bool        importance, no_last_gather;
    bool        overshoot, no_ambient, compare, light_groups;
    const char *changes;     /* file of changes */
    const char *script, *screenshot; /* view */
    uint32_t    frames;      /* view: how many; 0: until it is closed */
    double      rate;        /* view: frames a second; 0: as they are needed */
    bool        no_panels, list_bindings;
    TextList    set;         /* changes */
    int         renderer;    /* Renderer */
    uint32_t    depth;       /* of RENDERER_WHITTED; 0: not given */
    uint32_t    repair;      /* bit RepairBit: do it */
    uint32_t    light_check[2]; /* patches, rays from each in each half */
    uint32_t    samples;     /* compare: points of a solution; 0: not given */
    uint32_t    threads, seed, patches, rays, lamp_rays, max_iterations, spp, gather_rays;
    uint32_t    record_rays; /* meaningful only when given: 0 is a value */
    double      error;       /* of pixels, relative; 0: not given */
    uint64_t    max_memory;  /* bytes */
    double      time_limit;  /* seconds */
    double      time;        /* of the scene */
    double      shutter[2];  /* opens, closes; only when given */
    uint32_t    time_samples; /* 0: not given */
    double      checkpoint;  /* seconds between two; only when given */
    double      accuracy;    /* of factors between groups, of light; 0: not given */
    double      relaxation;  /* of sor; 0: not given */
    double      patch_size, least_size, weld, surroundings, tolerance, fov, unit_m, lamp;
    double      exposure;    /* EV; meaningful only when exposure_set */
    bool        exposure_set;
    int         size[2];     /* width, height */
    Vec3        eye, target, up;
    int         argc;        /* the whole command line, for records */
    char      **argv;
} Options;

typedef enum {
    KIND_FLAG,     /* bool */
    KIND_TEXT,     /* const char * */
    KIND_TEXTS,    /* TextList, one more each time */
    KIND_COUNT,    /* uint32_t within low..high */
    KIND_COUNTS,   /* uint32_t[2]: 4000 or 4000:512, both above 0, the first no more than high */
    KIND_NUMBER,   /* double within low..high */
    KIND_SHARE,    /* the same: 0.01 or 1% */
    KIND_BYTES,    /* uint64_t: 512MB */
    KIND_SECONDS,  /* double: 30s 5min */
    KIND_CHOICE,   /* int: position in the list of words */
    KIND_SET,      /* uint32_t, bit k: word k of the list is in it: all,-winding */
    KIND_PIXELS,   /* int[2]: 640x480 */
    KIND_VECTOR,   /* Vec3: x,y,z */
    KIND_RANGE,    /* double[2]: low,high, the first lower */
    KIND_BOX,      /* double[4]: left,top,right,bottom in pixels, whole numbers */
    KIND_EXPOSURE  /* double EV, or the word auto */
} OptionKind;

typedef struct {
    OptionId    id;
    const char *name;      /* with its dashes */
    const char *argument;  /* NULL: takes none */
    unsigned    commands;  /* Command bits */
    OptionKind  kind;
    size_t      offset;    /* of the field in Options */
    double      low, high;
    const char *words;     /* choices, comma between */
    const char *help;
} OptionRow;

/* The table, [OPTION_COUNT] in the order of OptionId. */
const OptionRow *options_table(void);

/* Fills *options from the words after the program's name.
 * fails  false and ERROR_USAGE with one sentence. */
bool options_parse(Options *options, int argc, char **argv, Error *err);

static inline bool options_given(const Options *options, OptionId id)
{
    return options->given[id];
}

/* Name of a command, or NULL; and back (COMMAND_NONE: no such command). */
const char *command_name(Command command);
Command     command_from_name(const char *name);

/* --- values: each reads the whole text or fails without touching *value ----------------------- */

bool value_number(const char *text, double *value);
/* 0.01 or 1%. */
bool value_share(const char *text, double *value);
bool value_count(const char *text, uint32_t *value);
bool value_bytes(const char *text, uint64_t *value);
bool value_seconds(const char *text, double *value);
/* Counts above 0 with a colon between; the second, which may be missing, is then not touched. */
bool value_counts(const char *text, uint32_t value[2]);
bool value_pixels(const char *text, int value[2]);
bool value_vector(const char *text, Vec3 *value);
/* `count` numbers with commas between. */
bool value_numbers(const char *text, double *value, int count);
/* Position of a word in "a,b,c", or -1. */
int value_choice(const char *text, const char *words);
/* A set of words: "all", "none", and words that are added or, with a - before them, taken out, from
 * left to right; starts empty, or full when the first one is taken out. */
bool value_set(const char *text, const char *words, uint32_t *value);
/* The word at a position of "a,b,c" into out. */
void value_word(const char *words, int position, char *out, size_t size);

/* How many letters must change to make b of a [levenshtein66]; at least `limit` when longer. */
unsigned word_distance(const char *a, const char *b, unsigned limit);

/* --- help ------------------------------------------------------------------------------------- */

void help_program(FILE *out);
void help_command(FILE *out, Command command);
void help_version(FILE *out);

#endif
