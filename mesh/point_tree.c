/* SPDX-License-Identifier: BSD-3-Clause */
/* Points along a line, by a tree of boxes over the points in Morton order [morton66]. */
#include "mesh/point_tree.h"

#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "mesh/edges.h"

enum { GRID_BITS = 10 }; /* of each coordinate in a Morton code: three leave room for an index */

/* --- building --------------------------------------------------------------------------------- */

static uint32_t spread_bits(uint32_t x)
{
    x = (x | x << 16) & 0x030000FFu;
    x = (x | x << 8) & 0x0300F00Fu;
    x = (x | x << 4) & 0x030C30C3u;
    return (x | x << 2) & 0x09249249u;
}

static void range_box(const PointTree *tree, uint32_t begin, uint32_t end, Vec3 *lo, Vec3 *hi)
{
    *lo = vec3(INFINITY, INFINITY, INFINITY);
    *hi = vec3(-INFINITY, -INFINITY, -INFINITY);
    for (uint32_t i = begin; i < end; i++) {
        *lo = vec3_min(*lo, tree->position[tree->point[i]]);
        *hi = vec3_max(*hi, tree->position[tree->point[i]]);
    }
}

static uint32_t grid_place(double x, double lo, double hi)
{
    const double most = (1 << GRID_BITS) - 1;
    return hi > lo ? (uint32_t)(fmin((x - lo) / (hi - lo), 1) * most) : 0;
}

/* Sorts a range; points that are crowded into one cell of its grid get a grid of their own. Each
 * grid is at most a 1023rd of the one around it, so doubles end this within a few rounds, but for
 * points that differ in one coordinate only by what is lost in (x - lo). */
static void morton_sort(PointTree *tree, uint32_t begin, uint32_t end, uint64_t *key, int rounds)
{
    Vec3 lo, hi;
    range_box(tree, begin, end, &lo, &hi);
    for (uint32_t i = begin; i < end; i++) {
        const Vec3 p = tree->position[tree->point[i]];
        const uint32_t code = spread_bits(grid_place(p.x, lo.x, hi.x))
                            | spread_bits(grid_place(p.y, lo.y, hi.y)) << 1
                            | spread_bits(grid_place(p.z, lo.z, hi.z)) << 2;
        key[i] = (uint64_t)code << 32 | tree->point[i];
    }
    edges_sort_keys(key + begin, end - begin);
    for (uint32_t i = begin; i < end; i++)
        tree->point[i] = (uint32_t)key[i];
    for (uint32_t i = begin; i < end && rounds > 1;) {
        uint32_t next = i + 1;
        while (next < end && key[next] >> 32 == key[i] >> 32)
            next++;
        if (next - i > POINT_TREE_LEAF && next - i < end - begin)
            morton_sort(tree, i, next, key, rounds - 1);
        i = next;
    }
}

static void build_boxes(PointTree *tree, uint32_t node, uint32_t begin, uint32_t end)
{
    if (end - begin <= POINT_TREE_LEAF) {
        range_box(tree, begin, end, &tree->box[node].lo, &tree->box[node].hi);
        return;
    }
    const uint32_t middle = begin + (end - begin) / 2;
    build_boxes(tree, 2 * node, begin, middle);
    build_boxes(tree, 2 * node + 1, middle, end);
    tree->box[node].lo = vec3_min(tree->box[2 * node].lo, tree->box[2 * node + 1].lo);
    tree->box[node].hi = vec3_max(tree->box[2 * node].hi, tree->box[2 * node + 1].hi);
}

bool point_tree_create(PointTree *tree, const Vec3 *position, const uint32_t *vertex,
                       uint32_t count, Error *err)
{
    assert(tree != NULL && err != NULL && (count == 0 || (position != NULL && vertex != NULL)));
    enum { ROUNDS = 8 };
    size_t boxes = 2;
    for (size_t n = count; n > POINT_TREE_LEAF; n -= n / 2) /* the greater half */
        boxes *= 2;
    *tree = (PointTree){ .position = position, .count = count };
    tree->point = array_create(count, sizeof *tree->point, "points", err);
    tree->box = array_create(boxes, sizeof *tree->box, "points", err);
    uint64_t *key = array_create(count, sizeof *key, "points", err);
    if (error_is_set(err)) {
        point_tree_clear(tree);
    } else {
        for (uint32_t i = 0; i < count; i++)
            tree->point[i] = vertex[i];
        morton_sort(tree, 0, count, key, ROUNDS);
        build_boxes(tree, 1, 0, count);
    }
    array_free(key);
    return !error_is_set(err);
}

void point_tree_clear(PointTree *tree)
{
    array_free(tree->point);
    array_free(tree->box);
    *tree = (PointTree){ 0 };
}

void point_tree_shorten(PointTree *tree, uint32_t count)
{
    assert(count <= tree->count);
    tree->count = count;
    build_boxes(tree, 1, 0, count);
}

/* --- searching -------------------------------------------------------------------------------- */

typedef struct {
    const PointTree *tree;
    Vec3             p, way;    /* the line from p to p + way */
    double           square;    /* of its length */
    double           reach;
    bool           (*found)(void *context, uint32_t vertex, double fraction);
    void            *context;
} Line;

/* Whether the line comes into a box grown by the reach. */
static bool line_meets_box(void *context, const PointBox *box)
{
    const Line *s = context;
    double enter = 0, leave = 1;
    for (int k = 0; k < 3; k++) {
        const double below = vec3_axis(box->lo, k) - s->reach - vec3_axis(s->p, k);
        const double above = vec3_axis(box->hi, k) + s->reach - vec3_axis(s->p, k);
        const double way = vec3_axis(s->way, k);
        if (way == 0) {
            if (below > 0 || above < 0)
                return false;
            continue;
        }
        const double a = below / way, b = above / way;
        enter = fmax(enter, fmin(a, b));
        leave = fmin(leave, fmax(a, b));
    }
    return enter <= leave;
}

static bool line_meets_point(void *context, uint32_t vertex)
{
    const Line *s = context;
    const Vec3 to = vec3_sub(s->tree->position[vertex], s->p);
    const double fraction = vec3_dot(to, s->way) / s->square;
    if (!(fraction > 0 && fraction < 1))
        return true;
    const Vec3 off = vec3_mad(to, -fraction, s->way);
    return vec3_length(off) > s->reach || s->found(s->context, vertex, fraction);
}

bool point_tree_along(const PointTree *tree, Vec3 p, Vec3 q, double reach,
                      bool (*found)(void *context, uint32_t vertex, double fraction),
                      void *context)
{
    assert(tree != NULL && found != NULL && reach >= 0);
    Line line = { .tree = tree, .p = p, .way = vec3_sub(q, p), .reach = reach, .found = found,
                  .context = context };
    line.square = vec3_dot(line.way, line.way);
    return !(line.square > 0) || point_tree_visit(tree, line_meets_box, line_meets_point, &line);
}
