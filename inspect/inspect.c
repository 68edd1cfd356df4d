/* SPDX-License-Identifier: BSD-3-Clause */
/* Rims, crossings and buried parts. */
#include "inspect/inspect.h"

#include "base/array.h"

void inspection_clear(Inspection *inspection)
{
    array_free(inspection->rim);
    *inspection = (Inspection){ 0 };
}
