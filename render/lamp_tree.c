/* SPDX-License-Identifier: BSD-3-Clause */
/* A binary tree of lamps: how it is made, and the way down. */
#include "render/lamp_tree.h"

#include <assert.h>
#include <float.h>
#include <math.h>

#include "base/array.h"

static const double PI = 3.14159265358979323846;

/* Directions within an angle of an axis; an angle of pi: all. */
typedef struct {
    Vec3   axis;
    double angle;
} Cone;

struct LampBranch {
    Vec3     centre;   /* of the ball */
    double   radius;
    Vec3     axis;     /* of the cone that holds the lamps' axes */
    double   cosine, sine; /* of its angle */
    double   strength;
    uint32_t child;    /* the first of the two that leave it, the other is the next; 0: a leaf */
    uint32_t begin, end; /* its lamps: lamp[begin..end) of the tree */
};

/* --- making ---------------------------------------------------------------------------------- */

typedef struct {
    Vec3   lo, hi;
    Cone   cone;
    double strength;
    bool   any;
} Extent;

typedef struct {
    LampTree       *tree;
    const TreeLamp *lamp;
    uint32_t       *order;  /* [count]  the tree's lamp[] */
    uint32_t        filled; /* branches */
} Builder;

/* The narrower of the cones that hold both. */
static Cone cone_merge(Cone a, Cone b)
{
    if (a.angle < b.angle) {
        const Cone c = a;
        a = b;
        b = c;
    }
    const Vec3   across = vec3_cross(a.axis, b.axis);
    const double sine = vec3_length(across), between = atan2(sine, vec3_dot(a.axis, b.axis));
    if (fmin(between + b.angle, PI) <= a.angle)
        return a;
    const double angle = (a.angle + between + b.angle) / 2;
    if (angle >= PI || !(sine > 0))
        return (Cone){ a.axis, PI };
    const Vec3   side = vec3_scale(vec3_cross(across, a.axis), 1 / sine);
    const double turn = angle - a.angle;
    return (Cone){ vec3_unit(vec3_mad(vec3_scale(a.axis, cos(turn)), sin(turn), side)), angle };
}

static void extent_add(Extent *all, const Extent *more)
{
    if (!all->any) {
        *all = *more;
        return;
    }
    if (!more->any)
        return;
    all->lo = vec3_min(all->lo, more->lo);
    all->hi = vec3_max(all->hi, more->hi);
    all->cone = cone_merge(all->cone, more->cone);
    all->strength += more->strength;
}

static Extent extent_of(const TreeLamp *lamp)
{
    const Vec3 r = vec3(lamp->radius, lamp->radius, lamp->radius);
    return (Extent){ .lo = vec3_sub(lamp->centre, r), .hi = vec3_add(lamp->centre, r),
                     .cone = { lamp->around ? vec3(0, 0, 1) : lamp->axis, lamp->around ? PI : 0 },
                     .strength = lamp->strength, .any = true };
}

/* What choosing within the extent costs in noise: strength, times the square of its size, times
 * the solid angle of the directions that it shines to (of a hemisphere around each axis). */
static double extent_cost(const Extent *e)
{
    const Vec3   d = vec3_sub(e->hi, e->lo);
    const double reach = fmin(e->cone.angle + PI / 2, PI);
    return e->any ? e->strength * vec3_dot(d, d) * 2 * PI * (1 - cos(reach)) : 0;
}

enum { BINS = 12, DEEPEST = 48 }; /* bins of the candidates for a cut; from DEEPEST down: halves */

static uint32_t bin_of(double x, double lo, double hi)
{
    const double place = BINS * (x - lo) / (hi - lo);
    return place < BINS - 1 ? (uint32_t)fmax(place, 0) : BINS - 1;
}

/* The best cut across one axis, better than *best: sets *cut to the first bin beyond it. */
static bool find_cut(const Builder *b, uint32_t begin, uint32_t end, int axis, double lo,
                     double hi, double *best, uint32_t *cut)
{
    Extent bin[BINS] = { 0 }, left = { 0 };
    double right_cost[BINS] = { 0 };
    bool   found = false;
    if (!(hi > lo))
        return false;
    for (uint32_t i = begin; i < end; i++) {
        const TreeLamp *lamp = &b->lamp[b->order[i]];
        const Extent    e = extent_of(lamp);
        extent_add(&bin[bin_of(vec3_axis(lamp->centre, axis), lo, hi)], &e);
    }
    Extent right = { 0 };
    for (uint32_t k = BINS - 1; k > 0; k--) {
        extent_add(&right, &bin[k]);
        right_cost[k] = extent_cost(&right);
    }
    for (uint32_t k = 1; k < BINS; k++) {
        extent_add(&left, &bin[k - 1]);
        const double cost = extent_cost(&left) + right_cost[k];
        if (cost < *best) {
            *best = cost;
            *cut = k;
            found = true;
        }
    }
    return found;
}

/* Parts order[begin, end) in two; returns where the second begins. */
static uint32_t part(const Builder *b, uint32_t begin, uint32_t end, unsigned depth)
{
    Vec3 lo = b->lamp[b->order[begin]].centre, hi = lo;
    for (uint32_t i = begin + 1; i < end; i++) {
        lo = vec3_min(lo, b->lamp[b->order[i]].centre);
        hi = vec3_max(hi, b->lamp[b->order[i]].centre);
    }
    double   best = INFINITY;
    uint32_t cut = 0;
    int      axis = -1;
    for (int k = 0; k < 3 && depth < DEEPEST; k++)
        if (find_cut(b, begin, end, k, vec3_axis(lo, k), vec3_axis(hi, k), &best, &cut))
            axis = k;
    uint32_t middle = begin;
    for (uint32_t i = begin; i < end && axis >= 0; i++) {
        const uint32_t lamp = b->order[i];
        if (bin_of(vec3_axis(b->lamp[lamp].centre, axis), vec3_axis(lo, axis),
                   vec3_axis(hi, axis)) >= cut)
            continue;
        b->order[i] = b->order[middle];
        b->order[middle++] = lamp;
    }
    return middle > begin && middle < end ? middle : begin + (end - begin) / 2;
}

/* Fills a branch with the lamps order[begin, end); as deep as DEEPEST + log2(count) calls. */
static void grow(Builder *b, uint32_t index, uint32_t begin, uint32_t end, unsigned depth)
{
    LampBranch *branch = &b->tree->branch[index];
    Extent      all = { 0 };
    assert(begin < end && index < 2 * b->tree->count - 1);
    for (uint32_t i = begin; i < end; i++) {
        const Extent e = extent_of(&b->lamp[b->order[i]]);
        extent_add(&all, &e);
    }
    const TreeLamp *only = &b->lamp[b->order[begin]];
    const bool      leaf = end - begin == 1;
    *branch = (LampBranch){ .centre = leaf ? only->centre : vec3_lerp(all.lo, all.hi, 0.5),
                            .radius = leaf ? only->radius
                                           : vec3_length(vec3_sub(all.hi, all.lo)) / 2,
                            .axis = all.cone.axis, .cosine = cos(all.cone.angle),
                            .sine = all.cone.angle < PI ? sin(all.cone.angle) : 0,
                            .strength = all.strength, .begin = begin, .end = end };
    if (leaf)
        return;
    const uint32_t middle = part(b, begin, end, depth);
    branch->child = b->filled;
    b->filled += 2;
    grow(b, branch->child, begin, middle, depth + 1);
    grow(b, branch->child + 1, middle, end, depth + 1);
}

bool lamp_tree_init(LampTree *tree, const TreeLamp *lamp, uint32_t count, Error *err)
{
    assert(count > 0 && count <= UINT32_MAX / 2);
    *tree = (LampTree){ .count = count };
    tree->branch = array_create(2 * (size_t)count - 1, sizeof *tree->branch, "lamps", err);
    tree->place = array_create(count, sizeof *tree->place, "lamps", err);
    tree->lamp = array_create(count, sizeof *tree->lamp, "lamps", err);
    tree->below = array_create((size_t)count + 1, sizeof *tree->below, "lamps", err);
    if (error_is_set(err)) {
        lamp_tree_clear(tree);
        return false;
    }
    Builder b = { .tree = tree, .lamp = lamp, .order = tree->lamp, .filled = 1 };
    for (uint32_t i = 0; i < count; i++)
        b.order[i] = i;
    grow(&b, 0, 0, count, 0);
    for (uint32_t i = 0; i < count; i++) {
        tree->place[tree->lamp[i]] = i;
        tree->below[i + 1] = tree->below[i] + lamp[tree->lamp[i]].strength;
    }
    return true;
}

void lamp_tree_clear(LampTree *tree)
{
    array_free(tree->branch);
    array_free(tree->place);
    array_free(tree->lamp);
    array_free(tree->below);
    *tree = (LampTree){ 0 };
}

/* --- choosing -------------------------------------------------------------------------------- */

static double sine_of(double cosine)
{
    const double square = 1 - cosine * cosine;
    return square > 0 ? sqrt(square) : 0;
}

/* Cosine of an angle less another, or 1 if the other is larger. */
static double cosine_less(double of, double cosine, double sine)
{
    return of > cosine ? 1 : of * cosine + (sine > 0 ? sine_of(of) * sine : 0);
}

/* Lamps that lie together are chosen among by strength alone where their ball's radius is so small
 * a part of how far away they are, how high over the horizon, and how far in front of themselves
 * the receiver lies: each of the three differs among them by a sixth at most. Their axes may differ
 * by 8 degrees, a seventh. Steps further down would take longer than the noise they save. */
static const double FAR = 6, FAR_COSINE = 0.99;

/* The most that a branch may send to the receiver, but that distances are those of its centre.
 * *far: as FAR says. */
static inline __attribute__((always_inline)) double bound(const LampBranch *branch, Vec3 point,
                                                          Vec3 normal, bool *far)
{
    const Vec3   d = vec3_sub(branch->centre, point);
    const double square = vec3_dot(d, d), radius2 = branch->radius * branch->radius;
    *far = false;
    if (!(square > radius2)) /* within the ball, or at a light without size */
        return branch->strength / (radius2 > 0 ? radius2 : 1);
    const double scale = 1 / sqrt(square), sine = branch->radius * scale, cosine = sine_of(sine);
    const double height = vec3_dot(d, normal) * scale, lit = cosine_less(height, cosine, sine);
    if (!(lit > 0))
        return 0;
    /* Between the cone's axis and the way to the receiver, less the cone's angle. */
    const double front = -vec3_dot(d, branch->axis) * scale;
    const double turn = cosine_less(front, branch->cosine, branch->sine);
    const double shine = cosine_less(turn, cosine, sine);
    *far = FAR * sine < height && FAR * sine < front && branch->cosine > FAR_COSINE;
    return shine > 0 ? branch->strength * lit * shine * scale * scale : 0;
}

/* Chance of the first of two branches; < 0: neither sends anything. far[]: of each. */
static double first_chance(const LampBranch *two, Vec3 point, Vec3 normal, bool far[2])
{
    const double first = bound(&two[0], point, normal, &far[0]);
    const double second = bound(&two[1], point, normal, &far[1]);
    return first + second > 0 ? first / (first + second) : -1;
}

/* Strength of the lamps of a branch, as sums round. */
static double strength_in(const LampTree *tree, const LampBranch *branch)
{
    return tree->below[branch->end] - tree->below[branch->begin];
}

/* One of a branch's lamps by strength: its place among them all. */
static uint32_t choose_far(const LampTree *tree, const LampBranch *branch, double *x,
                           double *chance)
{
    const double *below = tree->below, all = strength_in(tree, branch);
    const double  at = below[branch->begin] + *x * all;
    uint32_t      low = branch->begin, high = branch->end;
    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        *(at < below[middle] ? &high : &low) = middle;
    }
    const double own = below[low + 1] - below[low];
    *chance *= own / all;
    *x = own > 0 ? fmin(fmax((at - below[low]) / own, 0), 1 - DBL_EPSILON) : 0;
    return low;
}

uint32_t lamp_tree_choose(const LampTree *tree, Vec3 point, Vec3 normal, double *x,
                          double *chance)
{
    const LampBranch *at = tree->branch;
    bool              far[2];
    *chance = 1;
    assert(tree->count > 0 && *x >= 0 && *x < 1);
    if (!(bound(at, point, normal, far) > 0))
        return LAMP_TREE_NONE;
    while (at->child != 0 && !(*far && strength_in(tree, at) > 0)) {
        const LampBranch *two = &tree->branch[at->child];
        const double      first = first_chance(two, point, normal, far);
        if (first < 0)
            return LAMP_TREE_NONE;
        const bool   here = *x < first;
        const double share = here ? first : 1 - first;
        *x = fmin((here ? *x : *x - first) / share, 1 - DBL_EPSILON);
        *chance *= share;
        at = here ? two : two + 1;
        far[0] = far[here ? 0 : 1];
    }
    const uint32_t place = at->child != 0 ? choose_far(tree, at, x, chance) : at->begin;
    return *chance > 0 ? tree->lamp[place] : LAMP_TREE_NONE;
}

double lamp_tree_most(const LampTree *tree, Vec3 point, Vec3 normal)
{
    bool far;
    return bound(tree->branch, point, normal, &far);
}

double lamp_tree_chance(const LampTree *tree, Vec3 point, Vec3 normal, uint32_t k)
{
    const LampBranch *at = tree->branch;
    double            chance = 1;
    bool              far[2];
    assert(k < tree->count);
    const uint32_t place = tree->place[k];
    if (!(bound(at, point, normal, far) > 0))
        return 0;
    while (at->child != 0 && !(*far && strength_in(tree, at) > 0)) {
        const LampBranch *two = &tree->branch[at->child];
        const double      first = first_chance(two, point, normal, far);
        const bool        here = place < two->end;
        chance *= first < 0 ? 0 : here ? first : 1 - first;
        if (!(chance > 0))
            return 0;
        at = here ? two : two + 1;
        far[0] = far[here ? 0 : 1];
    }
    if (at->child != 0)
        chance *= (tree->below[place + 1] - tree->below[place]) / strength_in(tree, at);
    return chance;
}
