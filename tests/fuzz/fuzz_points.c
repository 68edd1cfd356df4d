/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as a file of measuring points: points or one clear line, never a crash or leak. */
#include <stdlib.h>

#include "app/points.c"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    Error err = { 0 };
    Points points = { 0 };
    char *text = malloc(size + 1);
    if (text == NULL)
        abort();
    memcpy(text, bytes, size);
    text[size] = '\0';
    const bool good = points_parse(&points, text, size, "points", &err);
    if (good == error_is_set(&err) || (good && points.count == 0))
        abort();
    for (size_t i = 0; i < points.count; i++)
        if (!vec3_finite(points.point[i]) || !(fabs(vec3_length(points.normal[i]) - 1) < 1e-9))
            abort();
    points_free(&points);
    free(text);
    if (array_live() != 0)
        abort();
    return 0;
}
