/* SPDX-License-Identifier: BSD-3-Clause */
/* The tree over copies of trees: built like any other, a copy's box in the place of a primitive. */
#include "raycast/instances.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "raycast/build.h"
#include "raycast/probe.h"

/* One copy. */
typedef struct {
    const Bvh *bvh;
    Affine     to_local;
} Place;

struct Instances {
    Bvh     *top; /* its shapes are the places */
    Place   *place;
    uint32_t count;
    uint64_t triangles;
};

/* --- making it ------------------------------------------------------------------------------- */

/* The box around the mapped box of the tree; wider than what its double arithmetic is off by. */
static bool instance_box(const Instance *instance, Ref *ref)
{
    const Bvh *bvh = instance->bvh;
    Vec3 lo = vec3(INFINITY, INFINITY, INFINITY), hi = vec3_scale(lo, -1);
    for (int i = 0; i < 8; i++) {
        const Vec3 corner = vec3((double)(i & 1 ? bvh->hi : bvh->lo)[0],
                                 (double)(i & 2 ? bvh->hi : bvh->lo)[1],
                                 (double)(i & 4 ? bvh->hi : bvh->lo)[2]);
        const Vec3 p = affine_point(&instance->to_world, corner);
        lo = vec3_min(lo, p);
        hi = vec3_max(hi, p);
    }
    for (int k = 0; k < 3; k++) {
        const double a = vec3_axis(lo, k), b = vec3_axis(hi, k);
        const double margin = (fabs(a) + fabs(b)) * (double)PROBE_ROUNDING;
        /* NaN fails this too. */
        if (!(fabs(a) <= (double)PROBE_COORDINATE_MAX && fabs(b) <= (double)PROBE_COORDINATE_MAX))
            return false;
        ref->lo[k] = nextafterf((float)(a - margin), -INFINITY);
        ref->hi[k] = nextafterf((float)(b + margin), INFINITY);
    }
    return true;
}

static bool bvh_is_empty(const Bvh *bvh) { return bvh->group_count + bvh->shape_count == 0; }

/* References to the copies that have anything in them. */
static Ref *places_fill(Instances *all, const Instance *instance, uint32_t *count, Error *err)
{
    Ref *ref = array_create(all->count, sizeof *ref, "references to instances", err);
    *count = 0;
    for (uint32_t i = 0; i < all->count && !error_is_set(err); i++) {
        Place *place = &all->place[i];
        assert(instance[i].bvh != NULL);
        place->bvh = instance[i].bvh;
        all->triangles += place->bvh->triangle_count;
        if (bvh_is_empty(place->bvh))
            continue;
        if (!affine_invert(&instance[i].to_world, &place->to_local))
            error_set(err, ERROR_INPUT, "instance %u: its map has no inverse", i);
        else if (!instance_box(&instance[i], &ref[*count]))
            error_set(err, ERROR_INPUT, "instance %u reaches beyond %g", i,
                      (double)PROBE_COORDINATE_MAX);
        ref[(*count)++].primitive = i;
    }
    return error_is_set(err) ? array_free(ref) : ref;
}

Instances *instances_create(const Instance *instance, uint32_t count, unsigned threads, Error *err)
{
    assert((instance != NULL || count == 0) && err != NULL);
    if (count > CHILD_INDEX_MAX)
        error_set(err, ERROR_INPUT, "%u instances are too many for one tree", count);
    Instances *all = array_create(1, sizeof *all, "instances", err);
    if (all == NULL)
        return NULL;
    all->count = count;
    all->place = array_create(count, sizeof *all->place, "instances", err);
    all->top = array_create(1, sizeof *all->top, "tree of instances", err);
    uint32_t used = 0;
    Ref *ref = error_is_set(err) ? NULL : places_fill(all, instance, &used, err);
    if (ref == NULL)
        return instances_destroy(all);
    /* The copies have the numbers that shapes would have. */
    const Primitives numbers = { .shape_count = count };
    return tree_build(all->top, &numbers, ref, used, threads, err) ? all : instances_destroy(all);
}

Instances *instances_destroy(Instances *instances)
{
    if (instances != NULL) {
        bvh_destroy(instances->top);
        array_free(instances->place);
    }
    return array_free(instances);
}

void instances_stats(const Instances *instances, InstancesStats *stats)
{
    assert(instances != NULL && stats != NULL);
    *stats = (InstancesStats){ .instances = instances->count, .triangles = instances->triangles };
    stats->bytes = sizeof *instances + instances->count * sizeof *instances->place
                   + instances->top->bytes + sizeof *instances->top;
}

void instances_bounds(const Instances *instances, Vec3 *lo, Vec3 *hi)
{
    assert(instances != NULL && lo != NULL && hi != NULL);
    const Bvh *top = instances->top;
    *lo = vec3((double)top->lo[0], (double)top->lo[1], (double)top->lo[2]);
    *hi = vec3((double)top->hi[0], (double)top->hi[1], (double)top->hi[2]);
}

Vec3 instances_normal(const Instances *instances, uint32_t instance, Vec3 normal)
{
    assert(instances != NULL && instance < instances->count);
    return affine_normal(&instances->place[instance].to_local, normal);
}

/* --- one ray --------------------------------------------------------------------------------- */

/* Where a ray enters a copy's box; copies are visited in this order. */
typedef struct {
    float    entry;
    uint32_t place; /* RAY_MISS: none is left */
} Visit;

static bool visit_before(Visit a, Visit b)
{
    return a.entry < b.entry || (a.entry == b.entry && a.place < b.place);
}

/* near[s] of a slot that the ray passes before `limit`; the rest are infinite. */
static void node_enter(const Node *node, const Probe *p, float limit, float near[NODE_WIDTH])
{
    float far[NODE_WIDTH];
    for (unsigned s = 0; s < NODE_WIDTH; s++) {
        near[s] = p->t_min;
        far[s] = limit;
    }
    for (unsigned k = 0; k < 3; k++) {
        const float *from = node->plane[2 * k + (p->octant >> k & 1)];
        const float *to = node->plane[2 * k + 1 - (p->octant >> k & 1)];
        for (unsigned s = 0; s < NODE_WIDTH; s++) {
            const float a = from[s] * p->inverse[k] + p->near_add[k];
            const float b = to[s] * p->inverse[k] + p->far_add[k];
            near[s] = near[s] > a ? near[s] : a;
            far[s] = far[s] < b ? far[s] : b;
        }
    }
    for (unsigned s = 0; s < NODE_WIDTH; s++)
        near[s] = near[s] <= far[s] ? near[s] : INFINITY;
}

/* The first visit after `last` that begins no later than `limit`. Starts from the root each time:
 * the tree is small, and nothing is kept of the rays that wait. */
static Visit visit_next(const Bvh *top, const Probe *p, float limit, Visit last)
{
    Visit next = { INFINITY, RAY_MISS };
    uint32_t stack[BVH_STACK], count = 0;
    float    entry[BVH_STACK], near[NODE_WIDTH];
    stack[count] = 0;
    entry[count++] = p->t_min;
    while (count-- > 0) {
        const Node *node = &top->node[stack[count]];
        if (entry[count] > limit || entry[count] > next.entry)
            continue;
        node_enter(node, p, limit < next.entry ? limit : next.entry, near);
        for (unsigned i = 0; i < NODE_WIDTH; i++) {
            const unsigned s = i ^ p->octant; /* the nearest last: it is taken first */
            if (node->child[s] == CHILD_NONE || near[s] == INFINITY)
                continue;
            if (!child_is_leaf(node->child[s])) {
                stack[count] = node->child[s];
                entry[count++] = near[s];
                continue;
            }
            const Visit visit = { near[s], child_shape_index(node->child[s]) };
            if (visit_before(last, visit) && visit_before(visit, next))
                next = visit;
        }
    }
    return next;
}

/* The ray in the copy's space, ended where what was hit already lies: there, not before it, as a
 * hit at the same t in a copy of a smaller number comes first. */
static Ray ray_into(const Place *place, const Ray *ray, const InstanceHit *best)
{
    const Vec3 o = affine_point(&place->to_local,
                                vec3((double)ray->ox, (double)ray->oy, (double)ray->oz));
    const Vec3 d = affine_vector(&place->to_local,
                                 vec3((double)ray->dx, (double)ray->dy, (double)ray->dz));
    const bool hit = best->instance != RAY_MISS;
    return (Ray){ .ox = (float)o.x, .oy = (float)o.y, .oz = (float)o.z, .t_min = ray->t_min,
                  .dx = (float)d.x, .dy = (float)d.y, .dz = (float)d.z,
                  .t_max = hit ? nextafterf(best->hit.t, ray->t_max) : ray->t_max };
}

static void best_take(InstanceHit *best, const Hit *hit, uint32_t place)
{
    if (best->instance == RAY_MISS || hit->t < best->hit.t
        || (hit->t == best->hit.t && place < best->instance))
        *best = (InstanceHit){ *hit, place };
}

/* A ray on its way through the copies. */
typedef struct {
    Ray         ray;      /* scaled when it is very long or short (probe.h) */
    int         exponent; /* its t times 2^this is the caller's */
    Probe       probe;
    Visit       visit;    /* the present one */
    InstanceHit best;
} Traveller;

/* The next copy to visit; false when the ray has arrived. */
static bool traveller_next(const Instances *all, Traveller *t)
{
    const float limit = t->best.instance != RAY_MISS ? t->best.hit.t : t->ray.t_max;
    t->visit = visit_next(all->top, &t->probe, limit, t->visit);
    return t->visit.place != RAY_MISS;
}

/* False when the ray is none, or there is nothing to meet. */
static bool traveller_start(const Instances *all, const Ray *ray, Traveller *t)
{
    t->best = (InstanceHit){ { .t = ray->t_max, .primitive = RAY_MISS }, RAY_MISS };
    t->visit = (Visit){ -INFINITY, 0 };
    t->ray = *ray;
    t->exponent = 0;
    if (!probe_takes(ray) && !ray_rescale(ray, &t->ray, &t->exponent))
        return false;
    probe_init(&t->probe, &t->ray, all->top->lo, all->top->hi);
    return traveller_next(all, t);
}

static bool traveller_end(const Traveller *t, const Ray *ray, InstanceHit *hit)
{
    *hit = t->best;
    if (hit->instance == RAY_MISS || (t->exponent != 0 && !hit_rescale(&hit->hit, t->exponent)))
        *hit = (InstanceHit){ { .t = ray->t_max, .primitive = RAY_MISS }, RAY_MISS };
    return hit->instance != RAY_MISS;
}

bool instances_nearest(const Instances *instances, const Ray *ray, InstanceHit *hit)
{
    assert(instances != NULL && ray != NULL && hit != NULL);
    Traveller t;
    for (bool on = traveller_start(instances, ray, &t); on; on = traveller_next(instances, &t)) {
        const Place *place = &instances->place[t.visit.place];
        const Ray local = ray_into(place, &t.ray, &t.best);
        Hit found;
        if (bvh_nearest(place->bvh, &local, &found))
            best_take(&t.best, &found, t.visit.place);
    }
    return traveller_end(&t, ray, hit);
}

bool instances_blocked(const Instances *instances, const Ray *ray)
{
    assert(instances != NULL && ray != NULL);
    InstanceHit hit;
    if (!probe_takes(ray)) /* a hit whose t is no float of the caller's is a miss */
        return instances_nearest(instances, ray, &hit);
    Traveller t;
    for (bool on = traveller_start(instances, ray, &t); on; on = traveller_next(instances, &t)) {
        const Place *place = &instances->place[t.visit.place];
        const Ray local = ray_into(place, &t.ray, &t.best);
        if (bvh_blocked(place->bvh, &local))
            return true;
    }
    return false;
}

/* --- many rays ------------------------------------------------------------------------------- */

#define BLOCK_RAYS 8192u

/* Rays of a block, and those under way sorted by the copy they have come to. */
typedef struct {
    Traveller traveller[BLOCK_RAYS];
    uint64_t  order[BLOCK_RAYS]; /* copy << 32 | number in the block */
    Ray       local[BLOCK_RAYS];
    Hit       found[BLOCK_RAYS];
    uint32_t  under_way;
} Block;

static int by_place(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Those of order[begin..end-1] have come to one copy. */
static void block_visit(const Instances *all, Block *block, uint32_t begin, uint32_t end,
                        bool beam)
{
    const uint32_t count = end - begin;
    const Place *place = &all->place[block->order[begin] >> 32];
    for (uint32_t i = 0; i < count; i++) {
        const Traveller *t = &block->traveller[(uint32_t)block->order[begin + i]];
        block->local[i] = ray_into(place, &t->ray, &t->best);
    }
    (beam ? bvh_nearest_beam : bvh_nearest_many)(place->bvh, block->local, block->found, count);
    for (uint32_t i = 0; i < count; i++) {
        Traveller *t = &block->traveller[(uint32_t)block->order[begin + i]];
        if (block->found[i].primitive != RAY_MISS)
            best_take(&t->best, &block->found[i], t->visit.place);
    }
}

static void block_start(const Instances *all, Block *block, const Ray *ray, uint32_t count)
{
    block->under_way = 0;
    for (uint32_t i = 0; i < count; i++) {
        Traveller *t = &block->traveller[i];
        if (traveller_start(all, &ray[i], t))
            block->order[block->under_way++] = (uint64_t)t->visit.place << 32 | i;
    }
}

/* Each ray visits one copy. With `any`, one hit ends a ray. */
static void block_step(const Instances *all, Block *block, bool beam, bool any)
{
    qsort(block->order, block->under_way, sizeof *block->order, by_place);
    for (uint32_t begin = 0, end; begin < block->under_way; begin = end) {
        for (end = begin + 1; end < block->under_way; end++)
            if (block->order[end] >> 32 != block->order[begin] >> 32)
                break;
        block_visit(all, block, begin, end, beam);
    }
    uint32_t left = 0;
    for (uint32_t i = 0; i < block->under_way; i++) {
        const uint32_t at = (uint32_t)block->order[i];
        Traveller *t = &block->traveller[at];
        if (!(any && t->best.instance != RAY_MISS) && traveller_next(all, t))
            block->order[left++] = (uint64_t)t->visit.place << 32 | at;
    }
    block->under_way = left;
}

/* Answers go to `hit`, or to `blocked` when that is NULL. */
static bool trace_many(const Instances *all, const Ray *ray, InstanceHit *hit, bool *blocked,
                       size_t count, bool beam, Error *err)
{
    Block *block = array_create(1, sizeof *block, "rays among instances", err);
    for (size_t begin = 0; block != NULL && begin < count; begin += BLOCK_RAYS) {
        const uint32_t n = count - begin < BLOCK_RAYS ? (uint32_t)(count - begin) : BLOCK_RAYS;
        block_start(all, block, ray + begin, n);
        while (block->under_way > 0)
            block_step(all, block, beam, hit == NULL);
        for (uint32_t i = 0; i < n; i++) {
            InstanceHit one;
            const bool found = traveller_end(&block->traveller[i], &ray[begin + i],
                                             hit != NULL ? &hit[begin + i] : &one);
            if (hit == NULL)
                blocked[begin + i] = found;
        }
    }
    array_free(block);
    return block != NULL;
}

bool instances_nearest_many(const Instances *instances, const Ray *ray, InstanceHit *hit,
                            size_t count, bool beam, Error *err)
{
    assert(instances != NULL && err != NULL && (count == 0 || (ray != NULL && hit != NULL)));
    return trace_many(instances, ray, hit, NULL, count, beam, err);
}

bool instances_blocked_many(const Instances *instances, const Ray *ray, bool *blocked,
                            size_t count, bool beam, Error *err)
{
    assert(instances != NULL && err != NULL && (count == 0 || (ray != NULL && blocked != NULL)));
    return trace_many(instances, ray, NULL, blocked, count, beam, err);
}
