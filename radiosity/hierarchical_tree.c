/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/hierarchical_tree.c -- a tree over patches: halves by place and by where they face. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "radiosity/hierarchical.h"
#include "radiosity/links_store.h"

enum { AXES = 6 }; /* three of place, three of the normal */

/* What patches are sorted by: what they can exchange light with, and whether they are lamps. */
typedef struct {
    uint64_t part;
    uint32_t patch;
} PartKey;

static uint32_t find_part(uint32_t *up, uint32_t i)
{
    while (up[i] != i) {
        up[i] = up[up[i]];
        i = up[i];
    }
    return i;
}

/* Patches between which light can go by any way belong to one part [galler64]; its name is its
 * first patch. Nodes of one part only: no light gets into a room that no ray has entered. */
static void join_parts(const SolveSystem *system, uint32_t *up)
{
    const Links *links = system->links;
    for (uint32_t i = 0; i < links->count; i++)
        up[i] = i;
    for (uint32_t i = 0; i < links->count; i++) {
        const LinksRow row = links_row(links, i, &system->scratch[0]);
        for (uint64_t k = 0; k < row.count; k++) {
            const uint32_t a = find_part(up, i), b = find_part(up, row.source[k]);
            if (row.form_factor[k] > 0 && a != b)
                up[a > b ? a : b] = a > b ? b : a;
        }
        links_pass(links, i);
    }
}

static int compare_keys(const void *a, const void *b)
{
    const PartKey *x = a, *y = b;
    if (x->part != y->part)
        return x->part < y->part ? -1 : 1;
    return x->patch < y->patch ? -1 : x->patch > y->patch;
}

static double coordinate(const SolveOptions *o, uint32_t patch, unsigned axis, double scale)
{
    const Vec3 v = axis < 3 ? o->centre[patch] : o->normal[patch];
    const unsigned k = axis % 3;
    return (k == 0 ? v.x : k == 1 ? v.y : v.z) * (axis < 3 ? scale : 1);
}

/* The axis along which leaves spread most, and the middle there. Normals count against places as
 * if the scene were of size 1: what faces apart is parted before what is apart. */
static double widest(const Tree *tree, const SolveOptions *o, const TreeNode *n, double scale,
                     unsigned *axis, double *middle)
{
    double most = -1;
    for (unsigned a = 0; a < AXES; a++) {
        double low = INFINITY, high = -INFINITY;
        for (uint32_t k = n->begin; k < n->end; k++) {
            const double x = coordinate(o, tree->patch[k], a, scale);
            low = fmin(low, x);
            high = fmax(high, x);
        }
        if (high - low > most) {
            most = high - low;
            *axis = a;
            *middle = (low + high) / 2;
        }
    }
    return most;
}

/* Brings the leaves on the near side of the middle to the front; where all lie in one place, they
 * are halved by number. */
static uint32_t divide(Tree *tree, const SolveOptions *o, const TreeNode *n, double scale)
{
    unsigned axis = 0;
    double middle = 0;
    uint32_t at = n->begin;
    if (widest(tree, o, n, scale, &axis, &middle) > 0)
        for (uint32_t k = n->begin; k < n->end; k++)
            if (coordinate(o, tree->patch[k], axis, scale) < middle) {
                const uint32_t swap = tree->patch[k];
                tree->patch[k] = tree->patch[at];
                tree->patch[at++] = swap;
            }
    return at > n->begin && at < n->end ? at : n->begin + (n->end - n->begin) / 2;
}

static void add_node(Tree *tree, uint32_t begin, uint32_t end, uint8_t lamp)
{
    tree->lamp[tree->count] = lamp;
    tree->node[tree->count++] = (TreeNode){ .begin = begin, .end = end };
}

/* One over the largest extent of all patches. */
static double scale_of(const SolveOptions *o, uint32_t count)
{
    Vec3 low = count > 0 ? o->centre[0] : vec3(0, 0, 0), high = low;
    for (uint32_t i = 1; i < count; i++) {
        const Vec3 c = o->centre[i];
        low = vec3(fmin(low.x, c.x), fmin(low.y, c.y), fmin(low.z, c.z));
        high = vec3(fmax(high.x, c.x), fmax(high.y, c.y), fmax(high.z, c.z));
    }
    const double extent = fmax(high.x - low.x, fmax(high.y - low.y, high.z - low.z));
    return extent > 0 ? 1 / extent : 1;
}

static void grow(Tree *tree, const SolveSystem *system, const PartKey *key)
{
    const SolveOptions *o = system->options;
    const uint32_t count = system->links->count;
    const double scale = scale_of(o, count);
    for (uint32_t k = 0; k < count; k++)
        tree->patch[k] = key[k].patch;
    for (uint32_t begin = 0, end; begin < count; begin = end) {
        for (end = begin + 1; end < count && key[end].part == key[begin].part;)
            end++;
        for (uint32_t k = begin; k < end; k++)
            tree->root[k] = tree->count;
        add_node(tree, begin, end, key[begin].part & 1);
    }
    for (uint32_t n = 0; n < tree->count; n++) {
        TreeNode *node = &tree->node[n];
        if (node->end - node->begin < 2)
            continue;
        const uint32_t middle = divide(tree, o, node, scale);
        node->child = tree->count;
        add_node(tree, node->begin, middle, tree->lamp[n]);
        add_node(tree, middle, node->end, tree->lamp[n]);
    }
    for (uint32_t k = 0; k < count; k++)
        tree->place[tree->patch[k]] = k;
    for (uint32_t n = tree->count; n-- > 0;) {
        TreeNode *node = &tree->node[n];
        node->area = node->child == 0 ? system->links->area[tree->patch[node->begin]]
                                      : tree->node[node->child].area +
                                        tree->node[node->child + 1].area;
    }
}

bool tree_create(Tree *tree, const SolveSystem *system, Error *err)
{
    static const char what[] = "the tree over the patches";
    const Links *links = system->links;
    const size_t count = links->count;
    assert(system->options->centre != NULL && system->options->normal != NULL);
    *tree = (Tree){ 0 };
    tree->node = array_create(2 * count, sizeof *tree->node, what, err);
    tree->patch = array_create(count, sizeof *tree->patch, what, err);
    tree->place = array_create(count, sizeof *tree->place, what, err);
    tree->root = array_create(count, sizeof *tree->root, what, err);
    tree->lamp = array_create(2 * count, 1, what, err);
    PartKey *key = array_create(count, sizeof *key, what, err);
    uint32_t *up = array_create(count, sizeof *up, what, err);
    if (!error_is_set(err)) {
        join_parts(system, up);
        for (uint32_t i = 0; i < links->count; i++) {
            const uint64_t lamp = links->lamp != NULL && links->lamp[i] != 0;
            key[i] = (PartKey){ (uint64_t)find_part(up, i) << 1 | lamp, i };
        }
        qsort(key, count, sizeof *key, compare_keys);
        grow(tree, system, key);
    }
    array_free(key);
    array_free(up);
    return !error_is_set(err);
}

void tree_clear(Tree *tree)
{
    array_free(tree->node);
    array_free(tree->patch);
    array_free(tree->place);
    array_free(tree->root);
    array_free(tree->lamp);
    *tree = (Tree){ 0 };
}
