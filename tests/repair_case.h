/* SPDX-License-Identifier: BSD-3-Clause */
/* A soup, how it is to be repaired, and what comes of it. */
#ifndef TESTS_REPAIR_CASE_H
#define TESTS_REPAIR_CASE_H

#include "tests/soup_tools.h"

typedef struct {
    Polygons       soup;
    SurfaceOptions options;
    Defects        defects;
    Surfaces      *s;
} Case;

static inline void case_run(Case *c)
{
    Error err = { 0 };
    c->s = surfaces_repair(&c->soup, &c->options, &c->defects, NULL, &err);
    assert_int_equal(err.code, ERROR_NONE);
    assert_true(surfaces_check(c->s));
}

static inline void case_clear(Case *c)
{
    surfaces_destroy(c->s);
    defects_clear(&c->defects);
    polygons_clear(&c->soup);
    *c = (Case){ 0 };
}

#endif
