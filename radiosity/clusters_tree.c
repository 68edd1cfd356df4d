/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/clusters_tree.c -- a tree over the patches that light can come to: halves by place and
 * by where they face. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "radiosity/clusters_internal.h"

enum { AXES = 6 }; /* three of place, three of the normal */

/* Opposite normals are as far apart as places are at opposite ends of the room. */
static const double NORMAL_WEIGHT = 0.5;

typedef struct {
    const Patches *patches;
    ClusterTree   *tree;
    double         scale;   /* one over the largest extent */
} Grower;

static double coordinate(const Grower *g, uint32_t patch, unsigned axis)
{
    const Vec3 v = axis < 3 ? g->patches->centre[patch] : g->patches->normal[patch];
    const unsigned k = axis % 3;
    return (k == 0 ? v.x : k == 1 ? v.y : v.z) * (axis < 3 ? g->scale : NORMAL_WEIGHT);
}

/* The axis along which leaves spread most, and the middle there. */
static double widest(const Grower *g, const ClusterNode *n, unsigned *axis, double *middle)
{
    double low[AXES], high[AXES], most = -1;
    for (unsigned a = 0; a < AXES; a++)
        low[a] = INFINITY, high[a] = -INFINITY;
    for (uint32_t k = n->begin; k < n->end; k++)
        for (unsigned a = 0; a < AXES; a++) {
            const double x = coordinate(g, g->tree->patch[k], a);
            low[a] = fmin(low[a], x);
            high[a] = fmax(high[a], x);
        }
    for (unsigned a = 0; a < AXES; a++)
        if (high[a] - low[a] > most) {
            most = high[a] - low[a];
            *axis = a;
            *middle = (low[a] + high[a]) / 2;
        }
    return most;
}

/* How far from flat a node is. */
static void measure(const Grower *g, ClusterNode *n)
{
    const Patches *p = g->patches;
    Vec3 normal = vec3(0, 0, 0), centre = normal;
    for (uint32_t k = n->begin; k < n->end; k++) {
        const uint32_t i = g->tree->patch[k];
        normal = vec3_mad(normal, p->area[i], p->normal[i]);
        centre = vec3_mad(centre, p->area[i], p->centre[i]);
        n->area += p->area[i];
    }
    normal = vec3_scale(normal, 1 / n->area);
    centre = vec3_scale(centre, 1 / n->area);
    const double square = vec3_dot(normal, normal);
    n->bend = (float)sqrt(fmax(0, 1 - square));
    const Vec3 unit = square > 0 ? vec3_scale(normal, 1 / sqrt(square)) : normal;
    for (uint32_t k = n->begin; k < n->end; k++) {
        const uint32_t i = g->tree->patch[k];
        const Vec3 way = vec3_sub(p->centre[i], centre);
        const double radius = vec3_length(way) + sqrt(p->area[i] / 2);
        n->thickness = fmaxf(n->thickness, (float)fabs(vec3_dot(unit, way)));
        n->radius = fmaxf(n->radius, (float)radius);
    }
    for (int k = 0; k < 3; k++) {
        n->centre[k] = (float)vec3_axis(centre, k);
        n->normal[k] = (float)vec3_axis(unit, k);
    }
}

/* Brings the leaves on the near side of the middle to the front; where all lie in one place, they
 * are halved by number. */
static uint32_t divide(const Grower *g, const ClusterNode *n)
{
    assert(n->end - n->begin > 1);
    uint32_t *patch = g->tree->patch, at = n->begin;
    unsigned axis = 0;
    double middle = 0;
    if (widest(g, n, &axis, &middle) > 0)
        for (uint32_t k = n->begin; k < n->end; k++)
            if (coordinate(g, patch[k], axis) < middle) {
                const uint32_t swap = patch[k];
                patch[k] = patch[at];
                patch[at++] = swap;
            }
    return at > n->begin && at < n->end ? at : n->begin + (n->end - n->begin) / 2;
}

static void grow(Grower *g)
{
    ClusterTree *tree = g->tree;
    Vec3 low = vec3(INFINITY, INFINITY, INFINITY), high = vec3_scale(low, -1);
    for (uint32_t k = 0; k < tree->leaves; k++) {
        low = vec3_min(low, g->patches->centre[tree->patch[k]]);
        high = vec3_max(high, g->patches->centre[tree->patch[k]]);
    }
    const double extent = fmax(high.x - low.x, fmax(high.y - low.y, high.z - low.z));
    g->scale = extent > 0 ? 1 / extent : 1;
    tree->count = tree->leaves > 0;
    tree->node[0].end = tree->leaves;
    for (uint32_t n = 0; n < tree->count; n++) {
        ClusterNode *node = &tree->node[n];
        measure(g, node);
        if (node->end - node->begin < 2)
            continue;
        const uint32_t middle = divide(g, node);
        node->child = tree->count;
        tree->node[tree->count++] = (ClusterNode){ .begin = node->begin, .end = middle };
        tree->node[tree->count++] = (ClusterNode){ .begin = middle, .end = node->end };
    }
}

bool cluster_tree_create(ClusterTree *tree, const Room *room, const double *area, Error *err)
{
    static const char what[] = "clusters of patches";
    const uint32_t count = room->patches->count;
    *tree = (ClusterTree){ 0 };
    tree->node = array_create(2 * (size_t)count, sizeof *tree->node, what, err);
    tree->patch = array_create(count, sizeof *tree->patch, what, err);
    tree->before = array_create((size_t)count + 1, sizeof *tree->before, what, err);
    if (error_is_set(err))
        return false;
    for (uint32_t i = 0; i < count; i++)
        if (area[i] > 0)
            tree->patch[tree->leaves++] = i;
    Grower g = { .patches = room->patches, .tree = tree };
    grow(&g);
    for (uint32_t k = 0; k < tree->leaves; k++)
        tree->before[k + 1] = tree->before[k] + area[tree->patch[k]];
    for (uint32_t n = tree->count; n-- > 0;) {
        ClusterNode *node = &tree->node[n];
        node->area = node->child == 0
                         ? area[tree->patch[node->begin]]
                         : tree->node[node->child].area + tree->node[node->child + 1].area;
    }
    return true;
}

void cluster_tree_clear(ClusterTree *tree)
{
    array_free(tree->node);
    array_free(tree->patch);
    array_free(tree->before);
    *tree = (ClusterTree){ 0 };
}

uint32_t cluster_tree_choose(const ClusterTree *tree, uint32_t node, double u, double *rest)
{
    assert(node < tree->count && u >= 0 && u < 1);
    const ClusterNode *n = &tree->node[node];
    const double start = tree->before[n->begin];
    const double at = start + u * (tree->before[n->end] - start);
    uint32_t low = n->begin, high = n->end;
    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        if (tree->before[middle] <= at)
            low = middle;
        else
            high = middle;
    }
    const double wide = tree->before[low + 1] - tree->before[low];
    const double part = wide > 0 ? (at - tree->before[low]) / wide : 0;
    *rest = part < 0 ? 0 : fmin(part, nextafter(1, 0));
    return low;
}
