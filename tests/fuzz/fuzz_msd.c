/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as an MSD file: a scene that passes its check or one line of error; no leaks. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "scenes/internal.h"

static void demand(bool condition)
{
    if (!condition)
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    Error  err = { 0 };
    Scene *scene = scene_parse_msd("fuzz.msd", (const char *)data, size, NULL, &err);

    demand((scene != NULL) != error_is_set(&err));
    if (scene != NULL)
        demand(scene_check(scene));
    else
        demand(err.text[0] != 0 && strchr(err.text, '\n') == NULL);
    scene_destroy(scene);
    demand(array_live() == 0);
    return 0;
}
