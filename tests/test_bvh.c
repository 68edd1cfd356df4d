/* SPDX-License-Identifier: BSD-3-Clause */
/* The tree of boxes against every primitive in turn, its kernels against each other bit for bit. */
#include "tests/ray_scenes.h"

/* --- tree against brute force ---------------------------------------------------------------- */

static void soups_agree(void **state)
{
    (void)state;
    static const struct {
        uint32_t triangles, rays;
        double   size;
    } table[] = { { 1, 20000, 1 }, { 3, 20000, 1 }, { 9, 30000, 0.5 }, { 40, 50000, 0.4 },
                  { 150, 50000, 0.3 }, { 400, 60000, 0.1 }, { 3000, 5000, 0.02 } };
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        Scene *s = soup_create(table[i].triangles, table[i].size, 7 + i);
        compare_scene(s, table[i].rays, vec3(0, 0, 0), 1.5, 70 + i);
        scene_destroy(s);
    }
}

static void room_agrees(void **state)
{
    (void)state;
    Scene *s = room_create();
    compare_scene(s, 100000, vec3(5, 5, 5), 6, 3);
    scene_destroy(s);
}

static void shapes_agree(void **state)
{
    (void)state;
    Scene *s = soup_create(40, 0.3, 99);
    add_shape(s, SHAPE_SPHERE, 0, vec3(0.3, 0.2, 0.1), 0.4);
    add_shape(s, SHAPE_DISC, 0, vec3(-0.5, 0.2, 0.4), 0.5);
    add_shape(s, SHAPE_FRUSTUM, 1, vec3(-0.3, -0.6, 0.1), 0.3);
    add_shape(s, SHAPE_FRUSTUM, 0, vec3(0.7, -0.6, 0.1), 0.3);
    add_shape(s, SHAPE_TORUS, 0.3, vec3(0, 0, -0.6), 0.5);
    add_shape(s, SHAPE_SPHERE, 0, vec3(0, 0, 0), 2);
    compare_scene(s, 60000, vec3(0, 0, 0), 1.5, 4);
    s->in.triangle_count = 0;
    compare_scene(s, 30000, vec3(0, 0, 0), 1.5, 5);
    scene_destroy(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(soups_agree),
        cmocka_unit_test(room_agrees),
        cmocka_unit_test(shapes_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
