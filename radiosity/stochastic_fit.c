/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/stochastic_fit.c -- noisy irradiance replaced by linear functions of place over groups
 * of patches: those groups of the tree that have the least estimated error.
 *
 * A group's error is what differs within it from the fit, and what noise the fit lets through;
 * noise is how far two independent halves are apart. The estimate is unbiased for a fixed group
 * [mallows73]; the best groups of all are found from the leaves up [donoho97]. Where a few patches
 * of a group deviate from its fit alike in both halves, such as along a shadow's edge that cuts a
 * corner off the group, they get that back. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "radiosity/stochastic_internal.h"

enum { SERIES = 2 * ROOM_BANDS, AXES = 3 };

/* Directions thinner than this share of the widest tell nothing: places of one plane, rounded. */
static const double THIN = 1e-4;

/* Moments of a group about its mean: places, and one value. */
typedef struct {
    double   area, mean[AXES + 1];
    double   m[AXES + 1][AXES + 1]; /* lower triangle */
    double   noise;                 /* sum of area * variance of the mean of the halves */
    uint32_t patches;
} Moments;

typedef struct {
    const EvenTree *tree;
    const double   *area;
    double         *const *half;
    uint8_t        *group;   /* [tree->count]  of the node parted at this place: it is one group */
    uint32_t        groups;
} Fit;

typedef struct {
    Moments moments;
    double  cost;
    bool    joined;   /* may be one group */
} FitNode;

static void moments_join(const Moments *a, const Moments *b, Moments *out)
{
    if (!(a->area > 0) || !(b->area > 0)) {
        *out = a->area > 0 ? *a : *b;
        return;
    }
    out->area = a->area + b->area;
    out->noise = a->noise + b->noise;
    out->patches = a->patches + b->patches;
    const double share = b->area / out->area, product = a->area * share;
    double off[AXES + 1];
    for (unsigned i = 0; i <= AXES; i++) {
        off[i] = b->mean[i] - a->mean[i];
        out->mean[i] = a->mean[i] + share * off[i];
    }
    for (unsigned i = 0; i <= AXES; i++)
        for (unsigned j = 0; j <= i; j++)
            out->m[i][j] = a->m[i][j] + b->m[i][j] + product * off[i] * off[j];
}

/* Cholesky's parts of the places' moments; thin directions are left out. Returns the rank. */
static unsigned factorize(const Moments *m, double l[AXES][AXES])
{
    const double thin = THIN * THIN * (m->m[0][0] + m->m[1][1] + m->m[2][2]);
    unsigned rank = 0;
    memset(l, 0, AXES * sizeof *l);
    for (unsigned j = 0; j < AXES; j++) {
        double pivot = m->m[j][j];
        for (unsigned k = 0; k < j; k++)
            pivot -= l[j][k] * l[j][k];
        if (!(pivot > thin))
            continue;
        rank++;
        l[j][j] = sqrt(pivot);
        for (unsigned i = j + 1; i < AXES; i++) {
            double sum = m->m[i][j];
            for (unsigned k = 0; k < j; k++)
                sum -= l[i][k] * l[j][k];
            l[i][j] = sum / l[j][j];
        }
    }
    return rank;
}

/* Slope of what has the moments `with` with places; returns how much of it the slope explains. */
static double slope_of(double l[AXES][AXES], const double with[AXES], double slope[AXES])
{
    double y[AXES], explained = 0;
    for (unsigned i = 0; i < AXES; i++) {
        double sum = with[i];
        for (unsigned k = 0; k < i; k++)
            sum -= l[i][k] * y[k];
        y[i] = l[i][i] > 0 ? sum / l[i][i] : 0;
        explained += y[i] * y[i];
    }
    for (unsigned i = AXES; i-- > 0;) {
        double sum = y[i];
        for (unsigned k = i + 1; k < AXES; k++)
            sum -= l[k][i] * slope[k];
        slope[i] = l[i][i] > 0 ? sum / l[i][i] : 0;
    }
    return explained;
}

static double value_of(const Fit *f, uint32_t patch, unsigned series)
{
    return f->half[series / ROOM_BANDS][(size_t)patch * ROOM_BANDS + series % ROOM_BANDS]
           / f->area[patch];
}

/* Patches that nothing reached do not count: they may be dark for good. */
static FitNode leaf(const Fit *f, uint32_t patch)
{
    double sum[2] = { 0, 0 };
    const Vec3 p = f->tree->place[patch];
    for (unsigned k = 0; k < SERIES; k++)
        sum[k / ROOM_BANDS] += value_of(f, patch, k);
    FitNode node = { .joined = true };
    if (!(sum[0] + sum[1] > 0))
        return node;
    const double area = f->area[patch];
    node.moments = (Moments){ .area = area, .mean = { p.x, p.y, p.z, sum[0] + sum[1] },
                              .noise = area * (sum[0] - sum[1]) * (sum[0] - sum[1]),
                              .patches = 1 };
    return node;
}

/* Estimated error of one group, but for what all choices have in common. */
static double group_cost(const Moments *m, double variance)
{
    double l[AXES][AXES], slope[AXES];
    const unsigned rank = factorize(m, l);
    const double even = m->m[AXES][AXES] + EVEN_PENALTY * variance;
    const double left = m->m[AXES][AXES] - slope_of(l, m->m[AXES], slope);
    return fmin(even, fmax(left, 0) + EVEN_PENALTY * variance * (1 + rank));
}

static void range_noise(const Fit *f, uint32_t begin, uint32_t end, double *noise, uint32_t *count)
{
    *noise = 0, *count = 0;
    for (uint32_t k = begin; k < end; k++) {
        const FitNode node = leaf(f, f->tree->order[k]);
        *noise += node.moments.noise;
        *count += node.moments.patches;
    }
}

/* `variance`: area * variance of a patch, mean over a group around it; 0: not known yet. */
static FitNode choose(Fit *f, uint32_t begin, uint32_t end, double variance)
{
    if (end - begin < 2 * EVEN_POOL && !(variance > 0)) {
        double noise;
        uint32_t count;
        range_noise(f, begin, end, &noise, &count);
        variance = count > 0 ? noise / count : 0;
    }
    if (end - begin == 1) {
        FitNode node = leaf(f, f->tree->order[begin]);
        node.cost = node.moments.patches > 0 ? EVEN_PENALTY * variance : 0;
        return node;
    }
    const uint32_t middle = begin + (end - begin) / 2;
    const FitNode a = choose(f, begin, middle, variance), b = choose(f, middle, end, variance);
    FitNode node = { .cost = a.cost + b.cost,
                     .joined = a.joined && b.joined && f->tree->joined[middle] };
    moments_join(&a.moments, &b.moments, &node.moments);
    f->group[middle] = 0;
    if (!node.joined || !(node.moments.area > 0))
        return node;
    if (!(variance > 0))
        variance = node.moments.noise / node.moments.patches;
    const double cost = group_cost(&node.moments, variance);
    if (cost <= node.cost) {
        node.cost = cost;
        f->group[middle] = 1;
    }
    return node;
}

/* Slopes of all series, shortened so that no sum over halves gets negative. */
static void fit_series(const Fit *f, uint32_t begin, uint32_t end, const Moments *m,
                       const double mean[SERIES], double slope[SERIES][AXES])
{
    double l[AXES][AXES], with[SERIES][AXES] = { { 0 } }, low[ROOM_BANDS] = { 0 };
    factorize(m, l);
    for (uint32_t k = begin; k < end; k++) {
        const uint32_t i = f->tree->order[k];
        const Vec3 p = f->tree->place[i];
        const double off[AXES] = { p.x - m->mean[0], p.y - m->mean[1], p.z - m->mean[2] };
        if (leaf(f, i).moments.patches > 0)
            for (unsigned s = 0; s < SERIES; s++)
                for (unsigned a = 0; a < AXES; a++)
                    with[s][a] += f->area[i] * off[a] * (value_of(f, i, s) - mean[s]);
    }
    for (unsigned s = 0; s < SERIES; s++)
        slope_of(l, with[s], slope[s]);
    for (uint32_t k = begin; k < end; k++) {
        const Vec3 p = f->tree->place[f->tree->order[k]];
        const double off[AXES] = { p.x - m->mean[0], p.y - m->mean[1], p.z - m->mean[2] };
        for (unsigned b = 0; b < ROOM_BANDS; b++) {
            double rise = 0;
            for (unsigned a = 0; a < AXES; a++)
                rise += (slope[b][a] + slope[ROOM_BANDS + b][a]) * off[a];
            low[b] = fmin(low[b], rise);
        }
    }
    for (unsigned s = 0; s < SERIES; s++) {
        const unsigned b = s % ROOM_BANDS;
        const double sum = mean[b] + mean[ROOM_BANDS + b];
        for (unsigned a = 0; a < AXES && sum + low[b] < 0; a++)
            slope[s][a] *= fmax(sum, 0) / -low[b];
    }
}

/* Correlation of the two halves' deviations of so many patches from which on these are light: fewer
 * must agree better for the same EVEN_TAKEN; one tells nothing. */
static const double TOLD[EVEN_JUDGED + 1] = { 1, 1, 0.9992, 0.974, 0.919, 0.859, 0.802, 0.751,
                                              0.7071 };

/* Share of the deviation `off` of `lit` patches (in both halves) that is light: what the halves
 * have in common of it, of all of it. None where noise alone may be the cause. */
static double deviation_share(double off[EVEN_JUDGED][SERIES], uint32_t lit)
{
    double common = 0, all = 0;
    for (uint32_t k = 0; k < EVEN_JUDGED; k++) {
        double sum[2] = { 0, 0 };
        for (unsigned s = 0; s < SERIES; s++)
            sum[s / ROOM_BANDS] += off[k][s];
        common += sum[0] * sum[1];
        all += (sum[0] * sum[0] + sum[1] * sum[1]) / 2;
    }
    return lit > 1 && common > TOLD[lit] * all ? common / all : 0;
}

/* Gives some patches of a group, at most EVEN_JUDGED, the values of its fit, and of their deviation
 * what is light; adds their power to `power`. */
static void settle_pool(const Fit *f, uint32_t begin, uint32_t end, const Moments *m,
                        const double mean[SERIES], double slope[SERIES][AXES],
                        double power[SERIES])
{
    double off[EVEN_JUDGED][SERIES] = { { 0 } };
    uint32_t lit = 0;
    for (uint32_t k = begin; k < end; k++) {
        const uint32_t i = f->tree->order[k];
        const Vec3 p = f->tree->place[i];
        const double at[AXES] = { p.x - m->mean[0], p.y - m->mean[1], p.z - m->mean[2] };
        if (leaf(f, i).moments.patches == 0)
            continue;
        lit++;
        for (unsigned s = 0; s < SERIES; s++) {
            double value = mean[s];
            for (unsigned a = 0; a < AXES; a++)
                value += slope[s][a] * at[a];
            double *out = &f->half[s / ROOM_BANDS][(size_t)i * ROOM_BANDS + s % ROOM_BANDS];
            off[k - begin][s] = *out - value * f->area[i];
            *out = value * f->area[i];
        }
    }
    const double share = deviation_share(off, lit);
    for (uint32_t k = begin; k < end; k++)
        for (unsigned s = 0; s < SERIES; s++) {
            const size_t at = (size_t)f->tree->order[k] * ROOM_BANDS + s % ROOM_BANDS;
            double *out = &f->half[s / ROOM_BANDS][at];
            *out += share * off[k - begin][s];
            power[s] += *out;
        }
}

/* Gives a group's patches the values of its fit. */
static void settle(Fit *f, uint32_t begin, uint32_t end)
{
    Moments m = { .area = 0 };
    double mean[SERIES] = { 0 }, slope[SERIES][AXES] = { { 0 } }, l[AXES][AXES], spare[AXES];
    for (uint32_t k = begin; k < end; k++) {
        const FitNode node = leaf(f, f->tree->order[k]);
        Moments sum;
        moments_join(&m, &node.moments, &sum);
        m = sum;
        for (unsigned s = 0; s < SERIES && node.moments.patches > 0; s++)
            mean[s] += f->half[s / ROOM_BANDS][(size_t)f->tree->order[k] * ROOM_BANDS
                                               + s % ROOM_BANDS];
    }
    if (!(m.area > 0))
        return;
    for (unsigned s = 0; s < SERIES; s++)
        mean[s] /= m.area;
    f->groups++;
    const double variance = m.noise / m.patches;
    const unsigned rank = factorize(&m, l);
    if (slope_of(l, m.m[AXES], spare) > EVEN_PENALTY * variance * rank)
        fit_series(f, begin, end, &m, mean, slope);
    double power[SERIES] = { 0 };
    for (uint32_t k = begin; k < end; k += EVEN_JUDGED)
        settle_pool(f, k, end - k < EVEN_JUDGED ? end : k + EVEN_JUDGED, &m, mean, slope,
                    power);
    /* The sums of before. */
    for (unsigned s = 0; s < SERIES; s++)
        for (uint32_t k = begin; k < end && power[s] > 0; k++) {
            const size_t at = (size_t)f->tree->order[k] * ROOM_BANDS + s % ROOM_BANDS;
            f->half[s / ROOM_BANDS][at] *= mean[s] * m.area / power[s];
        }
}

static void settle_all(Fit *f, uint32_t begin, uint32_t end)
{
    if (end - begin < 2)
        return;
    const uint32_t middle = begin + (end - begin) / 2;
    if (f->group[middle]) {
        settle(f, begin, end);
        return;
    }
    settle_all(f, begin, middle);
    settle_all(f, middle, end);
}

uint32_t even_tree_fit(const EvenTree *tree, const double *area, double *half[2])
{
    Fit f = { .tree = tree, .area = area, .half = half, .group = tree->group };
    if (tree->count > 1) {
        choose(&f, 0, tree->count, 0);
        settle_all(&f, 0, tree->count);
    }
    return f.groups;
}

void even_tree_pool(const EvenTree *tree, const double *value, float *mean)
{
    for (uint32_t begin = 0; begin < tree->count; begin += EVEN_POOL) {
        const uint32_t end = tree->count - begin < EVEN_POOL ? tree->count : begin + EVEN_POOL;
        double sum = 0;
        for (uint32_t k = begin; k < end; k++)
            sum += value[tree->order[k]];
        for (uint32_t k = begin; k < end; k++)
            mean[tree->order[k]] = (float)(sum / (end - begin));
    }
}
