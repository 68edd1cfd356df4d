/* SPDX-License-Identifier: BSD-3-Clause */
/* A solved mesh per light group. */
#include "app/group_files.h"

#include <assert.h>
#include <string.h>

#include "app/commands.h"
#include "app/name_mark.h"
#include "base/array.h"

static const char MARK[] = "{group}";

enum { PATH_MOST = 4096 };

bool group_files_asked(const char *output)
{
    return output != NULL && strstr(output, MARK) != NULL;
}

bool group_files_allowed(const Options *options, Error *err)
{
    if (!group_files_asked(options->output))
        return true;
    if (!options->light_groups || options->compare)
        return error_set(err, ERROR_USAGE, "-o %s: %s stands for light groups: needs "
                         "--light-groups, not with --compare", options->output, MARK);
    return true;
}

/* Group k's name, or "all" for k = group_count, in the place of the mark. */
static bool group_path(const Relit *relit, uint32_t k, const char *output, char path[PATH_MOST],
                       Error *err)
{
    const char *const all = "all";
    if (k < relit->group_count)
        return name_mark_fill(output, MARK, relit->name, relit->group_count, k, path, PATH_MOST,
                              err);
    const char **name = array_create((size_t)k + 1, sizeof *name, "light groups", err);
    if (name == NULL)
        return false;
    memcpy(name, relit->name, k * sizeof *name);
    name[k] = all;
    const bool filled = name_mark_fill(output, MARK, name, k + 1, k, path, PATH_MOST, err);
    array_free(name);
    return filled;
}

static bool write_group(Pipeline *p, uint32_t k, Solution *alone, double *dimmer,
                        const char *output, Error *err)
{
    const Relit *relit = &p->relit;
    char path[PATH_MOST];
    if (!group_path(relit, k, output, path, err))
        return false;
    for (uint32_t j = 0; j < relit->group_count * ROOM_BANDS; j++)
        dimmer[j] = j / ROOM_BANDS == k;
    light_groups_mix(relit->groups, dimmer, p->session->settings.threads, alone);
    Solution *const all = p->solution;
    p->solution = alone;
    const bool done = ply_write(p, path, err);
    p->solution = all;
    return done;
}

bool group_files_write(Pipeline *p, const char *output, Error *err)
{
    const Relit *relit = &p->relit;
    assert(relit->groups != NULL && p->solution != NULL);
    const size_t values = (size_t)p->patches->count * ROOM_BANDS;
    Solution alone = { .count = p->patches->count, .bands = ROOM_BANDS };
    alone.radiosity = array_create(values, sizeof(double), "a light group", err);
    alone.irradiance = array_create(values, sizeof(double), "a light group", err);
    double *dimmer = array_create((size_t)relit->group_count * ROOM_BANDS, sizeof *dimmer,
                                  "dimmers", err);
    bool done = !error_is_set(err);
    for (uint32_t k = 0; k < relit->group_count && done; k++)
        done = write_group(p, k, &alone, dimmer, output, err);
    char path[PATH_MOST];
    done = done && group_path(relit, relit->group_count, output, path, err) &&
           ply_write(p, path, err);
    array_free(alone.radiosity);
    array_free(alone.irradiance);
    array_free(dimmer);
    return done;
}
