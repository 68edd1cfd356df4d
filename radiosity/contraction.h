/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/contraction.h -- how much light is reflected once more at most; this folder only. */
#ifndef RADIOSITY_CONTRACTION_H
#define RADIOSITY_CONTRACTION_H

#include "radiosity/solve.h"

/* q of radiosity/solve.h for links and a reflectance [count * bands]. before: that of the same
 * links with another reflectance, or NULL: then only rows of what has changed are read.
 * owns   the caller frees with reflected_destroy.
 * fails  NULL; ERROR_MEMORY. */
Reflected *reflected_create(const Links *links, unsigned bands, const double *reflectance,
                            const Reflected *before, unsigned threads, Error *err);
/* Frees; NULL is allowed. Always returns NULL. */
Reflected *reflected_destroy(Reflected *reflected);

#endif
