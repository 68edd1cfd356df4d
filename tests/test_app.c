/* SPDX-License-Identifier: BSD-3-Clause */
/* Parts of the program that read and write text: values of options, JSON, CSV, points. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "app/csv.c"
#include "app/json.c"
#include "app/options_values.c"
#include "app/points.c"

static void numbers_are_read_whole(void **state)
{
    static const struct {
        const char *text;
        bool        good;
        double      value;
    } cases[] = {
        { "1", true, 1 },       { "-2.5e3", true, -2500 }, { "+.5", true, 0.5 },
        { "", false, 0 },
        { "1 ", false, 0 },     { " 1", false, 0 },        { "1x", false, 0 },
        { "nan", false, 0 },    { "inf", false, 0 },       { "0x10", false, 0 },
        { "-0x1", false, 0 },   { "1e999", false, 0 },     { "-", false, 0 },
        { "1,5", false, 0 },    { "1e", false, 0 },        { ".", false, 0 },
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double value = 0;
        assert_int_equal(value_number(cases[i].text, &value), cases[i].good);
        assert_true(value == cases[i].value);
    }
}

static void counts_do_not_overflow(void **state)
{
    uint32_t count = 7;
    (void)state;
    assert_true(value_count("4294967295", &count) && count == UINT32_MAX);
    assert_false(value_count("4294967296", &count));
    assert_false(value_count("99999999999999999999999", &count));
    assert_false(value_count("-1", &count) || value_count("1.0", &count));
    assert_false(value_count("", &count));
    assert_int_equal(count, UINT32_MAX);
}

static void sizes_and_times_have_units(void **state)
{
    uint64_t bytes = 0;
    double seconds = 0;
    int pixels[2] = { 0, 0 };
    (void)state;
    assert_true(value_bytes("512MB", &bytes) && bytes == 512u << 20);
    assert_true(value_bytes("1.5g", &bytes) && bytes == 3u << 29);
    assert_true(value_bytes("100", &bytes) && bytes == 100);
    assert_false(value_bytes("1e30T", &bytes) || value_bytes("12XB", &bytes) ||
                 value_bytes("-1", &bytes) || value_bytes("MB", &bytes));
    assert_true(value_seconds("30s", &seconds) && seconds == 30);
    assert_true(value_seconds("5min", &seconds) && seconds == 300);
    assert_true(value_seconds("2 h", &seconds) && seconds == 7200);
    assert_false(value_seconds("soon", &seconds) || value_seconds("-1s", &seconds));
    assert_true(value_pixels("640x480", pixels) && pixels[0] == 640 && pixels[1] == 480);
    assert_false(value_pixels("640", pixels) || value_pixels("0x480", pixels) ||
                 value_pixels("640x", pixels) || value_pixels("1x2x3", pixels) ||
                 value_pixels("99999999x1", pixels));
}

static void vectors_and_words(void **state)
{
    Vec3 v = { 0 };
    char word[8];
    (void)state;
    assert_true(value_vector("1,-2.5,3e2", &v) && v.x == 1 && v.y == -2.5 && v.z == 300);
    assert_false(value_vector("1,2", &v) || value_vector("1,2,3,4", &v) ||
                 value_vector("1,,3", &v) || value_vector("", &v));
    assert_int_equal(value_choice("medium", "draft,medium,high"), 1);
    assert_int_equal(value_choice("med", "draft,medium,high"), -1);
    assert_int_equal(value_choice("", "draft,medium,high"), -1);
    assert_int_equal(value_choice("draft,medium", "draft,medium,high"), -1);
    value_word("draft,medium,high", 2, word, sizeof word);
    assert_string_equal(word, "high");
    assert_int_equal(word_distance("--qualty", "--quality", 5), 1);
    assert_int_equal(word_distance("kitten", "sitting", 9), 3);
    assert_int_equal(word_distance("a", "abcdefgh", 3), 3);
}

/* What a writer printed, as a string of the caller's. */
static void json_to(char *out, size_t size, bool one_line, void (*fill)(Json *json))
{
    FILE *file = tmpfile();
    assert_non_null(file);
    Json json = { .out = file, .one_line = one_line };
    fill(&json);
    rewind(file);
    out[fread(out, 1, size - 1, file)] = '\0';
    fclose(file);
}

static void fill_odd_values(Json *json)
{
    json_open(json, NULL, '{');
    json_text(json, "a\"b", "tab\t \\ \x01 \xC3\xA9 \xFF \xED\xA0\x80 \xC0\x80");
    json_number(json, "third", 1.0 / 3);
    json_number(json, "whole", 5);
    json_number(json, "none", NAN);
    json_count(json, "big", UINT64_MAX);
    json_numbers(json, "list", (double[]){ 0.1, -1e300 }, 2);
    json_open(json, "empty", '[');
    json_close(json, ']');
    json_close(json, '}');
}

static void json_holds_any_value(void **state)
{
    char text[1024];
    (void)state;
    json_to(text, sizeof text, true, fill_odd_values);
    assert_string_equal(text,
                        "{\"a\\\"b\":\"tab\\t \\\\ \\u0001 \xC3\xA9 \xEF\xBF\xBD "
                        "\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD \xEF\xBF\xBD\xEF\xBF\xBD\","
                        "\"third\":0.33333333333333331,\"whole\":5.0,\"none\":null,"
                        "\"big\":1.8446744073709552e19,"
                        "\"list\":[0.10000000000000001,-1.0000000000000001e300],"
                        "\"empty\":[]}\n");
}

static void csv_quotes_what_it_must(void **state)
{
    char text[64];
    FILE *file = tmpfile();
    (void)state;
    assert_non_null(file);
    csv_text(file, "plain");
    csv_text(file, "a,\"b\"\n");
    rewind(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    assert_string_equal(text, "plain\"a,\"\"b\"\"\n\"");
}

static void points_in_many_forms(void **state)
{
    static const char text[] = "\xEF\xBB\xBFx,y,z,nx,ny,nz\r\n# c\r\n\r\n1,2,3,0,0,2 # n\r\n"
                               "4;5;6;0;1e-200;0\n7 8\t9 -3e200 0 0";
    Points points = { 0 };
    Error err = { 0 };
    (void)state;
    assert_true(points_parse(&points, text, sizeof text - 1, "p.csv", &err));
    assert_int_equal(points.count, 3);
    assert_true(points.point[0].z == 3 && points.normal[0].z == 1 && points.given[0].z == 2);
    assert_true(points.normal[1].y == 1 && points.normal[2].x == -1);
    points_free(&points);
    assert_int_equal(array_live(), 0);
}

static void points_that_are_none(void **state)
{
    static const struct {
        const char *text, *message;
    } cases[] = {
        { "1,2,3,0,0\n", "p.csv:1: 5 values where x,y,z,nx,ny,nz are expected" },
        { "1,2,3,0,0,1,9\n", "p.csv:1: 7 values where x,y,z,nx,ny,nz are expected" },
        { "\n1,2,3,0,0,0\n", "p.csv:2: the normal is 0,0,0" },
        { "a\nb,1,2,3,4,5\n", "p.csv:2: 'b' is not a number" },
        { "1,2,x,0,0,1\n", "p.csv:1: 'x' is not a number" },
        { "1,2,1e999,0,0,1\n", "p.csv:1: a value is not finite" },
        { "# nothing\n", "p.csv: holds no points" },
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        Points points = { 0 };
        Error err = { 0 };
        assert_false(points_parse(&points, cases[i].text, strlen(cases[i].text), "p.csv", &err));
        assert_string_equal(err.text, cases[i].message);
        assert_int_equal(err.code, ERROR_INPUT);
        points_free(&points);
    }
    assert_int_equal(array_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_are_read_whole),
        cmocka_unit_test(counts_do_not_overflow),
        cmocka_unit_test(sizes_and_times_have_units),
        cmocka_unit_test(vectors_and_words),
        cmocka_unit_test(json_holds_any_value),
        cmocka_unit_test(csv_quotes_what_it_must),
        cmocka_unit_test(points_in_many_forms),
        cmocka_unit_test(points_that_are_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
