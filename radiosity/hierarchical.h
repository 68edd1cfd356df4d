/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/hierarchical.h -- light between nodes of a tree over the patches; for hierarchical*.c
 * only.
 *
 * Hierarchical radiosity [hanrahan91] with clusters [smits94]: a tree whose leaves are the patches,
 * whose lower nodes are pieces of surfaces and whose upper ones hold several. Links join any two
 * nodes; one that carries much power gives way to two between smaller nodes. What a link carries is
 * known from the rays of all patches below: visibility samples are shared by all levels.
 */
#ifndef RADIOSITY_HIERARCHICAL_H
#define RADIOSITY_HIERARCHICAL_H

#include "math/vec3.h"
#include "radiosity/solve_internal.h"

typedef struct {
    uint32_t begin, end;  /* leaves, as places in the order of the tree */
    uint32_t child;       /* the first of two, the other follows; 0: a leaf */
    double   area;        /* visible, of all its leaves */
} TreeNode;

/* Children follow their parents. A part of the scene that no ray enters or leaves has nodes of its
 * own, and so have lamps; their topmost nodes are roots. */
typedef struct {
    TreeNode *node;       /* [count]  at most two per patch */
    uint32_t  count;
    uint32_t *patch;      /* [patches]  of a place */
    uint32_t *place;      /* [patches]  of a patch */
    uint32_t *root;       /* [patches]  node; of a place */
    uint8_t  *lamp;       /* [2 * patches]  of a node: all its patches are lamps */
} Tree;

/* On failure to be cleared as well. */
bool tree_create(Tree *tree, const SolveSystem *system, Error *err);
void tree_clear(Tree *tree);

/* A link between patches: what of a flat row falls into a link between nodes. */
typedef struct {
    uint32_t to, from;    /* places */
    float    share;       /* A F */
} Entry;

typedef struct {
    uint64_t begin, end;  /* entries */
    uint32_t to, from;    /* nodes */
    double   share;       /* A F, the sum over its entries */
} NodeLink;

typedef struct {
    const SolveSystem *system;
    const Tree *tree;
    Entry      *entry;    /* [entries] */
    uint64_t    entries;
    NodeLink   *link;     /* [count] */
    size_t      count, capacity;
    double      rays;     /* per patch */
} NodeLinks;

/* Links between the roots. On failure to be cleared as well. */
bool node_links_create(NodeLinks *links, const SolveSystem *system, const Tree *tree, Error *err);
void node_links_clear(NodeLinks *links);
/* Refines all links that carry too much of the power, given what nodes send out, radiosity
 * [tree->count * bands]; *refined gets how many. */
bool node_links_refine(NodeLinks *links, const double *radiosity, uint64_t *refined, Error *err);

#endif
