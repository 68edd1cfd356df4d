/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links_tile.c -- rows of neighbouring patches cast together: rays of thousands, sorted
 * by where they go, are traced faster than patch by patch. */
#include <assert.h>

#include "base/array.h"
#include "radiosity/internal.h"

/* Rays traced in one call: enough that those of a tile which go the same way fill packets; more of
 * them only leave the caches. */
enum { TILE_RAYS = 1 << 14 };

bool row_tile_create(RowTile *tile, uint32_t rays, uint32_t lamp_rays, Error *err)
{
    assert(rays > 0);
    const uint32_t fit = TILE_RAYS / rays;
    *tile = (RowTile){ .most = fit < 1 ? 1 : fit > TILE_PATCHES ? TILE_PATCHES : fit };
    if (!row_cast_allocate(&tile->all, rays, lamp_rays, tile->most, err))
        return false;
    for (uint32_t k = 0; k < tile->most; k++) {
        RowCast *row = &tile->row[k];
        *row = tile->all;
        row->position += (size_t)k * row->positions;
        row->valid += (size_t)k * row->positions;
        row->ray += (size_t)k * rays;
        row->hit += (size_t)k * rays;
        row->end += (size_t)k * rays;
        row->cosine += (size_t)k * rays;
        row->turned += (size_t)k * rays;
        row->cell += (size_t)k * rays;
        row->start += (size_t)k * rays;
        row->weight += (size_t)k * rays;
        row->place += (size_t)k * rays;
        row->sample += (size_t)k * lamp_rays;
    }
    return true;
}

void row_tile_clear(RowTile *tile)
{
    row_cast_clear(&tile->all);
    *tile = (RowTile){ .most = 0 };
}

void row_tile_cast(RowTile *tile, const Room *room, const LampTable *lamps, const uint32_t *patch,
                   uint32_t count, uint32_t seed)
{
    assert(count <= tile->most);
    const uint32_t rays = tile->all.rays;
    uint32_t to_lamps = 0;
    tile->count = count;
    for (uint32_t k = 0; k < count; k++) {
        tile->patch[k] = patch[k];
        row_cast_rays(&tile->row[k], room, patch[k], seed);
    }
    bvh_nearest_many(room->bvh, tile->all.ray, tile->all.hit, (size_t)count * rays);
    for (uint32_t k = 0; k < count; k++) {
        RowCast *row = &tile->row[k];
        row_cast_follow(row, room);
        row_cast_judge(row, room);
        row->lamp_ray = tile->all.lamp_ray + to_lamps; /* without gaps */
        row->blocked = tile->all.blocked + to_lamps;
        row_cast_aim(row, room, lamps, patch[k], seed);
        to_lamps += row->sample_count;
    }
    if (to_lamps > 0)
        bvh_blocked_many(room->bvh, tile->all.lamp_ray, tile->all.blocked, to_lamps);
    for (uint32_t k = 0; k < count; k++) {
        tile->cast += tile->row[k].cast;
        tile->row[k].cast = 0;
    }
}

const RowCast *row_tile_row(RowTile *tile, const Room *room, const LampTable *lamps, uint32_t k)
{
    assert(k < tile->count);
    RowCast *row = &tile->row[k];
    row->clamped = 0;
    row_cast_finish(row, room, lamps, tile->patch[k]);
    tile->clamped += row->clamped;
    return row;
}
