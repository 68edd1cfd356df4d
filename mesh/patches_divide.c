/* SPDX-License-Identifier: BSD-3-Clause */
/* Into how many cells each surface is cut, from a patch size or a wanted number of patches. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "math/tolerance.h"
#include "mesh/patches_internal.h"

enum {
    DIVISIONS_MOST = UINT16_MAX,
    WANTED_DEFAULT = 10000,
    ROUND_LEAST = 8,      /* cells round a circle, so that curves look like curves */
    SPHERE_LEAST = 4,     /* cells from pole to pole */
    DISC_LEAST = 2,       /* cells from centre to rim */
    TUBE_LEAST = 6,       /* cells round a torus' tube */
    BISECTIONS = 60       /* halve an interval of sizes down to the last bit of a double */
};

static const double PATCHES_MOST = 2147483648.0; /* 2^31, as the header says */

/* A surface alone takes its place for each side; where there are more of them than patches wanted,
 * this share of the wanted number still goes into dividing the large ones. */
static const double WANTED_RESERVE = 0.2;

typedef struct {
    double   u, v;             /* lengths to divide */
    uint16_t least_u, least_v;
    uint8_t  sides;            /* sides in use */
    bool     triangle;
} Extent;

/* By the root mean square radius: exact for circles, else up to 11 % too long. */
static double ellipse_length(double a, double b)
{
    return 2 * M_PI * sqrt((a * a + b * b) / 2);
}

static Extent shape_extent(const Shape *shape)
{
    const double x = vec3_length(shape->to_world.x), y = vec3_length(shape->to_world.y);
    const double z = vec3_length(shape->to_world.z), radius = fmax(x, y);
    Extent e = { .least_u = ROUND_LEAST };
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
static Extent triangle_extent(double longest, double area)
{
    const double length = sqrt(longest * sqrt(2 * area));
    return (Extent){ .u = length, .v = length, .least_u = 1, .least_v = 1, .triangle = true };
}

static Extent surface_extent(const Surfaces *s, const Surface *f)
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
    return (Extent){ .u = fmax(ab, cd), .v = fmax(bc, da), .least_u = 1, .least_v = 1 };
}

static uint32_t divisions(double length, double size, uint32_t least)
{
    /* Lengths come from positions in float: equal walls must not differ by a cell. */
    const double slack = 1 - (double)rounding_bound_float(32);
    const double n = ceil(length / size * slack);
    return n >= DIVISIONS_MOST ? DIVISIONS_MOST : n > least ? (uint32_t)n : least;
}

static double count_patches(const Extent *extent, uint32_t count, double size)
{
    double total = 0;
    for (uint32_t i = 0; i < count; i++) {
        const Extent *e = &extent[i];
        if (e->sides == 0)
            continue;
        const double nu = divisions(e->u, size, e->least_u);
        const double nv = e->triangle ? nu : divisions(e->v, size, e->least_v);
        total += e->sides * nu * nv;
    }
    return total;
}

/* The size whose number of patches is nearest to `wanted`. */
static double find_size(const Extent *extent, uint32_t count, double wanted)
{
    double high = 0;
    for (uint32_t i = 0; i < count; i++)
        if (extent[i].sides > 0)
            high = fmax(high, fmax(extent[i].u, extent[i].v));
    if (!(high > 0))
        return 1; /* no side is in use */
    const double least = count_patches(extent, count, high);
    const double target = fmax(wanted, least + WANTED_RESERVE * wanted);
    double low = high;
    /* Ends when all divisions are at their most, if not before. */
    for (int k = 0; k < BISECTIONS && count_patches(extent, count, low) < target; k++)
        low /= 2;
    for (int k = 0; k < BISECTIONS && low < high; k++) {
        const double middle = sqrt(low * high);
        if (!(middle > low && middle < high))
            break;
        if (count_patches(extent, count, middle) < target)
            high = middle;
        else
            low = middle;
    }
    const double over = count_patches(extent, count, low) - target;
    const double under = target - count_patches(extent, count, high);
    return over <= under ? low : high;
}

static void set_divisions(PatchBuilder *b, const Extent *extent, const Monitor *monitor)
{
    Patches *out = b->out;
    uint32_t limited = 0;
    for (uint32_t i = 0; i < out->surface_count; i++) {
        const Extent *e = &extent[i];
        const uint32_t nu = divisions(e->u, out->size, e->least_u);
        const uint32_t nv = e->triangle ? nu : divisions(e->v, out->size, e->least_v);
        limited += e->sides > 0 && (nu == DIVISIONS_MOST || nv == DIVISIONS_MOST);
        out->nu[i] = (uint16_t)nu;
        out->nv[i] = (uint16_t)nv;
    }
    if (limited > 0)
        monitor_warn(monitor, "patch-size-limited", "",
                     "%u surfaces are cut into %d cells along an edge, which is the most; their "
                     "patches are larger than %g", limited, DIVISIONS_MOST, out->size);
}

bool patches_divide(PatchBuilder *b, const PatchOptions *options, const Monitor *monitor)
{
    const Surfaces *s = b->surfaces;
    Extent *extent = array_create(s->count, sizeof *extent, "patch divisions", b->err);
    if (extent == NULL)
        return false;
    for (uint32_t i = 0; i < s->count; i++) {
        extent[i] = surface_extent(s, &s->surface[i]);
        extent[i].sides = (uint8_t)(patches_side_used(b, i, 0) + patches_side_used(b, i, 1));
    }
    const double wanted = options->wanted > 0 ? options->wanted : WANTED_DEFAULT;
    b->out->size = options->size > 0 ? options->size : find_size(extent, s->count, wanted);
    const double count = count_patches(extent, s->count, b->out->size);
    if (count <= PATCHES_MOST)
        set_divisions(b, extent, monitor);
    else
        error_set(b->err, ERROR_INPUT, "patches of size %g would be %.3g, more than 2^31",
                  b->out->size, count);
    array_free(extent);
    return !error_is_set(b->err);
}
