/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux factors: the form-factor matrix by group, material or patch; exchange of heat. */
#include <string.h>

#include "app/commands.h"
#include "app/factors_again.h"
#include "app/factors_files.h"
#include "app/output.h"
#include "app/per_group.h"
#include "app/summary.h"
#include "base/array.h"
#include "radiosity/exchange.h"

/* A view factor as good as nothing: then the faces look away from each other. */
static const double NEARLY_ALL = 0.999;

/* 20 degrees Celsius, where no temperature is given. */
static const double ROOM_TEMPERATURE = 293.15;

static bool write_patches(Pipeline *pipeline, const LinksErrors *errors, const char *output,
                          Error *err)
{
    char matrix[4096], table[4096];
    if (output_ends(output, ".npz")) {
        if (!factors_write_patches_npz(pipeline, errors, output, err))
            return false;
        session_say(pipeline->session, "isolux: %s -> %s", pipeline->session->options.scene,
                    output);
        return true;
    }
    if (!output_name(output, ".mtx", matrix, sizeof matrix, err) ||
        !output_name(output, ".csv", table, sizeof table, err))
        return false;
    if (!factors_write_patches(pipeline, errors, matrix, table, err))
        return false;
    session_say(pipeline->session, "isolux: %s -> %s, %s", pipeline->session->options.scene,
                matrix, table);
    return true;
}

static bool write_by_patch(Pipeline *pipeline, const char *output, Error *err)
{
    const char *path = pipeline->session->options.errors;
    LinksErrors *errors = path != NULL ? factors_patch_errors(pipeline, err) : NULL;
    const bool good = (path == NULL || errors != NULL) &&
                      write_patches(pipeline, errors, output, err) &&
                      (path == NULL || factors_write_errors(errors, path, err));
    links_errors_destroy(errors);
    return good;
}

static bool write_matrix(const Options *options, const Classes *classes, const double *factor,
                         const char *output, Error *err)
{
    const bool script = options->exchange == EXCHANGE_HOTTEL;
    if (output_ends(output, ".npz"))
        return factors_write_npz(classes, factor, output, err);
    if (output_ends(output, ".vf") || output_ends(output, ".txt"))
        return factors_write_view3d(classes, factor, script, output, err);
    if (output_ends(output, ".mtx"))
        return factors_write_class_mtx(classes, factor, output, err);
    return factors_write_csv(classes, (FactorsBy)options->by, factor, output, err);
}

/* Matrix of exchange factors. */
static bool write_exchange(const Options *options, const ExchangeProblem *problem,
                           const Classes *classes, const char *output, Error *err)
{
    const bool script = options->exchange == EXCHANGE_HOTTEL;
    double *factor = array_create(problem->count * problem->count, sizeof *factor,
                                  "exchange factors", err);
    const bool good = factor != NULL &&
                      exchange_factors(problem, script ? NULL : factor, script ? factor : NULL,
                                       err) &&
                      write_matrix(options, classes, factor, output, err);
    array_free(factor);
    return good;
}

static bool write_flux(const Options *options, const ExchangeProblem *problem,
                       const Classes *classes, const char *output, Error *err)
{
    const size_t n = problem->count;
    double *temperature = array_create(n, sizeof *temperature, "temperatures", err);
    double *flux = array_create(n, sizeof *flux, "heat flux", err);
    bool good = temperature != NULL && flux != NULL;
    for (size_t i = 0; good && i < n; i++)
        temperature[i] = ROOM_TEMPERATURE;
    good = good &&
           (options->temperature == NULL ||
            per_group_read(options->temperature, classes->name, n, temperature, err)) &&
           exchange_flux(problem, temperature,
                         options_given(options, OPTION_SURROUNDINGS) ? options->surroundings
                                                                     : ROOM_TEMPERATURE,
                         flux, err) &&
           factors_write_flux(classes, temperature, flux, output, err);
    array_free(temperature);
    array_free(flux);
    return good;
}

static bool write_by_class(Pipeline *pipeline, const char *output, Error *err)
{
    Session *session = pipeline->session;
    const Options *options = &session->options;
    Classes classes = { 0 };
    bool good = classes_sum(pipeline, (FactorsBy)options->by, &classes, err) &&
                (options->emissivity == NULL ||
                 per_group_read(options->emissivity, classes.name, classes.count,
                                classes.emissivity, err)) &&
                (options->errors == NULL || classes.error != NULL ||
                 classes_errors(pipeline, (FactorsBy)options->by, &classes, err));
    const ExchangeProblem problem = { .count = classes.count, .factor = classes.factor,
                                      .escape = classes.escape,
                                      .emissivity = classes.emissivity };
    if (good && options->exchange == EXCHANGE_NONE)
        good = write_matrix(options, &classes, classes.factor, output, err);
    else if (good && options->exchange == EXCHANGE_FLUX)
        good = write_flux(options, &problem, &classes, output, err);
    else if (good)
        good = write_exchange(options, &problem, &classes, output, err);
    if (good && options->rows != NULL)
        good = factors_write_class_rows(&classes, (FactorsBy)options->by, options->rows, err);
    if (good && options->errors != NULL)
        good = factors_write_csv(&classes, (FactorsBy)options->by, classes.error, options->errors,
                                 err);
    classes_clear(&classes);
    if (good)
        session_say(session, "isolux: %s -> %s", options->scene, output);
    return good;
}

static bool options_fit(const Options *options, const char *output, Error *err)
{
    if (options->by == BY_PATCH && strcmp(output, "-") == 0)
        return error_set(err, ERROR_USAGE, "--by patch writes two files; -o needs a name");
    if (options->by == BY_PATCH && options->rows != NULL)
        return error_set(err, ERROR_USAGE, "--rows is of groups or materials; --by patch writes "
                         "row sums beside the matrix");
    if (options->by == BY_PATCH && options->exchange != EXCHANGE_NONE)
        return error_set(err, ERROR_USAGE, "--exchange is between groups or materials");
    if (options->exchange != EXCHANGE_FLUX && options->temperature != NULL)
        return error_set(err, ERROR_USAGE, "--temperature belongs to --exchange flux");
    if (options->output == NULL && options->json != NULL && strcmp(options->json, "-") == 0)
        return error_set(err, ERROR_USAGE, "--json - needs -o FILE for the matrix");
    return true;
}

bool cmd_factors(Pipeline *pipeline, int *exit_code, Error *err)
{
    Session *session = pipeline->session;
    const Options *options = &session->options;
    const char *output = options->output != NULL ? options->output : "-";
    if (options->points != NULL)
        return factors_of_points(pipeline, output, err);
    if (!options_fit(options, output, err) || !pipeline_read(pipeline, err) ||
        !pipeline_mesh(pipeline, err) || !pipeline_patches(pipeline, err) ||
        !pipeline_factors(pipeline, err))
        return false;
    *exit_code = pipeline_exit_code(pipeline);
    if (pipeline->report.escaped > NEARLY_ALL)
        monitor_warn(&session->monitor, "all-escaped", options->scene,
                     "no side sees another; faces that look outwards need --sides both");
    const double begin = progress_now();
    if (!(options->by == BY_PATCH ? write_by_patch : write_by_class)(pipeline, output, err))
        return false;
    pipeline_note(pipeline, STAGE_WRITE, begin);
    summary_print(pipeline);
    return true;
}
