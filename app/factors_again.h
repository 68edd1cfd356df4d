/* SPDX-License-Identifier: BSD-3-Clause */
/* app/factors_again.h -- factors between patches cast again, to learn how far they are off. */
#ifndef APP_FACTORS_AGAIN_H
#define APP_FACTORS_AGAIN_H

#include "app/pipeline.h"
#include "radiosity/links_errors.h"

/* Takes one cast in; it is freed afterwards. max_bytes: what may be taken; 0: no limit. */
typedef bool (*FactorsTake)(void *context, const Links *cast, uint64_t max_bytes, Error *err);

/* Casts 1 .. LINKS_CASTS - 1, each given to `take`.
 * fails  false; ERROR_MEMORY, ERROR_STOPPED, what take says. */
bool factors_again(const Pipeline *pipeline, FactorsTake take, void *context, Error *err);
/* Standard errors of all pairs.
 * owns   the caller frees with links_errors_destroy.
 * fails  NULL; as above. */
LinksErrors *factors_patch_errors(const Pipeline *pipeline, Error *err);

#endif
