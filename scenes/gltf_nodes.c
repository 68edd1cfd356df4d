/* SPDX-License-Identifier: BSD-3-Clause */
/* Nodes of a glTF: which belong to the scene that is shown, and where they stand in the world. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "scenes/gltf.h"

typedef struct {
    const GltfContext *c;
    const Json        *list;   /* "nodes" */
    Gltf              *gltf;
    size_t            *stack;  /* [node_count]  nodes still to be visited */
    size_t             depth;
} NodeWalk;

static void where_put(char *where, size_t size, size_t node)
{
    snprintf(where, size, "nodes[%zu]", node);
}

/* --- one node --------------------------------------------------------------------------------- */

static Affine matrix_affine(const double m[16]) /* column by column */
{
    return (Affine){ { m[0], m[1], m[2] }, { m[4], m[5], m[6] }, { m[8], m[9], m[10] },
                     { m[12], m[13], m[14] } };
}

static Affine trs_affine(const double t[3], const double q[4], const double s[3])
{
    const double x = q[0], y = q[1], z = q[2], w = q[3];

    return (Affine){
        vec3_scale(vec3(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)), s[0]),
        vec3_scale(vec3(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)), s[1]),
        vec3_scale(vec3(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)), s[2]),
        { t[0], t[1], t[2] } };
}

static Affine local_read(const GltfContext *c, const Json *node, const char *where)
{
    double m[16], t[3] = { 0, 0, 0 }, q[4] = { 0, 0, 0, 1 }, s[3] = { 1, 1, 1 };

    if (gltf_numbers(c, node, where, "matrix", m, 16))
        return matrix_affine(m);
    gltf_numbers(c, node, where, "translation", t, 3);
    gltf_numbers(c, node, where, "scale", s, 3);
    if (gltf_numbers(c, node, where, "rotation", q, 4)) {
        const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        if (!(length > 0) || !isfinite(length))
            gltf_error(c, where, "\"rotation\" is not a rotation");
        else
            for (int i = 0; i < 4; i++)
                q[i] /= length;
    }
    return trs_affine(t, q, s);
}

/* Its own name, else the mesh's: what a user sees in the modelling program. */
static void name_read(const GltfContext *c, const Json *root, const Json *node, const char *where,
                      GltfNode *out)
{
    const char *name = gltf_word(c, node, where, "name", "");
    const Json *meshes = gltf_member(root, "meshes");

    if (name[0] == 0 && out->mesh != SIZE_MAX)
        name = gltf_word(c, gltf_item(meshes, out->mesh), "meshes", "name", "");
    if (name[0] != 0)
        snprintf(out->name, sizeof out->name, "%s", name);
    else
        snprintf(out->name, sizeof out->name, "%s", where);
}

static void references_read(const GltfContext *c, const Json *root, const Json *node,
                            const char *where, GltfNode *out)
{
    const Json *extensions = gltf_object(c, node, where, "extensions");
    const Json *use = gltf_object(c, extensions, where, "KHR_lights_punctual");
    const Json *defined = gltf_object(c, gltf_object(c, root, "", "extensions"), "extensions",
                                      "KHR_lights_punctual");
    const size_t lights = gltf_count(gltf_list(c, defined, "KHR_lights_punctual", "lights"));

    out->mesh = gltf_index(c, node, where, "mesh", gltf_count(gltf_list(c, root, "", "meshes")));
    out->camera = gltf_index(c, node, where, "camera",
                             gltf_count(gltf_list(c, root, "", "cameras")));
    out->light = use != NULL ? gltf_index(c, use, where, "light", lights) : SIZE_MAX;
}

/* --- the tree --------------------------------------------------------------------------------- */

static bool node_push(NodeWalk *walk, size_t node)
{
    char where[48];

    if (walk->gltf->node[node].present) {
        where_put(where, sizeof where, node);
        return gltf_error(walk->c, where, "has two parents or is its own ancestor");
    }
    assert(walk->depth < walk->gltf->node_count);
    walk->gltf->node[node].present = true;
    walk->stack[walk->depth++] = node;
    return true;
}

/* Places one node whose `world` holds its parent's map, and asks for its children. */
static bool node_visit(NodeWalk *walk, size_t index)
{
    GltfNode *node = &walk->gltf->node[index];
    const Json *json = gltf_item(walk->list, index);
    char where[48];

    where_put(where, sizeof where, index);
    const Affine local = local_read(walk->c, json, where);
    node->world = affine_then(&local, &node->world);
    if (!vec3_finite(node->world.x) || !vec3_finite(node->world.y) ||
        !vec3_finite(node->world.z) || !vec3_finite(node->world.t))
        return gltf_error(walk->c, where, "its place in the world is not finite");
    const Json *children = gltf_list(walk->c, json, where, "children");
    for (size_t i = 0; i < gltf_count(children); i++) {
        const size_t child = gltf_index_item(walk->c, children, where, i,
                                             walk->gltf->node_count);
        if (child == SIZE_MAX || !node_push(walk, child))
            return false;
        walk->gltf->node[child].world = node->world;
    }
    return !error_is_set(walk->c->err);
}

/* Without a scene every node is shown that is no other's child. */
static bool parentless_push(NodeWalk *walk)
{
    const size_t count = walk->gltf->node_count;
    bool *child = array_create(count, sizeof *child, "nodes", walk->c->err);
    bool good = child != NULL;

    for (size_t i = 0; good && i < count; i++) {
        const Json *children = gltf_list(walk->c, gltf_item(walk->list, i), "nodes", "children");
        for (size_t k = 0; k < gltf_count(children); k++) {
            const size_t at = gltf_index_item(walk->c, children, "nodes", k, count);
            if (at != SIZE_MAX)
                child[at] = true;
        }
        good = !error_is_set(walk->c->err);
    }
    for (size_t i = 0; good && i < count; i++)
        good = child[i] || node_push(walk, i);
    array_free(child);
    return good;
}

static bool roots_push(NodeWalk *walk, const Json *root)
{
    const Json *scenes = gltf_list(walk->c, root, "", "scenes");
    size_t scene = gltf_index(walk->c, root, "", "scene", gltf_count(scenes));

    if (error_is_set(walk->c->err))
        return false;
    if (scene == SIZE_MAX && gltf_count(scenes) == 0)
        return parentless_push(walk);
    if (scene == SIZE_MAX)
        scene = 0;
    char where[48];
    snprintf(where, sizeof where, "scenes[%zu]", scene);
    const Json *nodes = gltf_list(walk->c, gltf_item(scenes, scene), where, "nodes");
    for (size_t i = 0; i < gltf_count(nodes); i++) {
        const size_t node = gltf_index_item(walk->c, nodes, where, i, walk->gltf->node_count);
        if (node == SIZE_MAX || !node_push(walk, node))
            return false;
    }
    return !error_is_set(walk->c->err);
}

bool gltf_read_nodes(const GltfContext *c, const Json *root, Gltf *gltf)
{
    NodeWalk walk = { .c = c, .list = gltf_list(c, root, "", "nodes"), .gltf = gltf };

    gltf->node_count = gltf_count(walk.list);
    gltf->node = array_create(gltf->node_count, sizeof *gltf->node, "nodes", c->err);
    walk.stack = array_create(gltf->node_count, sizeof *walk.stack, "nodes", c->err);
    for (size_t i = 0; i < gltf->node_count && !error_is_set(c->err); i++) {
        char where[48];
        where_put(where, sizeof where, i);
        if (!gltf_is_object(gltf_item(walk.list, i)))
            return array_free(walk.stack), gltf_error(c, where, "is not an object");
        gltf->node[i].world = affine_identity();
        references_read(c, root, gltf_item(walk.list, i), where, &gltf->node[i]);
        if (!error_is_set(c->err))
            name_read(c, root, gltf_item(walk.list, i), where, &gltf->node[i]);
    }
    bool good = !error_is_set(c->err) && roots_push(&walk, root);
    while (good && walk.depth > 0)
        good = node_visit(&walk, walk.stack[--walk.depth]);
    array_free(walk.stack);
    return good;
}
