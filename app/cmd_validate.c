/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux validate: runs the cases, prints the table, says which failed. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "app/commands.h"
#include "app/summary.h"
#include "app/validate.h"
#include "base/array.h"

/* Rays per measured point: independent scramblings of a power of two. */
enum { POINT_RAYS = 32768 };
/* Where rays leave more open than the mesh is asked for, these many standard errors pass. */
static const double ERRORS_OFF = 3;
/* The solver stops long before its part of a deviation can be seen. */
static const double SOLVE_TOLERANCE = 1e-9;

bool validation_run(const Validation *validation, Scene *scene, const CaseSetup *setup,
                    Session *session, Pipeline *pipeline, Error *err)
{
    const Options *asked = &validation->session->options;
    const int solver = setup->solver != NULL ? *setup->solver : asked->solver;
    const Options options = { .command = setup->command, .scene = validation->name,
                              .solver = solver, .given = { [OPTION_TOLERANCE] = true },
                              .quality = QUALITY_MEDIUM, .progress = PROGRESS_NONE,
                              .closure = (int)setup->closure, .sides = (int)setup->sides,
                              .patches = setup->patches, .rays = setup->rays, .unit_m = 1,
                              .threads = asked->threads, .seed = asked->seed,
                              .tolerance = SOLVE_TOLERANCE, .no_adapt = true };
    session_init(session, &options);
    session->quiet = true;
    *pipeline = (Pipeline){ .session = session, .scene = scene, .point = setup->point,
                            .normal = setup->normal, .point_count = setup->points };
    if (scene == NULL || error_is_set(err))
        return false;
    assert(scene_check(scene));
    if (!pipeline_mesh(pipeline, err) || !pipeline_patches(pipeline, err) || setup->patches_only)
        return !error_is_set(err);
    return pipeline_factors(pipeline, err) &&
           (setup->command == COMMAND_FACTORS || pipeline_solve(pipeline, err));
}

void validation_end(Session *session, Pipeline *pipeline)
{
    pipeline_clear(pipeline);
    session_clear(session);
}

/* Errors below this are rounding, of which no multiple says anything. */
static const double SIGMA_LEAST = 1e-9;

static void print_check(FILE *out, const Check *check)
{
    const double off = check->value - check->expected;
    char percent[24] = "-", sigmas[24] = "-";
    if (check->expected != 0)
        snprintf(percent, sizeof percent, "%+.3f %%", 100 * off / check->expected);
    if (check->standard_error > SIGMA_LEAST * fabs(check->expected))
        snprintf(sigmas, sizeof sigmas, "%+.1f se", off / check->standard_error);
    fprintf(out, "%-24s %-26s %12.7g %12.7g %+10.2e %10s %9s  %s\n", check->name,
            check->quantity, check->expected, check->value, off, percent, sigmas,
            check->passed ? "pass" : "FAIL");
}

void validation_check(Validation *validation, const char *quantity, double expected, double value,
                      double tolerance, double standard_error, Error *err)
{
    assert(tolerance >= 0 && quantity != NULL);
    if (error_is_set(err) ||
        !array_reserve((void **)&validation->checks, &validation->capacity, validation->count + 1,
                       sizeof *validation->checks, "results", err))
        return;
    Check *check = &validation->checks[validation->count++];
    *check = (Check){ .expected = expected, .value = value, .tolerance = tolerance,
                      .standard_error = standard_error,
                      .passed = fabs(value - expected) <= tolerance };
    snprintf(check->name, sizeof check->name, "%s", validation->name);
    snprintf(check->quantity, sizeof check->quantity, "%s", quantity);
    validation->failed += !check->passed;
    if (validation->out != NULL)
        print_check(validation->out, check);
}

double validation_mean(const Pipeline *pipeline, const double *value, const char *group,
                       unsigned side)
{
    const Patches *patches = pipeline->patches;
    double sum = 0, area = 0;
    for (uint32_t i = 0; i < patches->count; i++)
        if ((side == ANY_SIDE || patches->side[i] == side) &&
            strcmp(pipeline->scene->polygons.group_name[patches->group[i]], group) == 0) {
            sum += pipeline->links->area[i] * value[ROOM_BANDS * i];
            area += pipeline->links->area[i];
        }
    return sum / area;
}

double validation_measure(const Pipeline *pipeline, Vec3 point, Vec3 normal, double *error,
                          Error *err)
{
    Irradiance result = { .standard_error = NAN };
    Gatherer *gatherer = gatherer_create(&pipeline->room, pipeline->solution, pipeline->links,
                                         err);
    if (gatherer == NULL)
        return NAN;
    gather_irradiance(gatherer, point, normal, POINT_RAYS, pipeline->session->settings.seed,
                      &result);
    gatherer_destroy(gatherer);
    *error = result.standard_error;
    return rgb_luminance(rgb_add(result.direct, result.indirect));
}

static bool check_points(Validation *validation, const Pipeline *pipeline, const MeanSetup *means,
                         Error *err)
{
    for (size_t i = 0; i < means->points && !error_is_set(err); i++) {
        const PointRadiosity *p = &means->point[i];
        double error = NAN;
        const double h = validation_measure(pipeline, p->point, p->normal, &error, err);
        error *= p->reflectance;
        validation_check(validation, p->quantity, p->radiosity, p->exitance + p->reflectance * h,
                         fmax(means->tolerance, ERRORS_OFF * error), error, err);
    }
    return !error_is_set(err);
}

bool validation_means(Validation *validation, Scene *scene, const MeanSetup *means,
                      const WallMean *walls, size_t count, Error *err)
{
    const CaseSetup setup = { .command = COMMAND_SOLVE, .closure = CLOSURE_BOTH,
                              .patches = means->patches, .rays = means->rays };
    Session session;
    Pipeline pipeline;
    if (validation_run(validation, scene, &setup, &session, &pipeline, err)) {
        for (size_t i = 0; i < count; i++)
            validation_check(validation, walls[i].quantity, walls[i].radiosity,
                             validation_mean(&pipeline, pipeline.solution->radiosity,
                                             walls[i].group, walls[i].side),
                             means->tolerance, NAN, err);
        check_points(validation, &pipeline, means, err);
    }
    validation_end(&session, &pipeline);
    return !error_is_set(err);
}

/* --- the run ---------------------------------------------------------------------------------- */

static bool run_cases(Validation *validation, const Case *cases, size_t count, Error *err)
{
    const Session *session = validation->session;
    const char *filter = session->options.filter;
    for (size_t i = 0; i < count; i++) {
        validation->name = cases[i].name;
        if (filter != NULL && strstr(cases[i].name, filter) == NULL)
            continue;
        if (session_stopped(session))
            return error_set(err, ERROR_STOPPED, "validate: %s", session_stop_reason());
        if (!cases[i].run(validation, err))
            return false;
        fflush(validation->out);
    }
    return true;
}

static bool write_json(const Validation *validation, int exit_code, const Error *failure,
                       Error *err)
{
    Summary summary;
    if (!summary_begin(&summary, validation->session, exit_code, failure, err))
        return false;
    if (summary.file == NULL)
        return true;
    Json *json = &summary.json;
    json_count(json, "passed", validation->count - validation->failed);
    json_count(json, "failed", validation->failed);
    json_open(json, "cases", '[');
    for (size_t i = 0; i < validation->count; i++) {
        const Check *check = &validation->checks[i];
        json_open(json, NULL, '{');
        json_text(json, "case", check->name);
        json_text(json, "quantity", check->quantity);
        json_number(json, "expected", check->expected);
        json_number(json, "value", check->value);
        json_number(json, "deviation", check->value - check->expected);
        json_number(json, "tolerance", check->tolerance);
        json_number(json, "standard_error", check->standard_error);
        json_bool(json, "passed", check->passed);
        json_close(json, '}');
    }
    json_close(json, ']');
    json_open(json, "seconds", '{');
    json_number(json, "total", progress_now() - validation->session->printer.start);
    json_close(json, '}');
    return summary_finish(&summary, validation->session, err);
}

bool cmd_validate(Pipeline *pipeline, int *exit_code, Error *err)
{
    Session *session = pipeline->session;
    const char *json = session->options.json;
    const bool taken = json != NULL && strcmp(json, "-") == 0;
    Validation v = { .session = session, .out = taken ? stderr : stdout };
    Error json_error = { 0 };
    typedef const Case *(*CaseList)(size_t *count);
    static const CaseList lists[] = { validate_factor_cases, validate_view_cases,
                                      validate_closed_cases, validate_light_cases,
                                      validate_plate_cases, validate_room_cases,
                                      validate_enclosure_cases, validate_made_cases,
                                      validate_solver_cases };
    session->told = true;
    fprintf(v.out, "%-24s %-26s %12s %12s %10s %10s %9s  %s\n", "case", "quantity", "expected",
            "value", "deviation", "per cent", "sigma", "verdict");
    for (size_t i = 0; i < sizeof lists / sizeof *lists && !error_is_set(err); i++) {
        size_t count = 0;
        const Case *cases = lists[i](&count);
        run_cases(&v, cases, count, err);
    }
    if (v.count == 0 && !error_is_set(err))
        error_set(err, ERROR_USAGE, "no case has '%s' in its name", session->options.filter);
    fprintf(v.out, "%zu passed, %zu failed\n", v.count - v.failed, v.failed);
    *exit_code = v.failed > 0 ? 4 : 0;
    write_json(&v, error_is_set(err) ? (int)err->code : *exit_code, err, &json_error);
    if (error_is_set(&json_error) && !error_is_set(err))
        *err = json_error;
    array_free(v.checks);
    return !error_is_set(err);
}
