/* SPDX-License-Identifier: BSD-3-Clause */
/* The slower, better trees: what they cost rays and memory, and that they are always the same. Hits
 * are compared with brute force in all tests that use ray_scenes.h. */
#include <stdio.h>
#include <unistd.h>

#include "tests/ray_scenes.h"

/* Thin triangles at any angle in a cube, `length` long at most along each axis: boxes around
 * nothing much, which overlap. */
static Scene *needles_create(uint32_t count, double length, uint64_t seed)
{
    Scene *s = scene_create(count);
    Random r = { seed };
    for (uint32_t i = 0; i < count; i++) {
        const Vec3 a = random_cube(&r), b = vec3_mad(a, length, random_cube(&r));
        add_triangle(s, a, b, vec3_mad(b, 0.005, random_cube(&r)));
    }
    return s;
}

static Bvh *tree_of(const Scene *s, BvhQuality quality, unsigned threads)
{
    Error err = { 0 };
    Bvh *bvh = bvh_create_as(&s->in, quality, threads, &err);
    assert_non_null(bvh);
    assert_true(bvh_check(bvh));
    return bvh;
}

/* References in all groups. */
static uint32_t lanes_of(const Bvh *bvh)
{
    uint32_t lanes = 0;
    for (uint32_t g = 0; g < bvh->group_count; g++)
        for (uint32_t i = 0; i < GROUP_WIDTH; i++)
            lanes += bvh->group[g].primitive[i] != RAY_MISS;
    return lanes;
}

static BvhCost cost_of(const Scene *s, const Bvh *bvh, bool any)
{
    BvhCost cost = { 0 };
    Random r = { 77 };
    for (int i = 0; i < 2000; i++) {
        const Ray ray = random_ray(s, &r, vec3(0, 0, 0), 1);
        bvh_cost(bvh, &ray, any, &cost);
    }
    return cost;
}

/* What builds try to make little of: nodes, and groups of triangles. */
static double work_of(const BvhCost *cost)
{
    return (double)cost->nodes + (double)cost->triangles / GROUP_WIDTH;
}

static void needles_agree(void **state)
{
    (void)state;
    Scene *s = needles_create(1500, 0.5, 3);
    add_shape(s, SHAPE_SPHERE, 0, vec3(0.3, 0.2, 0.1), 0.3);
    compare_scene(s, 10000, vec3(0, 0, 0), 1.2, 4);
    scene_destroy(s);
}

/* Long and thin is what the cuts are for. They add three references in ten at most. */
static void needles_cost_less(void **state)
{
    (void)state;
    const uint32_t counts[] = { 2000, 20000 };
    for (int i = 0; i < 2; i++) {
        Scene *s = needles_create(counts[i], 0.25, 8);
        Bvh *medium = tree_of(s, BVH_MEDIUM, 2), *high = tree_of(s, BVH_HIGH, 2);
        assert_int_equal(lanes_of(medium), counts[i]);
        assert_in_range(lanes_of(high), counts[i] + 1, counts[i] + 3 * counts[i] / 10);
        for (int any = 0; any < 2; any++) {
            const BvhCost a = cost_of(s, medium, any), b = cost_of(s, high, any);
            assert_true(work_of(&b) < work_of(&a));
        }
        bvh_destroy(medium);
        bvh_destroy(high);
        scene_destroy(s);
    }
}

/* Where boxes hardly overlap nothing is cut. */
static void far_triangles_stay_whole(void **state)
{
    (void)state;
    Scene *s = scene_create(1000);
    for (int i = 0; i < 1000; i++) {
        const Vec3 at = vec3(i % 10, i / 10 % 10, (double)(i / 100));
        add_triangle(s, at, vec3_add(at, vec3(0.5, 0, 0)), vec3_add(at, vec3(0, 0.5, 0.2)));
    }
    Bvh *high = tree_of(s, BVH_HIGH, 1);
    assert_int_equal(lanes_of(high), 1000);
    bvh_destroy(high);
    scene_destroy(s);
}

/* Large enough for tasks, and for cuts by all threads. */
static void threads_make_the_same_tree(void **state)
{
    (void)state;
    Scene *s = needles_create(35000, 0.1, 12);
    add_shape(s, SHAPE_TORUS, 0.3, vec3(0, 0, 0.6), 0.5);
    Bvh *one = tree_of(s, BVH_HIGH, 1);
    for (unsigned threads = 2; threads <= 5; threads += 3) {
        Bvh *more = tree_of(s, BVH_HIGH, threads);
        assert_int_equal(more->node_count, one->node_count);
        assert_int_equal(more->group_count, one->group_count);
        assert_memory_equal(more->node, one->node, one->node_count * sizeof *one->node);
        assert_memory_equal(more->group, one->group, one->group_count * sizeof *one->group);
        bvh_destroy(more);
    }
    bvh_destroy(one);
    scene_destroy(s);
}

/* All in one place: no plane and no move helps, and the tree stays within the stack's depth. */
static void one_place_for_all(void **state)
{
    (void)state;
    Scene *s = scene_create(3000);
    for (int i = 0; i < 3000; i++)
        add_triangle(s, vec3(-1, -1, 0), vec3(1, -1, 0.25), vec3(0, 1, 0.5));
    Bvh *high = tree_of(s, BVH_HIGH, 2);
    Hit hit;
    assert_true(bvh_nearest(high, &(Ray){ 0, 0, -1, 0, 0, 0, 1, INFINITY }, &hit));
    assert_int_equal(hit.primitive, 0);
    bvh_destroy(high);
    scene_destroy(s);
}

static void trees_come_back_from_files(void **state)
{
    (void)state;
    char path[64];
    Error err = { 0 };
    snprintf(path, sizeof path, "/tmp/isolux-high-%ld.bvh", (long)getpid());
    Scene *s = needles_create(1000, 0.5, 5);
    Bvh *bvh = tree_of(s, BVH_HIGH, 1);
    assert_true(bvh_save(bvh, &s->in, path, &err));
    Bvh *back = bvh_load(path, &s->in, &err);
    assert_non_null(back);
    assert_true(bvh_check(back));
    assert_memory_equal(back->node, bvh->node, bvh->node_count * sizeof *bvh->node);
    assert_memory_equal(back->group, bvh->group, bvh->group_count * sizeof *bvh->group);

    /* A box that no longer reaches to the end of its triangle is found. */
    Node *node = &back->node[back->node_count - 1];
    for (uint32_t i = 0; i < NODE_WIDTH; i++)
        if (node->child[i] != CHILD_NONE)
            node->plane[1][i] = node->plane[0][i];
    assert_false(bvh_check(back));
    bvh_destroy(back);
    bvh_destroy(bvh);
    scene_destroy(s);
    unlink(path);
}

/* Every allocation fails once; for the large scene, every one of a sample. */
static void memory_failures_leave_nothing(void **state)
{
    (void)state;
    for (int large = 0; large < 2; large++) {
        Scene *s = needles_create(large ? 35000 : 1000, 0.25, 3);
        const long live = array_live();
        Bvh *bvh = NULL;
        for (long n = 0; bvh == NULL; n += large ? 1 + 2 * n : 1) {
            Error err = { 0 };
            array_fail_after(n);
            bvh = bvh_create_as(&s->in, BVH_HIGH, 2, &err);
            array_fail_after(-1);
            if (bvh == NULL) {
                assert_int_equal(err.code, ERROR_MEMORY);
                assert_int_equal(array_live(), live);
            }
        }
        assert_true(bvh_check(bvh));
        bvh_destroy(bvh);
        assert_int_equal(array_live(), live);
        scene_destroy(s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(needles_agree),
        cmocka_unit_test(needles_cost_less),
        cmocka_unit_test(far_triangles_stay_whole),
        cmocka_unit_test(threads_make_the_same_tree),
        cmocka_unit_test(one_place_for_all),
        cmocka_unit_test(trees_come_back_from_files),
        cmocka_unit_test(memory_failures_leave_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
