/* SPDX-License-Identifier: BSD-3-Clause */
/* render/kept_tiles.h -- finished tiles of a picture: saved while others are made, and taken up by
 * a later run.
 *
 * Handed to render_gather in RenderOptions.kept. Tiles are independent, so a picture made in pieces
 * is the same, bit for bit.
 * Threads  has and add from any; all else from the thread that called render_gather.
 */
#ifndef RENDER_KEPT_TILES_H
#define RENDER_KEPT_TILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "render/image.h"

typedef struct KeptTiles KeptTiles;

/* owns   the caller frees with kept_tiles_destroy.
 * fails  NULL; ERROR_MEMORY. */
KeptTiles *kept_tiles_create(Error *err);
/* Frees; NULL is allowed. Always returns NULL. */
KeptTiles *kept_tiles_destroy(KeptTiles *kept);

/* All finished tiles as bytes, from within `progress` of render_gather; *bytes is NULL when there
 * are none.
 * owns   the caller frees *bytes with array_free.
 * fails  false; ERROR_MEMORY. */
bool kept_tiles_pack(const KeptTiles *kept, void **bytes, size_t *size, Error *err);
/* The same bytes for a picture that is to be made; copied when it begins.
 * fails  false when they cannot be tiles; ERROR_MEMORY is not told apart. */
bool kept_tiles_unpack(KeptTiles *kept, const void *bytes, size_t size);

/* --- for render_gather ------------------------------------------------------------------------ */

/* The picture begins: tiles that were unpacked go into it; rays [tiles] are counts of them. */
bool kept_tiles_begin(KeptTiles *kept, Image *image, int tile, uint64_t *rays, Error *err);
/* It ends: nothing of it is referred to any more. */
void kept_tiles_end(KeptTiles *kept);
bool kept_tiles_has(const KeptTiles *kept, uint32_t tile);
/* A tile is complete. */
void kept_tiles_add(KeptTiles *kept, uint32_t tile);

#endif
