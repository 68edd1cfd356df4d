/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux compare: the error of one picture, or one solution, against another, in luminance. */
#include <math.h>
#include <string.h>
#include <strings.h>

#include "app/commands.h"
#include "app/compare_ply.h"
#include "app/output.h"
#include "app/summary.h"
#include "base/array.h"
#include "math/rgb.h"
#include "render/compare.h"
#include "render/false_colour.h"
#include "render/image.h"

static void say_comparison(Session *session, const Comparison *c)
{
    session_say(session, "isolux: %s against %s", session->options.other, session->options.scene);
    session_say(session, "  counted     %.1f %% of the pixels, smooth %.1f %%; mean luminance %.6g",
                100 * c->counted, 100 * c->smooth, c->mean);
    session_say(session, "  all         %.3f %%    relative RMSE of luminance", 100 * c->all_error);
    session_say(session, "  rmse        %.6g    the same, absolute", c->all_error * c->mean);
    session_say(session, "  smooth      %.3f %%    without silhouettes", 100 * c->smooth_error);
    session_say(session, "  block       %.3f %%    8 x 8 means", 100 * c->block_error);
    session_say(session, "  bias       %+.3f %%", 100 * c->bias);
    session_say(session, "  psnr        %.2f dB", c->psnr);
}

static bool write_json(const Session *session, const Comparison *c, Error *err)
{
    Summary summary;
    Error none = { 0 };
    if (!summary_begin(&summary, session, 0, &none, err))
        return false;
    if (summary.file == NULL)
        return true;
    Json *json = &summary.json;
    json_open(json, "compare", '{');
    json_text(json, "reference", session->options.scene);
    json_text(json, "picture", session->options.other);
    json_number(json, "mean", c->mean);
    json_number(json, "counted", c->counted);
    json_number(json, "smooth_pixels", c->smooth);
    json_number(json, "all", c->all_error);
    json_number(json, "rmse", c->all_error * c->mean);
    json_number(json, "smooth", c->smooth_error);
    json_number(json, "block", c->block_error);
    json_number(json, "bias", c->bias);
    json_number(json, "psnr", c->psnr);
    json_close(json, '}');
    return summary_finish(&summary, session, err);
}

/* The difference of luminance, in per cent of the reference's mean, as a PNG in two colours. The
 * scale ends at four times the error, so that what sticks out of noise shows. */
static bool write_difference(const Session *session, const float *reference, const float *picture,
                             int width, int height, const Comparison *c, Error *err)
{
    static const double SIGMAS = 4, LEAST = 1e-6; /* per cent: equal pictures have a scale too */
    const Options *options = &session->options;
    const double   error = fmax(100 * SIGMAS * c->all_error, LEAST);
    const size_t   n = (size_t)width * (size_t)height;
    FalseColour    scale = { .low = -error, .high = error, .signs = true };
    float         *values = array_create(n, sizeof *values, "difference", err);
    if (options_given(options, OPTION_RANGE)) {
        scale.low = options->range[0];
        scale.high = options->range[1];
    }
    for (size_t i = 0; values != NULL && i < n; i++) {
        const float *a = reference + 3 * i, *b = picture + 3 * i;
        values[i] = (float)(100 / c->mean *
                            (rgb_luminance(rgb(b[0], b[1], b[2])) -
                             rgb_luminance(rgb(a[0], a[1], a[2]))));
    }
    const ImageInfo info = { .version = ISOLUX_VERSION, .scene = options->other };
    const bool ok = values != NULL && false_colour_write(values, width, height, &scale, "%", &info,
                                                         options->output, err);
    array_free(values);
    return ok;
}

static bool compare_pictures(Session *session, Error *err)
{
    const Options *options = &session->options;
    Comparison comparison = { 0 };
    int width = 0, height = 0, other_width = 0, other_height = 0;
    float *reference = image_read_layer(options->scene, options->layer, &width, &height, err);
    float *picture = image_read_layer(options->other, options->layer, &other_width, &other_height,
                                      err);
    if (!error_is_set(err) && (width != other_width || height != other_height))
        error_set(err, ERROR_INPUT, "%s is %d x %d, %s is %d x %d: not the same picture",
                  options->scene, width, height, options->other, other_width, other_height);
    if (!error_is_set(err))
        image_compare(reference, picture, width, height, options->lamp, &comparison, err);
    if (!error_is_set(err) && options->output != NULL)
        write_difference(session, reference, picture, width, height, &comparison, err);
    array_free(picture);
    array_free(reference);
    if (error_is_set(err))
        return false;
    say_comparison(session, &comparison);
    return write_json(session, &comparison, err);
}

/* --- solutions -------------------------------------------------------------------------------- */

static void say_meshes(Session *session, const MeshComparison *c)
{
    const CompareRow *all = &c->all;
    session_say(session, "isolux: %s against %s", session->options.other, session->options.scene);
    session_say(session, "  points      %u, %.2f %% of them found on both", c->samples,
                100 * all->matched);
    session_say(session, "  mean        %.6g    irradiance, luminance; the other %.6g", all->mean,
                all->other);
    session_say(session, "  error       %.3f %%    relative RMSE of irradiance", 100 * all->error);
    session_say(session, "  bias       %+.3f %%", 100 * (all->other / all->mean - 1));
}

static void json_row(Json *json, const CompareRow *row)
{
    json_number(json, "share", row->share);
    json_number(json, "matched", row->matched);
    json_number(json, "mean", row->mean);
    json_number(json, "mean_other", row->other);
    json_number(json, "error", row->error);
}

static bool write_meshes(const Session *session, const SolvedMesh *reference,
                         const MeshComparison *c, Error *err)
{
    Summary summary;
    Error none = { 0 };
    if (!summary_begin(&summary, session, 0, &none, err))
        return false;
    if (summary.file == NULL)
        return true;
    Json *json = &summary.json;
    json_open(json, "compare", '{');
    json_text(json, "reference", session->options.scene);
    json_text(json, "solution", session->options.other);
    json_count(json, "samples", c->samples);
    json_bool(json, "constant", session->options.constant);
    json_row(json, &c->all);
    json_open(json, "groups", '[');
    for (uint32_t g = 0; g < reference->group_count; g++) {
        if (!(c->group[g].share > 0))
            continue;
        json_open(json, NULL, '{');
        json_text(json, "group", reference->group_name[g]);
        json_row(json, &c->group[g]);
        json_close(json, '}');
    }
    json_close(json, ']');
    json_close(json, '}');
    return summary_finish(&summary, session, err);
}

/* Tolerances grow with coordinates: both go to the origin together. */
static void come_near(SolvedMesh *reference, SolvedMesh *mesh)
{
    if (!reference->far || reference->vertex_count == 0)
        return;
    const Vec3 by = reference->position[0];
    solved_mesh_move(reference, by);
    solved_mesh_move(mesh, by);
}

static bool compare_meshes(Session *session, Error *err)
{
    const Options *options = &session->options;
    const CompareOptions compare = { .samples = options->samples, .seed = options->seed,
                                     .constant = options->constant };
    SolvedMesh reference = { 0 }, mesh = { 0 };
    MeshComparison comparison = { 0 };
    bool good = solved_mesh_read(&reference, options->scene, err) &&
                solved_mesh_read(&mesh, options->other, err);
    if (good) {
        come_near(&reference, &mesh);
        good = mesh_compare(&reference, &mesh, &compare, &comparison, err);
    }
    if (good) {
        say_meshes(session, &comparison);
        good = write_meshes(session, &reference, &comparison, err);
    }
    mesh_comparison_clear(&comparison);
    solved_mesh_clear(&reference);
    solved_mesh_clear(&mesh);
    return good;
}

static bool is_ply(const char *path)
{
    const size_t length = strlen(path);
    return length >= 4 && strcasecmp(path + length - 4, ".ply") == 0;
}

bool cmd_compare(Pipeline *pipeline, int *exit_code, Error *err)
{
    Session *session = pipeline->session;
    const Options *options = &session->options;
    const bool ply = is_ply(options->scene);
    *exit_code = 0;
    session->told = true;
    if (options->output != NULL && (ply || !output_ends(options->output, ".png")))
        return error_set(err, ERROR_USAGE, "-o of compare is a picture of the difference between "
                         "two pictures, and ends in .png");
    if (ply != is_ply(options->other))
        return error_set(err, ERROR_USAGE, "compare takes two pictures (.exr) or two solved "
                         "meshes (.ply), not one of each");
    return ply ? compare_meshes(session, err) : compare_pictures(session, err);
}
