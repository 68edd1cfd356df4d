/* SPDX-License-Identifier: BSD-3-Clause */
/* Cases of validate: the same few rooms by every solver there is, by the names of --solver. */
#include <assert.h>
#include <math.h>
#include <stdio.h>

#include "app/model.h"
#include "app/options.h"
#include "app/validate.h"

enum { SOLVERS = SOLVER_COUNT + 1 }; /* those over links, then the one without */
enum { SMALL = 150, SMALL_RAYS = 256, FINE = 6000, FINE_RAYS = 2048 };

/* Rows are closed to 1e-6, the requirement on them; 1 / (1 - rho) multiplies that. Solvers that
 * cast rays of their own have noise: 3 / sqrt(rays of a patch) of a patch's light; none of all
 * power together, for it balances. */
static const double ROW_ERROR = 1e-6;
/* What a fine mesh is asked for, absolute at an exitance of 1. */
static const double FINE_MESH = 2e-4;
/* Steps in which the Krylov solvers and the two-level one are to be through. */
static const double STEPS_MOST = 59;

typedef struct {
    double reflectance, walls, ceiling; /* exitances */
} LitCube;

static Scene *make_cube(const LitCube *cube, Error *err)
{
    Scene *scene = scene_create("cube", err);
    if (scene == NULL)
        return NULL;
    const uint32_t m = model_grey(scene, "wall", cube->reflectance, cube->walls, err);
    const uint32_t lamp = model_grey(scene, "lamp", cube->reflectance, cube->ceiling, err);
    model_box(scene, vec3(1, 1, 1), (uint32_t[]){ m, m, m, m, m, lamp }, err);
    return scene;
}

/* What a case looks at, once a solver is through. */
typedef struct {
    Validation     *validation;
    const Pipeline *pipeline;
    int             solver;
    char            name[20]; /* of the solver */
} Solved;

typedef void (*SolvedCheck)(const Solved *solved, Error *err);

static bool has_noise(int solver)
{
    return solver == SOLVER_HIERARCHICAL || solver == SOLVER_COUNT;
}

/* Another solver over the same links. */
static bool solve_again(Pipeline *pipeline, int solver, Error *err)
{
    const Settings *settings = &pipeline->session->settings;
    assert(!has_noise(solver) && pipeline->links != NULL);
    const SolveOptions o = { .solver = (Solver)solver, .tolerance = settings->tolerance,
                             .threads = settings->threads, .centre = pipeline->patches->centre,
                             .normal = pipeline->patches->normal };
    solution_destroy(pipeline->solution);
    pipeline->solution = solve(pipeline->links, &pipeline->problem, &o,
                               &pipeline->session->monitor, err);
    return pipeline->solution != NULL;
}

/* Those over links on links that are cast once, the others on rays of their own. */
static bool by_each(Validation *validation, const LitCube *cube, const CaseSetup *setup,
                    SolvedCheck check, Error *err)
{
    Session  session[SOLVERS];
    Pipeline pipeline[SOLVERS];
    int      links = -1; /* the first solver over links */
    bool     run[SOLVERS] = { false };
    for (int solver = 0; solver < SOLVERS && !error_is_set(err); solver++) {
        Solved    solved = { .validation = validation, .solver = solver };
        CaseSetup own = *setup;
        own.solver = &solver;
        run[solver] = has_noise(solver) || links < 0;
        const int at = run[solver] ? solver : links;
        links = has_noise(solver) ? links : at;
        solved.pipeline = &pipeline[at];
        value_word(options_table()[OPTION_SOLVER].words, solver, solved.name, sizeof solved.name);
        if (run[solver] ? validation_run(validation, make_cube(cube, err), &own, &session[solver],
                                         &pipeline[solver], err)
                        : solve_again(&pipeline[at], solver, err))
            check(&solved, err);
    }
    for (int solver = 0; solver < SOLVERS; solver++)
        if (run[solver])
            validation_end(&session[solver], &pipeline[solver]);
    return !error_is_set(err);
}

static void note(const Solved *solved, const char *what, double expected, double value,
                 double tolerance, Error *err)
{
    char quantity[40];
    snprintf(quantity, sizeof quantity, "%s, %s", solved->name, what);
    validation_check(solved->validation, quantity, expected, value, tolerance, NAN, err);
}

/* Mean of all patches' radiosity, and the one furthest from `expected`. */
static double mean_of(const Pipeline *pipeline, double expected, double *furthest)
{
    double sum = 0, area = 0;
    assert(pipeline->solution->bands == ROOM_BANDS);
    *furthest = expected;
    for (uint32_t i = 0; i < pipeline->patches->count; i++) {
        const double b = pipeline->solution->radiosity[(size_t)ROOM_BANDS * i];
        sum += pipeline->links->area[i] * b;
        area += pipeline->links->area[i];
        if (!(fabs(b - expected) <= fabs(*furthest - expected)))
            *furthest = b;
    }
    return sum / area;
}

/* --- all walls shine: B = E / (1 - rho) ------------------------------------------------------- */

static const LitCube bright = { 0.99, 1, 1 };

static void check_bright(const Solved *solved, Error *err)
{
    const double expected = bright.walls / (1 - bright.reflectance);
    const double closed = ROW_ERROR / (1 - bright.reflectance);
    double furthest;
    const double mean = mean_of(solved->pipeline, expected, &furthest);
    note(solved, "mean", expected, mean, closed * expected, err);
    note(solved, "worst patch", expected, furthest,
         expected * (has_noise(solved->solver) ? 3 / sqrt(SMALL_RAYS) : closed), err);
}

static bool run_bright(Validation *validation, Error *err)
{
    const CaseSetup setup = { .command = COMMAND_SOLVE, .closure = CLOSURE_BOTH, .patches = SMALL,
                              .rays = SMALL_RAYS };
    return by_each(validation, &bright, &setup, check_bright, err);
}

/* --- the ceiling alone shines: what it sends is absorbed -------------------------------------- */

static const LitCube bright_lamp = { 0.99, 0, 6 };

static void check_lamp(const Solved *solved, Error *err)
{
    const double expected = bright_lamp.ceiling / 6 / (1 - bright_lamp.reflectance);
    double furthest;
    const double mean = mean_of(solved->pipeline, expected, &furthest);
    note(solved, "mean", expected, mean, ROW_ERROR / (1 - bright_lamp.reflectance) * expected,
         err);
    if (solved->solver == SOLVER_CONJUGATE_GRADIENTS || solved->solver == SOLVER_GMRES ||
        solved->solver == SOLVER_TWO_LEVEL)
        note(solved, "steps, below 60", 0, solved->pipeline->solution->iterations, STEPS_MOST,
             err);
}

static bool run_lamp(Validation *validation, Error *err)
{
    const CaseSetup setup = { .command = COMMAND_SOLVE, .closure = CLOSURE_BOTH, .patches = SMALL,
                              .rays = SMALL_RAYS };
    return by_each(validation, &bright_lamp, &setup, check_lamp, err);
}

/* --- nothing shines --------------------------------------------------------------------------- */

static void check_dark(const Solved *solved, Error *err)
{
    double furthest;
    mean_of(solved->pipeline, 0, &furthest);
    note(solved, "brightest patch", 0, furthest, 0, err);
}

static bool run_dark(Validation *validation, Error *err)
{
    static const LitCube dark = { 0.99, 0, 0 };
    const CaseSetup setup = { .command = COMMAND_SOLVE, .closure = CLOSURE_BOTH, .patches = SMALL,
                              .rays = SMALL_RAYS };
    return by_each(validation, &dark, &setup, check_dark, err);
}

/* --- the continuous radiosity equation in a cube ---------------------------------------------- */

/* Means by Galerkin's method, as for the case `cube`. */
static void check_cube(const Solved *solved, Error *err)
{
    const Pipeline *p = solved->pipeline;
    const double *b = p->solution->radiosity;
    note(solved, "wall", 0.1811055969, validation_mean(p, b, "x0", ANY_SIDE), FINE_MESH, err);
    note(solved, "floor", 0.1712160573, validation_mean(p, b, "z0", ANY_SIDE), FINE_MESH, err);
    note(solved, "ceiling", 1.104361555, validation_mean(p, b, "z1", ANY_SIDE), FINE_MESH, err);
}

static bool run_cube(Validation *validation, Error *err)
{
    static const LitCube lit = { 0.5, 0, 1 };
    const CaseSetup setup = { .command = COMMAND_SOLVE, .closure = CLOSURE_BOTH, .patches = FINE,
                              .rays = FINE_RAYS };
    return by_each(validation, &lit, &setup, check_cube, err);
}

const Case *validate_solver_cases(size_t *count)
{
    static const Case cases[] = {
        { "solvers-furnace", "all walls shine, rho 0.99, by every solver", run_bright },
        { "solvers-lamp", "the ceiling shines, rho 0.99, by every solver", run_lamp },
        { "solvers-dark", "nothing shines, by every solver", run_dark },
        { "solvers-cube", "cube with a shining ceiling, by every solver", run_cube },
    };
    *count = sizeof cases / sizeof *cases;
    return cases;
}
