/* SPDX-License-Identifier: BSD-3-Clause */
/* The patch size for a wanted number of patches: cells of grids and merged small surfaces. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "mesh/patches_divide.h"

enum {
    WANTED_DEFAULT = 10000,
    BISECTIONS = 60,      /* halve an interval of sizes down to the last bit of a double */
    TRIES_MOST = 12       /* sizes tried where surfaces are merged, which is slow */
};

/* A surface alone takes its place for each side; where there are more of them than patches wanted,
 * this share of the wanted number still goes into dividing the large ones. */
static const double WANTED_RESERVE = 0.2;

/* With merging a number this near to the wanted one is taken: well below the 20 % that a solution's
 * cost may be off, and reached in a few tries. */
static const double NEAR_ENOUGH = 0.03;

/* Clusters are of surfaces of less area than this in squares of the size (as patches_merge.c has
 * it): for a first guess only. */
static const double SMALL_AREA = 0.5;

/* --- grids alone ------------------------------------------------------------------------------ */

typedef double (*SizeCount)(const Division *d, double size);

/* The size whose number of patches is nearest to `target`; at `high` there are fewer. */
static double bisect_size(const Division *d, SizeCount number, double high, double target)
{
    double low = high;
    /* Ends when all divisions are at their most, if not before. */
    for (int k = 0; k < BISECTIONS && number(d, low) < target; k++)
        low /= 2;
    for (int k = 0; k < BISECTIONS && low < high; k++) {
        const double middle = sqrt(low * high);
        if (!(middle > low && middle < high))
            break;
        if (number(d, middle) < target)
            high = middle;
        else
            low = middle;
    }
    const double over = number(d, low) - target, under = target - number(d, high);
    return over <= under ? low : high;
}

static double largest_extent(const Division *d)
{
    double largest = 0;
    for (uint32_t i = 0; i < d->count; i++)
        if (d->extent[i].sides > 0)
            largest = fmax(largest, fmax(d->extent[i].u, d->extent[i].v));
    return largest;
}

/* --- with small surfaces merged --------------------------------------------------------------- */

/* Patches if small surfaces could be merged at will. */
static double pooled_count(const Division *d, double size)
{
    double total = 0;
    for (uint32_t i = 0; i < d->count; i++) {
        const PatchExtent *e = &d->extent[i];
        const double area = d->surfaces->surface[i].area / (size * size);
        if (e->least_u == 1 && area < SMALL_AREA)
            total += e->sides * area;
        else
            total += e->sides * fmax(ceil(e->u / size), e->least_u)
                   * fmax(ceil(e->v / size), e->least_v);
    }
    return total;
}

typedef struct {
    const PatchOptions *options;
    Division *best;           /* keeps the size and clusters of the best try */
    double    off;            /* how far that is off the target */
    double    target;
    double    low, high;      /* sizes with more patches than the target, and with fewer */
    double    low_count, high_count;
    int       tries;
} SizeSearch;

/* Number of patches at a size; keeps it when it is the nearest to the target so far. */
static bool try_size(SizeSearch *search, double size, double *count, Error *err)
{
    Division d = *search->best;
    d.cluster = array_create(2 * (size_t)d.count, sizeof *d.cluster, "patch pieces", err);
    if (d.cluster == NULL
        || !merge_small(d.surfaces, search->options, size, d.cluster, &d.cluster_count, err)) {
        array_free(d.cluster);
        return false;
    }
    search->tries++;
    *count = divide_count(&d, size);
    const double off = fabs(*count - search->target);
    if (off < search->off) {
        array_free(search->best->cluster);
        *search->best = d;
        search->best->size = size;
        search->off = off;
    } else {
        array_free(d.cluster);
    }
    return true;
}

/* The next size to try: between two known ones numbers go like a power of the size. */
static double next_size(const SizeSearch *search)
{
    const double low = log(search->low), high = log(search->high);
    const double fewer = log(search->high_count), more = log(search->low_count);
    double at = (more - log(search->target)) / (more - fewer);
    /* Never so near to an end that only this end would move. */
    at = fmin(fmax(at, 0.1), 0.9);
    if (search->tries % 4 == 3 || !isfinite(at))
        at = 0.5;
    return exp(low + at * (high - low));
}

static bool search_size(SizeSearch *search, double size, Error *err)
{
    bool low = false, high = false;
    while (search->tries < TRIES_MOST && search->off > NEAR_ENOUGH * search->target) {
        double count;
        if (!try_size(search, size, &count, err))
            return false;
        if (count >= search->target) {
            low = true;
            search->low = size;
            search->low_count = count;
        } else {
            high = true;
            search->high = size;
            search->high_count = fmax(count, 1);
        }
        if (low && high)
            size = next_size(search);
        else /* a little further than needed, so that the next is on the other side */
            size *= sqrt(fmax(count, 1) / search->target) * (low ? 1.1 : 0.9);
    }
    return true;
}

/* A size at which nothing is larger than one patch. */
static double scene_size(const Surfaces *s, double largest)
{
    return fmax(vec3_length(vec3_sub(s->hi, s->lo)), largest);
}

static bool find_merged_size(Division *d, const PatchOptions *options, double largest,
                             double wanted, Error *err)
{
    const double high = scene_size(d->surfaces, largest);
    SizeSearch search = { .options = options, .best = d, .target = wanted, .off = INFINITY };
    double least;
    if (!try_size(&search, high, &least, err))
        return false;
    search.target = fmax(wanted, least + WANTED_RESERVE * wanted);
    search.off = fabs(least - search.target);
    search.tries = 0;
    return search_size(&search, bisect_size(d, pooled_count, high, search.target), err);
}

bool divide_find_size(Division *d, const PatchOptions *options, Error *err)
{
    const double largest = largest_extent(d);
    const double wanted = options->wanted > 0 ? options->wanted : WANTED_DEFAULT;
    double least = 0;
    d->size = options->size > 0 ? options->size : 1;
    if (!(largest > 0))
        return true; /* no side is in use */
    if (!(options->size > 0)) {
        least = divide_count(d, largest);
        d->size = bisect_size(d, divide_count, largest,
                              fmax(wanted, least + WANTED_RESERVE * wanted));
    }
    if (options->separate)
        return true;
    SizeSearch search = { .options = options, .best = d, .off = INFINITY, .target = wanted };
    double count;
    if (!try_size(&search, d->size, &count, err))
        return false;
    /* Without clusters, and room for all surfaces, the grids' size stands. */
    const bool room = least + WANTED_RESERVE * wanted <= wanted;
    if (options->size > 0 || (room && (d->cluster_count == 0
                                       || search.off <= NEAR_ENOUGH * wanted)))
        return true;
    d->cluster = array_free(d->cluster);
    d->cluster_count = 0;
    return find_merged_size(d, options, largest, wanted, err);
}
