/* SPDX-License-Identifier: BSD-3-Clause */
/* A binary tree of lamps: how it is made, and the way down and up. */
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
    uint32_t above;    /* the branch that this one leaves; of the root: itself */
    uint32_t second;   /* the first is the next in the array; 0: a leaf */
    uint32_t lamp;     /* of a leaf */
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
    uint32_t       *order;  /* [count] */
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
static uint32_t grow(Builder *b, uint32_t begin, uint32_t end, uint32_t above, unsigned depth)
{
    const uint32_t index = b->filled++;
    LampBranch    *branch = &b->tree->branch[index];
    Extent         all = { 0 };
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
                            .strength = all.strength, .above = above };
    if (leaf) {
        branch->lamp = b->order[begin];
        b->tree->leaf[branch->lamp] = index;
        return index;
    }
    const uint32_t middle = part(b, begin, end, depth);
    grow(b, begin, middle, index, depth + 1);
    branch->second = grow(b, middle, end, index, depth + 1);
    return index;
}

bool lamp_tree_init(LampTree *tree, const TreeLamp *lamp, uint32_t count, Error *err)
{
    assert(count > 0 && count <= UINT32_MAX / 2);
    *tree = (LampTree){ .count = count };
    Builder b = { .tree = tree, .lamp = lamp };
    tree->branch = array_create(2 * (size_t)count - 1, sizeof *tree->branch, "lamps", err);
    tree->leaf = array_create(count, sizeof *tree->leaf, "lamps", err);
    b.order = array_create(count, sizeof *b.order, "lamps", err);
    const bool ok = tree->branch != NULL && tree->leaf != NULL && b.order != NULL;
    for (uint32_t i = 0; i < count && ok; i++)
        b.order[i] = i;
    if (ok)
        grow(&b, 0, count, 0, 0);
    array_free(b.order);
    if (!ok)
        lamp_tree_clear(tree);
    return ok;
}

void lamp_tree_clear(LampTree *tree)
{
    array_free(tree->branch);
    array_free(tree->leaf);
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
    return of > cosine ? 1 : of * cosine + sine_of(of) * sine;
}

/* The most that a branch may send to the receiver, but that distances are those of its centre. */
static double bound(const LampBranch *branch, Vec3 point, Vec3 normal)
{
    const Vec3   d = vec3_sub(branch->centre, point);
    const double square = vec3_dot(d, d), radius2 = branch->radius * branch->radius;
    if (!(square > radius2)) /* within the ball, or at a light without size */
        return branch->strength / (radius2 > 0 ? radius2 : 1);
    const double scale = 1 / sqrt(square), sine = branch->radius * scale, cosine = sine_of(sine);
    const double lit = cosine_less(vec3_dot(d, normal) * scale, cosine, sine);
    if (!(lit > 0))
        return 0;
    /* Between the cone's axis and the way to the receiver, less the cone's angle. */
    const double turn = cosine_less(-vec3_dot(d, branch->axis) * scale, branch->cosine,
                                    branch->sine);
    const double shine = cosine_less(turn, cosine, sine);
    return shine > 0 ? branch->strength * lit * shine * scale * scale : 0;
}

/* Chance of the first of the two branches that leave `above`; < 0: neither sends anything. */
static double first_chance(const LampTree *tree, uint32_t above, Vec3 point, Vec3 normal)
{
    const double first = bound(&tree->branch[above + 1], point, normal);
    const double second = bound(&tree->branch[tree->branch[above].second], point, normal);
    return first + second > 0 ? first / (first + second) : -1;
}

uint32_t lamp_tree_choose(const LampTree *tree, Vec3 point, Vec3 normal, double *x,
                          double *chance)
{
    uint32_t at = 0;
    *chance = 1;
    assert(tree->count > 0 && *x >= 0 && *x < 1);
    if (!(bound(&tree->branch[0], point, normal) > 0))
        return LAMP_TREE_NONE;
    while (tree->branch[at].second != 0) {
        const double first = first_chance(tree, at, point, normal);
        if (first < 0)
            return LAMP_TREE_NONE;
        const bool   here = *x < first;
        const double share = here ? first : 1 - first;
        *x = fmin((here ? *x : *x - first) / share, 1 - DBL_EPSILON);
        *chance *= share;
        at = here ? at + 1 : tree->branch[at].second;
    }
    return *chance > 0 ? tree->branch[at].lamp : LAMP_TREE_NONE;
}

double lamp_tree_chance(const LampTree *tree, Vec3 point, Vec3 normal, uint32_t k)
{
    double chance = 1;
    assert(k < tree->count);
    if (!(bound(&tree->branch[0], point, normal) > 0))
        return 0;
    for (uint32_t at = tree->leaf[k]; at != 0; at = tree->branch[at].above) {
        const uint32_t above = tree->branch[at].above;
        const double   first = first_chance(tree, above, point, normal);
        chance *= first < 0 ? 0 : at == above + 1 ? first : 1 - first;
    }
    return chance;
}
