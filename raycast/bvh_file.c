/* SPDX-License-Identifier: BSD-3-Clause */
/* A tree in a file: a header, nodes, groups, and a checksum over all of it. Shapes are not in it:
 * they come with the primitives, which must be those that the tree was made from. What is read is
 * checked like a tree that was built (bvh_check), so that no file leads a ray astray. */
#include <assert.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"
#include "raycast/build.h"
#include "raycast/probe.h"

#define FILE_MAGIC "isoluxB1"
#define FILE_ORDER UINT32_C(0x01020304) /* reads differently in another order of bytes */

typedef struct {
    char     magic[8];
    uint32_t order, node_bytes, group_bytes, version;
    uint64_t key; /* of the primitives */
    uint32_t node_count, group_count, flat_count;
    uint32_t cut; /* 1: triangles may be cut (internal.h); else 0 */
    float    lo[3], hi[3];
} Header;

/* Counts when the meaning of nodes or groups changes while their size does not. */
#define FILE_VERSION 1u

/* --- what it was made from ------------------------------------------------------------------- */

/* Field by field: what lies between the fields of a struct has no value. */
static uint64_t shape_hash(const Shape *shape, uint64_t hash)
{
    const int kind = shape->kind;
    hash = file_hash(&kind, sizeof kind, hash);
    hash = file_hash(&shape->ratio, sizeof shape->ratio, hash);
    return file_hash(&shape->to_world, sizeof shape->to_world, hash);
}

static uint64_t primitives_key(const Primitives *in)
{
    const uint32_t count[3] = { in->vertex_count, in->triangle_count, in->shape_count };
    uint64_t hash = file_hash(count, sizeof count, 0);
    if (in->triangle_count > 0) {
        hash = file_hash(in->position, in->vertex_count * sizeof *in->position, hash);
        hash = file_hash(in->corner, 3 * (size_t)in->triangle_count * sizeof *in->corner, hash);
    }
    for (uint32_t i = 0; i < in->shape_count; i++)
        hash = shape_hash(&in->shape[i], hash);
    return hash;
}

/* --- writing --------------------------------------------------------------------------------- */

bool bvh_save(const Bvh *bvh, const Primitives *primitives, const char *path, Error *err)
{
    assert(bvh != NULL && primitives != NULL && path != NULL && err != NULL);
    assert(primitives->triangle_count == bvh->triangle_count);
    assert(primitives->shape_count == bvh->shape_count);
    Header header = { .magic = FILE_MAGIC, .order = FILE_ORDER, .node_bytes = sizeof(Node),
                      .group_bytes = sizeof(TriangleGroup), .version = FILE_VERSION,
                      .key = primitives_key(primitives), .node_count = bvh->node_count,
                      .group_count = bvh->group_count, .flat_count = bvh->flat_count,
                      .cut = bvh->cut };
    memcpy(header.lo, bvh->lo, sizeof header.lo);
    memcpy(header.hi, bvh->hi, sizeof header.hi);
    OutFile *out = outfile_open(path, err);
    if (out == NULL)
        return false;
    FILE *file = outfile_stream(out);
    /* Groups follow the nodes in memory too (tree_reserve). */
    const size_t size = bvh->node_count * sizeof *bvh->node + bvh->group_count * sizeof *bvh->group;
    const uint64_t sum = file_hash(bvh->node, size, file_hash(&header, sizeof header, 0));
    if (fwrite(&header, sizeof header, 1, file) != 1 || fwrite(bvh->node, size, 1, file) != 1
        || fwrite(&sum, sizeof sum, 1, file) != 1) {
        outfile_discard(out);
        return error_at(err, ERROR_FAILED, path, 0, "cannot be written: the disk may be full");
    }
    return outfile_commit(out, err);
}

/* --- reading --------------------------------------------------------------------------------- */

/* Why the header is not that of a tree of these primitives; NULL: it is. */
static const char *header_fault(const Header *h, size_t size, const Primitives *in)
{
    if (memcmp(h->magic, FILE_MAGIC, sizeof h->magic) != 0)
        return "is not a tree of boxes";
    if (h->order != FILE_ORDER || h->node_bytes != sizeof(Node)
        || h->group_bytes != sizeof(TriangleGroup) || h->version != FILE_VERSION)
        return "is a tree of boxes of another version or machine: it must be made anew";
    const uint64_t expected = sizeof *h + (uint64_t)h->node_count * sizeof(Node)
                              + (uint64_t)h->group_count * sizeof(TriangleGroup) + sizeof(uint64_t);
    if (expected != size || h->node_count == 0 || h->cut > 1)
        return "is damaged: its length does not fit its contents";
    if (h->key != primitives_key(in))
        return "is a tree of boxes of another scene: it must be made anew";
    return NULL;
}

/* The same float corners that a new tree would have. */
static bool group_is_of(const TriangleGroup *group, const Primitives *in)
{
    for (uint32_t lane = 0; lane < GROUP_WIDTH; lane++) {
        float corner[3][3];
        if (group->primitive[lane] == RAY_MISS)
            continue;
        if (group->primitive[lane] >= in->triangle_count
            || !probe_corners(in, group->primitive[lane], corner))
            return false;
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++)
                if (group->vertex[c][k][lane] != corner[c][k])
                    return false;
    }
    return true;
}

static bool corners_in_range(const Primitives *in)
{
    for (size_t i = 0; i < 3 * (size_t)in->triangle_count; i++)
        if (in->corner[i] >= in->vertex_count)
            return false;
    return true;
}

static bool tree_is_sound(const Bvh *bvh, const Primitives *in)
{
    if (!corners_in_range(in))
        return false;
    for (uint32_t i = 0; i < bvh->group_count; i++)
        if (!group_is_of(&bvh->group[i], in))
            return false;
    return bvh_check(bvh);
}

static bool sum_is_right(const char *bytes, size_t size)
{
    uint64_t sum;
    const size_t covered = size - sizeof sum - sizeof(Header);
    memcpy(&sum, bytes + size - sizeof sum, sizeof sum);
    return sum == file_hash(bytes + sizeof(Header), covered, file_hash(bytes, sizeof(Header), 0));
}

static bool tree_fill(Bvh *bvh, const Header *h, const char *bytes, const Primitives *in,
                      Error *err)
{
    if (!tree_reserve(bvh, h->node_count, h->group_count, in->shape_count, err))
        return false;
    memcpy(bvh->lo, h->lo, sizeof bvh->lo);
    memcpy(bvh->hi, h->hi, sizeof bvh->hi);
    memcpy(bvh->node, bytes,
           bvh->node_count * sizeof *bvh->node + bvh->group_count * sizeof *bvh->group);
    if (in->shape_count > 0)
        memcpy(bvh->shape, in->shape, in->shape_count * sizeof *bvh->shape);
    bvh->triangle_count = in->triangle_count;
    bvh->flat_count = h->flat_count;
    bvh->cut = h->cut == 1;
    return true;
}

Bvh *bvh_parse(const void *bytes, size_t size, const char *name, const Primitives *primitives,
               Error *err)
{
    assert((bytes != NULL || size == 0) && name != NULL && primitives != NULL && err != NULL);
    if (error_is_set(err))
        return NULL;
    Header header = { 0 };
    if (size >= sizeof header)
        memcpy(&header, bytes, sizeof header);
    const char *fault = header_fault(&header, size, primitives);
    if (fault == NULL && !sum_is_right(bytes, size))
        fault = "is damaged: its checksum is wrong";
    if (fault != NULL) {
        error_at(err, ERROR_INPUT, name, 0, "%s", fault);
        return NULL;
    }
    Bvh *bvh = array_create(1, sizeof *bvh, "tree of boxes", err);
    if (bvh == NULL)
        return NULL;
    bvh->kernel = kernel_choose(err);
    if (bvh->kernel == NULL
        || !tree_fill(bvh, &header, (const char *)bytes + sizeof header, primitives, err))
        return bvh_destroy(bvh);
    if (tree_is_sound(bvh, primitives))
        return bvh;
    error_at(err, ERROR_INPUT, name, 0, "is damaged: its boxes do not hold the scene");
    return bvh_destroy(bvh);
}

Bvh *bvh_load(const char *path, const Primitives *primitives, Error *err)
{
    assert(path != NULL && primitives != NULL && err != NULL);
    size_t size = 0;
    char *bytes = file_read(path, SIZE_MAX / 4, &size, err);
    if (bytes == NULL)
        return NULL;
    Bvh *bvh = bvh_parse(bytes, size, path, primitives, err);
    array_free(bytes);
    return bvh;
}
