/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux measure: illuminance at points. */
#include <math.h>
#include <string.h>

#include "app/commands.h"
#include "app/pipeline_accuracy.h"
#include "app/place.h"
#include "app/points.h"
#include "app/summary.h"
#include "base/array.h"
#include "base/file.h"
#include "base/parallel.h"
#include "math/sampling.h"

/* Of a point, where --accuracy is asked for. */
enum { FIRST_RAYS = 1024 };

/* Points a thread takes at a time: few, for one may cost thousands of rays. */
enum { POINT_CHUNK = 4 };

typedef struct {
    const Gatherer *gatherer;
    const Points   *points;
    Irradiance     *result; /* [points->count] */
    uint32_t        rays, seed;
} Measuring;

static void measure_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Measuring *m = context;
    (void)worker;
    for (uint32_t i = begin; i < end; i++)
        gather_irradiance(m->gatherer, m->points->point[i], m->points->normal[i], m->rays,
                          sampling_seed(m->seed, i, 0, 0), &m->result[i]);
}

/* Results of all points, or NULL. Stopped: those not reached are left out, *done says so. */
static Irradiance *measure(Pipeline *pipeline, const Points *points, bool *done, Error *err)
{
    Session *session = pipeline->session;
    const double begin = progress_now();
    if (points->count > UINT32_MAX) {
        error_set(err, ERROR_INPUT, "more than 2^32 points");
        return NULL;
    }
    Measuring m = { .points = points, .rays = session->settings.gather_rays,
                    .seed = session->settings.seed };
    Gatherer *gatherer = gatherer_create(&pipeline->room, pipeline->solution, pipeline->links,
                                         err);
    m.gatherer = gatherer;
    m.result = array_create(points->count, sizeof *m.result, "points", err);
    for (size_t i = 0; m.result != NULL && i < points->count; i++)
        m.result[i].standard_error = -1; /* not measured yet */
    if (gatherer != NULL && m.result != NULL)
        *done = parallel_for((uint32_t)points->count, POINT_CHUNK, session->settings.threads,
                             measure_chunk, &m, &session->monitor,
                             &(Progress){ .stage = "gather", .done = 1, .energy_left = -1 });
    gatherer_destroy(gatherer);
    pipeline_note(pipeline, STAGE_GATHER, begin);
    return error_is_set(err) ? array_free(m.result) : m.result;
}

/* Root mean square of the points' standard errors over that of what they receive. */
static double error_of(const Irradiance *result, size_t count)
{
    double squares = 0, all = 0;
    for (size_t i = 0; i < count; i++) {
        const double e = rgb_luminance(rgb_add(result[i].direct, result[i].indirect));
        squares += result[i].standard_error * result[i].standard_error;
        all += e * e;
    }
    return all > 0 ? sqrt(squares / all) : 0;
}

/* With twice as many rays each time, while --accuracy asks for them and they are allowed; what was
 * measured stays when time runs out while it is measured better. */
static Irradiance *measure_accurately(Pipeline *pipeline, const Points *points, bool *done,
                                      Error *err)
{
    LightAccuracy *a = &pipeline->accuracy;
    Settings *settings = &pipeline->session->settings;
    const uint32_t most = pipeline_accuracy_point_rays(pipeline);
    if (a->asked > 0)
        settings->gather_rays = settings->gather_rays < FIRST_RAYS ? settings->gather_rays
                                                                   : FIRST_RAYS;
    Irradiance *best = measure(pipeline, points, done, err);
    while (best != NULL && *done && a->asked > 0) {
        a->points = error_of(best, points->count);
        a->point_rays = settings->gather_rays;
        if (!(a->points > a->asked) || settings->gather_rays > most / 2)
            break;
        settings->gather_rays *= 2;
        bool whole = false;
        Irradiance *better = measure(pipeline, points, &whole, err);
        if (better == NULL)
            return array_free(best);
        array_free(whole ? best : better);
        best = whole ? better : best;
        if (!whole)
            break;
    }
    return best;
}

static bool write_points(const Pipeline *pipeline, const Points *points, const Irradiance *result,
                         const char *path, Error *err)
{
    OutFile *file = outfile_open(path, err);
    const bool lux = pipeline->session->options.units == UNITS_PHOTOMETRIC;
    if (file == NULL)
        return false;
    FILE *out = outfile_stream(file);
    fputs(lux ? "x,y,z,nx,ny,nz,E_r,E_g,E_b,lux,lux_direct,lux_error\n"
              : "x,y,z,nx,ny,nz,E_r,E_g,E_b,W/m2,W/m2_direct,W/m2_error\n", out);
    for (size_t i = 0; i < points->count; i++) {
        const Vec3 n = points->given[i];
        char place[PLACE_TEXT];
        const Rgb e = rgb_add(result[i].direct, result[i].indirect);
        if (result[i].standard_error < 0)
            continue;
        place_text(pipeline->scene, points->point[i], 9, place);
        fprintf(out, "%s,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.3g\n", place, n.x, n.y, n.z, e.r,
                e.g, e.b, rgb_luminance(e), rgb_luminance(result[i].direct),
                result[i].standard_error);
    }
    return outfile_commit(file, err);
}

/* `points` in the file's coordinates: they go where the scene went. */
static bool measure_points(Pipeline *pipeline, const Points *points, int *exit_code, Error *err)
{
    Session *session = pipeline->session;
    const Options *options = &session->options;
    const char *output = options->output != NULL ? options->output : "-";
    bool done = false;
    if (!pipeline_read(pipeline, err))
        return false;
    for (size_t i = 0; i < points->count; i++)
        points->point[i] = scene_from_file(pipeline->scene, points->point[i]);
    if (!pipeline_mesh(pipeline, err) || !pipeline_patches(pipeline, err) ||
        !pipeline_accurate(pipeline, err))
        return false;
    Irradiance *result = measure_accurately(pipeline, points, &done, err);
    if (result == NULL)
        return false;
    *exit_code = pipeline_exit_code(pipeline);
    const double begin = progress_now();
    const bool written = write_points(pipeline, points, result, output, err);
    array_free(result);
    pipeline_note(pipeline, STAGE_WRITE, begin);
    if (!done) {
        *exit_code = ERROR_STOPPED;
        monitor_warn(&session->monitor, "stopped", output, "%s: some points are missing",
                     session_stop_reason());
    }
    if (!written)
        return false;
    session_say(session, "isolux: %s, %zu points -> %s", options->scene, points->count, output);
    summary_print(pipeline);
    return true;
}

bool cmd_measure(Pipeline *pipeline, int *exit_code, Error *err)
{
    const Options *options = &pipeline->session->options;
    Points points = { 0 };
    if (options->points == NULL)
        return error_set(err, ERROR_USAGE, "measure needs --points FILE");
    if (!pipeline_accuracy_allowed(options, err))
        return false;
    if (options->output == NULL && options->json != NULL && strcmp(options->json, "-") == 0)
        return error_set(err, ERROR_USAGE, "--json - needs -o FILE for the points");
    bool done = points_read(&points, options->points, err);
    if (done) {
        pipeline->point = points.point;
        pipeline->normal = points.normal;
        pipeline->point_count = points.count;
        done = measure_points(pipeline, &points, exit_code, err);
    }
    points_free(&points);
    return done;
}
