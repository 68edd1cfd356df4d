/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as a solved mesh: refused in one clear line, or sound enough to be compared. */
#include <stdlib.h>
#include <string.h>

#include "app/compare_ply.h"
#include "base/array.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static void demand(bool condition)
{
    if (!condition)
        abort();
}

static void said_in_a_line(const Error *err)
{
    demand(err->code == ERROR_INPUT && err->text[0] != 0 && strchr(err->text, '\n') == NULL);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    Error err = { 0 };
    SolvedMesh mesh = { 0 };
    MeshComparison comparison = { 0 };

    const bool read = solved_mesh_parse(&mesh, bytes, size, "fuzz.ply", &err);
    demand(read != error_is_set(&err));
    if (read && !mesh_compare(&mesh, &mesh, &(CompareOptions){ .samples = 64 }, &comparison, &err))
        said_in_a_line(&err);
    else if (!read)
        said_in_a_line(&err);
    mesh_comparison_clear(&comparison);
    solved_mesh_clear(&mesh);
    demand(array_live() == 0);
    return 0;
}
