/* SPDX-License-Identifier: BSD-3-Clause */
/* Links in files, in 16 bits, by column: the same numbers as in memory. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/spill.h"
#include "radiosity/internal.h"
#include "tests/room_maker.h"

/* A closed box with a lamp, so that rows of both kinds are there. */
static Links *box_links(TestRoom *r, const LinksOptions *options)
{
    *r = (TestRoom){ 0 };
    const uint32_t grey = room_material(r, 0.5, 0), lamp = room_material(r, 0.5, 1);
    room_box(r, vec3(0, 0, 0), vec3(1, 2, 1), BOX_ALL & ~BOX_Z1, true, grey, "");
    room_box(r, vec3(0, 0, 0), vec3(1, 2, 1), BOX_Z1, true, lamp, "");
    const Vec3 eye = vec3(0.5, 0.5, 0.5);
    Error err = { 0 };
    room_finish(r, 0.05, &(SidesOptions){ .eye = &eye, .eye_count = 1 }, NULL, 0, NULL);
    Links *links = links_create(&r->room, options, NULL, &err);
    assert_false(error_is_set(&err));
    return links;
}

static void assert_same(const Links *a, const Links *b)
{
    const uint64_t n = a->first[a->count];
    assert_int_equal(a->count, b->count);
    assert_memory_equal(a->first, b->first, (a->count + 1) * sizeof *a->first);
    assert_memory_equal(a->source, b->source, n * sizeof *a->source);
    assert_memory_equal(a->form_factor, b->form_factor, n * sizeof *a->form_factor);
    assert_memory_equal(a->escape, b->escape, a->count * sizeof *a->escape);
    assert_memory_equal(a->area, b->area, a->count * sizeof *a->area);
}

static void a_file_holds_the_same(void **state)
{
    (void)state;
    TestRoom r, s;
    Links *memory = box_links(&r, &(LinksOptions){ .rays = 400 });
    const LinksOptions little = { .rays = 400, .max_bytes = 26 << 20, .folder = "/tmp" };
    Links *file = box_links(&s, &little);
    assert_true(memory->mapped == 0 && file->mapped > 0);
    assert_same(memory, file);
    links_destroy(memory);
    links_destroy(file);
    room_clear(&r);
    room_clear(&s);
    assert_int_equal(array_live(), 0);
}

/* The same links, in a file. */
static Links *copy_to_file(const Links *from)
{
    Error err = { 0 };
    const uint32_t n = from->count;
    const uint64_t links = from->first[n];
    Links *to = links_allocate_in(n, links, "/tmp", &err);
    assert_non_null(to);
    memcpy(to->first, from->first, (n + 1) * sizeof *to->first);
    memcpy(to->source, from->source, links * sizeof *to->source);
    memcpy(to->form_factor, from->form_factor, links * sizeof *to->form_factor);
    memcpy(to->escape, from->escape, n * sizeof *to->escape);
    memcpy(to->area, from->area, n * sizeof *to->area);
    memcpy(to->lamp, from->lamp, n * sizeof *to->lamp);
    return to;
}

static void a_file_is_closed_the_same(void **state)
{
    (void)state;
    TestRoom r;
    Error err = { 0 };
    Links *memory = box_links(&r, &(LinksOptions){ .rays = 64 }), *file = copy_to_file(memory);
    for (Closure c = CLOSURE_NONE; c <= CLOSURE_BOTH; c++) {
        LinksReport a, b;
        LinksChange x, y;
        Links *p = links_close(memory, r.patches, c, 2, NULL, &err);
        Links *q = links_close(file, r.patches, c, 2, NULL, &err);
        assert_true(p != NULL && q != NULL && p->mapped == 0 && q->mapped > 0);
        assert_same(p, q);
        assert_true(links_report(p, &a, &err) && links_report(q, &b, &err));
        assert_memory_equal(&a, &b, sizeof a);
        links_change(memory, p, &x);
        links_change(file, q, &y);
        assert_true(x.largest == y.largest && x.row == y.row && x.column == y.column);
        assert_true(c == CLOSURE_NONE ? x.largest == 0 : x.largest > 0);
        links_destroy(p);
        links_destroy(q);
    }
    links_destroy(memory);
    links_destroy(file);
    room_clear(&r);
    assert_int_equal(array_live(), 0);
}

static void too_little_is_said(void **state)
{
    (void)state;
    TestRoom r;
    Error err = { 0 };
    links_destroy(box_links(&r, &(LinksOptions){ .rays = 8 }));
    const LinksOptions none = { .rays = 512, .max_bytes = 4096, .folder = "/tmp" };
    assert_null(links_create(&r.room, &none, NULL, &err));
    assert_int_equal(err.code, ERROR_MEMORY);
    err = (Error){ 0 };
    const LinksOptions nowhere = { .rays = 512, .max_bytes = 27 << 20, .folder = "/dev/null/x" };
    assert_null(links_create(&r.room, &nowhere, NULL, &err));
    assert_int_equal(err.code, ERROR_FAILED);
    room_clear(&r);
    assert_int_equal(array_live(), 0);
}

/* Each factor within the bound that links.h states, each row's sum kept to what a float's scale
 * leaves, and the same from a file. */
static void sixteen_bits_round_as_stated(void **state)
{
    (void)state;
    TestRoom r;
    Error err = { 0 };
    double rounding = 0, again = 0;
    Links *raw = box_links(&r, &(LinksOptions){ .rays = 64 });
    Links *links = links_close(raw, r.patches, CLOSURE_BOTH, 1, NULL, &err);
    Links *packed = links_pack(links, NULL, 2, &rounding, &err);
    Links *file = links_pack(links, "/tmp", 1, &again, &err);
    LinksScratch a, b;
    assert_true(links_scratch_create(packed, &a, &err) && links_scratch_create(file, &b, &err));
    assert_true(rounding > 0 && rounding <= 0x1p-11 && rounding == again);
    assert_true(links_bytes(packed) < 0.55 * links_bytes(links));
    for (uint32_t i = 0; i < links->count; i++) {
        const LinksRow row = links_row(packed, i, &a), other = links_row(file, i, &b);
        const uint64_t first = links->first[i];
        double sum = 0, expected = 0;
        assert_int_equal(row.count, links->first[i + 1] - first);
        for (uint64_t k = 0; k < row.count; k++) {
            const double f = links->form_factor[first + k];
            assert_int_equal(row.source[k], links->source[first + k]);
            assert_true(fabs(row.form_factor[k] - f) <= 0x1p-11 * f + 0x1p-31);
            assert_true(row.form_factor[k] == other.form_factor[k]);
            sum += row.form_factor[k];
            expected += f;
        }
        assert_true(fabs(sum - expected) <= 0x1p-22 * expected);
    }
    links_scratch_clear(&a);
    links_scratch_clear(&b);
    links_destroy(raw);
    links_destroy(links);
    links_destroy(packed);
    links_destroy(file);
    room_clear(&r);
    assert_int_equal(array_live(), 0);
}

/* Gaps up to 2^32, factors from 1 down to nothing: by hand. */
static void wide_gaps_and_small_factors(void **state)
{
    (void)state;
    uint64_t first[] = { 0, 7, 7 };
    uint32_t source[] = { 0, 65535, 131071, 131072, 200000, 4000000, 4000001 };
    float factor[] = { 0.5f, 0.25f, 0x1p-20f, 0.1f, 0, 0x1p-60f, 1.0f / 3 };
    float escape[] = { 0, 1 };
    double area[] = { 1, 1 }, rounding = 0;
    const Links links = { .count = 2, .first = first, .source = source, .form_factor = factor,
                          .escape = escape, .area = area };
    Error err = { 0 };
    Links *packed = links_pack(&links, NULL, 1, &rounding, &err);
    LinksScratch scratch;
    assert_true(packed != NULL && links_scratch_create(packed, &scratch, &err));
    const LinksRow row = links_row(packed, 0, &scratch);
    uint64_t at = 0;
    for (int k = 0; k < 7; k++, at++) {
        while (row.source[at] != source[k])
            assert_true(row.form_factor[at++] == 0);
        if (factor[k] > 0x1p-31f)
            assert_true(fabs(row.form_factor[at] / factor[k] - 1) <= 0x1p-11);
        else
            assert_true(row.form_factor[at] <= 0x1p-31f && (factor[k] > 0) ==
                        (row.form_factor[at] > 0));
    }
    assert_int_equal(at, row.count);
    assert_int_equal(links_row(packed, 1, &scratch).count, 0);
    links_scratch_clear(&scratch);
    links_destroy(packed);
    assert_int_equal(array_live(), 0);
}

/* Columns of the box, whole and in blocks, against the rows. */
static void columns_are_rows_turned(void **state)
{
    (void)state;
    TestRoom r;
    Error err = { 0 };
    Links *links = box_links(&r, &(LinksOptions){ .rays = 64 });
    uint64_t *total = links_column_totals(links, &err), seen = 0;
    for (uint32_t begin = 0, end; begin < links->count; begin = end) {
        LinkColumns columns;
        end = link_columns_end(total, links->count, begin, 1000);
        assert_true(end > begin && (total[end] - total[begin] <= 1000 || end == begin + 1));
        assert_true(link_columns_create(links, total, begin, end, false, &columns, &err));
        for (uint32_t j = begin; j < end; j++)
            for (uint64_t k = columns.first[j - begin]; k < columns.first[j - begin + 1]; k++) {
                const uint32_t i = columns.receiver[k];
                uint64_t at = links->first[i];
                while (at < links->first[i + 1] && links->source[at] != j)
                    at++;
                assert_true(at < links->first[i + 1]);
                assert_true(links->form_factor[at] == columns.form_factor[k]);
                seen++;
            }
        link_columns_clear(&columns);
    }
    assert_int_equal(seen, links->first[links->count]);
    array_free(total);
    links_destroy(links);
    room_clear(&r);
    assert_int_equal(array_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_holds_the_same),
        cmocka_unit_test(a_file_is_closed_the_same),
        cmocka_unit_test(too_little_is_said),
        cmocka_unit_test(sixteen_bits_round_as_stated),
        cmocka_unit_test(wide_gaps_and_small_factors),
        cmocka_unit_test(columns_are_rows_turned),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
