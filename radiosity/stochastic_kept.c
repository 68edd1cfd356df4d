/* SPDX-License-Identifier: BSD-3-Clause */
/* The state of a stochastic run as bytes. */
#include "radiosity/stochastic_kept.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "radiosity/stochastic_internal.h"

static const char what[] = "light that is kept";

struct StochasticKept {
    unsigned char *bytes;   /* head, then the arrays of StochasticPlaces in their order */
    size_t         size;
    bool           full;    /* something was put or loaded */
};

enum { PIECES = STOCHASTIC_SERIES + 3 };

typedef struct {
    void  *array[PIECES];
    size_t size[PIECES];
} Pieces;

static Pieces find_pieces(const StochasticPlaces *p, uint32_t count)
{
    Pieces pieces = { .array = { [STOCHASTIC_SERIES] = p->missed, p->told, p->sights },
                      .size = { [STOCHASTIC_SERIES] = count * sizeof *p->missed,
                                count * sizeof *p->told, count * sizeof *p->sights } };
    for (unsigned k = 0; k < STOCHASTIC_SERIES; k++) {
        pieces.array[k] = p->power[k];
        pieces.size[k] = (size_t)count * ROOM_BANDS * sizeof *p->power[k];
    }
    return pieces;
}

static size_t bytes_of(uint32_t count)
{
    const Pieces pieces = find_pieces(&(StochasticPlaces){ .missed = NULL }, count);
    size_t size = sizeof(StochasticHead);
    for (unsigned k = 0; k < PIECES; k++)
        size += pieces.size[k];
    return size;
}

StochasticKept *stochastic_kept_create(Error *err)
{
    return array_create(1, sizeof(StochasticKept), what, err);
}

StochasticKept *stochastic_kept_destroy(StochasticKept *kept)
{
    if (kept != NULL)
        array_free(kept->bytes);
    return array_free(kept);
}

void *stochastic_kept_bytes(const StochasticKept *kept, size_t *size)
{
    const bool full = kept != NULL && kept->full;
    *size = full ? kept->size : 0;
    return full ? kept->bytes : NULL;
}

static bool finite_values(const unsigned char *bytes, size_t count, size_t size)
{
    for (size_t k = 0; k < count; k++) {
        double value;
        float  less;
        memcpy(&value, bytes + k * size, size < sizeof value ? 0 : size);
        memcpy(&less, bytes + k * size, size < sizeof value ? size : 0);
        if (!isfinite(size < sizeof value ? (double)less : value))
            return false;
    }
    return true;
}

/* Nets of rays to lamps begin at multiples of their sizes, powers of 2; patches that take no part
 * have none. */
static bool sights_fit(const unsigned char *bytes, uint32_t count)
{
    for (uint32_t k = 0; k < count; k++) {
        uint16_t sights;
        memcpy(&sights, bytes + k * sizeof sights, sizeof sights);
        if (sights > GATHER_SIGHTS || (sights & (sights - 1)) != 0)
            return false;
    }
    return true;
}

static bool head_fits(const StochasticHead *head, uint32_t count)
{
    const uint32_t rays = head->round_rays;
    bool fits = head->count == count && head->batches > 0 && head->batches % 2 == 0 &&
                rays <= GATHER_RAYS && (rays & (rays - 1)) == 0 && isfinite(head->unshot) &&
                isfinite(head->quantum) && head->rounds < UINT16_MAX;
    for (unsigned b = 0; b < ROOM_BANDS; b++)
        fits = fits && isfinite(head->escaped[b]);
    return fits;
}

bool stochastic_kept_load(StochasticKept *kept, void *bytes, size_t size, uint32_t count)
{
    StochasticHead head;
    array_free(kept->bytes);
    *kept = (StochasticKept){ .bytes = bytes, .size = size };
    if (bytes == NULL || size != bytes_of(count))
        return false;
    memcpy(&head, bytes, sizeof head);
    const unsigned char *at = kept->bytes + sizeof head;
    const size_t n = (size_t)count * ROOM_BANDS * STOCHASTIC_SERIES;
    kept->full = head_fits(&head, count) && finite_values(at, n, sizeof(double)) &&
                 finite_values(at + n * sizeof(double), 2 * (size_t)count, sizeof(float)) &&
                 sights_fit(at + n * sizeof(double) + 2 * count * sizeof(float), count);
    return kept->full;
}

bool stochastic_kept_begin(StochasticKept *kept, uint32_t count, Error *err)
{
    if (kept->full && kept->size == bytes_of(count))
        return true;
    array_free(kept->bytes);
    *kept = (StochasticKept){ .size = bytes_of(count) };
    kept->bytes = array_create(kept->size, 1, what, err);
    return kept->bytes != NULL;
}

void stochastic_kept_put(StochasticKept *kept, const StochasticHead *head,
                         const StochasticPlaces *from)
{
    assert(kept->size == bytes_of(head->count));
    const Pieces pieces = find_pieces(from, head->count);
    unsigned char *at = kept->bytes + sizeof *head;
    memcpy(kept->bytes, head, sizeof *head);
    for (unsigned k = 0; k < PIECES; at += pieces.size[k++])
        memcpy(at, pieces.array[k], pieces.size[k]);
    kept->full = true;
}

bool stochastic_kept_get(const StochasticKept *kept, StochasticHead *head,
                         const StochasticPlaces *to)
{
    if (!kept->full)
        return false;
    memcpy(head, kept->bytes, sizeof *head);
    const Pieces pieces = find_pieces(to, head->count);
    const unsigned char *at = kept->bytes + sizeof *head;
    for (unsigned k = 0; k < PIECES; at += pieces.size[k++])
        memcpy(pieces.array[k], at, pieces.size[k]);
    return true;
}
