/* SPDX-License-Identifier: BSD-3-Clause */
/* Light groups as layers of pictures. */
#include "app/light_layers.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "app/name_mark.h"
#include "base/array.h"

static const char MARK[] = "{group}";
static const char REST[] = "background"; /* the layer of what no group sends */

/* Room for "+1000000" behind a name. */
enum { NAME_MOST = IMAGE_NAME - 12 };

uint32_t light_layers_count(const Pipeline *pipeline)
{
    const Relit *relit = &pipeline->relit;
    return relit->groups != NULL && relit->group_count > 0 ? relit->group_count + 1 : 0;
}

/* Group k's name as far as layers can have it: a dot would begin a layer within the layer. */
static void shorten(const Relit *relit, uint32_t k, char out[IMAGE_NAME])
{
    snprintf(out, NAME_MOST, "%s", k < relit->group_count ? relit->name[k] : REST);
    for (char *c = out; *c != '\0'; c++)
        *c = *c == '.' ? '_' : *c;
}

static bool find_names(Relit *relit, Error *err)
{
    const uint32_t count = relit->group_count + 1;
    char (*plain)[IMAGE_NAME] = array_create(count, IMAGE_NAME, "light groups", err);
    char (*text)[IMAGE_NAME] = array_create(count, IMAGE_NAME, "light groups", err);
    const char **name = array_create(count, sizeof *name, "light groups", err);
    relit->layer_text = (char *)text;
    relit->layer_name = array_create(count, sizeof *relit->layer_name, "light groups", err);
    for (uint32_t k = 0; !error_is_set(err) && k < count; k++) {
        shorten(relit, k, plain[k]);
        name[k] = plain[k];
        relit->layer_name[k] = text[k];
    }
    for (uint32_t k = 0; !error_is_set(err) && k < count; k++)
        name_mark_fill(MARK, MARK, name, count, k, text[k], IMAGE_NAME, err);
    array_free(plain);
    array_free(name);
    return !error_is_set(err);
}

bool light_layers_split(Pipeline *pipeline, Gatherer *gatherer, Error *err)
{
    Relit *relit = &pipeline->relit;
    assert(gatherer != NULL && relit->layer_name == NULL);
    if (light_layers_count(pipeline) == 0)
        return true;
    if (!find_names(relit, err))
        return false;
    const GatherGroups groups = { .count = relit->group_count, .first_light = relit->first_light,
                                  .radiosity = relit->groups->radiosity,
                                  .dimmer = relit->mixed ? relit->dimmer : NULL,
                                  .of_group = relit->group_of, .name = relit->layer_name };
    return gatherer_split(gatherer, &groups, pipeline->links, err);
}
