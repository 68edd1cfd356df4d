/* SPDX-License-Identifier: BSD-3-Clause */
/* app/relit.h -- light groups, and how a change of light was carried out, for summaries. */
#ifndef APP_RELIT_H
#define APP_RELIT_H

#include "radiosity/relight.h"

typedef struct {
    LightGroups *groups;       /* NULL: not asked for */
    uint32_t     group_count, first_light; /* from first_light on: point lights */
    const char **name;         /* [group_count]  the scene's */
    uint32_t    *group_of;     /* [groups of the scene]  light group; UINT32_MAX: none */
    double      *dimmer;       /* [group_count * bands]  what `mixed` groups were dimmed by */
    char        *layer_text;   /* names of layers, see layer_name */
    const char **layer_name;   /* [group_count + 1]  the last: light of no group */
    double       groups_seconds;
    bool         lights_changed, mixed; /* mixed: from light groups, not solved for */
    double       seconds, cpu_seconds; /* from the change to the new solution */
} Relit;

void relit_clear(Relit *relit);

#endif
