/* SPDX-License-Identifier: BSD-3-Clause */
/* Trees after they were made: primitives that move, trees in files. */
#include <stdio.h>
#include <unistd.h>

#include "base/file.h"
#include "tests/ray_scenes.h"

/* --- things that move ------------------------------------------------------------------------ */

static void shake(Scene *s, double most, Random *r)
{
    for (uint32_t i = 0; i < s->in.vertex_count; i++)
        s->position[i] = vec3_mad(s->position[i], most, random_cube(r));
}

static void refit_all(Trees *trees, const Scene *s)
{
    for (int k = 0; k < TREES; k++) {
        Error err = { 0 };
        if (trees->bvh[k] == NULL)
            continue;
        assert_true(bvh_refit(trees->bvh[k], &s->in, (unsigned)k + 1, &err));
        assert_true(bvh_check(trees->bvh[k]));
    }
}

static void compare_random(const Scene *s, const Trees *trees, uint32_t rays, Random *r)
{
    for (uint32_t i = 0; i < rays / SLOWER + 10; i++) {
        const Ray ray = random_ray(s, r, vec3(0, 0, 0), 1.5);
        compare_ray(&s->in, trees, &ray);
    }
}

static void moved_trees_answer_like_brute_force(void **state)
{
    (void)state;
    Scene *s = soup_create(700, 0.2, 5);
    add_shape(s, SHAPE_SPHERE, 0, vec3(0.3, 0.2, 0.1), 0.4);
    add_shape(s, SHAPE_TORUS, 0.3, vec3(0, 0, -0.6), 0.5);
    Trees trees = trees_create(&s->in);
    Random r = { 9 };
    static const double most[] = { 0.01, 0.3, 2 };
    for (int i = 0; i < 3; i++) {
        shake(s, most[i], &r);
        s->shape[0] = s->shape[1];
        refit_all(&trees, s);
        compare_random(s, &trees, 4000, &r);
    }
    trees_destroy(&trees);
    scene_destroy(s);
}

/* A triangle may lose its area and get it back; one that never had any is not in the tree. */
static void areas_that_come_and_go(void **state)
{
    (void)state;
    Scene *s = soup_create(50, 0.4, 6);
    Trees trees = trees_create(&s->in);
    Random r = { 10 };
    const Vec3 was = s->position[31];
    s->position[31] = s->position[30];
    refit_all(&trees, s);
    compare_random(s, &trees, 5000, &r);
    Trees without = trees_create(&s->in);
    s->position[31] = was;
    refit_all(&trees, s);
    compare_random(s, &trees, 5000, &r);

    Error err = { 0 };
    assert_false(bvh_refit(without.bvh[0], &s->in, 1, &err));
    assert_int_equal(err.code, ERROR_INPUT);
    assert_non_null(strstr(err.text, "triangle 10 "));
    assert_true(bvh_check(without.bvh[0]));
    s->position[31] = s->position[30];
    compare_random(s, &without, 1000, &r);
    trees_destroy(&without);
    trees_destroy(&trees);
    scene_destroy(s);
}

static void moves_that_cannot_be(void **state)
{
    (void)state;
    Error err = { 0 };
    Scene *s = soup_create(50, 0.4, 6);
    Bvh *bvh = bvh_create(&s->in, 1, &err);
    s->position[17].y = NAN;
    assert_false(bvh_refit(bvh, &s->in, 1, &err));
    assert_int_equal(err.code, ERROR_INPUT);
    assert_non_null(strstr(err.text, "vertex 17 "));
    s->position[17].y = 0;
    err = (Error){ 0 };
    assert_true(bvh_refit(bvh, &s->in, 1, &err));
    bvh_destroy(bvh);

    s->in.triangle_count = 0; /* nothing can move, too */
    bvh = bvh_create(&s->in, 1, &err);
    assert_true(bvh_refit(bvh, &s->in, 1, &err));
    bvh_destroy(bvh);
    scene_destroy(s);
}

/* --- files ----------------------------------------------------------------------------------- */

static void temporary(char path[64])
{
    snprintf(path, 64, "/tmp/isolux-tree-%ld.bvh", (long)getpid());
}

static void trees_come_back_from_files(void **state)
{
    (void)state;
    char path[64];
    temporary(path);
    for (uint32_t triangles = 0; triangles <= 3000; triangles += 1500) {
        Error err = { 0 };
        Scene *s = soup_create(triangles, 0.1, 8);
        if (triangles > 0)
            s->position[4] = s->position[5]; /* a triangle without area */
        add_shape(s, SHAPE_SPHERE, 0, vec3(0.3, 0.2, 0.1), 0.4);
        Bvh *bvh = bvh_create(&s->in, 2, &err);
        assert_true(bvh_save(bvh, &s->in, path, &err));
        Bvh *back = bvh_load(path, &s->in, &err);
        assert_non_null(back);
        assert_true(bvh_check(back));
        assert_int_equal(back->node_count, bvh->node_count);
        assert_memory_equal(back->node, bvh->node, bvh->node_count * sizeof *bvh->node);
        assert_int_equal(back->group_count, bvh->group_count);
        if (bvh->group_count > 0)
            assert_memory_equal(back->group, bvh->group, bvh->group_count * sizeof *bvh->group);
        Random r = { 3 };
        for (int i = 0; i < 300; i++) {
            const Ray ray = random_ray(s, &r, vec3(0, 0, 0), 1.5);
            Hit want, got;
            assert_int_equal(brute_nearest(&s->in, &ray, &want), bvh_nearest(back, &ray, &got));
            assert_memory_equal(&want, &got, sizeof want);
        }
        bvh_destroy(back);
        bvh_destroy(bvh);
        scene_destroy(s);
    }
    unlink(path);
}

static void refused(const void *bytes, size_t size, const Primitives *in, const char *why)
{
    Error err = { 0 };
    assert_null(bvh_parse(bytes, size, "some.bvh", in, &err));
    assert_int_equal(err.code, ERROR_INPUT);
    assert_non_null(strstr(err.text, "some.bvh"));
    assert_null(strchr(err.text, '\n'));
    if (strstr(err.text, why) == NULL)
        print_error("%s\n", err.text);
    assert_non_null(strstr(err.text, why));
}

static void damaged_files_are_refused(void **state)
{
    (void)state;
    char path[64];
    Error err = { 0 };
    size_t size = 0;
    temporary(path);
    Scene *s = room_create();
    Bvh *bvh = bvh_create(&s->in, 1, &err);
    assert_true(bvh_save(bvh, &s->in, path, &err));
    unsigned char *bytes = (unsigned char *)file_read(path, 1 << 20, &size, &err);
    assert_non_null(bytes);
    refused(bytes, 0, &s->in, "is not a tree");
    refused(bytes, 40, &s->in, "is not a tree");
    refused(bytes, size - 1, &s->in, "its length");
    for (size_t i = 0; i < size; i++) {
        bytes[i] ^= 0x10;
        refused(bytes, size, &s->in, i < 8 ? "is not a tree" : "");
        bytes[i] ^= 0x10;
    }
    s->position[3].x += 0.5;
    refused(bytes, size, &s->in, "another scene");
    s->position[3].x -= 0.5;
    bvh_destroy(bvh);
    bvh = bvh_parse(bytes, size, "some.bvh", &s->in, &err);
    assert_non_null(bvh);
    bvh_destroy(bvh);
    array_free(bytes);
    unlink(path);

    assert_null(bvh_load(path, &s->in, &err));
    assert_int_equal(err.code, ERROR_INPUT);
    scene_destroy(s);
}

/* A file whose checksum is right may still hold anything. */
static void wrong_contents_are_refused(void **state)
{
    (void)state;
    enum { HEADER = 72 };
    char path[64];
    Error err = { 0 };
    size_t size = 0;
    temporary(path);
    Scene *s = room_create();
    Bvh *bvh = bvh_create(&s->in, 1, &err);
    assert_true(bvh_save(bvh, &s->in, path, &err));
    char *bytes = file_read(path, 1 << 20, &size, &err);
    assert_non_null(bytes);
    uint32_t sound = 0;
    Random r = { 4 };
    for (int i = 0; i < 3000; i++) {
        char *copy = malloc(size);
        memcpy(copy, bytes, size);
        const size_t at = HEADER + (size_t)(random_unit(&r) * (double)(size - HEADER - 8));
        const uint32_t value = (uint32_t)(random_unit(&r) * (i % 2 ? 4294967295.0 : 60));
        memcpy(copy + (at < size - 12 ? at : size - 12), &value, sizeof value);
        const uint64_t hash = file_hash(copy + HEADER, size - HEADER - 8,
                                        file_hash(copy, HEADER, 0));
        memcpy(copy + size - 8, &hash, sizeof hash);
        Error why = { 0 };
        Bvh *back = bvh_parse(copy, size, "some.bvh", &s->in, &why);
        if (back != NULL) { /* a box may have become larger */
            const Ray ray = random_ray(s, &r, vec3(5, 5, 5), 5);
            Hit hit;
            bvh_nearest(back, &ray, &hit);
            sound++;
        } else
            assert_int_equal(why.code, ERROR_INPUT);
        bvh_destroy(back);
        free(copy);
    }
    assert_in_range(sound, 1, 1000);
    array_free(bytes);
    bvh_destroy(bvh);
    scene_destroy(s);
    unlink(path);
}

/* Four triangles side by side in one group, a sphere apart: what rays meet is known. */
static void costs_are_counted(void **state)
{
    (void)state;
    Error err = { 0 };
    Scene *s = scene_create(4);
    for (int i = 0; i < 4; i++)
        add_triangle(s, vec3(i, 0, 0), vec3(i + 1, 0, 0), vec3(i, 1, 0));
    Bvh *bvh = bvh_create(&s->in, 1, &err);
    BvhCost cost = { 0 };
    bvh_cost(bvh, &(Ray){ 0.2f, 0.2f, -1, 0, 0, 0, 1, INFINITY }, false, &cost);
    assert_int_equal(cost.nodes, 1);
    assert_int_equal(cost.triangles, 4);
    bvh_cost(bvh, &(Ray){ 9, 9, -1, 0, 0, 0, 1, INFINITY }, true, &cost);
    bvh_cost(bvh, &(Ray){ NAN, 9, -1, 0, 0, 0, 1, INFINITY }, true, &cost);
    assert_int_equal(cost.nodes, 2); /* missed from the root; no ray at all */
    assert_int_equal(cost.triangles, 4);
    assert_int_equal(cost.shapes, 0);
    bvh_destroy(bvh);

    s->in.triangle_count = 0;
    add_shape(s, SHAPE_SPHERE, 0, vec3(0, 0, 0), 1);
    bvh = bvh_create(&s->in, 1, &err);
    cost = (BvhCost){ 0 };
    bvh_cost(bvh, &(Ray){ 0, 0, 0, 0, 0, 0, 1, INFINITY }, true, &cost);
    assert_int_equal(cost.shapes, 1);
    assert_int_equal(cost.nodes, 1);
    bvh_destroy(bvh);
    scene_destroy(s);
}

static void memory_that_runs_out(void **state)
{
    (void)state;
    char path[64];
    Error err = { 0 };
    temporary(path);
    Scene *s = soup_create(200, 0.1, 8);
    Bvh *bvh = bvh_create(&s->in, 1, &err);
    assert_true(bvh_save(bvh, &s->in, path, &err));
    const long before = array_live();
    bool loaded = false, refitted = false;
    for (long n = 0; n < 40 && !(loaded && refitted); n++) {
        Error no = { 0 }, again = { 0 };
        array_fail_after(n);
        Bvh *back = bvh_load(path, &s->in, &no);
        array_fail_after(n);
        refitted = bvh_refit(bvh, &s->in, 1, &again);
        array_fail_after(-1);
        loaded = back != NULL;
        assert_true(loaded || no.code == ERROR_MEMORY || no.code == ERROR_INPUT);
        assert_true(refitted || again.code == ERROR_MEMORY);
        bvh_destroy(back);
        assert_int_equal(array_live(), before);
    }
    assert_true(loaded && refitted);
    bvh_destroy(bvh);
    scene_destroy(s);
    unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(moved_trees_answer_like_brute_force),
        cmocka_unit_test(areas_that_come_and_go),
        cmocka_unit_test(moves_that_cannot_be),
        cmocka_unit_test(trees_come_back_from_files),
        cmocka_unit_test(damaged_files_are_refused),
        cmocka_unit_test(wrong_contents_are_refused),
        cmocka_unit_test(costs_are_counted),
        cmocka_unit_test(memory_that_runs_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
