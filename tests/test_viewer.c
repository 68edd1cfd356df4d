/* SPDX-License-Identifier: BSD-3-Clause */
/* The window's parts that need no screen: keys, cameras, scripts, what the threads share. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/array.h"
#include "viewer/bindings.h"
#include "viewer/control.h"
#include "viewer/matrix.h"
#include "viewer/script.h"

static void test_keys_are_found_by_their_names(void **state)
{
    size_t count;
    const Binding *table = bindings_table(&count);
    (void)state;
    for (size_t i = 0; i < count; i++) {
        int key = 0;
        unsigned mods = 0;
        /* "1 .. 9" and "X, then drag" are more than a key. */
        if (table[i].key == 0 || strpbrk(table[i].name, " ,") != NULL)
            continue;
        assert_true(bindings_key(table[i].name, &key, &mods));
        assert_int_equal(key, table[i].key);
        assert_int_equal(mods, table[i].mods);
        assert_int_equal(bindings_find(key, mods), table[i].action);
    }
}

static void test_no_key_does_two_things(void **state)
{
    size_t count;
    const Binding *table = bindings_table(&count);
    (void)state;
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < i; j++)
            assert_false(table[i].key != 0 && table[i].key == table[j].key &&
                         table[i].mods == table[j].mods);
}

static void test_strange_keys_are_refused(void **state)
{
    static const char *const names[] = { "", "Shift-", "F12x", "Ctrl", "two", "\x7f" };
    int key;
    unsigned mods;
    (void)state;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        assert_false(bindings_key(names[i], &key, &mods));
}

static const Camera CAMERA = { .eye = { 3, -2, 1 }, .target = { 1, 4, 2 }, .up = { 0, 0, 1 },
                               .vertical_fov = 50 };

/* A place on the ray through a pixel is drawn at that pixel. */
static void test_the_matrix_agrees_with_rays(void **state)
{
    enum { W = 640, H = 360 };
    const Vec3 middle = vec3(1, 2, 3), lo = vec3(-9, -9, -9), hi = vec3(9, 9, 9);
    float m[16];
    (void)state;
    matrix_of_camera(&CAMERA, (double)W / H, middle, lo, hi, m);
    for (int k = 0; k < 25; k++) {
        const double x = 20 + 150 * (k % 5), y = 15 + 80 * (k / 5);
        const Vec3 d = view_direction(&CAMERA, x, y, W, H);
        const Vec3 p = vec3_sub(vec3_mad(CAMERA.eye, 1.5 + k / 5.0, d), middle);
        double clip[4];
        for (int r = 0; r < 4; r++)
            clip[r] = (double)m[r] * p.x + (double)m[4 + r] * p.y + (double)m[8 + r] * p.z +
                      (double)m[12 + r];
        assert_true(clip[3] > 0 && fabs(clip[2]) <= clip[3]);
        /* floats: some 2^-24 of numbers up to ten, over half a picture */
        assert_true(fabs((1 + clip[0] / clip[3]) * W / 2 - x) < 0.01);
        assert_true(fabs((1 - clip[1] / clip[3]) * H / 2 - y) < 0.01);
    }
}

static void test_orbits_keep_their_distance_and_stay_upright(void **state)
{
    const Vec3 up = vec3(0, 0, 1);
    const double radius = vec3_length(vec3_sub(CAMERA.eye, CAMERA.target));
    Camera camera = CAMERA;
    (void)state;
    for (int k = 0; k < 200; k++) {
        view_orbit(&camera, up, 0.13, k < 100 ? 0.1 : -0.1);
        const ViewFrame f = view_frame(&camera);
        assert_true(fabs(vec3_length(vec3_sub(camera.eye, camera.target)) - radius) < 1e-9);
        assert_true(fabs(vec3_dot(f.right, up)) < 1e-9 && vec3_dot(f.up, up) > 0);
    }
    view_look(&camera, up, 2 * acos(-1.0), 0);
    assert_true(fabs(vec3_length(vec3_sub(camera.eye, camera.target)) - radius) < 1e-9);
}

/* All of a sphere is inside the picture, and it touches the nearer rims. */
static void test_what_is_framed_is_seen_whole(void **state)
{
    Camera camera = CAMERA;
    (void)state;
    view_fit(&camera, vec3(5, 5, 5), 2, 1.6);
    const double distance = vec3_length(vec3_sub(camera.eye, vec3(5, 5, 5)));
    assert_true(fabs(asin(2 / distance) - 25 * acos(-1.0) / 180) < 1e-9);
}

static Script *script_of(const char *text, Error *err)
{
    char path[] = "/tmp/isolux-script-XXXXXX";
    const int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    assert_int_equal(write(descriptor, text, strlen(text)), strlen(text));
    close(descriptor);
    Script *script = script_read(path, err);
    unlink(path);
    return script;
}

static void test_scripts_are_read(void **state)
{
    Error err = { 0 };
    (void)state;
    Script *script = script_of("# nothing\n\nkey Shift-S\nwait frames 3 # and on\n"
                               "drag left 1 2 3 4\nwait lit\nscreenshot a.png\n", &err);
    assert_non_null(script);
    assert_false(error_is_set(&err));
    script_destroy(script);
}

static void test_wrong_lines_are_told(void **state)
{
    static const char *const wrong[] = {
        "key\n", "key Hyper-S\n", "click left 1\n", "click thumb 1 2\n", "drag left 1 2 3\n",
        "wait for godot\n", "wait frames\n", "wait frames x\n", "wheel up\n", "move 1 2 3\n",
        "screenshot\n", "sing\n",
    };
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        Error err = { 0 };
        assert_null(script_of(wrong[i], &err));
        assert_int_equal(err.code, ERROR_INPUT);
        assert_non_null(strstr(err.text, ":1: what is '"));
    }
    assert_int_equal(array_live(), 0);
}

/* The pixel of a place is the one whose ray meets it. */
static void test_places_and_pixels_agree(void **state)
{
    const Camera camera = { .eye = { 1, 2, 3 }, .target = { 4, 1, -5 }, .up = { 0, 1, 0.2 },
                            .vertical_fov = 55 };
    (void)state;
    for (int k = 0; k < 20; k++) {
        const double at_x = 37.25 * k, at_y = 470 - 21.5 * k, far = 0.5 + k;
        double x = 0, y = 0;
        const Vec3 d = view_direction(&camera, at_x, at_y, 640, 480);
        const Vec3 place = vec3_mad(camera.eye, far, d), behind = vec3_mad(camera.eye, -far, d);
        assert_true(view_pixel(&camera, place, 640, 480, &x, &y));
        assert_true(fabs(x - at_x) < 1e-9 && fabs(y - at_y) < 1e-9);
        assert_false(view_pixel(&camera, behind, 640, 480, &x, &y));
    }
}

static void test_knobs_count_their_turns(void **state)
{
    KnobSetting setting;
    Knobs knobs;
    const Knob knob = { .kind = KNOB_GROUP, .base = { 4, 2, 0 } };
    (void)state;
    knobs_init(&knobs);
    assert_int_equal(knobs_read(&knobs, &setting), 0);
    assert_true(knobs_value(&knobs, &knob, 7).r == 4);
    knobs_turn(&knobs, 7, rgb(1, 1, 1));
    assert_int_equal(knobs_read(&knobs, &setting), 1);
    assert_true(setting.turned[7] && !setting.turned[6]);
    assert_true(knobs_value(&knobs, &knob, 7).r == 1);
    knobs_reset(&knobs);
    assert_int_equal(knobs_read(&knobs, &setting), 2);
    assert_false(setting.turned[7]);
    knobs_clear(&knobs);
}

static void test_knobs_scale_what_the_scene_has(void **state)
{
    Knob knob = { .kind = KNOB_GROUP, .base = { 4, 2, 0 } };
    (void)state;
    const Rgb dim = knob_apply(&knob, rgb(1, 4, 3), rgb(2, 1, 0));
    assert_true(dim.r == 0.5 && dim.g == 2 && dim.b == 0); /* there is no blue to scale */
    assert_true(knob_is_factor(&knob, rgb(1, 4, 3)));
    knob.plain = true;
    assert_true(knob_apply(&knob, rgb(1, 4, 3), rgb(4, 2, 0)).b == 3);
    assert_false(knob_is_factor(&knob, rgb(1, 4, 3)));
    knob.kind = KNOB_PAINT;
    assert_true(knob_apply(&knob, rgb(9, 9, 9), rgb(0.5, 0.5, 0.5)).r < 1);
}

/* What was not taken in time is gone when the next comes, and only then. */
static void test_the_mailbox_keeps_the_newest(void **state)
{
    Error err = { 0 };
    Mailbox mailbox = { NULL };
    Snapshot *first = array_create(1, sizeof *first, "test", &err);
    Snapshot *second = array_create(1, sizeof *second, "test", &err);
    (void)state;
    assert_null(mailbox_take(&mailbox));
    mailbox_put(&mailbox, first);
    mailbox_put(&mailbox, second);
    assert_int_equal(array_live(), 1);
    assert_ptr_equal(mailbox_take(&mailbox), second);
    assert_null(mailbox_take(&mailbox));
    snapshot_destroy(second);
    assert_int_equal(array_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_keys_are_found_by_their_names),
        cmocka_unit_test(test_no_key_does_two_things),
        cmocka_unit_test(test_strange_keys_are_refused),
        cmocka_unit_test(test_the_matrix_agrees_with_rays),
        cmocka_unit_test(test_orbits_keep_their_distance_and_stay_upright),
        cmocka_unit_test(test_what_is_framed_is_seen_whole),
        cmocka_unit_test(test_scripts_are_read),
        cmocka_unit_test(test_wrong_lines_are_told),
        cmocka_unit_test(test_places_and_pixels_agree),
        cmocka_unit_test(test_knobs_count_their_turns),
        cmocka_unit_test(test_knobs_scale_what_the_scene_has),
        cmocka_unit_test(test_the_mailbox_keeps_the_newest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
