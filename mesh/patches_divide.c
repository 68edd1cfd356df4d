/* SPDX-License-Identifier: BSD-3-Clause */
/* Into how many cells each surface is cut at a patch size; the size for a wanted number of patches,
 * where none are merged. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "math/tolerance.h"
#include "mesh/patches_divide.h"

enum {
    DIVISIONS_MOST = UINT16_MAX,
    ROUND_LEAST = 8,      /* cells round a circle, so that curves look like curves */
    SPHERE_LEAST = 4,     /* cells from pole to pole */
    DISC_LEAST = 2,       /* cells from centre to rim */
    TUBE_LEAST = 6        /* cells round a torus' tube */
};

static const double PATCHES_MOST = 2147483648.0; /* 2^31, as the header says */

/* By the root mean square radius: exact for circles, else up to 11 % too long. */
static double ellipse_length(double a, double b)
{
    return 2 * M_PI * sqrt((a * a + b * b) / 2);
}

static PatchExtent shape_extent(const Shape *shape)
{
    const double x = vec3_length(shape->to_world.x), y = vec3_length(shape->to_world.y);
    const double z = vec3_length(shape->to_world.z), radius = fmax(x, y);
    PatchExtent e = { .least_u = ROUND_LEAST };
    switch (shape->kind) {
    case SHAPE_SPHERE:
        e.u = ellipse_length(x, y);
        e.v = ellipse_length(radius, z) / 2;
        e.least_v = SPHERE_LEAST;
        break;
    case SHAPE_DISC:
        e.u = ellipse_length(x, y);
        e.v = radius;
        e.least_v = DISC_LEAST;
        break;
    case SHAPE_FRUSTUM:
        e.u = ellipse_length(x, y) * fmax(1, shape->ratio);
        e.v = hypot(z, (shape->ratio - 1) * radius);
        e.least_v = 1;
        break;
    case SHAPE_TORUS:
        e.u = ellipse_length(x, y) * (1 + shape->ratio);
        e.v = ellipse_length(radius, z) * shape->ratio;
        e.least_v = TUBE_LEAST;
        break;
    }
    return e;
}

/* A triangle's n^2 patches: n = longest edge / size keeps edges short, but cuts a needle into n^2
 * needles; n = sqrt(2 area) / size gives patches of the right area, but leaves a needle whole. The
 * geometric mean of both lengths is 1.19 times the legs of a right isosceles triangle, 0.96 times
 * the edge of an equilateral one, and cuts a needle of length L and height h into L sqrt(L h) /
 * size^2 patches where a quad of that shape has L / size. */
static PatchExtent triangle_extent(double longest, double area)
{
    const double length = sqrt(longest * sqrt(2 * area));
    return (PatchExtent){ .u = length, .v = length, .least_u = 1, .least_v = 1, .triangle = true };
}

static PatchExtent surface_extent(const Surfaces *s, const Surface *f)
{
    if (f->kind == SURFACE_SHAPE)
        return shape_extent(&s->shape[f->primitive - s->triangle_count]);
    const uint32_t *c = s->corner + 3 * (size_t)f->primitive;
    const bool quad = f->kind == SURFACE_QUAD;
    const Vec3 p[4] = { s->position[c[0]], s->position[c[1]], s->position[c[2]],
                        s->position[quad ? c[5] : c[0]] };
    const double ab = vec3_length(vec3_sub(p[1], p[0])), bc = vec3_length(vec3_sub(p[2], p[1]));
    const double cd = vec3_length(vec3_sub(p[3], p[2])), da = vec3_length(vec3_sub(p[0], p[3]));
    if (!quad) /* d is a */
        return triangle_extent(fmax(ab, fmax(bc, cd)), f->area);
    return (PatchExtent){ .u = fmax(ab, cd), .v = fmax(bc, da), .least_u = 1, .least_v = 1 };
}

static uint32_t divisions(double length, double size, uint32_t least)
{
    /* Lengths come from positions in float: equal walls must not differ by a cell. */
    const double slack = 1 - (double)rounding_bound_float(32);
    const double n = ceil(length / size * slack);
    return n >= DIVISIONS_MOST ? DIVISIONS_MOST : n > least ? (uint32_t)n : least;
}

double divide_count(const Division *d, double size)
{
    double total = d->cluster_count;
    for (uint32_t i = 0; i < d->count; i++) {
        const PatchExtent *e = &d->extent[i];
        const uint32_t sides = divide_unmerged(d, i);
        if (sides == 0)
            continue;
        const bool whole = sides < e->sides;
        const double nu = whole ? 1 : divisions(e->u, size, e->least_u);
        const double nv = whole ? 1 : e->triangle ? nu : divisions(e->v, size, e->least_v);
        total += sides * nu * nv;
    }
    return total;
}

static void set_divisions(PatchBuilder *b, const Division *d, const Monitor *monitor)
{
    Patches *out = b->out;
    uint32_t limited = 0;
    for (uint32_t i = 0; i < out->surface_count; i++) {
        const PatchExtent *e = &d->extent[i];
        const bool whole = divide_unmerged(d, i) < e->sides;
        const uint32_t nu = whole ? 1 : divisions(e->u, out->size, e->least_u);
        const uint32_t nv = whole ? 1 : e->triangle ? nu : divisions(e->v, out->size, e->least_v);
        limited += e->sides > 0 && (nu == DIVISIONS_MOST || nv == DIVISIONS_MOST);
        out->nu[i] = (uint16_t)nu;
        out->nv[i] = (uint16_t)nv;
    }
    if (limited > 0)
        monitor_warn(monitor, "patch-size-limited", "",
                     "%u surfaces are cut into %d cells along an edge, which is the most; their "
                     "patches are larger than %g", limited, DIVISIONS_MOST, out->size);
}

static bool start_division(PatchBuilder *b, Division *d)
{
    const Surfaces *s = b->surfaces;
    *d = (Division){ .surfaces = s, .count = s->count };
    d->extent = array_create(s->count, sizeof *d->extent, "patch divisions", b->err);
    for (uint32_t i = 0; d->extent != NULL && i < s->count; i++) {
        d->extent[i] = surface_extent(s, &s->surface[i]);
        d->extent[i].sides = (uint8_t)(patches_side_used(b, i, 0) + patches_side_used(b, i, 1));
    }
    return d->extent != NULL;
}

bool patches_divide(PatchBuilder *b, const PatchOptions *options, const Monitor *monitor)
{
    Division d;
    if (!start_division(b, &d))
        return false;
    if (divide_find_size(&d, options, b->err)) {
        const double count = divide_count(&d, d.size);
        b->out->size = d.size;
        if (count <= PATCHES_MOST)
            set_divisions(b, &d, monitor);
        else
            error_set(b->err, ERROR_INPUT, "patches of size %g would be %.3g, more than 2^31",
                      d.size, count);
    }
    b->cluster = d.cluster;
    b->cluster_count = d.cluster_count;
    array_free(d.extent);
    return !error_is_set(b->err);
}
