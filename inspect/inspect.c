/* SPDX-License-Identifier: BSD-3-Clause */
/* What is wrong with a scene's geometry: the searches one after the other. */
#include "inspect/inspect.h"

#include <assert.h>
#include <time.h>

#include "base/array.h"
#include "inspect/internal.h"
#include "math/tolerance.h"

/* Two points, or a point and a plane, are both off by rounding. */
double inspect_tolerance(double largest_coordinate)
{
    return 2 * position_tolerance(largest_coordinate);
}

static double clock_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec / 1e9;
}

/* Where nothing gives light and nobody looks, all sides are in use, which tells nothing. */
static void look_at_sides(Inspector *in)
{
    const uint8_t *sides = in->options->sides;
    for (uint32_t i = 0; sides != NULL && i < in->surfaces->count; i++) {
        in->sighted = in->sighted || sides[i] != 3;
        in->out->hidden += sides[i] == 0;
    }
}

bool inspect(const Surfaces *surfaces, const InspectOptions *options, Defects *defects,
             Inspection *inspection, const Monitor *monitor, Error *err)
{
    assert(surfaces != NULL && options != NULL && inspection != NULL && err != NULL);
    if (error_is_set(err))
        return false;
    const double begin = clock_seconds();
    Inspector    in = { .surfaces = surfaces, .options = options, .monitor = monitor,
                        .defects = defects, .out = inspection, .err = err };
    *inspection = (Inspection){ 0 };
    look_at_sides(&in);
    const bool ok = inspect_rims(&in) && inspect_crossings(&in) && inspect_parts(&in);
    box_tree_clear(&in.tree);
    inspection->seconds = clock_seconds() - begin;
    if (!ok)
        inspection_clear(inspection);
    return ok;
}

void inspection_clear(Inspection *inspection)
{
    array_free(inspection->rim);
    array_free(inspection->edge);
    array_free(inspection->part);
    *inspection = (Inspection){ 0 };
}
