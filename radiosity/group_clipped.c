/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/group_clipped.c -- partly hidden pairs of polygons: from points all over the one, what
 * is seen of the other, exactly. */
#include <assert.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "radiosity/group_internal.h"

/* Points of each scrambling at most. */
enum { POINTS_MOST = 8192 };

/* All points may take as long as this many times all rays. */
static const double POINTS_OF_RAYS = 4;

/* Share of the asked error that points may have; the rest is for rays of the same class. */
static const double POINTS_SHARE = 0.5;

/* With fewer points than this on one side of a shadow's edge, what 16 scramblings disagree by says
 * little about what all of them missed. */
enum { FEW_POINTS = 16 };

/* What the points of a pair have in common. */
typedef struct {
    ConvexPolygon from, to, blocker[GROUP_BLOCKERS];
    uint32_t      blockers;
    Vec3          normal;
    double        area, part[SIGHT_CORNERS]; /* of `from`; share of its triangles up to each */
} Sight;

/* Running sums of one scrambling. */
typedef struct {
    double   seen, hidden;
    uint64_t all, none;   /* points that see all of it, nothing of it */
} SightSum;

static void prepare(const Grouping *g, const ClippedPair *pair, Sight *s)
{
    const GroupSide *p = &g->side[pair->i], *q = &g->side[pair->j];
    /* The smaller one is looked from: what a point sees of the larger varies less. */
    const GroupSide *from = p->area <= q->area ? p : q, *to = from == p ? q : p;
    const bool good = group_blockers(g, from, to, s->blocker, &s->blockers);
    assert(good);
    (void)good;
    s->from = group_before(from, to);
    s->to = group_before(to, from);
    s->normal = from->normal;
    s->area = 0;
    for (size_t k = 1; k + 1 < s->from.count; k++) {
        const Vec3 a = vec3_sub(s->from.corner[k], s->from.corner[0]);
        const Vec3 b = vec3_sub(s->from.corner[k + 1], s->from.corner[0]);
        s->area += vec3_length(vec3_cross(a, b)) / 2;
        s->part[k] = s->area;
    }
}

/* The point of the polygon for (u, v) of the unit square: its triangles from corner 0 in turn. */
static Vec3 place(const Sight *s, double u, double v)
{
    const double at = u * s->area;
    size_t k = 1;
    while (k + 2 < s->from.count && at >= s->part[k])
        k++;
    const double before = k > 1 ? s->part[k - 1] : 0;
    const double rest = (at - before) / (s->part[k] - before);
    double a, b;
    sampling_triangle(fmin(fmax(rest, 0), 1), v, &a, &b);
    const Vec3 o = s->from.corner[0];
    return vec3_mad(vec3_mad(o, a, vec3_sub(s->from.corner[k], o)), b,
                    vec3_sub(s->from.corner[k + 1], o));
}

static bool look(const Sight *s, uint32_t seed, uint32_t begin, uint32_t end, SightScratch *scratch,
                 SightSum *sum)
{
    for (uint32_t k = begin; k < end; k++) {
        float x[2];
        sampling_sobol2(k, seed, x);
        const Vec3 p = place(s, x[0], x[1]);
        const double open = sight_factor(p, s->normal, &s->to);
        const double seen = sight_past(p, s->normal, &s->to, s->blocker, s->blockers, scratch);
        if (isnan(seen))
            return false;
        sum->seen += seen;
        sum->hidden += fmax(open - seen, 0);
        sum->all += !(open - seen > 1e-9 * open);
        sum->none += !(seen > 1e-9 * open);
    }
    return true;
}

static double spread(const double *x)
{
    double mean = 0, squares = 0;
    for (int r = 0; r < GROUP_SCRAMBLES; r++)
        mean += x[r] / GROUP_SCRAMBLES;
    for (int r = 0; r < GROUP_SCRAMBLES; r++)
        squares += (x[r] - mean) * (x[r] - mean);
    return sqrt(squares / (GROUP_SCRAMBLES * (GROUP_SCRAMBLES - 1.0)));
}

/* What is seen, or all less what is hidden: whichever the scramblings agree on better. */
static double estimate(const Sight *s, ClippedPair *pair, const SightSum *sum)
{
    double seen[GROUP_SCRAMBLES], less[GROUP_SCRAMBLES];
    uint64_t all = 0, none = 0;
    const double n = pair->points, total = n * GROUP_SCRAMBLES;
    for (int r = 0; r < GROUP_SCRAMBLES; r++) {
        seen[r] = s->area * sum[r].seen / n;
        less[r] = pair->open - s->area * sum[r].hidden / n;
        all += sum[r].all;
        none += sum[r].none;
    }
    const double a = spread(seen), b = spread(less);
    for (int r = 0; r < GROUP_SCRAMBLES; r++)
        pair->exchange[r] = fmin(fmax(a < b ? seen[r] : less[r], 0), pair->open);
    pair->least_error = all > total - FEW_POINTS || none > total - FEW_POINTS
                            ? pair->open / total : 0;
    return fmax(fmin(a, b), pair->least_error);
}

/* The error that a pair may have, so that all of its two classes together stay within what is asked
 * of their factor. */
static double allowance(const Grouping *g, const ClippedPair *pair)
{
    const uint32_t n = g->options->count;
    const uint32_t a = g->side[pair->i].class, b = g->side[pair->j].class;
    const double area = fmin(g->class_area[a], g->class_area[b]);
    const uint32_t crowd = g->crowd[a < b ? a * n + b : b * n + a];
    return POINTS_SHARE * g->options->accuracy * area / sqrt(crowd);
}

static void run_pair(Grouping *g, ClippedPair *pair, SightScratch *scratch, uint32_t most)
{
    Sight sight;
    SightSum sum[GROUP_SCRAMBLES] = { { 0 } };
    const double allowed = allowance(g, pair);
    prepare(g, pair, &sight);
    double error = INFINITY;
    for (uint32_t n = GROUP_POINTS_FIRST; error > allowed && n <= most; n *= 2) {
        for (uint32_t r = 0; r < GROUP_SCRAMBLES; r++) {
            const uint32_t seed = sampling_seed(g->options->seed, pair->i, pair->j,
                                                SEED_GROUPS + r);
            if (!look(&sight, seed, pair->points, n, scratch, &sum[r])) {
                pair->given_up = true;
                return;
            }
        }
        pair->points = n;
        error = estimate(&sight, pair, sum);
    }
}

typedef struct {
    Grouping     *g;
    SightScratch *scratch; /* [threads] */
    uint32_t      most;
} ClippedRun;

static void run_pairs(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    ClippedRun *run = context;
    for (uint32_t k = begin; k < end; k++)
        run_pair(run->g, &run->g->clipped[k], &run->scratch[worker], run->most);
}

bool group_clipped_run(Grouping *g, Error *err)
{
    if (g->clipped_count == 0)
        return true;
    double cost = 0; /* of one point of each scrambling for all pairs */
    for (uint32_t k = 0; k < g->clipped_count; k++)
        cost += GROUP_SCRAMBLES * group_point_cost(g->clipped[k].blockers);
    ClippedRun run = { g, array_create(g->threads, sizeof *run.scratch, "sights", err),
                       GROUP_POINTS_FIRST };
    if (run.scratch == NULL)
        return false;
    while (run.most < POINTS_MOST &&
           2 * run.most * cost <= POINTS_OF_RAYS * (double)g->options->most_rays)
        run.most *= 2;
    const bool done = parallel_for(g->clipped_count, 1, g->threads, run_pairs, &run, g->monitor,
                                   NULL);
    array_free(run.scratch);
    const size_t n = g->sides;
    for (uint32_t k = 0; k < g->clipped_count; k++) {
        const ClippedPair *pair = &g->clipped[k];
        g->out->points += (uint64_t)pair->points * GROUP_SCRAMBLES;
        if (pair->given_up)
            g->kind[pair->i * n + pair->j] = GROUP_RAYS;
    }
    return done || error_set(err, ERROR_STOPPED, "stopped while looking past what is between");
}
