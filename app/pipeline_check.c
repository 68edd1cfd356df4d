/* SPDX-License-Identifier: BSD-3-Clause */
/* The check of a solution by paths, and what is told of it. */
#include "app/pipeline_check.h"

#include <math.h>
#include <stdio.h>

/* Paths from each patch in each half, unless said. */
enum { CHECK_RAYS = 256 };

/* Exit code of what was asked to stop. */
enum { STOPPED = 5 };

bool pipeline_check_allowed(const Pipeline *pipeline, Error *err)
{
    if (options_given(&pipeline->session->options, OPTION_LIGHT_CHECK) && pipeline->room.mirrors)
        return error_set(err, ERROR_USAGE, "--check: its paths end at mirrors and glass, and light "
                         "goes on there; --solver stochastic leaves them out too");
    return true;
}

bool pipeline_check(Pipeline *pipeline, int *exit_code, Error *err)
{
    const Session *session = pipeline->session;
    const uint32_t *asked = session->options.light_check;
    if (!options_given(&session->options, OPTION_LIGHT_CHECK) || session->hurry)
        return true;
    const LightCheckOptions options = { .patches = asked[0],
                                        .rays = asked[1] > 0 ? asked[1] : CHECK_RAYS,
                                        .seed = session->settings.seed,
                                        .threads = session->settings.threads };
    if (light_check(&pipeline->room, pipeline->links, &pipeline->problem, pipeline->solution,
                    &options, &pipeline->check, &session->monitor, err))
        return true;
    pipeline->check = (LightCheck){ .patches = 0 };
    if (err->code != ERROR_STOPPED)
        return false;
    *err = (Error){ 0 };
    *exit_code = STOPPED;
    return true;
}

static void put_error(Json *json, const char *name, const LightError *error)
{
    json_open(json, name, '{');
    json_number(json, "rms", error->found);
    json_number(json, "standard_error", error->standard_error);
    json_close(json, '}');
}

void pipeline_check_put(Json *json, const LightCheck *check)
{
    if (check->patches == 0)
        return;
    json_open(json, "check", '{');
    json_count(json, "patches", check->patches);
    json_count(json, "rays_per_half", check->rays);
    put_error(json, "irradiance", &check->all);
    if (check->apart) {
        put_error(json, "direct", &check->direct);
        put_error(json, "reflected", &check->reflected);
    }
    json_number(json, "mean_irradiance", check->mean);
    json_number(json, "worst_hundredth", check->worst);
    json_count(json, "rays", check->cast);
    json_close(json, '}');
}

static void text_of(const LightError *error, char *text, size_t size)
{
    snprintf(text, size, "%.2g +- %.1g %%", 100 * error->found, 100 * error->standard_error);
}

void pipeline_check_print(const Pipeline *pipeline)
{
    const LightCheck *c = &pipeline->check;
    char all[32], direct[32], reflected[32];
    if (c->patches == 0)
        return;
    text_of(&c->all, all, sizeof all);
    text_of(&c->direct, direct, sizeof direct);
    text_of(&c->reflected, reflected, sizeof reflected);
    session_say(pipeline->session, "  check    irradiance off by %s (rms, relative to the mean), "
                "by %u paths twice from %u patches", all, c->rays, c->patches);
    if (c->apart)
        session_say(pipeline->session, "           direct by %s, reflected by %s", direct,
                    reflected);
    session_say(pipeline->session, "           %.2g of the square in the worst hundredth of them",
                c->worst);
}
