/* SPDX-License-Identifier: BSD-3-Clause */
/* Soup to inspection, for the tests of inspect. */
#ifndef TESTS_INSPECT_TOOLS_H
#define TESTS_INSPECT_TOOLS_H

#include "inspect/inspect.h"
#include "tests/soup_tools.h"

typedef struct {
    Surfaces  *surfaces;
    Defects    defects;
    Inspection found;
} Inspected;

/* Connects the soup, inspects it, frees the soup. `own` drops what connecting it found. */
static inline void inspect_soup(Inspected *i, Polygons *soup, const SurfaceOptions *repair,
                                const uint8_t *sides)
{
    Error err = { 0 };
    *i = (Inspected){ 0 };
    i->surfaces = surfaces_repair(soup, repair, NULL, NULL, &err);
    assert_non_null(i->surfaces);
    const InspectOptions options = { .sides = sides, .threads = 2 };
    assert_true(inspect(i->surfaces, &options, &i->defects, &i->found, NULL, &err));
    assert_int_equal(err.code, ERROR_NONE);
    assert_int_equal(i->defects.found[DEFECT_OPEN_EDGE], i->found.open_edges);
    assert_int_equal(i->found.parts, i->surfaces->part_count);
    polygons_clear(soup);
}

static inline void inspected_clear(Inspected *i)
{
    surfaces_destroy(i->surfaces);
    defects_clear(&i->defects);
    inspection_clear(&i->found);
}

/* The k-th defect of a kind. */
static inline const Defect *inspected_defect(const Inspected *i, DefectKind kind, size_t k)
{
    for (size_t n = 0; n < i->defects.count; n++)
        if (i->defects.item[n].kind == kind && k-- == 0)
            return &i->defects.item[n];
    fail_msg("no such defect");
    return NULL;
}

static inline bool near(double a, double b, double tolerance) { return fabs(a - b) <= tolerance; }

#endif
