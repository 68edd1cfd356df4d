/* SPDX-License-Identifier: BSD-3-Clause */
/* Links through a file: the same bits back, and nothing but them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/array.h"
#include "radiosity/links_file.h"

static char folder[] = "/tmp/isolux-links-XXXXXX";
static char path[64];

static int open_folder(void **state)
{
    (void)state;
    if (mkdtemp(folder) == NULL)
        return 1;
    snprintf(path, sizeof path, "%s/links", folder);
    return 0;
}

static int close_folder(void **state)
{
    (void)state;
    unlink(path);
    return rmdir(folder);
}

static uint64_t first[] = { 0, 2, 3, 3 };
static uint32_t source[] = { 1, 2, 0 };
static float    factor[] = { 0.25f, 0.1f, 0.3333333f }, escape[] = { 0.65f, 0.6666667f, 1 };
static double   area[] = { 1, 0.75, 1e-9 };
static uint8_t  lamp[] = { 0, 1, 0 };

static const LinksOptions in_memory = { .max_bytes = 0 };

static Links some_links(bool lamps)
{
    return (Links){ .count = 3, .first = first, .source = source, .form_factor = factor,
                    .escape = escape, .area = area, .lamp = lamps ? lamp : NULL, .rays = 77,
                    .clamped = 5, .seconds = 0.5 };
}

static void the_same_bits_come_back(void **state)
{
    (void)state;
    for (int lamps = 0; lamps < 2; lamps++) {
        const Links links = some_links(lamps);
        Error err = { 0 };
        assert_true(links_save(&links, 42, path, &err));
        bool other = true;
        Links *back = links_load(path, 42, &in_memory, &other, &err);
        assert_non_null(back);
        assert_false(other);
        assert_int_equal(back->count, 3);
        assert_int_equal(back->rays, 77);
        assert_int_equal(back->clamped, 5);
        assert_true(back->seconds == 0.5);
        assert_memory_equal(back->first, first, sizeof first);
        assert_memory_equal(back->source, source, sizeof source);
        assert_memory_equal(back->form_factor, factor, sizeof factor);
        assert_memory_equal(back->escape, escape, sizeof escape);
        assert_memory_equal(back->area, area, sizeof area);
        assert_int_equal(back->lamp != NULL, lamps);
        if (lamps)
            assert_memory_equal(back->lamp, lamp, sizeof lamp);
        links_destroy(back);
        assert_int_equal(array_live(), 0);
    }
}

static void another_key_is_refused(void **state)
{
    (void)state;
    const Links links = some_links(true);
    Error err = { 0 };
    bool other = false;
    assert_true(links_save(&links, 42, path, &err));
    assert_null(links_load(path, 43, &in_memory, &other, &err));
    assert_true(other);
    assert_int_equal(err.code, ERROR_INPUT);
    err = (Error){ 0 };
    unlink(path);
    assert_null(links_load(path, 42, &in_memory, &other, &err));
    assert_int_equal(err.code, ERROR_INPUT);
    assert_false(other);
}

/* Each byte changed in turn, and each length: nothing of it is taken for links. */
static void damage_is_found(void **state)
{
    (void)state;
    const Links links = some_links(true);
    Error err = { 0 };
    assert_true(links_save(&links, 42, path, &err));
    FILE *file = fopen(path, "rb");
    unsigned char bytes[1000];
    const size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    assert_int_equal(size, links_file_bytes(&links));
    for (size_t cut = 0; cut < 2 * size; cut++) {
        const size_t length = cut < size ? cut : size;
        if (cut >= size)
            bytes[cut - size] ^= 0x10;
        file = fopen(path, "wb");
        fwrite(bytes, 1, length, file);
        fclose(file);
        if (cut >= size)
            bytes[cut - size] ^= 0x10;
        err = (Error){ 0 };
        assert_null(links_load(path, 42, &in_memory, NULL, &err));
        assert_int_equal(err.code, ERROR_INPUT);
        assert_int_equal(array_live(), 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_same_bits_come_back),
        cmocka_unit_test(another_key_is_refused),
        cmocka_unit_test(damage_is_found),
    };
    return cmocka_run_group_tests(tests, open_folder, close_folder);
}
