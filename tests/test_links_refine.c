/* SPDX-License-Identifier: BSD-3-Clause */
/* Links of rooms whose patches are divided further, against closed forms and links cast afresh. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "tests/room_maker.h"

enum { RAYS = 256 };
static const LinksOptions OPTIONS = { .rays = RAYS };

/* A room divided in part, and its links before and after. */
typedef struct {
    TestRoom  r;
    Patches  *finer;
    uint32_t *parent;
    Room      room;       /* with the finer patches */
    Links    *old, *links;
} Divided;

/* Divides the patches that `choose` names. */
static void divide(Divided *d, bool (*choose)(const TestRoom *r, uint32_t patch), unsigned threads)
{
    Error err = { 0 };
    const Patches *p = d->r.patches;
    uint8_t *split = array_create(p->count, 1, "marks", &err);
    for (uint32_t i = 0; i < p->count; i++)
        split[i] = choose(&d->r, i);
    d->finer = patches_split(p, d->r.surfaces, split, &d->parent, &err);
    assert_non_null(d->finer);
    assert_true(d->finer->count > p->count);
    d->room = d->r.room;
    d->room.patches = d->finer;
    LinksOptions o = OPTIONS;
    o.threads = threads;
    d->old = links_create(&d->r.room, &o, NULL, &err);
    d->links = links_refine(d->old, &d->room, d->parent, &o, NULL, &err);
    assert_non_null(d->links);
    assert_true(links_check(d->links));
    array_free(split);
}

static void divided_clear(Divided *d)
{
    links_destroy(d->old);
    links_destroy(d->links);
    patches_destroy(d->finer);
    array_free(d->parent);
    room_clear(&d->r);
}

/* How many parts an old patch has. */
static uint32_t parts_of(const Divided *d, uint32_t old)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < d->finer->count; i++)
        n += d->parent[i] == old;
    return n;
}

/* The unit cube, grey, with a box and a lamp in it. */
static void furnished(TestRoom *r)
{
    const uint32_t wall = room_material(r, 0.5, 0);
    room_box(r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL, true, wall, "");
    room_box(r, vec3(0.3, 0.4, 0), vec3(0.6, 0.6, 0.4), BOX_ALL, false, wall, "box-");
    room_quad(r, vec3(0.4, 0.4, 0.95), vec3(0, 0.2, 0), vec3(0.2, 0, 0),
              room_material(r, 0, 20), "lamp");
    room_finish(r, 0.2, &(SidesOptions){ 0 }, NULL, 0, NULL);
}

static bool every_third(const TestRoom *r, uint32_t patch)
{
    (void)r;
    return patch % 3 == 0;
}
static bool all(const TestRoom *r, uint32_t patch)
{
    (void)r;
    (void)patch;
    return true;
}
static bool on_floor(const TestRoom *r, uint32_t patch)
{
    return r->patches->group[patch] == room_group(r, "z0");
}

/* Rows of undivided patches keep their sums, what they have to each undivided patch, and what they
 * have to all parts of a divided one. */
static void test_rows_kept(void **state)
{
    (void)state;
    Divided d = { 0 };
    furnished(&d.r);
    divide(&d, every_third, 0);
    double *sum = calloc(d.old->count, sizeof *sum);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < d.links->count; i++) {
        const uint32_t o = d.parent[i];
        if (parts_of(&d, o) > 1)
            continue;
        memset(sum, 0, d.old->count * sizeof *sum);
        for (uint64_t k = d.links->first[i]; k < d.links->first[i + 1]; k++)
            sum[d.parent[d.links->source[k]]] += (double)d.links->form_factor[k];
        /* Up to four parts, each rounded to float once. */
        for (uint64_t k = d.old->first[o]; k < d.old->first[o + 1]; k++) {
            const double f = (double)d.old->form_factor[k];
            assert_true(fabs(sum[d.old->source[k]] - f) <= 0x1p-23 * f);
            sum[d.old->source[k]] = 0;
        }
        for (uint32_t j = 0; j < d.old->count; j++)
            assert_true(sum[j] == 0);
        assert_true(d.links->escape[i] == d.old->escape[o] && d.links->area[i] == d.old->area[o]);
        kept++;
    }
    assert_in_range(kept, d.old->count / 4, d.old->count);
    free(sum);
    divided_clear(&d);
}

static void assert_same_row(const Links *a, const Links *b, uint32_t i)
{
    const uint64_t n = a->first[i + 1] - a->first[i];
    assert_int_equal(n, b->first[i + 1] - b->first[i]);
    assert_memory_equal(a->source + a->first[i], b->source + b->first[i], n * sizeof *a->source);
    assert_memory_equal(a->form_factor + a->first[i], b->form_factor + b->first[i],
                        n * sizeof *a->form_factor);
    assert_true(a->escape[i] == b->escape[i] && a->area[i] == b->area[i]);
}

/* The parts' rows are those that a fresh cast gives; when all is divided, that is everything. */
static void test_fresh_rows(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        Divided d = { 0 };
        Error err = { 0 };
        furnished(&d.r);
        divide(&d, k == 0 ? every_third : all, 0);
        Links *fresh = links_create(&d.room, &OPTIONS, NULL, &err);
        uint32_t same = 0;
        for (uint32_t i = 0; i < d.links->count; i++)
            if (parts_of(&d, d.parent[i]) > 1) {
                assert_same_row(d.links, fresh, i);
                same++;
            }
        assert_true(k == 0 ? same > 0 : same == fresh->count);
        links_destroy(fresh);
        divided_clear(&d);
    }
}

/* A light-tight wall across the cube, its floor in one patch under it: what was one patch on both
 * sides is two after division, and no row of one half names a part in the other. */
static void test_no_leak(void **state)
{
    (void)state;
    Divided d = { 0 };
    TestRoom *r = &d.r;
    const uint32_t grey = room_material(r, 0.5, 0);
    const Vec3 eyes[2] = { { 0.2, 0.5, 0.5 }, { 0.8, 0.5, 0.5 } };
    room_box(r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL, true, grey, "");
    room_box(r, vec3(0.45, -0.1, -0.1), vec3(0.55, 1.1, 1.1), BOX_ALL, false, grey, "wall-");
    room_finish(r, 1, &(SidesOptions){ .eye = eyes, .eye_count = 2 }, NULL, 0, NULL);
    divide(&d, on_floor, 0);
    uint32_t links = 0;
    for (uint32_t i = 0; i < d.links->count; i++)
        for (uint64_t k = d.links->first[i]; k < d.links->first[i + 1]; k++) {
            const uint32_t j = d.links->source[k];
            const double x = d.finer->centre[i].x, y = d.finer->centre[j].x;
            /* Patches that reach through the wall see both halves themselves. */
            if (fabs(x - 0.5) < 0.06 || fabs(y - 0.5) < 0.06)
                continue;
            assert_true((x < 0.5) == (y < 0.5));
            links++;
        }
    assert_true(links > 0);
    divided_clear(&d);
}

static bool low_half(const TestRoom *r, uint32_t patch)
{
    return r->patches->centre[patch].z < 0.5;
}

/* Factors between the walls of a cube divided below: closed forms, within three standard errors of
 * the rays. */
static void test_cube(void **state)
{
    (void)state;
    Divided d = { 0 };
    const Vec3 eye = vec3(0.5, 0.5, 0.5);
    room_box(&d.r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL, true, room_material(&d.r, 0.5, 0), "");
    room_finish(&d.r, 0.25, &(SidesOptions){ .eye = &eye, .eye_count = 1 }, NULL, 0, NULL);
    divide(&d, low_half, 0);
    static const char *const names[6] = { "x0", "x1", "y0", "y1", "z0", "z1" };
    const double opposite = 0.199824896, adjacent = 0.200043776;
    const double allowed = 3 * sqrt(0.2 * 0.8 / (16.0 * RAYS));
    Patches *coarse = d.r.patches;
    d.r.patches = d.finer; /* what room_factor reads */
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++) {
            const double f = room_factor(&d.r, d.links, names[i], names[j]);
            const double exact = i == j ? 0 : i / 2 == j / 2 ? opposite : adjacent;
            assert_true(fabs(f - exact) <= (i == j ? 0 : allowed));
        }
    d.r.patches = coarse;
    divided_clear(&d);
}

static void test_threads(void **state)
{
    (void)state;
    Divided d = { 0 }, e = { 0 };
    furnished(&d.r);
    furnished(&e.r);
    divide(&d, every_third, 1);
    divide(&e, every_third, 3);
    assert_int_equal(d.links->count, e.links->count);
    for (uint32_t i = 0; i < d.links->count; i++)
        assert_same_row(d.links, e.links, i);
    assert_int_equal(d.links->rays, e.links->rays);
    divided_clear(&d);
    divided_clear(&e);
}

static bool stop(void *user)
{
    (void)user;
    return true;
}

static void test_memory(void **state)
{
    (void)state;
    Divided d = { 0 };
    furnished(&d.r);
    divide(&d, every_third, 1);
    const LinksOptions few = { .rays = 16, .threads = 1 };
    const long live = array_live();
    for (long n = 0;; n++) {
        Error err = { 0 };
        array_fail_after(n);
        Links *links = links_refine(d.old, &d.room, d.parent, &few, NULL, &err);
        array_fail_after(-1);
        assert_int_equal(links != NULL, !error_is_set(&err));
        const bool done = links != NULL;
        links_destroy(links);
        assert_int_equal(array_live(), live);
        if (done)
            break;
        assert_int_equal(err.code, ERROR_MEMORY);
    }
    Error err = { 0 };
    const LinksOptions tight = { .rays = 16, .max_bytes = 1000 };
    assert_null(links_refine(d.old, &d.room, d.parent, &tight, NULL, &err));
    assert_int_equal(err.code, ERROR_MEMORY);
    err = (Error){ 0 };
    const Monitor monitor = { .stop = stop };
    assert_null(links_refine(d.old, &d.room, d.parent, &few, &monitor, &err));
    assert_int_equal(err.code, ERROR_STOPPED);
    assert_int_equal(array_live(), live);
    divided_clear(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rows_kept), cmocka_unit_test(test_fresh_rows),
        cmocka_unit_test(test_no_leak),   cmocka_unit_test(test_cube),
        cmocka_unit_test(test_threads),   cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
