/* SPDX-License-Identifier: BSD-3-Clause */
/* Form factors: cast or read from a file, measured, enforced, stored as was asked. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "app/pipeline.h"
#include "app/pipeline_adapt.h"
#include "app/pipeline_groups.h"
#include "app/pipeline_stochastic.h"
#include "app/saving.h"
#include "radiosity/links_file.h"

/* In a hurry, factors are cast again with this many rays in all: about a second's work. */
enum { HURRY_RAYS = 1 << 20, HURRY_RAYS_LEAST = 8 };

/* Bytes that links may take: what --max-memory leaves, half of it when a closed copy is made. */
static uint64_t links_budget(const Pipeline *pipeline)
{
    const uint64_t limit = pipeline->session->options.max_memory, used = progress_peak_bytes();
    const uint64_t left = limit > used ? limit - used : 1;
    if (limit == 0)
        return 0;
    return pipeline->session->settings.closure == CLOSURE_NONE ? left : left / 2 + 1;
}

/* Where links go that memory has no room for: TMPDIR, else beside the result. */
static bool spill_folder(const Options *options, char *folder, size_t size, Error *err)
{
    const char *given = getenv("TMPDIR"), *output = options->output;
    const char *slash = output != NULL ? strrchr(output, '/') : NULL;
    int n = 0;
    if (given != NULL && *given != '\0')
        n = snprintf(folder, size, "%s", given);
    else if (slash != NULL)
        n = snprintf(folder, size, "%.*s", slash > output ? (int)(slash - output) : 1, output);
    else
        n = snprintf(folder, size, ".");
    return (n >= 0 && (size_t)n < size) ||
           error_set(err, ERROR_USAGE, "the name of the folder for temporary files is too long");
}

static bool cast(Pipeline *pipeline, LinksOptions *lo, Error *err)
{
    Session *session = pipeline->session;
    bool again;
    lo->kept = saving_rows(pipeline->saving);
    do {
        pipeline->links = links_create(&pipeline->room, lo, &session->monitor, err);
        again = pipeline->links == NULL && pipeline_hurry(pipeline, err);
        const uint32_t few = HURRY_RAYS / pipeline->patches->count;
        lo->rays = few < lo->rays ? few : lo->rays;
        lo->rays = lo->rays > HURRY_RAYS_LEAST ? lo->rays : HURRY_RAYS_LEAST;
        lo->lamp_rays = lo->rays / 4;
        lo->kept = NULL;
    } while (again);
    return pipeline->links != NULL;
}

/* Reads --factors when the file is there, else casts and writes it. */
static bool find_links(Pipeline *pipeline, const LinksOptions *lo, Error *err)
{
    const Session *session = pipeline->session;
    const char *path = session->options.factors;
    LinksOptions casting = *lo;
    struct stat info;
    if (pipeline_groups_wanted(pipeline) && !pipeline_groups(pipeline, err))
        return false;
    if (pipeline->links != NULL)
        return true;
    if (path == NULL)
        return cast(pipeline, &casting, err);
    const uint64_t key = links_key(&pipeline->room, lo);
    if (stat(path, &info) == 0) {
        pipeline->links = links_load(path, key, lo, NULL, err);
        pipeline->factors_loaded = pipeline->links != NULL;
        return pipeline->factors_loaded;
    }
    /* What was cast in a hurry is not worth keeping. */
    return cast(pipeline, &casting, err) &&
           (session->hurry || links_save(pipeline->links, key, path, err));
}

static bool enforce(Pipeline *pipeline, Error *err)
{
    Session *session = pipeline->session;
    const double begin = progress_now();
    if (session->settings.closure == CLOSURE_NONE)
        return true;
    const Patches *patches = pipeline->groups == NULL ? pipeline->patches : NULL;
    Links *closed;
    do {
        closed = links_close(pipeline->links, patches, session->settings.closure,
                             session->settings.threads, &session->monitor, err);
    } while (closed == NULL && pipeline_hurry(pipeline, err));
    pipeline->closure_seconds = progress_now() - begin;
    if (closed == NULL)
        return false;
    links_change(pipeline->links, closed, &pipeline->change);
    pipeline->raw_links = pipeline->links;
    pipeline->links = closed;
    if (session->options.command != COMMAND_FACTORS)
        pipeline->raw_links = links_destroy(pipeline->raw_links);
    return links_report(closed, &pipeline->report, err);
}

/* Links in 16 bits take the place of the others; where those lie in a file, so do these, unless
 * memory has room enough. */
static bool store(Pipeline *pipeline, const LinksOptions *lo, Error *err)
{
    const Links *links = pipeline->links;
    if (pipeline->session->options.storage != STORAGE_16)
        return true;
    const bool small = lo->max_bytes == 0 || links_bytes(links) / 2 <= lo->max_bytes / 2;
    Links *packed = links_pack(links, small ? NULL : links->folder,
                               pipeline->session->settings.threads, &pipeline->rounding, err);
    if (packed == NULL)
        return false;
    links_destroy(pipeline->links);
    pipeline->links = packed;
    pipeline->report.bytes = links_bytes(packed);
    return true;
}

bool pipeline_factors(Pipeline *pipeline, Error *err)
{
    Session *session = pipeline->session;
    const Settings *settings = &session->settings;
    const double begin = progress_now();
    char folder[4096];
    assert(pipeline->patches != NULL && pipeline->links == NULL);
    if (settings->stochastic)
        return pipeline_stochastic_places(pipeline, err);
    pipeline_begin(pipeline, STAGE_FACTORS);
    if (!saving_resume(pipeline->saving, err))
        return false;
    if (pipeline->solution != NULL) { /* the links are not needed any more */
        pipeline_note(pipeline, STAGE_FACTORS, begin);
        return true;
    }
    if (!spill_folder(&session->options, folder, sizeof folder, err))
        return false;
    const LinksOptions lo = { .rays = settings->rays, .lamp_rays = settings->lamp_rays,
                              .seed = settings->seed, .threads = settings->threads,
                              .max_bytes = links_budget(pipeline), .folder = folder };
    if (pipeline->links == NULL && !find_links(pipeline, &lo, err))
        return false;
    saving_state(pipeline->saving, SAVING_LINKS);
    if (settings->adapt && !session->hurry &&
        !pipeline_adapt(pipeline, &lo, &pipeline->adapt, err))
        return false;
    saving_now(pipeline->saving);
    saving_state(pipeline->saving, SAVING_NOTHING);
    if (session->broken)
        return false;
    pipeline->factors_seconds = pipeline->links->seconds;
    if (!links_report(pipeline->links, &pipeline->raw, err))
        return false;
    pipeline->report = pipeline->raw;
    const bool done = enforce(pipeline, err) && store(pipeline, &lo, err);
    pipeline_note(pipeline, STAGE_FACTORS, begin);
    return done && pipeline_fits(pipeline, 0, session->options.scene, err);
}
