/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux compare: the error of one picture against another, in luminance. */
#include "app/commands.h"
#include "app/summary.h"
#include "base/array.h"
#include "render/compare.h"
#include "render/image.h"

static void say_comparison(Session *session, const Comparison *c)
{
    session_say(session, "isolux: %s against %s", session->options.other, session->options.scene);
    session_say(session, "  counted     %.1f %% of the pixels, smooth %.1f %%; mean luminance %.6g",
                100 * c->counted, 100 * c->smooth, c->mean);
    session_say(session, "  all         %.3f %%    relative RMSE of luminance", 100 * c->all_error);
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
    json_number(json, "smooth", c->smooth_error);
    json_number(json, "block", c->block_error);
    json_number(json, "bias", c->bias);
    json_number(json, "psnr", c->psnr);
    json_close(json, '}');
    return summary_finish(&summary, session, err);
}

bool cmd_compare(Pipeline *pipeline, int *exit_code, Error *err)
{
    Session *session = pipeline->session;
    const Options *options = &session->options;
    Comparison comparison = { 0 };
    int width = 0, height = 0, other_width = 0, other_height = 0;
    *exit_code = 0;
    session->told = true;
    float *reference = image_read_exr(options->scene, &width, &height, err);
    float *picture = image_read_exr(options->other, &other_width, &other_height, err);
    if (!error_is_set(err) && (width != other_width || height != other_height))
        error_set(err, ERROR_INPUT, "%s is %d x %d, %s is %d x %d: not the same picture",
                  options->scene, width, height, options->other, other_width, other_height);
    if (!error_is_set(err))
        image_compare(reference, picture, width, height, options->lamp, &comparison, err);
    array_free(picture);
    array_free(reference);
    if (error_is_set(err))
        return false;
    say_comparison(session, &comparison);
    return write_json(session, &comparison, err);
}
