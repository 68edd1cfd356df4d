/* SPDX-License-Identifier: BSD-3-Clause */
/* app/marked.h -- the faces of a file as they are, coloured by what is wrong with them. */
#ifndef APP_MARKED_H
#define APP_MARKED_H

#include "app/check.h"

/* Every face of the file is there, unwelded, in its order; curved faces as grids. Open edges are
 * edges. What the colours mean stands in the header's comments. `path` "-": standard output.
 * fails  ERROR_FAILED, ERROR_MEMORY. */
bool marked_write(const Check *check, const char *path, Error *err);

#endif
