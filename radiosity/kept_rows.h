/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/kept_rows.h -- rows of a cast under way: saved from time to time, taken up again later.
 *
 * Handed to links_create or links_refine in LinksOptions.kept. While they cast, their monitor's
 * `progress` may save what is finished (checkpoint_save); rows loaded from such a file before the
 * call are not cast again. The links that result are the same, bit for bit.
 * Threads  save only from within `progress` of the call that was given the rows.
 */
#ifndef RADIOSITY_KEPT_ROWS_H
#define RADIOSITY_KEPT_ROWS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"

typedef struct KeptRows KeptRows;

/* owns   the caller frees with kept_rows_destroy, not before the call that uses them returned.
 * fails  NULL; ERROR_MEMORY. */
KeptRows *kept_rows_create(Error *err);
/* Frees; NULL is allowed. Always returns NULL. */
KeptRows *kept_rows_destroy(KeptRows *rows);
/* Forgets what was loaded. */
void kept_rows_clear(KeptRows *rows);
/* Rows of the cast that was loaded or is under way; 0: none. */
uint32_t kept_rows_count(const KeptRows *rows);
/* Whether a cast is under way. */
bool kept_rows_casting(const KeptRows *rows);

#endif
