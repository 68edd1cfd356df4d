/* SPDX-License-Identifier: BSD-3-Clause */
/* Pairs to nodes of 8 children: of all ways to leave out pairs and to end in leaves, the one of
 * least cost by the surface-area heuristic, found from below [ylitie17]. For each pair: what its
 * references cost in one child of a node above, and in up to 2, 3, ... 7 children. */
#include <assert.h>
#include <string.h>

#include "base/array.h"
#include "raycast/pairs.h"

#define FILL_CHUNK 4096u
#define MANY 255u /* references: more than a leaf takes, or a shape among them */
_Static_assert(LEAF_REFS_MAX < MANY, "counts of leaves are bytes");

/* Way [i] is for i + 1 children. */
typedef struct {
    float   cost[NODE_WIDTH - 1];
    uint8_t left[NODE_WIDTH - 1]; /* of them the left pair's; 0: fewer children cost no more */
    uint8_t left_of_node;         /* when it is a node itself: of its 8; 0: it is a leaf */
    uint8_t refs;                 /* up to MANY */
} Ways;

typedef struct {
    const Pairs      *pairs;
    const Primitives *in;
    Ways             *ways;
    uint32_t         *order; /* [order_count] pairs with two children, parents first */
    uint32_t          order_count;
    uint32_t          node_count, group_count;
    bool              deep;
    Bvh              *bvh;
} Collapse;

/* --- costs ----------------------------------------------------------------------------------- */

static bool list_pairs(Collapse *c, Error *err)
{
    uint32_t *stack = NULL, height = 0;
    size_t capacity = 0;
    const Pair *pair = c->pairs->pair;
    bool good = array_reserve((void **)&stack, &capacity, 64, sizeof *stack, "pairs", err);
    if (good)
        stack[height++] = 0;
    while (good && height > 0) {
        const uint32_t i = stack[--height];
        if (pair_is_one(&pair[i]))
            continue;
        c->order[c->order_count++] = i;
        good = array_reserve((void **)&stack, &capacity, height + 2, sizeof *stack, "pairs", err);
        if (good) {
            stack[height++] = pair[i].right;
            stack[height++] = pair[i].left;
        }
    }
    array_free(stack);
    return good;
}

static Ways ways_of_one(const Collapse *c, const Pair *pair)
{
    Ways w = { .refs = pair->left < c->in->triangle_count ? 1 : MANY };
    const float area = box_area(pair_box(pair));
    for (uint32_t i = 0; i < NODE_WIDTH - 1; i++)
        w.cost[i] = area;
    return w;
}

/* The cheapest way to share `children` among both; how many the left one gets. */
static uint8_t cheapest_share(const Ways *left, const Ways *right, uint32_t children, float *cost)
{
    uint32_t best = 1;
    *cost = INFINITY;
    for (uint32_t k = 1; k < children; k++) {
        const float sum = left->cost[k - 1] + right->cost[children - k - 1];
        if (sum < *cost) {
            *cost = sum;
            best = k;
        }
    }
    return (uint8_t)best;
}

static void ways_fill(Collapse *c, uint32_t i)
{
    const Pair *pair = &c->pairs->pair[i];
    const Ways *left = &c->ways[pair->left], *right = &c->ways[pair->right];
    const float area = box_area(pair_box(pair));
    const uint32_t refs = (uint32_t)left->refs + right->refs;
    Ways w = { .refs = (uint8_t)(refs < MANY ? refs : MANY) };
    w.left_of_node = cheapest_share(left, right, NODE_WIDTH, &w.cost[0]);
    w.cost[0] += COST_NODE * area;
    if (refs <= LEAF_REFS_MAX && area * groups_of(refs) <= w.cost[0]) {
        w.cost[0] = area * groups_of(refs);
        w.left_of_node = 0;
    }
    for (uint32_t k = 1; k < NODE_WIDTH - 1; k++) {
        w.left[k] = cheapest_share(left, right, k + 1, &w.cost[k]);
        if (w.cost[k - 1] <= w.cost[k]) {
            w.cost[k] = w.cost[k - 1];
            w.left[k] = 0;
        }
    }
    c->ways[i] = w;
}

/* --- children -------------------------------------------------------------------------------- */

static void children_share(const Collapse *c, uint32_t pair, uint32_t left, uint32_t children,
                           uint32_t *child, uint32_t *count);

/* The pairs that stand for this one when it may have so many children. */
static void children_list(const Collapse *c, uint32_t pair, uint32_t children, uint32_t *child,
                          uint32_t *count)
{
    const Ways *w = &c->ways[pair];
    while (children > 1 && w->left[children - 1] == 0)
        children--;
    if (children == 1)
        child[(*count)++] = pair;
    else
        children_share(c, pair, w->left[children - 1], children, child, count);
}

static void children_share(const Collapse *c, uint32_t pair, uint32_t left, uint32_t children,
                           uint32_t *child, uint32_t *count)
{
    const Pair *p = &c->pairs->pair[pair];
    children_list(c, p->left, left, child, count);
    children_list(c, p->right, children - left, child, count);
}

static uint32_t node_children(const Collapse *c, uint32_t pair, uint32_t child[NODE_WIDTH])
{
    uint32_t count = 0;
    children_share(c, pair, c->ways[pair].left_of_node, NODE_WIDTH, child, &count);
    assert(count <= NODE_WIDTH);
    return count;
}

/* The primitives of a leaf, each once. */
static uint32_t leaf_list(const Collapse *c, uint32_t pair, uint32_t *primitive, uint32_t count)
{
    const Pair *p = &c->pairs->pair[pair];
    if (!pair_is_one(p))
        return leaf_list(c, p->right, primitive, leaf_list(c, p->left, primitive, count));
    for (uint32_t i = 0; i < count; i++)
        if (primitive[i] == p->left)
            return count;
    primitive[count] = p->left;
    return count + 1;
}

/* --- nodes ----------------------------------------------------------------------------------- */

static void count_node(Collapse *c, uint32_t pair, uint32_t depth)
{
    uint32_t child[NODE_WIDTH], primitive[LEAF_REFS_MAX];
    c->node_count++;
    c->deep |= depth > BVH_DEPTH;
    const uint32_t count = node_children(c, pair, child);
    for (uint32_t i = 0; i < count && !c->deep; i++) {
        if (c->ways[child[i]].left_of_node != 0)
            count_node(c, child[i], depth + 1);
        else if (c->ways[child[i]].refs != MANY)
            c->group_count += (uint32_t)groups_of(leaf_list(c, child[i], primitive, 0));
    }
}

static uint32_t emit_leaf(Collapse *c, uint32_t pair)
{
    uint32_t primitive[LEAF_REFS_MAX];
    if (c->ways[pair].refs == MANY)
        return child_shape(c->pairs->pair[pair].left - c->in->triangle_count);
    const uint32_t count = leaf_list(c, pair, primitive, 0), first = c->group_count;
    const uint32_t groups = (count + GROUP_WIDTH - 1) / GROUP_WIDTH;
    for (uint32_t i = 0; i < groups * GROUP_WIDTH; i++)
        c->bvh->group[first + i / GROUP_WIDTH].primitive[i % GROUP_WIDTH] =
            i < count ? primitive[i] : RAY_MISS;
    c->group_count += groups;
    return child_triangles(first, groups);
}

static uint32_t emit_node(Collapse *c, uint32_t pair)
{
    uint32_t child[NODE_WIDTH], slot_of[NODE_WIDTH];
    Box box[NODE_WIDTH] = { { { 0 }, { 0 } } };
    const uint32_t count = node_children(c, pair, child), index = c->node_count++;
    Node *node = &c->bvh->node[index];
    for (uint32_t i = 0; i < count; i++)
        box[i] = pair_box(&c->pairs->pair[child[i]]);
    node_slots(pair_box(&c->pairs->pair[pair]), box, count, slot_of);
    node_clear(node);
    for (uint32_t i = 0; i < count; i++) {
        node_set_box(node, slot_of[i], box[i]);
        node->child[slot_of[i]] = c->ways[child[i]].left_of_node != 0 ? emit_node(c, child[i])
                                                                      : emit_leaf(c, child[i]);
    }
    return index;
}

static void fill_groups(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Collapse *c = context;
    (void)worker;
    for (uint32_t i = begin; i < end; i++)
        group_fill(c->in, &c->bvh->group[i]);
}

/* The root is a node also when all fits into a leaf. */
static bool collapse_emit(Collapse *c, unsigned threads, Error *err)
{
    const bool leaf = c->ways[0].left_of_node == 0;
    uint32_t primitive[LEAF_REFS_MAX];
    if (!leaf)
        count_node(c, 0, 1);
    else {
        c->node_count = 1;
        c->group_count = c->ways[0].refs == MANY ? 0
                                                 : (uint32_t)groups_of(leaf_list(c, 0, primitive,
                                                                                 0));
    }
    if (c->deep || !tree_reserve(c->bvh, c->node_count, c->group_count, c->in->shape_count, err))
        return !error_is_set(err);
    const Box all = pair_box(&c->pairs->pair[0]);
    c->node_count = c->group_count = 0;
    if (!leaf)
        emit_node(c, 0);
    else {
        Node *node = &c->bvh->node[c->node_count++];
        node_clear(node);
        node_set_box(node, 0, all);
        node->child[0] = emit_leaf(c, 0);
    }
    assert(c->node_count == c->bvh->node_count && c->group_count == c->bvh->group_count);
    parallel_for(c->group_count, FILL_CHUNK, threads, fill_groups, c, NULL, NULL);
    if (c->in->shape_count > 0)
        memcpy(c->bvh->shape, c->in->shape, c->in->shape_count * sizeof *c->bvh->shape);
    for (int k = 0; k < 3; k++) {
        c->bvh->lo[k] = all.lo[k];
        c->bvh->hi[k] = all.hi[k];
    }
    return true;
}

bool pairs_collapse(Bvh *bvh, const Pairs *pairs, const Primitives *in, unsigned threads,
                    bool *deep, Error *err)
{
    assert(bvh != NULL && pairs->refs > 0 && in != NULL && deep != NULL);
    Collapse c = { .pairs = pairs, .in = in, .bvh = bvh };
    c.ways = array_create(pairs->count, sizeof *c.ways, "ways of a tree", err);
    c.order = array_create(pairs->refs, sizeof *c.order, "pairs of a tree", err);
    bool good = !error_is_set(err) && list_pairs(&c, err);
    for (uint32_t i = 0; good && i < pairs->count; i++)
        if (pair_is_one(&pairs->pair[i]))
            c.ways[i] = ways_of_one(&c, &pairs->pair[i]);
    for (uint32_t i = c.order_count; good && i-- > 0;)
        ways_fill(&c, c.order[i]);
    good = good && collapse_emit(&c, threads, err);
    *deep = c.deep;
    array_free(c.ways);
    array_free(c.order);
    return good;
}
