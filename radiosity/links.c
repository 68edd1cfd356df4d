/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links.c -- all rows of form factors: cast in parallel, gathered in order. */
#include "radiosity/links.h"

#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "base/parallel.h"
#include "radiosity/internal.h"

/* Rows cast beforehand to learn how many links a row has, when memory is limited; spread evenly,
 * and the tenth that is added to what they say covers their chance. */
enum { PILOT_ROWS = 256 };
static const double PILOT_MARGIN = 1.1;

static void cast_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    RowMaker *maker = context;
    uint32_t row[MAKER_CHUNK];
    if (row_maker_has(maker, begin) || error_is_set(&maker->buffer[worker].error))
        return; /* no place to keep more rows */
    for (uint32_t i = begin; i < end; i++)
        row[i - begin] = i;
    row_maker_cast(maker, row, end - begin, worker);
    row_maker_keep(maker, begin, worker);
}

/* Links are held twice while the chunks are gathered. */
static double bytes_needed(const RowMaker *m, double links_per_row)
{
    const double per_link = 2.0 * (sizeof(uint32_t) + sizeof(float));
    const double per_row = sizeof(uint64_t) + 2 * (sizeof(float) + sizeof(double)) +
                           sizeof(uint32_t) + sizeof(uint8_t);
    return m->count * (links_per_row * per_link + per_row);
}

static bool check_memory(RowMaker *m, const LinksOptions *options, Error *err)
{
    RowTile *tile = &m->tile[0];
    const double most = (double)options->max_bytes;
    if (options->max_bytes == 0 || m->count == 0)
        return true;
    if (bytes_needed(m, (double)tile->all.rays + tile->all.lamp_rays) <= most)
        return true; /* even if no two rays met the same patch */
    const uint32_t pilots = m->count < PILOT_ROWS ? m->count : PILOT_ROWS;
    uint64_t links = 0;
    for (uint32_t k = 0; k < pilots; k++) {
        const uint32_t patch = (uint32_t)((uint64_t)k * m->count / pilots);
        row_tile_cast(tile, m->room, &m->lamps, &patch, 1, m->seed);
        links += row_tile_row(tile, m->room, &m->lamps, 0)->links;
    }
    const double needed = PILOT_MARGIN * bytes_needed(m, (double)links / pilots);
    tile->cast = tile->clamped = 0;
    return links_choose_folder(needed, m->count, options, &m->folder, err);
}

Links *links_create(const Room *room, const LinksOptions *options, const Monitor *monitor,
                    Error *err)
{
    if (error_is_set(err))
        return NULL;
    assert(room != NULL && options != NULL && room->bvh != NULL && room->patches != NULL);
    RowMaker maker;
    Links *links = NULL;
    Progress progress = { .stage = "factors", .done = 1, .energy_left = -1 };
    if (row_maker_create(&maker, room, options, err) &&
        check_memory(&maker, options, err)) {
        progress.rays = (uint64_t)maker.count * row_maker_rays(&maker);
        if (parallel_for(maker.count, MAKER_CHUNK, maker.threads, cast_chunk, &maker, monitor,
                         &progress))
            links = row_maker_gather(&maker, err);
        else
            error_set(err, ERROR_STOPPED, "stopped while casting form factors");
    }
    row_maker_clear(&maker);
    return links;
}

Links *links_empty(uint32_t count, uint64_t nonzeros, Error *err)
{
    return links_allocate(count, nonzeros, err);
}
