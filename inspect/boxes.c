/* SPDX-License-Identifier: BSD-3-Clause */
/* A tree of boxes: binned surface-area heuristic [wald07], two children a node. */
#include <assert.h>
#include <float.h>
#include <math.h>

#include "base/array.h"
#include "inspect/internal.h"

enum {
    LEAF = 4,
    BINS = 16,
    SAH_DEPTH = 48,  /* below, halves: bins of hostile sizes could peel off one box at a time */
    STACK = 128      /* SAH_DEPTH and 32 halvings, one waiting node each */
};

Box box_around(Vec3 lo, Vec3 hi)
{
    const double low[3] = { lo.x, lo.y, lo.z }, high[3] = { hi.x, hi.y, hi.z };
    Box box;
    for (int k = 0; k < 3; k++) {
        box.lo[k] = nextafterf((float)low[k], -INFINITY);
        box.hi[k] = nextafterf((float)high[k], INFINITY);
    }
    return box;
}

float box_size(const Box *box)
{
    return fmaxf(box->hi[0] - box->lo[0],
                 fmaxf(box->hi[1] - box->lo[1], box->hi[2] - box->lo[2]));
}

static const Box no_box = { { FLT_MAX, FLT_MAX, FLT_MAX }, { -FLT_MAX, -FLT_MAX, -FLT_MAX } };

static void box_add(Box *box, const Box *other)
{
    for (int k = 0; k < 3; k++) {
        box->lo[k] = other->lo[k] < box->lo[k] ? other->lo[k] : box->lo[k];
        box->hi[k] = other->hi[k] > box->hi[k] ? other->hi[k] : box->hi[k];
    }
}

static float box_area(const Box *box)
{
    const float x = box->hi[0] - box->lo[0], y = box->hi[1] - box->lo[1];
    const float z = box->hi[2] - box->lo[2];
    return x * y + y * z + z * x;
}

/* Twice the centre. */
static float box_middle(const Box *box, int axis) { return box->lo[axis] + box->hi[axis]; }

/* --- building --------------------------------------------------------------------------------- */

typedef struct {
    uint32_t node, begin, end, depth;
} Task;

static uint32_t bin_of(const Box *box, int axis, float low, float scale)
{
    const float at = (box_middle(box, axis) - low) * scale;
    return at >= BINS - 1 ? BINS - 1 : (uint32_t)fmaxf(at, 0);
}

/* Best bin to cut before: least area times count of both sides; 0: none. */
static uint32_t best_bin(const Box bin[BINS], const uint32_t count[BINS])
{
    float    cost[BINS] = { 0 }, best = INFINITY;
    Box      box = no_box;
    uint32_t n = 0, at = 0;
    for (uint32_t k = BINS - 1; k > 0; k--) {
        box_add(&box, &bin[k]);
        n += count[k];
        cost[k] = n > 0 ? (float)n * box_area(&box) : INFINITY;
    }
    box = no_box;
    n = 0;
    for (uint32_t k = 1; k < BINS; k++) {
        box_add(&box, &bin[k - 1]);
        n += count[k - 1];
        if (n > 0 && cost[k] + (float)n * box_area(&box) < best) {
            best = cost[k] + (float)n * box_area(&box);
            at = k;
        }
    }
    return at;
}

/* Where the entries begin..end-1 are parted in two; they are put in order for it. */
static uint32_t part_entries(BoxEntry *entry, const Task *task)
{
    float lo[3] = { FLT_MAX, FLT_MAX, FLT_MAX }, hi[3] = { -FLT_MAX, -FLT_MAX, -FLT_MAX };
    for (uint32_t i = task->begin; i < task->end; i++)
        for (int k = 0; k < 3; k++) {
            lo[k] = fminf(lo[k], box_middle(&entry[i].box, k));
            hi[k] = fmaxf(hi[k], box_middle(&entry[i].box, k));
        }
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (hi[k] - lo[k] > hi[axis] - lo[axis])
            axis = k;
    const uint32_t half = task->begin + (task->end - task->begin) / 2;
    const float scale = BINS / (hi[axis] - lo[axis]);
    if (task->depth >= SAH_DEPTH || !(hi[axis] > lo[axis]) || !isfinite(scale))
        return half;
    Box      bin[BINS];
    uint32_t count[BINS] = { 0 };
    for (int k = 0; k < BINS; k++)
        bin[k] = no_box;
    for (uint32_t i = task->begin; i < task->end; i++) {
        const uint32_t k = bin_of(&entry[i].box, axis, lo[axis], scale);
        box_add(&bin[k], &entry[i].box);
        count[k]++;
    }
    const uint32_t cut = best_bin(bin, count);
    uint32_t       left = task->begin, right = task->end;
    while (left < right)
        if (bin_of(&entry[left].box, axis, lo[axis], scale) < cut) {
            left++;
        } else {
            const BoxEntry other = entry[--right];
            entry[right] = entry[left];
            entry[left] = other;
        }
    return left > task->begin && left < task->end ? left : half;
}

static void fill_node(const BoxTree *tree, const Task *task)
{
    BoxNode *node = &tree->node[task->node];
    *node = (BoxNode){ .box = no_box };
    for (uint32_t i = task->begin; i < task->end; i++) {
        box_add(&node->box, &tree->entry[i].box);
        node->size = fmaxf(node->size, box_size(&tree->entry[i].box));
    }
}

bool box_tree_create(BoxTree *tree, BoxEntry *entry, uint32_t count, Error *err)
{
    assert(tree != NULL && err != NULL && count < UINT32_MAX / 2);
    *tree = (BoxTree){ .entry = entry, .count = count };
    tree->node = array_create(2 * (size_t)count + 1, sizeof *tree->node, "box tree", err);
    if (tree->node == NULL || entry == NULL) {
        box_tree_clear(tree);
        return false;
    }
    for (uint32_t i = 0; i < count; i++)
        entry[i].item = i;
    Task     stack[STACK] = { { .end = count } };
    uint32_t waiting = count > 0;
    tree->node_count = count > 0;
    while (waiting > 0) {
        const Task task = stack[--waiting];
        fill_node(tree, &task);
        BoxNode *node = &tree->node[task.node];
        if (task.end - task.begin <= LEAF) {
            node->first = task.begin;
            node->count = task.end - task.begin;
            continue;
        }
        const uint32_t cut = part_entries(entry, &task), depth = task.depth + 1;
        node->first = tree->node_count;
        tree->node_count += 2;
        assert(waiting + 2 <= STACK);
        stack[waiting++] = (Task){ node->first + 1, cut, task.end, depth };
        stack[waiting++] = (Task){ node->first, task.begin, cut, depth };
    }
    return true;
}

void box_tree_clear(BoxTree *tree)
{
    array_free(tree->node);
    array_free(tree->entry);
    *tree = (BoxTree){ 0 };
}

/* --- asking ----------------------------------------------------------------------------------- */

static bool boxes_meet(const Box *a, const Box *b)
{
    return a->lo[0] <= b->hi[0] && b->lo[0] <= a->hi[0] && a->lo[1] <= b->hi[1] &&
           b->lo[1] <= a->hi[1] && a->lo[2] <= b->hi[2] && b->lo[2] <= a->hi[2];
}

uint32_t box_tree_meet(const BoxTree *tree, const Box *box, float least, uint32_t *at,
                       uint32_t most)
{
    uint32_t stack[STACK], waiting = tree->count > 0, found = 0;
    stack[0] = 0;
    while (waiting > 0) {
        const BoxNode *node = &tree->node[stack[--waiting]];
        if (node->size < least || !boxes_meet(&node->box, box))
            continue;
        for (uint32_t i = node->first; i < node->first + node->count; i++) {
            const BoxEntry *entry = &tree->entry[i];
            if (!boxes_meet(&entry->box, box) || box_size(&entry->box) < least)
                continue;
            if (found == most)
                return most + 1;
            at[found++] = i;
        }
        if (node->count == 0) {
            assert(waiting + 2 <= STACK);
            stack[waiting++] = node->first + 1;
            stack[waiting++] = node->first;
        }
    }
    return found;
}

/* The slab test; comparisons are such that a box is rather met than missed. */
static bool box_pierced(const Box *box, const double origin[3], const double inverse[3],
                        double reach)
{
    double enter = 0, leave = reach;
    for (int k = 0; k < 3; k++) {
        const double a = (box->lo[k] - origin[k]) * inverse[k];
        const double b = (box->hi[k] - origin[k]) * inverse[k];
        enter = fmax(enter, fmin(a, b));
        leave = fmin(leave, fmax(a, b));
    }
    return enter <= leave;
}

uint32_t box_tree_pierce(const BoxTree *tree, Vec3 origin, Vec3 direction, double reach,
                         uint32_t *at, uint32_t most)
{
    assert(direction.x != 0 && direction.y != 0 && direction.z != 0);
    const double o[3] = { origin.x, origin.y, origin.z };
    const double inverse[3] = { 1 / direction.x, 1 / direction.y, 1 / direction.z };
    uint32_t     stack[STACK], waiting = tree->count > 0, found = 0;
    stack[0] = 0;
    while (waiting > 0) {
        const BoxNode *node = &tree->node[stack[--waiting]];
        if (!box_pierced(&node->box, o, inverse, reach))
            continue;
        for (uint32_t i = node->first; i < node->first + node->count; i++) {
            if (!box_pierced(&tree->entry[i].box, o, inverse, reach))
                continue;
            if (found == most)
                return most + 1;
            at[found++] = i;
        }
        if (node->count == 0) {
            assert(waiting + 2 <= STACK);
            stack[waiting++] = node->first + 1;
            stack[waiting++] = node->first;
        }
    }
    return found;
}
