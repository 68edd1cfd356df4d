/* SPDX-License-Identifier: BSD-3-Clause */
/* A lattice of turned copies of a scene, drawn: how many triangles fit, and how fast rays find
 * their way among them. Nothing is lit: normals against one direction, fading with distance. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <sys/resource.h>

#include "base/array.h"
#include "base/parallel.h"
#include "bench/bench.h"
#include "raycast/instances.h"
#include "render/image.h"

enum { WIDE = 960, HIGH = 640, TILE = 64, TILE_RAYS = TILE * TILE };

typedef struct {
    const Model *model;
    Instances   *all;
    Image       *image;
    Vec3         eye, ahead, right, up;
    double       fade; /* distance at which 1/e is left */
} Drawing;

/* Side by side with a gap, each by a quarter turn of its own. */
static void place(const Model *m, uint32_t i, uint32_t side, Affine *map)
{
    const Vec3 size = vec3_sub(m->hi, m->lo), middle = vec3_lerp(m->lo, m->hi, 0.5);
    const double step = 1.1 * fmax(size.x, fmax(size.y, size.z));
    const Affine centred = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, vec3_scale(middle, -1) };
    const Affine turn = affine_rotation((int)(i % 3), 90.0 * (i % 4) + 20.0 * (i % 5));
    *map = affine_then(&centred, &turn);
    map->t = vec3_add(map->t, vec3_scale(vec3(i % side, i / side % side, i / (side * side)), step));
}

static Instances *lattice(const Model *m, const Bvh *bvh, uint32_t count, unsigned threads,
                          Error *err)
{
    Instance *instance = array_create(count, sizeof *instance, "copies", err);
    const uint32_t side = (uint32_t)ceil(cbrt(count));
    for (uint32_t i = 0; instance != NULL && i < count; i++) {
        instance[i].bvh = bvh;
        place(m, i, side, &instance[i].to_world);
    }
    Instances *all = instance != NULL ? instances_create(instance, count, threads, err) : NULL;
    array_free(instance);
    return all;
}

/* Ray k of a tile: squares of 4 x 4 pixels, one after the other. */
static void pixel(uint32_t tile, uint32_t k, uint32_t *x, uint32_t *y)
{
    const uint32_t square = k / 16, across = WIDE / TILE;
    *x = tile % across * TILE + square % (TILE / 4) * 4 + k % 4;
    *y = tile / across * TILE + square / (TILE / 4) * 4 + k / 4 % 4;
}

static Ray eye_ray(const Drawing *d, uint32_t x, uint32_t y)
{
    const double u = (2.0 * x + 1 - WIDE) / HIGH, v = 1 - (2.0 * y + 1) / HIGH;
    const Vec3 to = vec3_unit(vec3_mad(vec3_mad(d->ahead, 0.7 * u, d->right), 0.7 * v, d->up));
    return ray_leaving(d->eye, to, 0, to, INFINITY);
}

static void shade(const Drawing *d, const Ray *ray, const InstanceHit *hit, float rgb[3])
{
    static const float sky[3] = { 0.55f, 0.62f, 0.7f };
    const Vec3 light = vec3_unit(vec3(0.4, 0.8, 0.3));
    float left = 0, tint[3] = { 0, 0, 0 };
    if (hit->instance != RAY_MISS) {
        const uint32_t *c = &d->model->corner[3 * (size_t)hit->hit.primitive];
        const Vec3 a = d->model->position[c[0]];
        const Vec3 n = vec3_cross(vec3_sub(d->model->position[c[1]], a),
                                  vec3_sub(d->model->position[c[2]], a));
        Vec3 world = vec3_unit(instances_normal(d->all, hit->instance, n));
        if (vec3_dot(world, vec3((double)ray->dx, (double)ray->dy, (double)ray->dz)) > 0)
            world = vec3_scale(world, -1);
        left = (float)exp(-(double)hit->hit.t / d->fade);
        for (uint32_t k = 0; k < 3; k++)
            tint[k] = (float)(0.35 + 0.3 * vec3_dot(world, light) + 0.1 * vec3_axis(world, (int)k))
                      * (0.7f + 0.3f * (float)(hit->instance * (k + 3) % 7) / 6);
    }
    for (int k = 0; k < 3; k++)
        rgb[k] = left * tint[k] + (1 - left) * sky[k];
}

static void draw_tile(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Drawing *d = context;
    Error err = { 0 };
    (void)worker;
    Ray *ray = array_create(TILE_RAYS, sizeof *ray, "rays", &err);
    InstanceHit *hit = array_create(TILE_RAYS, sizeof *hit, "hits", &err);
    for (uint32_t tile = begin; tile < end && !error_is_set(&err); tile++) {
        uint32_t x, y;
        for (uint32_t k = 0; k < TILE_RAYS; k++) {
            pixel(tile, k, &x, &y);
            ray[k] = eye_ray(d, x, y);
        }
        if (!instances_nearest_many(d->all, ray, hit, TILE_RAYS, true, &err))
            break;
        for (uint32_t k = 0; k < TILE_RAYS; k++) {
            pixel(tile, k, &x, &y);
            shade(d, &ray[k], &hit[k], &d->image->radiance[3 * (WIDE * (size_t)y + x)]);
            d->image->depth[WIDE * (size_t)y + x] = hit[k].hit.t;
        }
    }
    array_free(ray);
    array_free(hit);
    assert(!error_is_set(&err)); /* a few hundred kilobytes */
}

static void look(Drawing *d)
{
    Vec3 lo, hi;
    instances_bounds(d->all, &lo, &hi);
    d->eye = vec3_lerp(lo, hi, -0.12);
    d->eye.y += 0.25 * (hi.y - lo.y);
    d->ahead = vec3_unit(vec3_sub(vec3_lerp(lo, hi, 0.5), d->eye));
    d->right = vec3_unit(vec3_cross(d->ahead, vec3(0, 1, 0)));
    d->up = vec3_cross(d->right, d->ahead);
    d->fade = 0.8 * vec3_length(vec3_sub(hi, lo));
}

bool copies_draw(const Model *model, uint32_t count, unsigned threads, const char *path,
                 Error *err)
{
    const Primitives in = { .position = model->position, .corner = model->corner,
                            .vertex_count = model->vertex_count,
                            .triangle_count = model->triangle_count };
    Drawing d = { .model = model };
    InstancesStats stats;
    BvhStats tree;
    struct rusage use;
    Bvh *bvh = bvh_create(&in, threads, err);
    d.all = bvh != NULL ? lattice(model, bvh, count, threads, err) : NULL;
    d.image = image_create(WIDE, HIGH, err);
    if (d.all != NULL && d.image != NULL) {
        look(&d);
        const double begin = bench_now();
        parallel_for(WIDE / TILE * (HIGH / TILE), 1, threads, draw_tile, &d, NULL, NULL);
        const double seconds = bench_now() - begin;
        instances_stats(d.all, &stats);
        bvh_stats(bvh, &tree);
        getrusage(RUSAGE_SELF, &use);
        printf("%-16s copies     %u  %.3g triangles in %u copies of %.1f MB, places %.2f MB; "
               "%.2f Mrays/s, %.0f MB at most\n", model->name, threads, (double)stats.triangles,
               count, 1e-6 * (double)tree.bytes, 1e-6 * (double)stats.bytes,
               1e-6 * WIDE * HIGH / seconds, (double)use.ru_maxrss / 1024);
        image_write_png(d.image, 0, &(ImageInfo){ .scene = model->name }, path, err);
    }
    image_destroy(d.image);
    instances_destroy(d.all);
    bvh_destroy(bvh);
    return !error_is_set(err);
}
