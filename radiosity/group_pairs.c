/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/group_pairs.c -- what kind of estimate each pair of sides wants. */
#include <assert.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/polygon_factor.h"
#include "radiosity/group_internal.h"

/* Points of the first round may take as long as this many times all rays; where they would take
 * longer, rays do the work of all of them. */
static const double POINTS_OF_RAYS = 2;

/* Planes of the hull of two convex polygons: two of their own, and at most as many through an edge
 * of the one and a corner of the other as there are edges, but for those given twice. */
enum { HULL_PLANES = 2 + 4 * SIGHT_CORNERS };

typedef struct {
    Plane    plane[HULL_PLANES];
    uint32_t count;
} Hull;

/* Greatest and least height of a polygon's corners over a plane. */
static void heights(const ConvexPolygon *p, Vec3 n, double offset, double *low, double *high)
{
    for (size_t i = 0; i < p->count; i++) {
        const double h = vec3_dot(n, p->corner[i]) - offset;
        *low = fmin(*low, h);
        *high = fmax(*high, h);
    }
}

/* Adds the planes through edges of p and corners of q that have both on one side. */
static void add_planes(Hull *hull, const ConvexPolygon *p, const ConvexPolygon *q, double slack)
{
    for (size_t i = 0; i < p->count; i++) {
        const Vec3 a = p->corner[i], along = vec3_sub(p->corner[(i + 1) % p->count], a);
        for (size_t k = 0; k < q->count && hull->count < HULL_PLANES; k++) {
            const Vec3 across = vec3_cross(along, vec3_sub(q->corner[k], a));
            const double length = vec3_length(across);
            /* A corner on the edge's own line makes no plane. */
            if (!(length > slack * vec3_length(along)))
                continue;
            Vec3 n = vec3_scale(across, 1 / length);
            double low = 0, high = 0;
            heights(p, n, vec3_dot(n, a), &low, &high);
            heights(q, n, vec3_dot(n, a), &low, &high);
            if (low < -slack && high > slack)
                continue;
            if (high <= slack)
                n = vec3_scale(n, -1);
            hull->plane[hull->count++] = (Plane){ n, vec3_dot(n, a) };
        }
    }
}

ConvexPolygon group_before(const GroupSide *p, const GroupSide *q)
{
    ConvexPolygon part = p->polygon;
    const bool fits = convex_polygon_cut(&part, q->normal, q->offset);
    assert(fits);
    (void)fits;
    return part;
}

typedef struct {
    const Grouping  *g;
    const GroupSide *p, *q;
    const Hull      *hull;
    ConvexPolygon   *blocker;
    uint32_t        *count, key[GROUP_BLOCKERS];
} BlockerSearch;

/* What of a polygon is within the hull, off its planes. */
static bool reaches_into(const BlockerSearch *s, ConvexPolygon part)
{
    for (uint32_t k = 0; k < s->hull->count && part.count > 0; k++) {
        const Plane *plane = &s->hull->plane[k];
        if (!convex_polygon_cut(&part, plane->normal, plane->offset + s->g->slack))
            return true;
    }
    return part.count > 0;
}

static bool visit_blocker(void *user, uint32_t primitive)
{
    BlockerSearch *s = user;
    const Surfaces *surfaces = s->g->room->surfaces;
    if (primitive >= surfaces->triangle_count) {
        *s->count = GROUP_BLOCKERS + 1;
        return false;
    }
    const uint32_t surface = surfaces->triangle_surface[primitive];
    ConvexPolygon part;
    uint32_t key = surface;
    if (!group_polygon(surfaces, surface, s->g->slack, &part)) { /* a bent quad: by triangles */
        key = surfaces->count + primitive;
        part.count = 3;
        for (int k = 0; k < 3; k++)
            part.corner[k] = surfaces->position[surfaces->corner[3 * (size_t)primitive +
                                                                 (size_t)k]];
    }
    for (uint32_t k = 0; k < *s->count; k++)
        if (s->key[k] == key)
            return true;
    if (!reaches_into(s, part))
        return true;
    if (*s->count == GROUP_BLOCKERS ||
        !convex_polygon_cut(&part, s->p->normal, s->p->offset) ||
        !convex_polygon_cut(&part, s->q->normal, s->q->offset)) {
        *s->count = GROUP_BLOCKERS + 1;
        return false;
    }
    s->key[*s->count] = key;
    s->blocker[(*s->count)++] = part;
    return true;
}

bool group_blockers(const Grouping *g, const GroupSide *p, const GroupSide *q,
                    ConvexPolygon blocker[GROUP_BLOCKERS], uint32_t *count)
{
    const ConvexPolygon a = group_before(p, q), b = group_before(q, p);
    Hull hull = { .count = 2, .plane = { { p->normal, p->offset }, { q->normal, q->offset } } };
    add_planes(&hull, &a, &b, g->slack);
    add_planes(&hull, &b, &a, g->slack);
    *count = 0;
    BlockerSearch search = { .g = g, .p = p, .q = q, .hull = &hull, .blocker = blocker,
                             .count = count };
    return bvh_shaft(g->room->bvh, hull.plane, hull.count, g->slack, visit_blocker, &search);
}

static double open_exchange(const GroupSide *p, const GroupSide *q)
{
    FlatPolygon a = { .count = p->polygon.count }, b = { .count = q->polygon.count };
    for (size_t k = 0; k < a.count; k++)
        a.corner[k] = p->polygon.corner[k];
    for (size_t k = 0; k < b.count; k++)
        b.corner[k] = q->polygon.corner[k];
    return polygon_factor_area(&a, &b);
}

static bool faces(const GroupSide *p, const GroupSide *q, double slack)
{
    double low = 0, high = 0;
    heights(&p->polygon, q->normal, q->offset, &low, &high);
    return high > slack;
}

static GroupKind judge(const Grouping *g, const GroupSide *p, const GroupSide *q, double *open,
                       uint8_t *between)
{
    ConvexPolygon blocker[GROUP_BLOCKERS];
    uint32_t blockers;
    if (p == q || !p->flat || !q->flat)
        return p == q && p->flat ? GROUP_AWAY : GROUP_RAYS;
    if (!faces(p, q, g->slack) || !faces(q, p, g->slack))
        return GROUP_AWAY;
    if (!group_blockers(g, p, q, blocker, &blockers))
        return GROUP_RAYS;
    *open = open_exchange(p, q);
    *between = (uint8_t)blockers;
    return blockers == 0 ? GROUP_EXACT : GROUP_CLIPPED;
}

static void judge_rows(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Grouping *g = context;
    const size_t n = g->sides;
    (void)worker;
    for (uint32_t i = begin; i < end; i++)
        for (uint32_t j = i; j < n; j++)
            g->kind[i * n + j] = (uint8_t)judge(g, &g->side[i], &g->side[j],
                                                &g->value[i * n + j], &g->between[i * n + j]);
}

static bool list_clipped(Grouping *g, Error *err)
{
    const size_t n = g->sides, classes = g->options->count;
    uint64_t count = 0;
    double cost = 0;
    for (size_t k = 0; k < n * n; k++)
        if (g->kind[k] == GROUP_CLIPPED) {
            count++;
            cost += GROUP_SCRAMBLES * GROUP_POINTS_FIRST * group_point_cost(g->between[k]);
        }
    if (cost > POINTS_OF_RAYS * (double)g->options->most_rays) {
        for (size_t k = 0; k < n * n; k++)
            g->kind[k] = g->kind[k] == GROUP_CLIPPED ? GROUP_RAYS : g->kind[k];
        return true;
    }
    g->clipped = array_create(count, sizeof *g->clipped, "pairs of sides", err);
    if (g->clipped == NULL)
        return false;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = i; j < n; j++)
            if (g->kind[i * n + j] == GROUP_CLIPPED) {
                const uint32_t a = g->side[i].class, b = g->side[j].class;
                g->crowd[a < b ? a * classes + b : b * classes + a]++;
                g->clipped[g->clipped_count++] = (ClippedPair){
                    .i = i, .j = j, .blockers = g->between[i * n + j],
                    .open = g->value[i * n + j] };
            }
    return true;
}

bool group_pairs_find(Grouping *g, Error *err)
{
    if (g->kind == NULL)
        return true;
    if (!parallel_for(g->sides, 1, g->threads, judge_rows, g, g->monitor, NULL))
        return error_set(err, ERROR_STOPPED, "stopped while looking for what is between surfaces");
    return list_clipped(g, err);
}
