/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as a saved tree, with a checksum that is right: refused in one clear line, or sound
 * enough for rays. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"
#include "raycast/bvh.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

enum { HEADER = 72, SUM = 8, SIDE = 6, VERTICES = (SIDE + 1) * (SIDE + 1) };

static void demand(bool condition)
{
    if (!condition)
        abort();
}

/* A square of 6 * 6 squares: the scene of the corpus. */
static Primitives sheet(Vec3 position[VERTICES], uint32_t corner[SIDE * SIDE * 6])
{
    Primitives in = { .position = position, .corner = corner, .vertex_count = VERTICES };
    for (uint32_t i = 0; i < VERTICES; i++)
        position[i] = vec3(i % (SIDE + 1), i / (SIDE + 1), i % 3);
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        const uint32_t a = i / SIDE * (SIDE + 1) + i % SIDE, d = a + SIDE + 1;
        const uint32_t six[6] = { a, a + 1, d + 1, a, d + 1, d };
        memcpy(corner + 3 * in.triangle_count, six, sizeof six);
        in.triangle_count += 2;
    }
    return in;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    Vec3 position[VERTICES];
    uint32_t corner[SIDE * SIDE * 6];
    Error err = { 0 };
    const Primitives in = sheet(position, corner);
    uint8_t *copy = malloc(size + 1);
    demand(copy != NULL);
    if (size > 0)
        memcpy(copy, bytes, size);
    if (size >= HEADER + SUM) {
        const uint64_t sum = file_hash(copy + HEADER, size - HEADER - SUM,
                                       file_hash(copy, HEADER, 0));
        memcpy(copy + size - SUM, &sum, SUM);
    }
    Bvh *bvh = bvh_parse(copy, size, "fuzz.bvh", &in, &err);
    demand((bvh == NULL) == error_is_set(&err));
    if (bvh == NULL)
        demand(err.code == ERROR_INPUT && err.text[0] != 0 && strchr(err.text, '\n') == NULL);
    for (int i = 0; bvh != NULL && i < 8; i++) {
        const Ray ray = { 0.3f * (float)i, 1.7f, -5, 0, 0.1f, 0.05f * (float)i, 1, INFINITY };
        Hit hit;
        demand(bvh_nearest(bvh, &ray, &hit) == bvh_blocked(bvh, &ray));
        demand(hit.primitive == RAY_MISS || hit.primitive < in.triangle_count);
    }
    bvh_destroy(bvh);
    free(copy);
    demand(array_live() == 0);
    return 0;
}
