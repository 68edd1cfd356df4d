/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/stochastic_places.c -- which places of patches lie inside solids, for patches without
 * links. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "base/parallel.h"
#include "radiosity/stochastic_internal.h"
#include "radiosity/visible.h"

/* Rays that look whether anything of a patch may be hidden; OPEN_RAYS tell where. */
enum { LOOK_RAYS = 16, PLACES_CHUNK = 1024 };

typedef struct {
    const Room *room;
    OpenPlaces *places;
    LampTable   none;
    RowTile    *tile;   /* [threads] */
    RowCast    *judge;  /* [threads] */
    uint32_t    seed;
} PlacesPass;

static bool any_bad(const RowCast *row)
{
    for (uint32_t p = 0; p < row->positions; p++)
        if (row->position[p].bad > 0 || row->position[p].good == 0)
            return true;
    return false;
}

static void take(OpenPlaces *places, uint32_t patch, const RowCast *row, uint64_t open)
{
    places->links->area[patch] = open != 0 ? row->area : 0;
    places->links->escape[patch] = (float)row->escape;
    places->open[patch] = open;
}

uint64_t open_cells_judge(RowCast *row, const Room *room, uint32_t patch, uint32_t seed)
{
    uint64_t open = 0;
    row_cast_positions(row, room, patch, seed);
    assert(row->positions == OPEN_CELLS);
    for (uint32_t p = 0; p < row->positions; p++)
        open |= (uint64_t)(row->position[p].good > 0) << p;
    return open;
}

void open_cells_place(const Room *room, uint64_t open, uint32_t patch, const float x[2],
                      PatchPoint *at)
{
    double a = x[0], b = x[1];
    assert(open != 0);
    if (open != UINT64_MAX) {
        const double along = x[0] * (double)__builtin_popcountll(open);
        uint64_t left = open;
        for (uint32_t k = (uint32_t)along; k > 0; k--)
            left &= left - 1;
        const int cell = __builtin_ctzll(left);
        a = (cell / 8 + (along - floor(along))) / 8;
        b = (cell % 8 + b) / 8;
    }
    patches_point(room->patches, room->surfaces, patch, a, b, at);
    visible_move(room, at);
}

static void judge_patch(PlacesPass *pass, RowCast *row, uint32_t patch)
{
    const uint64_t open = open_cells_judge(row, pass->room, patch, pass->seed);
    row_cast_finish(row, pass->room, &pass->none, patch);
    take(pass->places, patch, row, open);
}

static void places_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    PlacesPass *pass = context;
    RowTile *tile = &pass->tile[worker];
    for (uint32_t first = begin; first < end; first += tile->most) {
        const uint32_t count = end - first < tile->most ? end - first : tile->most;
        uint32_t patch[TILE_PATCHES];
        for (uint32_t k = 0; k < count; k++)
            patch[k] = first + k;
        row_tile_cast(tile, pass->room, &pass->none, patch, count, pass->seed);
        for (uint32_t k = 0; k < count; k++) {
            if (any_bad(&tile->row[k]))
                judge_patch(pass, &pass->judge[worker], first + k);
            else
                take(pass->places, first + k,
                     row_tile_row(tile, pass->room, &pass->none, k), UINT64_MAX);
        }
    }
}

static bool find(PlacesPass *pass, unsigned threads, const Monitor *monitor, Error *err)
{
    const uint32_t count = pass->room->patches->count;
    const Progress progress = { .stage = "factors", .energy_left = -1 };
    for (unsigned k = 0; k < threads; k++)
        if (!row_tile_create(&pass->tile[k], LOOK_RAYS, 0, err) ||
            !row_cast_create(&pass->judge[k], OPEN_RAYS, 0, err))
            return false;
    if (!parallel_for(count, PLACES_CHUNK, threads, places_chunk, pass, monitor, &progress))
        return error_set(err, ERROR_STOPPED, "stopped while looking for hidden places");
    for (unsigned k = 0; k < threads; k++)
        pass->places->links->rays += pass->tile[k].cast + pass->judge[k].cast;
    return true;
}

bool open_places_find(const Room *room, uint32_t seed, unsigned threads, OpenPlaces *places,
                      const Monitor *monitor, Error *err)
{
    static const char what[] = "places of patches";
    *places = (OpenPlaces){ .links = NULL };
    assert(room != NULL && room->patches != NULL);
    threads = parallel_threads(threads);
    PlacesPass pass = { .room = room, .places = places, .seed = seed };
    places->links = links_empty(room->patches->count, 0, err);
    places->open = array_create(room->patches->count, sizeof *places->open, what, err);
    pass.none.probability = array_create(room->patches->count, sizeof *pass.none.probability, what,
                                         err);
    pass.tile = array_create(threads, sizeof *pass.tile, what, err);
    pass.judge = array_create(threads, sizeof *pass.judge, what, err);
    const bool done = !error_is_set(err) && find(&pass, threads, monitor, err);
    for (unsigned k = 0; k < threads && pass.tile != NULL && pass.judge != NULL; k++) {
        row_tile_clear(&pass.tile[k]);
        row_cast_clear(&pass.judge[k]);
    }
    array_free(pass.tile);
    array_free(pass.judge);
    array_free(pass.none.probability);
    if (!done)
        open_places_clear(places);
    return done;
}

void open_places_clear(OpenPlaces *places)
{
    links_destroy(places->links);
    array_free(places->open);
    *places = (OpenPlaces){ .links = NULL };
}
