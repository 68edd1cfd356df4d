/* SPDX-License-Identifier: BSD-3-Clause */
/* The one table of options, and how a command line is read by it. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/film.h"
#include "app/options.h"
#include "app/options_agree.h"
#include "radiosity/links.h"
#include "radiosity/sides.h"
#include "radiosity/solve.h"
#include "render/image.h"
#include "render/whitted.h"
#include "scenes/scene.h"

/* The words of these options stand in the order of the library's enumerations. */
_Static_assert(CLOSURE_NONE == 0 && CLOSURE_ROWS == 1 && CLOSURE_RECIPROCITY == 2 &&
                   CLOSURE_BOTH == 3, "words of --closure");
_Static_assert(SOLVER_GAUSS_SEIDEL == 0 && SOLVER_JACOBI == 1 && SOLVER_PROGRESSIVE == 2 &&
                   SOLVER_SOR == 3 && SOLVER_CONJUGATE_GRADIENTS == 4 && SOLVER_GMRES == 5 &&
                   SOLVER_HIERARCHICAL == 6 && SOLVER_TWO_LEVEL == 7 &&
                   SOLVER_COUNT == 8, "words of --solver");
_Static_assert(EMIT_AUTO == 0 && EMIT_FRONT == 1 && EMIT_BACK == 2 && EMIT_BOTH == 3,
               "words of --emit");

_Static_assert(CAMERA_PERSPECTIVE == 0 && CAMERA_ORTHOGRAPHIC == 1 && CAMERA_FISHEYE == 2 &&
                   CAMERA_PANORAMA == 3, "words of --projection");
_Static_assert(FILTER_BOX == 0 && FILTER_TENT == 1 && FILTER_GAUSS == 2 &&
                   FILTER_BLACKMAN_HARRIS == 3, "words of --pixel-filter");
_Static_assert(FILM_NONE == 0 && FILM_LUMINANCE == 1 && FILM_ILLUMINANCE == 2,
               "words of --false-colour");
_Static_assert(TONE_SHOULDER == 0 && TONE_LINEAR == 1 && TONE_REINHARD == 2 && TONE_FILMIC == 3,
               "words of --tone");

#define FIELD(name) offsetof(Options, name)
#define BIG 1e30
#define ALL_BITS (COMMAND_RENDER | COMMAND_SOLVE | COMMAND_FACTORS | COMMAND_MEASURE | \
                  COMMAND_CHECK | COMMAND_VALIDATE | COMMAND_BENCH | COMMAND_COMPARE | \
                  COMMAND_DEVELOP | COMMAND_VIEW)
/* Commands that solve, those that build patches and links, those that read a scene. */
#define SOLVING (COMMAND_RENDER | COMMAND_SOLVE | COMMAND_MEASURE | COMMAND_BENCH)
#define LINKING (SOLVING | COMMAND_FACTORS)
/* The same and the window; without what makes no sense where somebody looks on. */
#define SHOWING (SOLVING | COMMAND_VIEW)
#define BUILDING (LINKING | COMMAND_VIEW)
#define DRAWING (COMMAND_RENDER | COMMAND_VIEW)
/* Those with a camera; solve has one for --importance. */
#define VIEWING (DRAWING | COMMAND_BENCH | COMMAND_SOLVE)
#define SAVING (COMMAND_RENDER | COMMAND_SOLVE | COMMAND_MEASURE | COMMAND_FACTORS)
#define READING (LINKING | COMMAND_CHECK)

static const OptionRow option_rows[OPTION_COUNT] = {
    { OPTION_OUTPUT, "-o", "FILE",
      COMMAND_RENDER | COMMAND_SOLVE | COMMAND_FACTORS | COMMAND_MEASURE | COMMAND_CHECK |
          COMMAND_COMPARE | COMMAND_DEVELOP, KIND_TEXT,
      FIELD(output), 0, 0, NULL, "result file; - is standard output (not for pictures)" },
    { OPTION_JSON, "--json", "FILE", ALL_BITS, KIND_TEXT, FIELD(json), 0, 0, NULL,
      "summary as JSON; - is standard output" },
    { OPTION_QUALITY, "--quality", "LEVEL", BUILDING, KIND_CHOICE, FIELD(quality), 0, 0,
      "draft,medium,high,final", "one knob for all that follows (default medium)" },
    { OPTION_PRINT_CONFIG, "--print-config", NULL, BUILDING, KIND_FLAG, FIELD(print_config), 0, 0,
      NULL, "print what quality and options amount to, and stop" },
    { OPTION_THREADS, "--threads", "N", ALL_BITS, KIND_COUNT, FIELD(threads), 1, 1024, NULL,
      "default: one per core; results do not depend on it" },
    { OPTION_SEED, "--seed", "N", ALL_BITS, KIND_COUNT, FIELD(seed), 0, UINT32_MAX, NULL,
      "another set of random numbers (default 0)" },
    { OPTION_PROGRESS, "--progress", "HOW", READING | COMMAND_VIEW, KIND_CHOICE, FIELD(progress),
      0, 0, "auto,plain,json,none", "on standard error; auto: a live line on a terminal" },
    { OPTION_MAX_MEMORY, "--max-memory", "SIZE", BUILDING, KIND_BYTES, FIELD(max_memory), 1, BIG,
      NULL, "refuse to use more, e.g. 512MB (exit code 6)" },
    { OPTION_TIME_LIMIT, "--time-limit", "T", LINKING, KIND_SECONDS, FIELD(time_limit), 0, BIG,
      NULL, "stop after 30s, 5min, 2h with what there is (exit code 5)" },
    { OPTION_PATCH_SIZE, "--patch-size", "L", BUILDING, KIND_NUMBER, FIELD(patch_size), 1e-30, BIG,
      NULL, "greatest patch edge in scene units" },
    { OPTION_PATCHES, "--patches", "N", BUILDING, KIND_COUNT, FIELD(patches), 1, UINT32_MAX / 2,
      NULL, "total number of patches aimed at" },
    { OPTION_ADAPT, "--adapt", NULL, SHOWING, KIND_FLAG, FIELD(adapt), 0, 0, NULL,
      "divide patches where light changes (default from quality medium on)" },
    { OPTION_NO_ADAPT, "--no-adapt", NULL, SHOWING, KIND_FLAG, FIELD(no_adapt), 0, 0, NULL,
      "patches of one size everywhere" },
    { OPTION_LEAST_SIZE, "--least-size", "L", SHOWING, KIND_NUMBER, FIELD(least_size), 1e-30, BIG,
      NULL, "--adapt makes no patch edge shorter (default 1/16 of the greatest)" },
    { OPTION_TREE, "--tree", "HOW", BUILDING, KIND_CHOICE, FIELD(tree), 0, 0, "auto,medium,high",
      "of boxes for rays; high: slower to build, then faster (auto: from quality high)" },
    { OPTION_REPAIR, "--repair", "LIST", READING | COMMAND_VIEW, KIND_SET, FIELD(repair), 0, 0,
      "weld,duplicates,junctions,nonmanifold,winding,cuts,covered",
      "all (default), none, or a list; all,-winding leaves one out" },
    { OPTION_WELD, "--weld", "L", READING | COMMAND_VIEW, KIND_NUMBER, FIELD(weld), 0, BIG, NULL,
      "corners nearer than this are one (default: from the scene's rounding)" },
    { OPTION_INSTANCES, "--instances", "HOW", READING | COMMAND_VIEW, KIND_CHOICE,
      FIELD(instances), 0, 0, "auto,flatten,keep",
      "meshes placed often: auto keeps references beyond 4 million faces" },
    { OPTION_TIME, "--time", "T", READING | COMMAND_VIEW, KIND_NUMBER, FIELD(time), -BIG, BIG,
      NULL, "what TIME is in an MSD file (default 0)" },
    { OPTION_RAYS, "--rays", "N", BUILDING, KIND_COUNT, FIELD(rays), 1, 1 << 24, NULL,
      "hemisphere rays per patch" },
    { OPTION_LAMP_RAYS, "--lamp-rays", "N", BUILDING, KIND_COUNT, FIELD(lamp_rays), 1, 1 << 24,
      NULL, "rays per patch to surfaces that emit" },
    { OPTION_ACCURACY, "--accuracy", "X",
      COMMAND_FACTORS | COMMAND_SOLVE | COMMAND_MEASURE | COMMAND_RENDER, KIND_NUMBER,
      FIELD(accuracy), 1e-9, 1, NULL, "standard error asked of factors between groups, of light" },
    { OPTION_CLOSURE, "--closure", "WHAT", BUILDING, KIND_CHOICE, FIELD(closure), 0, 0,
      "none,rows,reciprocity,both", "enforce row sums, reciprocity on the factors (default both)" },
    { OPTION_STORAGE, "--storage", "BITS", LINKING, KIND_CHOICE, FIELD(storage), 0, 0, "32,16",
      "of each factor; 16: half the memory, rounded by at most 0.05 % (default 32)" },
    { OPTION_FACTORS, "--factors", "FILE",
      COMMAND_RENDER | COMMAND_SOLVE | COMMAND_MEASURE | COMMAND_FACTORS, KIND_TEXT,
      FIELD(factors), 0, 0, NULL, "read the factors as cast from there; write them if it is not" },
    { OPTION_SOLVER, "--solver", "NAME", SHOWING | COMMAND_VALIDATE, KIND_CHOICE, FIELD(solver), 0,
      0, "gauss-seidel,jacobi,progressive,sor,cg,gmres,hierarchical,two-level,stochastic",
      "default gauss-seidel; for very many patches stochastic, without links" },
    { OPTION_TOLERANCE, "--tolerance", "X", SHOWING, KIND_NUMBER, FIELD(tolerance), 1e-14, 1, NULL,
      "stop when the missing power falls below this share" },
    { OPTION_MAX_ITERATIONS, "--max-iterations", "N", SHOWING, KIND_COUNT, FIELD(max_iterations),
      1, UINT32_MAX, NULL, "sweeps, or shots of progressive; default: no limit" },
    { OPTION_TRACE, "--trace", "FILE", SOLVING, KIND_TEXT, FIELD(trace), 0, 0, NULL,
      "CSV of the solver: step, seconds, rays, residual, unshot, error bound" },
    { OPTION_RELAXATION, "--relaxation", "W", SOLVING, KIND_NUMBER, FIELD(relaxation), 0.01, 1.99,
      NULL, "of sor: each step is taken W times (default: from the first sweeps)" },
    { OPTION_OVERSHOOT, "--overshoot", NULL, SOLVING, KIND_FLAG, FIELD(overshoot), 0, 0, NULL,
      "progressive: patches send the light they expect back as well" },
    { OPTION_NO_AMBIENT, "--no-ambient", NULL, SOLVING, KIND_FLAG, FIELD(no_ambient), 0, 0, NULL,
      "progressive, stopped early: no estimate of what was not shot" },
    { OPTION_IMPORTANCE, "--importance", NULL, COMMAND_RENDER | COMMAND_SOLVE,
      KIND_FLAG, FIELD(importance), 0, 0, NULL,
      "hierarchical: light that the camera receives counts, by its way back" },
    { OPTION_NO_LAST_GATHER, "--no-last-gather", NULL, SOLVING, KIND_FLAG, FIELD(no_last_gather),
      0, 0, NULL, "hierarchical: leave light as links between clusters have it" },
    { OPTION_COMPARE, "--compare", NULL, COMMAND_SOLVE, KIND_FLAG, FIELD(compare), 0, 0, NULL,
      "run all solvers on the same factors: -o FILE.csv and a plot FILE.svg" },
    { OPTION_LIGHT_CHECK, "--check", "N[:RAYS]", COMMAND_SOLVE, KIND_COUNTS, FIELD(light_check), 1,
      1e6, NULL, "tell how far irradiance is off, by twice RAYS (256) paths back from N patches" },
    { OPTION_SET, "--set", "CHANGE", SOLVING, KIND_TEXTS, FIELD(set), 0, 0, NULL,
      "relight: GROUP.emission=*0.5, GROUP.reflectance=0.6; may be given again" },
    { OPTION_CHANGES, "--changes", "FILE", SOLVING, KIND_TEXT, FIELD(changes), 0, 0, NULL,
      "the same as JSON: { \"lamp\": { \"emission\": \"*0.5\" } }" },
    { OPTION_LIGHT_GROUPS, "--light-groups", NULL, SOLVING, KIND_FLAG, FIELD(light_groups), 0, 0,
      NULL, "solve each emitting group and light apart: mixed when dimmed; layers of pictures" },
    { OPTION_CHECKPOINT, "--checkpoint", "T", SAVING, KIND_SECONDS, FIELD(checkpoint), 0, BIG,
      NULL, "save what is done every 30s, 5min, and when stopped, as RESULT.checkpoint" },
    { OPTION_RESUME, "--resume", "FILE", SAVING, KIND_TEXT, FIELD(resume), 0, 0, NULL,
      "go on from such a file, to the same bytes as an unbroken run" },
    { OPTION_SIZE, "--size", "WxH", DRAWING, KIND_PIXELS, FIELD(size), 0, 0,
      NULL, "picture size in pixels (default: the scene's, or 512x512)" },
    { OPTION_SPP, "--spp", "N", DRAWING, KIND_COUNT, FIELD(spp), 1, 1 << 20, NULL,
      "camera rays per pixel" },
    { OPTION_GATHER_RAYS, "--gather-rays", "N",
      DRAWING | COMMAND_MEASURE | COMMAND_FACTORS, KIND_COUNT, FIELD(gather_rays), 1,
      1 << 24, NULL, "hemisphere rays per camera ray (render) or per point (measure, factors)" },
    { OPTION_RECORD_RAYS, "--record-rays", "N", DRAWING, KIND_COUNT, FIELD(record_rays), 0,
      1 << 24, NULL, "hemisphere rays of each record of indirect light; 0: no records" },
    { OPTION_ERROR, "--error", "X", DRAWING, KIND_SHARE, FIELD(error), 1e-6, 1, NULL,
      "standard error of pixels to reach, as 1% of the mean; --spp bounds the effort" },
    { OPTION_EXPOSURE, "--exposure", "EV", DRAWING | COMMAND_SOLVE | COMMAND_DEVELOP,
      KIND_EXPOSURE, FIELD(exposure), 0, 0, NULL,
      "of PNG and PLY colours, in stops, or auto (default)" },
    { OPTION_TONE, "--tone", "CURVE", DRAWING | COMMAND_DEVELOP, KIND_CHOICE, FIELD(tone), 0, 0,
      "shoulder,linear,reinhard,filmic",
      "how bright light is put on the PNG (default shoulder)" },
    { OPTION_FALSE_COLOUR, "--false-colour", "WHAT", COMMAND_RENDER | COMMAND_DEVELOP,
      KIND_CHOICE, FIELD(false_colour), 0, 0, "none,luminance,illuminance",
      "a PNG of values with a legend" },
    { OPTION_RANGE, "--range", "LOW,HIGH", COMMAND_RENDER | COMMAND_DEVELOP | COMMAND_COMPARE,
      KIND_RANGE, FIELD(range), 0, 0, NULL, "values at the ends of false colours (default: all)" },
    { OPTION_LOG, "--log", NULL, COMMAND_RENDER | COMMAND_DEVELOP, KIND_FLAG, FIELD(logarithmic),
      0, 0, NULL, "false colours in equal steps of ratio" },
    { OPTION_ISOLINES, "--isolines", NULL, COMMAND_RENDER | COMMAND_DEVELOP, KIND_FLAG,
      FIELD(isolines), 0, 0, NULL, "lines along the legend's values" },
    { OPTION_LAYER, "--layer", "NAME", COMMAND_DEVELOP | COMMAND_COMPARE, KIND_TEXT, FIELD(layer),
      0, 0, NULL, "of the EXR instead of its R G B: direct, lightgroup.NAME ..." },
    { OPTION_MIX, "--mix", "NAME=F", COMMAND_DEVELOP, KIND_TEXTS, FIELD(mix), 0, 0, NULL,
      "dims a light group of the EXR: F or R,G,B times; may be given again" },
    { OPTION_CROP, "--crop", "BOX", COMMAND_RENDER, KIND_BOX, FIELD(crop), 0, 0, NULL,
      "only this part of the picture: left,top,right,bottom in pixels" },
    { OPTION_PIXEL_FILTER, "--pixel-filter", "SHAPE", DRAWING, KIND_CHOICE,
      FIELD(pixel_filter), 0, 0, "box,tent,gauss,blackman-harris",
      "how samples around a pixel count (default box: its square alone)" },
    { OPTION_CAMERA, "--camera", "NAME", VIEWING, KIND_TEXT, FIELD(camera),
      0, 0, NULL, "of the file; render: also A,B or all (default: its first, or a view)" },
    { OPTION_EYE, "--eye", "X,Y,Z", VIEWING, KIND_VECTOR, FIELD(eye), 0, 0,
      NULL, "a view of your own: where the eye is" },
    { OPTION_TARGET, "--target", "X,Y,Z", VIEWING, KIND_VECTOR,
      FIELD(target), 0, 0, NULL, "what it looks at (default: the scene's middle)" },
    { OPTION_UP, "--up", "X,Y,Z", SHOWING, KIND_VECTOR, FIELD(up), 0, 0,
      NULL, "what is up (default: as the file says)" },
    { OPTION_FOV, "--fov", "DEG", VIEWING, KIND_NUMBER, FIELD(fov), 0.01,
      360, NULL, "vertical field of view, whole angle (fisheye and panorama: default 180)" },
    { OPTION_PROJECTION, "--projection", "KIND", COMMAND_RENDER, KIND_CHOICE, FIELD(projection), 0,
      0, "perspective,orthographic,fisheye,panorama", "of the camera (default: as the file says)" },
    { OPTION_VIEW_HEIGHT, "--view-height", "L", COMMAND_RENDER, KIND_NUMBER, FIELD(view_height),
      1e-30, BIG, NULL, "orthographic: what the picture's height shows, in scene units" },
    { OPTION_APERTURE, "--aperture", "L", COMMAND_RENDER, KIND_NUMBER, FIELD(aperture), 0, BIG,
      NULL, "diameter of the lens in scene units: depth of field (default 0: all sharp)" },
    { OPTION_FOCUS, "--focus", "L", COMMAND_RENDER, KIND_NUMBER, FIELD(focus), 1e-30, BIG, NULL,
      "distance that is sharp (default: the target's)" },
    { OPTION_SHUTTER, "--shutter", "T0,T1", COMMAND_RENDER, KIND_RANGE, FIELD(shutter), 0, 0, NULL,
      "motion blur: the mean over TIME from T0 to T1" },
    { OPTION_TIME_SAMPLES, "--time-samples", "N", COMMAND_RENDER, KIND_COUNT, FIELD(time_samples),
      1, 1 << 16, NULL, "moments of --shutter (default 16)" },
    { OPTION_DIFFUSE, "--diffuse", NULL, DRAWING, KIND_FLAG, FIELD(diffuse), 0, 0, NULL,
      "leave mirrors, glass and gloss out" },
    { OPTION_RENDERER, "--renderer", "NAME", COMMAND_RENDER, KIND_CHOICE, FIELD(renderer), 0, 0,
      "gather,path,whitted",
      "gather (default); unbiased paths, the slow reference; plain ray tracing" },
    { OPTION_DEPTH, "--depth", "N", COMMAND_RENDER, KIND_COUNT, FIELD(depth), 1,
      WHITTED_DEPTH_MOST, NULL, "mirrors and glass that whitted follows rays through (default 5)" },
    { OPTION_BY, "--by", "WHAT", COMMAND_FACTORS, KIND_CHOICE, FIELD(by), 0, 0,
      "group,material,patch", "rows of the matrix (default group)" },
    { OPTION_ROWS, "--rows", "FILE", COMMAND_FACTORS, KIND_TEXT, FIELD(rows), 0, 0, NULL,
      "CSV of areas, row sums and escaped shares, as used and as cast" },
    { OPTION_ERRORS, "--errors", "FILE", COMMAND_FACTORS, KIND_TEXT, FIELD(errors), 0, 0, NULL,
      "standard errors of the factors: CSV, by patch Matrix Market" },
    { OPTION_EXCHANGE, "--exchange", "WHAT", COMMAND_FACTORS, KIND_CHOICE, FIELD(exchange), 0, 0,
      "none,gebhart,hottel,flux", "of heat between grey surfaces, instead of plain factors" },
    { OPTION_EMISSIVITY, "--emissivity", "LIST", COMMAND_FACTORS, KIND_TEXT, FIELD(emissivity), 0,
      0, NULL, "0.9, NAME=0.9,NAME=0.5 or a CSV file (default: 1 - reflectance)" },
    { OPTION_TEMPERATURE, "--temperature", "LIST", COMMAND_FACTORS, KIND_TEXT, FIELD(temperature),
      0, 0, NULL, "in K, given in the same ways (default 293.15)" },
    { OPTION_SURROUNDINGS, "--surroundings", "K", COMMAND_FACTORS, KIND_NUMBER,
      FIELD(surroundings), 0, BIG, NULL, "temperature that what escapes meets (default 293.15)" },
    { OPTION_POINTS, "--points", "FILE", COMMAND_MEASURE | COMMAND_FACTORS, KIND_TEXT,
      FIELD(points), 0, 0, NULL,
      "x,y,z,nx,ny,nz per line; - is standard input" },
    { OPTION_LIGHT, "--light", "KIND", SHOWING, KIND_CHOICE, FIELD(light), 0, 0, "none,ceiling",
      "ceiling: hang a lamp under the ceiling of a scene without one" },
    { OPTION_EMIT, "--emit", "SIDE", BUILDING | COMMAND_CHECK, KIND_CHOICE, FIELD(emit), 0, 0,
      "auto,front,back,both", "side that lamps shine from (default auto)" },
    { OPTION_SIDES, "--sides", "WHICH", READING | COMMAND_VIEW, KIND_CHOICE, FIELD(sides), 0, 0,
      "auto,front,both", "sides that take part (default auto: what light or eye can reach)" },
    { OPTION_UNITS, "--units", "LABEL", SHOWING | COMMAND_DEVELOP, KIND_CHOICE, FIELD(units), 0, 0,
      "photometric,radiometric", "what the file's values are called; nothing is converted" },
    { OPTION_UNIT_M, "--unit-m", "X", SHOWING | COMMAND_CHECK, KIND_NUMBER, FIELD(unit_m), 1e-12,
      1e12, NULL, "length of a scene unit in metres (default 1)" },
    { OPTION_FILTER, "--filter", "TEXT", COMMAND_VALIDATE, KIND_TEXT, FIELD(filter), 0, 0, NULL,
      "only cases whose name contains this" },
    { OPTION_LAMP, "--lamp", "L", COMMAND_COMPARE, KIND_NUMBER, FIELD(lamp), 1e-30, BIG, NULL,
      "luminance from which a pixel is lamp and left out (default 5)" },
    { OPTION_SAMPLES, "--samples", "N", COMMAND_COMPARE, KIND_COUNT, FIELD(samples), 1, 1 << 28,
      NULL, "points at which two solutions are compared (default 100000)" },
    { OPTION_CONSTANT, "--constant", NULL, COMMAND_COMPARE, KIND_FLAG, FIELD(constant), 0, 0, NULL,
      "compare each patch's own value, not what its vertices interpolate" },
    { OPTION_SCRIPT, "--script", "FILE", COMMAND_VIEW, KIND_TEXT, FIELD(script), 0, 0, NULL,
      "drive the window by this file, then close it (isolux.1 tells the words)" },
    { OPTION_SCREENSHOT, "--screenshot", "FILE", COMMAND_VIEW, KIND_TEXT, FIELD(screenshot), 0, 0,
      NULL, "PNG of the window's last frame" },
    { OPTION_FRAMES, "--frames", "N", COMMAND_VIEW, KIND_COUNT, FIELD(frames), 1, UINT32_MAX, NULL,
      "close after so many frames" },
    { OPTION_RATE, "--rate", "HZ", COMMAND_VIEW, KIND_NUMBER, FIELD(rate), 0.1, 1000, NULL,
      "draw so often, also when nothing changes (default: when needed, at most 60)" },
    { OPTION_NO_PANELS, "--no-panels", NULL, COMMAND_VIEW, KIND_FLAG, FIELD(no_panels), 0, 0, NULL,
      "begin with the picture alone" },
    { OPTION_LIST_BINDINGS, "--list-bindings", NULL, COMMAND_VIEW, KIND_FLAG,
      FIELD(list_bindings), 0, 0, NULL, "print keys and mouse, and stop" },
    { OPTION_HELP, "--help", NULL, ALL_BITS, KIND_FLAG, FIELD(help), 0, 0, NULL, "this page" },
};

const OptionRow *options_table(void)
{
    return option_rows;
}

/* --- commands --------------------------------------------------------------------------------- */

static const struct {
    Command     command;
    const char *name;
} command_names[] = {
    { COMMAND_RENDER, "render" },   { COMMAND_SOLVE, "solve" }, { COMMAND_FACTORS, "factors" },
    { COMMAND_MEASURE, "measure" }, { COMMAND_CHECK, "check" }, { COMMAND_VALIDATE, "validate" },
    { COMMAND_BENCH, "bench" },     { COMMAND_COMPARE, "compare" },
    { COMMAND_VIEW, "view" },
    { COMMAND_DEVELOP, "develop" },
};
enum { COMMAND_TOTAL = sizeof command_names / sizeof *command_names };

const char *command_name(Command command)
{
    for (int i = 0; i < COMMAND_TOTAL; i++)
        if (command_names[i].command == command)
            return command_names[i].name;
    return NULL;
}

Command command_from_name(const char *name)
{
    assert(name != NULL);
    for (int i = 0; i < COMMAND_TOTAL; i++)
        if (strcmp(command_names[i].name, name) == 0)
            return command_names[i].command;
    return COMMAND_NONE;
}

/* --- one option ------------------------------------------------------------------------------- */

/* Misspellings further away than this are not worth a guess. */
enum { GUESS_DISTANCE = 3 };

static bool unknown_option(const char *name, Command command, Error *err)
{
    const char *best = NULL;
    unsigned best_distance = GUESS_DISTANCE;
    for (int i = 0; i < OPTION_COUNT; i++) {
        const unsigned distance = word_distance(name, option_rows[i].name, GUESS_DISTANCE);
        if ((option_rows[i].commands & command) != 0 && distance < best_distance) {
            best = option_rows[i].name;
            best_distance = distance;
        }
    }
    if (best != NULL)
        return error_set(err, ERROR_USAGE, "unknown option '%s'; did you mean %s?", name, best);
    return error_set(err, ERROR_USAGE, "unknown option '%s'; see isolux %s --help", name,
                     command_name(command));
}

/* More stops than floats have powers of two: black is black and white is white long before. */
static const double EXPOSURE_MOST = 300;

static bool wrong_value(const OptionRow *row, const char *text, Error *err)
{
    if (row->kind == KIND_SET)
        return error_set(err, ERROR_USAGE, "%s '%s' is not a list of all,none,%s, or of these with "
                         "- before them", row->name, text, row->words);
    if (row->kind == KIND_CHOICE)
        return error_set(err, ERROR_USAGE, "%s '%s' is not one of %s", row->name, text, row->words);
    if (row->kind == KIND_COUNT || row->kind == KIND_NUMBER)
        return error_set(err, ERROR_USAGE, "%s '%s' is not a number%s from %g to %g", row->name,
                         text, row->kind == KIND_COUNT ? " without a fraction" : "", row->low,
                         row->high);
    static const char *const forms[] = {
        [KIND_BYTES] = "a size like 512MB",        [KIND_SECONDS] = "a time like 30s or 5min",
        [KIND_SET] = "a list like all,-winding",
        [KIND_COUNTS] = "a number from 1 to 1000000, or two like 4000:512",
        [KIND_PIXELS] = "a size like 640x480",     [KIND_VECTOR] = "three numbers like 1,2.5,-3",
        [KIND_RANGE] = "two numbers, the lower first, like 0,500",
        [KIND_BOX] = "left,top,right,bottom in whole pixels like 100,50,300,200",
        [KIND_TEXTS] = "one of at most 64",
        [KIND_EXPOSURE] = "a number of stops from -300 to 300, or auto",
        [KIND_SHARE] = "a share like 1% or 0.01, above 0 and not above 1",
    };
    assert((size_t)row->kind < sizeof forms / sizeof *forms && forms[row->kind] != NULL);
    return error_set(err, ERROR_USAGE, "%s '%s' is not %s", row->name, text, forms[row->kind]);
}

static bool texts_add(TextList *list, const char *text)
{
    if (list->count == TEXTS_MOST)
        return false;
    list->text[list->count++] = text;
    return true;
}

/* Left, top, right, bottom of whole pixels with something between them. */
static bool is_box(const double box[4])
{
    static const double MOST = 32768;
    for (int k = 0; k < 4; k++)
        if (!(box[k] >= 0 && box[k] <= MOST && box[k] == floor(box[k])))
            return false;
    return box[0] < box[2] && box[1] < box[3];
}

/* Stores the value; *field is the option's place in Options. */
static bool store_value(Options *options, const OptionRow *row, const char *text, Error *err)
{
    void *field = (char *)options + row->offset;
    uint32_t count = 0;
    double number = 0;
    bool good = false;
    switch (row->kind) {
    case KIND_FLAG:
        *(bool *)field = good = true;
        break;
    case KIND_TEXT:
        *(const char **)field = text;
        good = *text != '\0';
        if (!good)
            return error_set(err, ERROR_USAGE, "%s needs a %s", row->name, row->argument);
        break;
    case KIND_TEXTS:
        good = *text != '\0' && texts_add(field, text);
        break;
    case KIND_COUNT:
        good = value_count(text, &count) && count >= row->low && count <= row->high;
        *(uint32_t *)field = count;
        break;
    case KIND_COUNTS:
        good = value_counts(text, field) && *(uint32_t *)field <= row->high;
        break;
    case KIND_NUMBER:
        good = value_number(text, &number) && number >= row->low && number <= row->high;
        *(double *)field = number;
        break;
    case KIND_SHARE:
        good = value_share(text, &number) && number >= row->low && number <= row->high;
        *(double *)field = number;
        break;
    case KIND_BYTES:
        good = value_bytes(text, field) && *(uint64_t *)field > 0;
        break;
    case KIND_SECONDS:
        good = value_seconds(text, field);
        break;
    case KIND_CHOICE:
        *(int *)field = value_choice(text, row->words);
        good = *(int *)field >= 0;
        break;
    case KIND_SET:
        good = value_set(text, row->words, field);
        break;
    case KIND_PIXELS:
        good = value_pixels(text, field);
        break;
    case KIND_VECTOR:
        good = value_vector(text, field);
        break;
    case KIND_RANGE:
        good = value_numbers(text, field, 2) && ((double *)field)[0] < ((double *)field)[1];
        break;
    case KIND_BOX:
        good = value_numbers(text, field, 4) && is_box(field);
        break;
    case KIND_EXPOSURE:
        options->exposure_set = strcmp(text, "auto") != 0;
        good = !options->exposure_set ||
               (value_number(text, field) && fabs(*(const double *)field) <= EXPOSURE_MOST);
        break;
    }
    return good || wrong_value(row, text, err);
}

/* The row whose name is the first `length` letters of word, or NULL. */
static const OptionRow *find_row(const char *word, size_t length)
{
    for (int i = 0; i < OPTION_COUNT; i++) {
        assert(option_rows[i].id == (OptionId)i);
        if (strlen(option_rows[i].name) == length &&
            memcmp(option_rows[i].name, word, length) == 0)
            return &option_rows[i];
    }
    return NULL;
}

static bool parse_option(Options *options, char **argv, int argc, int *at, Error *err)
{
    const char *word = argv[*at];
    const char *value = NULL;
    const OptionRow *row = NULL;
    char name[64];
    const size_t length = strcspn(word, "=");
    if (strcmp(word, "-h") == 0)
        row = &option_rows[OPTION_HELP];
    else if (word[1] == 'o') {
        row = &option_rows[OPTION_OUTPUT];
        value = word[2] != '\0' ? word + 2 : NULL;
    } else
        row = find_row(word, length);
    if (row != NULL && word[1] == '-' && word[length] == '=')
        value = word + length + 1;
    if (row == NULL) {
        const size_t keep = length < sizeof name ? length : sizeof name - 1;
        memcpy(name, word, keep);
        name[keep] = '\0';
        return unknown_option(name, options->command, err);
    }
    if ((row->commands & options->command) == 0)
        return error_set(err, ERROR_USAGE, "%s is not an option of %s", row->name,
                         command_name(options->command));
    if (row->kind == KIND_FLAG && value != NULL)
        return error_set(err, ERROR_USAGE, "%s takes no value", row->name);
    if (row->kind != KIND_FLAG && value == NULL) {
        if (*at + 1 >= argc)
            return error_set(err, ERROR_USAGE, "%s needs a %s", row->name, row->argument);
        value = argv[++*at];
    }
    options->given[row->id] = true;
    return store_value(options, row, value, err);
}

/* --- the whole line --------------------------------------------------------------------------- */

bool options_parse(Options *options, int argc, char **argv, Error *err)
{
    assert(options != NULL && argc >= 1 && err != NULL);
    *options = (Options){ .command = command_from_name(argv[0]), .quality = QUALITY_MEDIUM,
                          .closure = CLOSURE_BOTH, .unit_m = 1,
                          .repair = (1u << REPAIR_COUNT) - 1, .argc = argc, .argv = argv };
    if (options->command == COMMAND_NONE)
        return error_set(err, ERROR_USAGE, "unknown command '%s'; see isolux --help", argv[0]);
    bool options_end = false;
    for (int i = 1; i < argc; i++) {
        if (!options_end && strcmp(argv[i], "--") == 0)
            options_end = true;
        else if (!options_end && argv[i][0] == '-' && argv[i][1] != '\0') {
            if (!parse_option(options, argv, argc, &i, err))
                return false;
        } else if (options->command == COMMAND_VALIDATE)
            return error_set(err, ERROR_USAGE, "validate takes no scene ('%s')", argv[i]);
        else if (options->command == COMMAND_COMPARE && options->scene != NULL &&
                 options->other == NULL)
            options->other = argv[i];
        else if (options->scene != NULL)
            return error_set(err, ERROR_USAGE, "one scene at a time: '%s' and '%s'",
                             options->scene, argv[i]);
        else if (argv[i][0] == '\0')
            return error_set(err, ERROR_USAGE, "the scene's name is empty");
        else
            options->scene = argv[i];
    }
    if (options->help)
        return true;
    const bool optional = options->command == COMMAND_VALIDATE ||
                          options->command == COMMAND_BENCH || options->print_config ||
                          options->list_bindings;
    if (options->scene == NULL && !optional)
        return error_set(err, ERROR_USAGE, "which scene? isolux %s SCENE; see isolux %s --help",
                         argv[0], argv[0]);
    if (options->command == COMMAND_COMPARE && options->other == NULL)
        return error_set(err, ERROR_USAGE, "compare needs two pictures: the reference, then yours");
    return options_agree(options, err);
}
