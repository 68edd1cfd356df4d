/* SPDX-License-Identifier: BSD-3-Clause */
/* Ranges of references to nodes: a node's range is cut until it has 8 parts, the one of largest
 * surface first. The top of the tree is built first, with all threads at each cut; what is below a
 * fixed share of the whole becomes a task of its own, and all tasks run side by side. Sizes of
 * tasks depend on the input alone, so the tree does not depend on the number of threads. */
#include <assert.h>
#include <string.h>
#include <sys/mman.h>

#include "base/array.h"
#include "raycast/build.h"
#include "raycast/probe.h"

#define TASKS_FROM 16384u /* references from which there are tasks at all */
#define TASK_REFS_MIN 1024u
#define TASK_REFS_MAX SPLIT_TOGETHER /* two copies fit into a core's own cache */
#define TASKS_WANTED 32u /* several per thread, so that unequal ones even out */
#define TREE_ALIGNMENT 64u /* a cache line */
/* A leaf is parted in two for a slot that is free anyway where this share of its cost is left:
 * more often, memory and time of the build grow and rays gain nothing (measured). */
#define LEAF_KEEPS 0.7f
#define LARGE_PAGE ((uintptr_t)2 << 20)

/* While the tree is in parts: a child that is a task. Nodes are fewer than 2^30. */
#define CHILD_TASK (UINT32_C(1) << 30)

/* Who will be in a group of triangles; unused: RAY_MISS. The corners are copied at the end, once,
 * to where they stay. */
typedef struct {
    uint32_t primitive[GROUP_WIDTH];
} Members;

/* A piece of the tree; references count from its own arrays. */
typedef struct {
    Node    *node;
    Members *group;
    size_t   node_count, node_capacity, group_count, group_capacity;
} Part;

typedef struct {
    Range    range;
    Part     part;
    uint32_t root; /* a reference into part */
    uint32_t node_base, group_base;
    Error    error;
} Task;

typedef struct {
    RefSet            set;
    const Primitives *in;
    Part             *part;
    Task            **task; /* NULL: no tasks are made */
    size_t           *task_count, *task_capacity;
    uint32_t          task_refs; /* ranges up to this many references become tasks */
    Ref              *scratch;   /* [task_refs] of each worker */
} Builder;

/* Rays jump all over a large tree: with small pages the way to each place is looked up each time,
 * and the system hands out memory page by page. Where it has no large pages to give, nothing
 * changes. */
static void pages_enlarge(void *memory, size_t bytes)
{
#ifdef MADV_HUGEPAGE
    const uintptr_t from = ((uintptr_t)memory + LARGE_PAGE - 1) / LARGE_PAGE * LARGE_PAGE;
    const uintptr_t to = ((uintptr_t)memory + bytes) / LARGE_PAGE * LARGE_PAGE;
    if (from < to)
        madvise((void *)from, to - from, MADV_HUGEPAGE);
#else
    (void)memory, (void)bytes;
#endif
}

/* --- leaves ---------------------------------------------------------------------------------- */

static bool leaf_triangles(Builder *b, const Range *r, uint32_t *child, Error *err)
{
    Part *part = b->part;
    const uint32_t count = r->end - r->begin;
    const uint32_t groups = (count + GROUP_WIDTH - 1) / GROUP_WIDTH;
    assert(0 < groups && groups <= LEAF_GROUPS_MAX);
    if (part->group_count + groups > CHILD_INDEX_MAX)
        return error_set(err, ERROR_INPUT, "too many triangles for one tree");
    if (!array_reserve((void **)&part->group, &part->group_capacity, part->group_count + groups,
                       sizeof *part->group, "groups of triangles", err))
        return false;
    const Ref *ref = b->set.ref[r->where] + r->begin;
    for (uint32_t i = 0; i < groups * GROUP_WIDTH; i++)
        part->group[part->group_count + i / GROUP_WIDTH].primitive[i % GROUP_WIDTH] =
            i < count ? ref[i].primitive : RAY_MISS;
    *child = child_triangles((uint32_t)part->group_count, groups);
    part->group_count += groups;
    return true;
}

void group_fill(const Primitives *in, TriangleGroup *group)
{
    memset(group->vertex, 0, sizeof group->vertex);
    for (uint32_t lane = 0; lane < GROUP_WIDTH; lane++) {
        const uint32_t primitive = group->primitive[lane];
        if (primitive == RAY_MISS)
            continue;
        float corner[3][3];
        probe_corners(in, primitive, corner);
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++)
                group->vertex[c][k][lane] = corner[c][k];
    }
}

static bool leaf_build(Builder *b, const Range *r, uint32_t *child, Error *err)
{
    const uint32_t first = b->set.ref[r->where][r->begin].primitive;
    if (first < b->in->triangle_count)
        return leaf_triangles(b, r, child, err);
    assert(r->end - r->begin == 1);
    *child = child_shape(first - b->in->triangle_count);
    return true;
}

/* --- nodes ----------------------------------------------------------------------------------- */

/* Cuts the largest part until there are 8, or all are leaves. */
static bool node_parts(Builder *b, const Range *range, Range part[NODE_WIDTH], uint32_t *count,
                       Error *err)
{
    part[0] = *range;
    for (*count = 1; *count < NODE_WIDTH; (*count)++) {
        float largest = -1;
        uint32_t which = NODE_WIDTH;
        for (uint32_t i = 0; i < *count; i++)
            if (part[i].split.axis != SPLIT_NONE && box_area(part[i].box) > largest) {
                largest = box_area(part[i].box);
                which = i;
            }
        if (which == NODE_WIDTH)
            break;
        const Range cut = part[which];
        if (!range_cut(&b->set, &cut, &part[which], &part[*count], err))
            return false;
    }
    return true;
}

/* Whether parting a leaf saves a good share of its cost; how then. */
static float leaf_saving(const Builder *b, const Range *leaf, Split *split)
{
    const uint32_t count = leaf->end - leaf->begin;
    const float whole = box_area(leaf->box) * groups_of(count);
    if (count < 2 || leaf->depth >= BVH_DEPTH_FREE)
        return 0;
    const BinMap map = bin_map(leaf);
    Bins bins;
    float cost;
    bins_fill(&bins, &map, b->set.ref[leaf->where] + leaf->begin, count);
    *split = bins_split(&bins, &map, &cost);
    return cost < LEAF_KEEPS * whole ? whole - cost : 0;
}

/* Slots that are left over: a box more in a node costs rays nothing, and leaves that are parted
 * have smaller ones. */
static bool parts_fill(Builder *b, Range part[NODE_WIDTH], uint32_t *count, Error *err)
{
    float saving[NODE_WIDTH];
    Split split[NODE_WIDTH];
    for (uint32_t i = 0; i < *count && *count < NODE_WIDTH; i++)
        saving[i] = leaf_saving(b, &part[i], &split[i]);
    while (*count < NODE_WIDTH) {
        uint32_t most = 0;
        for (uint32_t i = 1; i < *count; i++)
            most = saving[i] > saving[most] ? i : most;
        if (!(saving[most] > 0))
            break;
        Range cut = part[most];
        cut.split = split[most];
        const uint32_t new = (*count)++;
        if (!range_cut(&b->set, &cut, &part[most], &part[new], err))
            return false;
        part[most].split.axis = part[new].split.axis = SPLIT_NONE;
        saving[most] = leaf_saving(b, &part[most], &split[most]);
        saving[new] = leaf_saving(b, &part[new], &split[new]);
    }
    return true;
}

/* How well children lie in slots: along a slot's diagonal (internal.h). */
static void slot_scores(Box whole, const Box *child, uint32_t count,
                        float score[NODE_WIDTH][NODE_WIDTH])
{
    const Float4 middle = box_centre(whole);
    for (uint32_t i = 0; i < count; i++) {
        const Float4 o = box_centre(child[i]) - middle;
        for (uint32_t s = 0; s < NODE_WIDTH; s++)
            score[i][s] = (s & 1 ? -o[0] : o[0]) + (s & 2 ? -o[1] : o[1]) + (s & 4 ? -o[2] : o[2]);
    }
}

/* Greedy: the best pair of a child and a free slot first. */
void node_slots(Box whole, const Box *child, uint32_t count, uint32_t slot_of[NODE_WIDTH])
{
    float score[NODE_WIDTH][NODE_WIDTH];
    uint32_t taken = 0, placed = 0;
    slot_scores(whole, child, count, score);
    for (uint32_t round = 0; round < count; round++) {
        float best = -INFINITY;
        uint32_t best_child = 0, best_slot = 0;
        for (uint32_t i = 0; i < count; i++) {
            if (placed >> i & 1)
                continue;
            for (uint32_t s = 0; s < NODE_WIDTH; s++)
                if (!(taken >> s & 1) && score[i][s] > best) {
                    best = score[i][s];
                    best_child = i;
                    best_slot = s;
                }
        }
        slot_of[best_child] = best_slot;
        placed |= 1u << best_child;
        taken |= 1u << best_slot;
    }
}

void node_clear(Node *node)
{
    for (uint32_t i = 0; i < NODE_WIDTH; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            node->plane[2 * k][i] = INFINITY;
            node->plane[2 * k + 1][i] = -INFINITY;
        }
        node->child[i] = CHILD_NONE;
    }
}

static bool part_add_node(Part *part, uint32_t *index, Error *err)
{
    if (!array_reserve((void **)&part->node, &part->node_capacity, part->node_count + 1,
                       sizeof *part->node, "nodes of the tree", err))
        return false;
    *index = (uint32_t)part->node_count++;
    node_clear(&part->node[*index]);
    return true;
}

static bool task_add(Builder *b, const Range *range, uint32_t *child, Error *err)
{
    if (!array_reserve((void **)b->task, b->task_capacity, *b->task_count + 1, sizeof **b->task,
                       "tasks of the build", err))
        return false;
    *child = CHILD_TASK | (uint32_t)*b->task_count;
    memset(&(*b->task)[*b->task_count], 0, sizeof **b->task);
    (*b->task)[(*b->task_count)++].range = *range;
    return true;
}

/* Depth is bounded by BVH_DEPTH: each level is at least one cut. */
static bool child_build(Builder *b, const Range *range, uint32_t *child, Error *err)
{
    if (range->split.axis == SPLIT_NONE)
        return leaf_build(b, range, child, err);
    if (b->task != NULL && range->end - range->begin <= b->task_refs)
        return task_add(b, range, child, err);

    Range part[NODE_WIDTH];
    Box box[NODE_WIDTH];
    uint32_t slot_of[NODE_WIDTH], count, index;
    if (!node_parts(b, range, part, &count, err) || !parts_fill(b, part, &count, err) ||
        !part_add_node(b->part, &index, err))
        return false;
    for (uint32_t i = 0; i < count; i++)
        box[i] = part[i].box;
    node_slots(range->box, box, count, slot_of);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t below;
        if (!child_build(b, &part[i], &below, err))
            return false;
        Node *node = &b->part->node[index]; /* the array may have moved */
        node_set_box(node, slot_of[i], part[i].box);
        node->child[slot_of[i]] = below;
    }
    *child = index;
    return true;
}

/* Node 0 of the part, also when there is only a leaf or nothing. */
static bool root_build(Builder *b, const Range *range, Error *err)
{
    uint32_t child;
    if (range->begin < range->end && range->split.axis != SPLIT_NONE) {
        const bool good = child_build(b, range, &child, err);
        assert(!good || child == 0);
        return good;
    }
    if (!part_add_node(b->part, &child, err) || range->begin == range->end)
        return !error_is_set(err);
    Node *node = &b->part->node[child];
    node_set_box(node, 0, range->box);
    return leaf_build(b, range, &node->child[0], err);
}

/* --- tasks ----------------------------------------------------------------------------------- */

/* A task works in its own stretch of the references and in its worker's scratch. */
static void task_run(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Builder *whole = context;
    for (uint32_t i = begin; i < end; i++) {
        Task *task = &(*whole->task)[i];
        Range *r = &task->range;
        Builder b = { .set = whole->set, .in = whole->in, .part = &task->part };
        assert(r->where == 0 && r->end - r->begin <= whole->task_refs);
        b.set.ref[0] = whole->set.ref[0] + r->begin;
        b.set.ref[1] = whole->scratch + (size_t)worker * whole->task_refs;
        r->end -= r->begin;
        r->begin = 0;
        child_build(&b, r, &task->root, &task->error);
    }
}

/* References of tasks that lie in the second array go back to the first. */
static void task_bring(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Builder *b = context;
    (void)worker;
    for (uint32_t i = begin; i < end; i++) {
        Range *r = &(*b->task)[i].range;
        if (r->where == 1)
            memcpy(b->set.ref[0] + r->begin, b->set.ref[1] + r->begin,
                   (r->end - r->begin) * sizeof(Ref));
        r->where = 0;
    }
}

static bool refs_reserve(Ref **ref, size_t count, Error *err)
{
    size_t capacity = 0;
    *ref = NULL;
    if (!array_reserve((void **)ref, &capacity, count, sizeof **ref, "references to primitives",
                       err))
        return false;
    pages_enlarge(*ref, count * sizeof **ref);
    return true;
}

static bool tasks_run(Builder *b, Error *err)
{
    const uint32_t count = (uint32_t)*b->task_count;
    const unsigned threads = parallel_threads(b->set.threads);
    if (count == 0)
        return true;
    parallel_for(count, 1, threads, task_bring, b, NULL, NULL);
    b->set.ref[1] = array_free(b->set.ref[1]);
    b->set.threads = 0;
    if (!refs_reserve(&b->scratch, (size_t)threads * b->task_refs, err))
        return false;
    parallel_for(count, 1, threads, task_run, b, NULL, NULL);
    b->scratch = array_free(b->scratch);
    return true;
}

static uint32_t child_moved(const Task *task, uint32_t child, uint32_t node_base,
                            uint32_t group_base)
{
    if (child == CHILD_NONE || child_is_shape(child))
        return child;
    if (child_is_leaf(child))
        return child + group_base;
    if ((child & CHILD_TASK) == 0)
        return child + node_base;
    const Task *t = &task[child & ~CHILD_TASK];
    return child_moved(NULL, t->root, t->node_base, t->group_base);
}

static void part_move(Bvh *bvh, const Primitives *in, Part *part, const Task *task,
                      uint32_t node_base, uint32_t group_base)
{
    for (size_t i = 0; i < part->node_count; i++) {
        Node *node = &bvh->node[node_base + i];
        *node = part->node[i];
        for (uint32_t s = 0; s < NODE_WIDTH; s++)
            node->child[s] = child_moved(task, node->child[s], node_base, group_base);
    }
    for (size_t i = 0; i < part->group_count; i++) {
        TriangleGroup *group = &bvh->group[group_base + i];
        memcpy(group->primitive, part->group[i].primitive, sizeof group->primitive);
        group_fill(in, group);
    }
    part->node = array_free(part->node);
    part->group = array_free(part->group);
}

typedef struct {
    Bvh              *bvh;
    const Primitives *in;
    Task             *task;
} MoveContext;

static void task_move(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    MoveContext *c = context;
    (void)worker;
    for (uint32_t i = begin; i < end; i++)
        part_move(c->bvh, c->in, &c->task[i].part, NULL, c->task[i].node_base,
                  c->task[i].group_base);
}

/* One block: nodes, groups, shapes, from a cache line's start. */
bool tree_reserve(Bvh *bvh, size_t nodes, size_t groups, size_t shapes, Error *err)
{
    if (groups > CHILD_INDEX_MAX)
        return error_set(err, ERROR_INPUT, "too many triangles for one tree");
    bvh->bytes = nodes * sizeof(Node) + groups * sizeof(TriangleGroup) + shapes * sizeof(Shape)
                 + TREE_ALIGNMENT;
    bvh->memory = array_create(bvh->bytes, 1, "tree of boxes", err);
    if (bvh->memory == NULL)
        return false;
    pages_enlarge(bvh->memory, bvh->bytes);
    const uintptr_t at = (uintptr_t)bvh->memory;
    char *p = (char *)bvh->memory + (TREE_ALIGNMENT - at % TREE_ALIGNMENT) % TREE_ALIGNMENT;
    bvh->node = (Node *)(void *)p;
    bvh->group = (TriangleGroup *)(void *)(bvh->node + nodes);
    bvh->shape = (Shape *)(void *)(bvh->group + groups);
    bvh->node_count = (uint32_t)nodes;
    bvh->group_count = (uint32_t)groups;
    bvh->shape_count = (uint32_t)shapes;
    return true;
}

static bool tree_join(Bvh *bvh, Builder *b, unsigned threads, Error *err)
{
    size_t nodes = b->part->node_count, groups = b->part->group_count;
    for (size_t i = 0; i < *b->task_count; i++) {
        Task *task = &(*b->task)[i];
        if (error_is_set(&task->error)) {
            *err = task->error;
            return false;
        }
        task->node_base = (uint32_t)nodes;
        task->group_base = (uint32_t)groups;
        nodes += task->part.node_count;
        groups += task->part.group_count;
    }
    const size_t shapes = b->in->shape != NULL ? b->in->shape_count : 0;
    if (!tree_reserve(bvh, nodes, groups, shapes, err))
        return false;
    if (shapes > 0)
        memcpy(bvh->shape, b->in->shape, shapes * sizeof *bvh->shape);
    part_move(bvh, b->in, b->part, *b->task, 0, 0);
    MoveContext c = { .bvh = bvh, .in = b->in, .task = *b->task };
    parallel_for((uint32_t)*b->task_count, 1, threads, task_move, &c, NULL, NULL);
    return true;
}

static bool parts_build(Builder *b, Range *all, uint32_t count, Error *err)
{
    Task **tasks = b->task;
    if (count == 0)
        return root_build(b, all, err);
    if (!refs_reserve(&b->set.ref[1], count, err))
        return false;
    *all = range_all(&b->set, count);
    range_decide(&b->set, all);
    if (b->task_refs == 0)
        b->task = NULL;
    const bool good = root_build(b, all, err);
    b->task = tasks;
    return good && tasks_run(b, err);
}

bool tree_build(Bvh *bvh, const Primitives *in, Ref *ref, uint32_t count, unsigned threads,
                Error *err)
{
    assert(bvh != NULL && in != NULL && ref != NULL && err != NULL);
    Part top = { 0 };
    Task *task = NULL;
    size_t task_count = 0, task_capacity = 0;
    Builder b = { .in = in, .part = &top, .task = &task, .task_count = &task_count,
                  .task_capacity = &task_capacity,
                  .set = { .ref = { ref }, .triangle_count = in->triangle_count,
                           .shapes = in->shape_count > 0 } };
    if (count >= TASKS_FROM) {
        const uint32_t share = count / TASKS_WANTED;
        b.task_refs = share < TASK_REFS_MIN   ? TASK_REFS_MIN
                      : share > TASK_REFS_MAX ? TASK_REFS_MAX
                                              : share;
        b.set.threads = parallel_threads(threads);
    }
    Range all = { 0 };
    bool good = parts_build(&b, &all, count, err);
    for (int k = 0; good && count > 0 && k < 3; k++) {
        bvh->lo[k] = all.box.lo[k];
        bvh->hi[k] = all.box.hi[k];
    }
    array_free(b.set.ref[0]);
    array_free(b.set.ref[1]);
    array_free(b.scratch);
    good = good && tree_join(bvh, &b, threads, err);

    for (size_t i = 0; i < task_count; i++) {
        array_free(task[i].part.node);
        array_free(task[i].part.group);
    }
    array_free(task);
    array_free(top.node);
    array_free(top.group);
    return good;
}
