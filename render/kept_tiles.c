/* SPDX-License-Identifier: BSD-3-Clause */
/* Tiles between two runs. */
#include "render/kept_tiles.h"

#include <assert.h>
#include <stdatomic.h>
#include <string.h>

#include "base/array.h"

static const char what[] = "tiles of the picture";

typedef struct {
    int32_t  width, height, tile;
    uint32_t groups;     /* layers of light groups */
    uint32_t count;      /* of tiles that follow: number, rays, then its pixels' layers */
    uint32_t unused;
} TilesHead;

typedef struct {
    uint64_t rays;
    uint32_t number, unused;
} TileHead;

struct KeptTiles {
    /* of the picture under way; image NULL: none is */
    Image       *image;
    int          tile;         /* pixels along an edge */
    uint32_t     across, count;
    uint64_t    *rays;         /* [count] */
    atomic_bool *done;         /* [count] */
    /* unpacked, for the next one */
    unsigned char *bytes;
    size_t         size;
};

/* Layers as rows of 4-byte values: how many a pixel has, and where they begin. */
enum { LAYERS = 9 };
static size_t pixel_bytes(uint32_t groups)
{
    return 4 * (6 * 3 + 3 + 3 * (size_t)groups);
}

typedef struct {
    void  *begin;
    size_t bytes;        /* of a pixel */
} Layer;

static Layer find_layer(const Image *image, uint32_t k)
{
    float *const three[] = { image->radiance, image->direct, image->indirect, image->albedo,
                             image->irradiance, image->normal };
    if (k < 6)
        return (Layer){ three[k], 3 * sizeof(float) };
    switch (k) {
    case 6:
        return (Layer){ image->depth, sizeof(float) };
    case 7:
        return (Layer){ image->patch, sizeof(uint32_t) };
    case 8:
        return (Layer){ image->deviation, sizeof(float) };
    default:
        return (Layer){ image_group(image, k - LAYERS), 3 * sizeof(float) };
    }
}

KeptTiles *kept_tiles_create(Error *err)
{
    return array_create(1, sizeof(KeptTiles), what, err);
}

KeptTiles *kept_tiles_destroy(KeptTiles *kept)
{
    if (kept == NULL)
        return NULL;
    kept_tiles_end(kept);
    array_free(kept->bytes);
    return array_free(kept);
}

/* Pixels of a tile; tiles at the edge are smaller. */
typedef struct {
    size_t x, y, width, height;
} Box;

static Box find_box(int width, int height, int tile, uint32_t across, uint32_t number)
{
    const size_t t = (size_t)tile, w = (size_t)width, h = (size_t)height;
    const size_t x = number % across * t, y = number / across * t;
    return (Box){ x, y, w - x < t ? w - x : t, h - y < t ? h - y : t };
}

static uint32_t tiles_along(int pixels, int tile)
{
    return ((uint32_t)pixels + (uint32_t)tile - 1) / (uint32_t)tile;
}

/* Copies a tile's pixels out of the picture or into it; returns what follows in bytes. */
static unsigned char *copy_tile(const KeptTiles *kept, uint32_t number, unsigned char *bytes,
                                bool into)
{
    const Image *image = kept->image;
    const Box box = find_box(image->width, image->height, kept->tile, kept->across, number);
    for (uint32_t k = 0; k < LAYERS + image->group_count; k++) {
        const Layer layer = find_layer(image, k);
        for (size_t y = box.y; y < box.y + box.height; y++) {
            const size_t size = box.width * layer.bytes;
            unsigned char *at = layer.begin == NULL ? NULL : (unsigned char *)layer.begin +
                                (y * (size_t)image->width + box.x) * layer.bytes;
            if (layer.begin == NULL && !into) /* not estimated: room is kept all the same */
                memset(bytes, 0, size);
            else if (layer.begin != NULL)
                memcpy(into ? at : bytes, into ? bytes : at, size);
            bytes += size;
        }
    }
    return bytes;
}

bool kept_tiles_pack(const KeptTiles *kept, void **bytes, size_t *size, Error *err)
{
    *bytes = NULL;
    *size = 0;
    if (kept->image == NULL)
        return true;
    const size_t each = sizeof(TileHead) +
                        (size_t)kept->tile * (size_t)kept->tile *
                            pixel_bytes(kept->image->group_count);
    TilesHead head = { .width = kept->image->width, .height = kept->image->height,
                       .tile = kept->tile, .groups = kept->image->group_count };
    uint32_t *number = array_create(kept->count, sizeof *number, what, err);
    for (uint32_t k = 0; number != NULL && k < kept->count; k++)
        if (kept_tiles_has(kept, k))
            number[head.count++] = k;
    unsigned char *out = array_create(sizeof head + head.count * each, 1, what, err);
    if (number != NULL && out != NULL) {
        memcpy(out, &head, sizeof head);
        unsigned char *at = out + sizeof head;
        for (uint32_t k = 0; k < head.count; k++) {
            const TileHead tile = { .rays = kept->rays[number[k]], .number = number[k] };
            memcpy(at, &tile, sizeof tile);
            at = copy_tile(kept, number[k], at + sizeof tile, false);
        }
        *bytes = out;
        *size = (size_t)(at - out);
    } else {
        array_free(out);
    }
    array_free(number);
    return !error_is_set(err);
}

/* Whether the bytes are tiles of one picture, each within it, and just these. */
static bool tiles_check(const unsigned char *bytes, size_t size, TilesHead *head)
{
    enum { EDGE_MOST = 1 << 15, GROUPS_MOST = 1 << 20 };
    if (size < sizeof *head)
        return false;
    memcpy(head, bytes, sizeof *head);
    if (head->width < 1 || head->height < 1 || head->tile < 1 || head->width > EDGE_MOST ||
        head->height > EDGE_MOST || head->tile > EDGE_MOST || head->groups > GROUPS_MOST)
        return false;
    const uint32_t across = tiles_along(head->width, head->tile);
    const uint32_t count = across * tiles_along(head->height, head->tile);
    size_t at = sizeof *head;
    for (uint32_t k = 0; k < head->count; k++) {
        TileHead tile;
        if (size - at < sizeof tile)
            return false;
        memcpy(&tile, bytes + at, sizeof tile);
        at += sizeof tile;
        if (tile.number >= count)
            return false;
        const Box box = find_box(head->width, head->height, head->tile, across, tile.number);
        if ((size - at) / pixel_bytes(head->groups) < box.width * box.height)
            return false;
        at += box.width * box.height * pixel_bytes(head->groups);
    }
    return at == size;
}

bool kept_tiles_unpack(KeptTiles *kept, const void *bytes, size_t size)
{
    TilesHead head;
    Error err = { 0 };
    kept->bytes = array_free(kept->bytes);
    if (!tiles_check(bytes, size, &head))
        return false;
    kept->bytes = array_create(size, 1, what, &err);
    if (kept->bytes == NULL)
        return false;
    memcpy(kept->bytes, bytes, size);
    kept->size = size;
    return true;
}

/* Tiles of a picture of the same size go into this one; others are forgotten. */
static void take_unpacked(KeptTiles *kept)
{
    TilesHead head;
    const unsigned char *bytes = kept->bytes;
    if (bytes == NULL)
        return;
    memcpy(&head, bytes, sizeof head);
    const bool same = head.width == kept->image->width && head.height == kept->image->height &&
                      head.tile == kept->tile && head.groups == kept->image->group_count;
    unsigned char *at = kept->bytes + sizeof head;
    for (uint32_t k = 0; same && k < head.count; k++) {
        TileHead tile;
        memcpy(&tile, at, sizeof tile);
        at = copy_tile(kept, tile.number, at + sizeof tile, true);
        kept->rays[tile.number] = tile.rays;
        kept->done[tile.number] = true;
    }
    kept->bytes = array_free(kept->bytes);
}

bool kept_tiles_begin(KeptTiles *kept, Image *image, int tile, uint64_t *rays, Error *err)
{
    assert(kept->image == NULL && tile > 0);
    kept->tile = tile;
    kept->across = tiles_along(image->width, tile);
    kept->count = kept->across * tiles_along(image->height, tile);
    kept->done = array_create(kept->count, sizeof *kept->done, what, err);
    if (kept->done == NULL)
        return false;
    kept->rays = rays;
    kept->image = image;
    take_unpacked(kept);
    return true;
}

void kept_tiles_end(KeptTiles *kept)
{
    kept->image = NULL;
    kept->rays = NULL;
    kept->done = array_free(kept->done);
}

bool kept_tiles_has(const KeptTiles *kept, uint32_t tile)
{
    assert(tile < kept->count);
    return atomic_load_explicit(&kept->done[tile], memory_order_acquire);
}

void kept_tiles_add(KeptTiles *kept, uint32_t tile)
{
    assert(tile < kept->count);
    atomic_store_explicit(&kept->done[tile], true, memory_order_release);
}
