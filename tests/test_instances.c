/* SPDX-License-Identifier: BSD-3-Clause */
/* Trees in many places against the same triangles written out, and against each copy in turn. */
#include "raycast/instances.h"
#include "tests/ray_scenes.h"

enum { COPIES = 27 };

typedef struct {
    Scene     *thing[2];
    Bvh       *bvh[2];
    Instance   instance[COPIES];
    Instances *all;
} Forest;

/* Quarter turns, whole shifts and powers of two: exact in float, so that a copy's triangles written
 * out are the same to the bit. Copies do not touch. */
static Affine exact_map(int i)
{
    const double size = i % 4 == 3 ? 0.5 : 1, mirror = i % 5 == 4 ? -size : size;
    const Vec3 at = vec3(32 * (i % 3), 32 * (i / 3 % 3), 32 * (i / 9));
    const Affine scale = { { mirror, 0, 0 }, { 0, size, 0 }, { 0, 0, size }, { 0, 0, 0 } };
    const Affine turns[3] = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, at },
                              { { 0, 1, 0 }, { -1, 0, 0 }, { 0, 0, 1 }, at },
                              { { 0, 0, 1 }, { 1, 0, 0 }, { 0, 1, 0 }, at } };
    return affine_then(&scale, &turns[i % 3]);
}

static Affine any_map(Random *r)
{
    const Vec3 at = vec3_scale(random_cube(r), 20);
    return (Affine){ random_cube(r), random_cube(r), random_cube(r), at };
}

/* Triangles about the origin, up to 12 away, on multiples of 1/16. */
static Scene *exact_soup(void)
{
    Scene *s = soup_create(60, 0.5, 5);
    for (uint32_t i = 0; i < s->in.vertex_count; i++) {
        const Vec3 p = vec3_scale(s->position[i], 128);
        s->position[i] = vec3(floor(p.x) / 16, floor(p.y) / 16, floor(p.z) / 16);
    }
    return s;
}

static Forest forest_create(bool exact)
{
    Forest f = { { exact_soup(), soup_create(200, 0.3, 4) }, { 0 }, { { 0 } }, NULL };
    Error err = { 0 };
    Random r = { 12 };
    for (int k = 0; k < 2; k++)
        f.bvh[k] = bvh_create(&f.thing[k]->in, 1, &err);
    for (int i = 0; i < COPIES; i++)
        f.instance[i] = (Instance){ f.bvh[exact ? 0 : i % 2],
                                    exact ? exact_map(i) : any_map(&r) };
    f.all = instances_create(f.instance, COPIES, 2, &err);
    assert_non_null(f.all);
    return f;
}

static void forest_destroy(Forest *f)
{
    instances_destroy(f->all);
    for (int k = 0; k < 2; k++) {
        bvh_destroy(f->bvh[k]);
        scene_destroy(f->thing[k]);
    }
}

/* Few binary places: exact in each copy's space too. No two components of the direction are of one
 * length, as the largest is treated apart. */
static Ray exact_ray(Random *r)
{
    double v[6];
    for (int k = 0; k < 6; k++)
        v[k] = floor(64 * (k < 3 ? 90 * random_unit(r) - 12 : 2 * random_unit(r) - 1)) / 64;
    return ray_of(vec3(v[0], v[1], v[2]), vec3(v[3] + 0x1p-7, v[4] + 0x1p-8, v[5]), 0,
                  random_unit(r) < 0.2 ? 20 : INFINITY);
}

static void copies_are_like_triangles_written_out(void **state)
{
    (void)state;
    Forest f = forest_create(true);
    const Primitives *one = &f.thing[0]->in;
    Scene *flat = scene_create(COPIES * one->triangle_count);
    for (int i = 0; i < COPIES; i++)
        for (uint32_t t = 0; t < one->triangle_count; t++) {
            Vec3 p[3];
            for (uint32_t c = 0; c < 3; c++)
                p[c] = affine_point(&f.instance[i].to_world,
                                    one->position[one->corner[3 * t + c]]);
            add_triangle(flat, p[0], p[1], p[2]);
        }
    Random r = { 6 };
    uint32_t hits = 0;
    for (int i = 0; i < 12000 / (int)SLOWER; i++) {
        const Ray ray = exact_ray(&r);
        Hit want;
        InstanceHit got;
        const bool found = brute_nearest(&flat->in, &ray, &want);
        assert_int_equal(instances_nearest(f.all, &ray, &got), found);
        assert_int_equal(instances_blocked(f.all, &ray), found);
        hits += found;
        if (!found)
            continue;
        assert_int_equal(got.instance, want.primitive / one->triangle_count);
        assert_true(got.hit.t == want.t);
    }
    assert_in_range(hits, 1000 / SLOWER, 12000 / SLOWER);
    scene_destroy(flat);
    forest_destroy(&f);
}

/* Each copy asked by brute force with the ray in its own space. */
static InstanceHit in_turn(const Forest *f, const Ray *ray)
{
    InstanceHit best = { { .t = ray->t_max, .primitive = RAY_MISS }, RAY_MISS };
    for (uint32_t i = 0; i < COPIES; i++) {
        Affine inverse;
        Hit hit;
        assert_true(affine_invert(&f->instance[i].to_world, &inverse));
        const Vec3 o = affine_point(&inverse, vec3((double)ray->ox, (double)ray->oy,
                                                   (double)ray->oz));
        const Vec3 d = affine_vector(&inverse, vec3((double)ray->dx, (double)ray->dy,
                                                    (double)ray->dz));
        const Ray local = ray_of(o, d, ray->t_min, ray->t_max);
        const Scene *thing = f->thing[f->instance[i].bvh == f->bvh[1]];
        if (brute_nearest(&thing->in, &local, &hit)
            && (best.instance == RAY_MISS || hit.t < best.hit.t))
            best = (InstanceHit){ hit, i };
    }
    return best;
}

static Ray some_ray(Random *r, int i)
{
    Ray ray = ray_of(vec3_scale(random_cube(r), 25), random_direction(r), 0,
                     i % 6 == 0 ? 10 : INFINITY);
    if (i % 97 == 3)
        ray.oy = NAN;
    if (i % 89 == 5)
        ray.dx = ray.dy = ray.dz = 0;
    if (i % 83 == 7)
        ray.dx *= 0x1p60f, ray.dy *= 0x1p60f, ray.dz *= 0x1p60f;
    return ray;
}

static bool hits_equal(const InstanceHit *a, const InstanceHit *b)
{
    return a->instance == b->instance && a->hit.primitive == b->hit.primitive
           && (a->instance == RAY_MISS
               || (a->hit.t == b->hit.t && a->hit.u == b->hit.u && a->hit.v == b->hit.v));
}

static void copies_are_like_each_in_turn(void **state)
{
    (void)state;
    enum { RAYS = 20000 / SLOWER };
    Forest f = forest_create(false);
    Random r = { 7 };
    Ray *ray = calloc(RAYS, sizeof *ray);
    InstanceHit *one = calloc(RAYS, sizeof *one), *many = calloc(RAYS, sizeof *many);
    bool *blocked = calloc(RAYS, sizeof *blocked);
    Error err = { 0 };
    uint32_t hits = 0;
    for (int i = 0; i < RAYS; i++) {
        ray[i] = some_ray(&r, i);
        const InstanceHit want = in_turn(&f, &ray[i]);
        const bool found = instances_nearest(f.all, &ray[i], &one[i]);
        assert_int_equal(found, want.instance != RAY_MISS);
        assert_int_equal(instances_blocked(f.all, &ray[i]), found);
        if (!isfinite(ray[i].dx) || fabsf(ray[i].dx) < 0x1p30f) /* scaled rays round otherwise */
            assert_true(hits_equal(&one[i], &want));
        hits += found;
    }
    assert_in_range(hits, RAYS / 20, RAYS);
    for (int beam = 0; beam < 2; beam++) {
        assert_true(instances_nearest_many(f.all, ray, many, RAYS, beam, &err));
        assert_true(instances_blocked_many(f.all, ray, blocked, RAYS, beam, &err));
        for (int i = 0; i < RAYS; i++) {
            assert_true(hits_equal(&many[i], &one[i]));
            assert_int_equal(blocked[i], one[i].instance != RAY_MISS);
        }
    }
    free(ray);
    free(one);
    free(many);
    free(blocked);
    forest_destroy(&f);
}

/* Copies in one place: the first of them. */
static void equal_hits_go_to_the_smaller_number(void **state)
{
    (void)state;
    Error err = { 0 };
    Scene *s = ball_create(2, vec3(0, 0, 0), 1);
    Bvh *bvh = bvh_create(&s->in, 1, &err);
    Instance instance[40];
    for (int i = 0; i < 40; i++)
        instance[i] = (Instance){ bvh, affine_identity() };
    Instances *all = instances_create(instance, 40, 1, &err);
    Random r = { 3 };
    for (int i = 0; i < 200; i++) {
        InstanceHit hit;
        const Ray ray = ray_of(vec3_scale(random_cube(&r), 0.5), random_direction(&r), 0, 9);
        assert_true(instances_nearest(all, &ray, &hit));
        assert_int_equal(hit.instance, 0);
    }
    instances_destroy(all);
    bvh_destroy(bvh);
    scene_destroy(s);
}

/* What is there is counted, not stored. */
static void many_copies_take_little(void **state)
{
    (void)state;
    enum { SIDE = 40 };
    Error err = { 0 };
    Scene *s = ball_create(3, vec3(0, 0, 0), 0.25);
    Bvh *bvh = bvh_create(&s->in, 1, &err);
    Instance *instance = calloc(SIDE * SIDE * SIDE, sizeof *instance);
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        instance[i] = (Instance){ bvh, affine_identity() };
        instance[i].to_world.t = vec3(i % SIDE, i / SIDE % SIDE, i / (SIDE * SIDE));
    }
    Instances *all = instances_create(instance, SIDE * SIDE * SIDE, 2, &err);
    InstancesStats stats;
    instances_stats(all, &stats);
    assert_int_equal(stats.triangles, 1280u * SIDE * SIDE * SIDE);
    assert_true(stats.bytes < 220u * SIDE * SIDE * SIDE);
    /* Along the diagonals of a layer, and between the balls. */
    InstanceHit hit;
    const Ray through = { -1, -1, 7, 0, 1, 1, 0, INFINITY };
    assert_true(instances_nearest(all, &through, &hit));
    assert_int_equal(hit.instance, 7 * SIDE * SIDE);
    const Ray between = { -1, 0.5f, 7, 0, 1, 0, 0, INFINITY };
    assert_false(instances_blocked(all, &between));
    instances_destroy(all);
    free(instance);
    bvh_destroy(bvh);
    scene_destroy(s);
}

static void bad_places_are_told(void **state)
{
    (void)state;
    Error err = { 0 };
    Scene *s = soup_create(10, 0.3, 4);
    Bvh *bvh = bvh_create(&s->in, 1, &err);
    s->in.triangle_count = 0;
    Bvh *empty = bvh_create(&s->in, 1, &err);
    Instance instance[3] = { { bvh, affine_identity() }, { empty, affine_identity() },
                             { bvh, affine_identity() } };
    const long live = array_live();
    instance[2].to_world.z = vec3(0, 0, 0);
    assert_null(instances_create(instance, 3, 1, &err));
    assert_non_null(strstr(err.text, "instance 2"));
    err = (Error){ 0 };
    instance[2].to_world = affine_identity();
    instance[2].to_world.t.x = 0x1p41;
    assert_null(instances_create(instance, 3, 1, &err));
    assert_int_equal(err.code, ERROR_INPUT);
    instance[2].to_world.t.x = 5;
    Instances *all = NULL;
    for (long n = 0; all == NULL; n++) {
        err = (Error){ 0 };
        assert_int_equal(array_live(), live);
        array_fail_after(n);
        all = instances_create(instance, 3, 1, &err);
        array_fail_after(-1);
        assert_true(all != NULL || err.code == ERROR_MEMORY);
    }
    instances_destroy(all);

    all = instances_create(&instance[1], 1, 1, &err); /* nothing to meet */
    InstanceHit hit;
    assert_false(instances_nearest(all, &(Ray){ 0, 0, 0, 0, 1, 1, 1, INFINITY }, &hit));
    assert_int_equal(hit.instance, RAY_MISS);
    instances_destroy(all);
    bvh_destroy(bvh);
    bvh_destroy(empty);
    scene_destroy(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(copies_are_like_triangles_written_out),
        cmocka_unit_test(copies_are_like_each_in_turn),
        cmocka_unit_test(equal_hits_go_to_the_smaller_number),
        cmocka_unit_test(many_copies_take_little),
        cmocka_unit_test(bad_places_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
