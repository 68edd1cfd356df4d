/* SPDX-License-Identifier: BSD-3-Clause */
/* Comment lines of solved meshes: what is ours is read, all else is passed over. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/ply_notes.h"

static void take(PlyNotes *notes, const char *line)
{
    Error err = { 0 };
    assert_true(ply_notes_take(notes, line, &err));
    assert_false(error_is_set(&err));
}

static void test_units_and_up(void **state)
{
    PlyNotes notes = { 0 };
    (void)state;
    take(&notes, "x y z: scene units of 0.001 m");
    take(&notes, "radiosity: all that leaves, W/m2");
    take(&notes, "up 0 0 2");
    assert_true(fabs(notes.unit_m - 0.001) < 1e-12);
    assert_true(notes.watts && notes.has_up);
    assert_true(fabs(notes.up.z - 1) < 1e-12 && fabs(notes.up.x) < 1e-12);
    ply_notes_clear(&notes);
}

static void test_what_was_written_is_read(void **state)
{
    char *text = NULL;
    size_t size = 0;
    Error err = { 0 };
    PlyNotes notes = { 0 };
    (void)state;
    Scene *scene = scene_create("room.obj", &err);
    const Camera camera = { .name = "by the door", .eye = { 1, 2, 3.25 }, .target = { 4, 5, 6 },
                            .up = { 0, 1, 0 }, .vertical_fov = 40.1 };
    const Camera around = { .name = "all", .eye = { 1, 2, 3 }, .target = { 4, 5, 6 },
                            .up = { 0, 1, 0 }, .vertical_fov = 180,
                            .projection = CAMERA_PANORAMA };
    const Light light = { .kind = LIGHT_SPOT, .position = { 0.1, 0.2, 0.3 },
                          .direction = { 0, -1, 0 }, .intensity = { 100, 90, 80 },
                          .cos_inner = 0.9, .cos_outer = 0.8, .name = "desk" };
    assert_true(scene_add_camera(scene, &camera, &err) && scene_add_camera(scene, &around, &err));
    assert_true(scene_add_light(scene, &light, &err));
    scene->origin = vec3(1e6, 0, 0);
    FILE *out = open_memstream(&text, &size);
    ply_notes_put(out, scene);
    fclose(out);
    for (char *line = strtok(text, "\n"); line != NULL; line = strtok(NULL, "\n")) {
        assert_int_equal(strncmp(line, "comment ", 8), 0);
        take(&notes, line + 8);
    }
    assert_int_equal(notes.camera_count, 1); /* the window has no panorama */
    assert_string_equal(notes.camera[0].name, "by the door");
    assert_true(fabs(notes.camera[0].eye.x - 1000001) < 1e-9);
    assert_true(fabs(notes.camera[0].vertical_fov - 40.1) < 1e-12);
    assert_int_equal(notes.light_count, 1);
    assert_string_equal(notes.light[0].name, "desk");
    assert_int_equal(notes.light[0].kind, LIGHT_SPOT);
    assert_true(fabs(notes.light[0].intensity.b - 80) < 1e-12);
    assert_true(fabs(notes.light[0].cos_outer - 0.8) < 1e-12);
    free(text);
    ply_notes_clear(&notes);
    scene_destroy(scene);
}

static void test_other_lines_are_passed_over(void **state)
{
    static const char *const lines[] = {
        "", "up", "up 0 0 0", "up nan 0 1", "camera 1 2 3", "camera 1 2 3 1 2 3 0 1 0 40 same",
        "camera 1 2 3 4 5 6 0 1 0 180 wide", "camera 1 2 3 4 5 6 0 1 0 inf", "light point 1 2",
        "light beam 0 0 0 0 0 1 1 1 1 0 0 x", "light spot 0 0 0 0 0 0 1 1 1 1 0 no axis",
        "light point 0 0 0 0 0 1 -1 1 1 0 0 dark", "material 7 late", "material x", "material 0",
        "x y z: scene units of -1 m"
    };
    PlyNotes notes = { 0 };
    (void)state;
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        take(&notes, lines[i]);
    assert_int_equal(notes.camera_count + notes.light_count + notes.material_count, 0);
    assert_false(notes.has_up || notes.watts || notes.unit_m > 0);
    take(&notes, "material 0 ");
    take(&notes, "material 1 red wall");
    assert_int_equal(notes.material_count, 2);
    assert_string_equal(notes.material_name[1], "red wall");
    ply_notes_clear(&notes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_units_and_up),
        cmocka_unit_test(test_what_was_written_is_read),
        cmocka_unit_test(test_other_lines_are_passed_over),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
