/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as a checkpoint: refused in one clear line, or all of it sound. */
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "radiosity/checkpoint.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static void demand(bool condition)
{
    if (!condition)
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    Error err = { 0 };
    Checkpoint checkpoint = { 0 };
    FILE *stream = fmemopen((void *)(size > 0 ? bytes : (const uint8_t *)""), size + (size == 0),
                            "rb");

    demand(stream != NULL);
    const bool good = checkpoint_read(&checkpoint, stream, size, "fuzz.checkpoint", &err);
    fclose(stream);
    demand(good != error_is_set(&err));
    demand(good || (err.code == ERROR_INPUT && err.text[0] != 0 &&
                    strchr(err.text, '\n') == NULL));
    demand(!good || checkpoint.links == NULL || links_check(checkpoint.links));
    checkpoint_clear(&checkpoint);
    demand(array_live() == 0);
    return 0;
}
