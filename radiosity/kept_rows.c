/* SPDX-License-Identifier: BSD-3-Clause */
/* Rows between two runs. */
#include "radiosity/kept_rows.h"

#include <assert.h>

#include "base/array.h"
#include "radiosity/internal.h"

KeptRows *kept_rows_create(Error *err)
{
    return array_create(1, sizeof(KeptRows), "rows to keep", err);
}

void kept_rows_clear(KeptRows *rows)
{
    for (uint32_t k = 0; rows->chunk != NULL && k * MAKER_CHUNK < rows->count; k++) {
        array_free(rows->chunk[k].source);
        array_free(rows->chunk[k].form_factor);
    }
    rows->chunk = array_free(rows->chunk);
    rows->length = array_free(rows->length);
    rows->escape = array_free(rows->escape);
    rows->area = array_free(rows->area);
    rows->count = 0;
}

KeptRows *kept_rows_destroy(KeptRows *rows)
{
    if (rows == NULL)
        return NULL;
    assert(rows->maker == NULL);
    kept_rows_clear(rows);
    return array_free(rows);
}

uint32_t kept_rows_count(const KeptRows *rows)
{
    if (rows == NULL)
        return 0;
    return rows->maker != NULL ? rows->maker->count : rows->count;
}

bool kept_rows_casting(const KeptRows *rows)
{
    return rows->maker != NULL;
}
