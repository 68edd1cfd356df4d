/* SPDX-License-Identifier: BSD-3-Clause */
/* The rays that a radiosity solver casts: hemispheres over whole tiles of neighbouring patches,
 * segments between points that face each other, and those of a camera. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "bench/bench.h"
#include "math/sampling.h"

/* A million patches of one size, in Morton order; tiles of neighbours all over the scene. */
enum { PATCHES = 1000000, TILE = 1024, TILES = 8, SIDE = 16, PER_PATCH = SIDE * SIDE };
enum { SEGMENTS = 1 << 20, PICTURE = 1024, PICTURE_TILE = 16 };

const char *work_name(Work work)
{
    static const char *const names[] = { "hemisphere", "visibility", "primary" };
    assert((unsigned)work < WORKS);
    return names[work];
}

typedef struct {
    Vec3     point, normal;
    uint64_t key;
} Patch;

static double *area_sums(const Model *m, Error *err)
{
    double *sum = array_create(m->triangle_count + 1, sizeof *sum, "areas", err);
    for (uint32_t i = 0; sum != NULL && i < m->triangle_count; i++) {
        const uint32_t *c = &m->corner[(size_t)3 * i];
        const Vec3 a = m->position[c[0]];
        sum[i + 1] = sum[i] + 0.5 * vec3_length(vec3_cross(vec3_sub(m->position[c[1]], a),
                                                           vec3_sub(m->position[c[2]], a)));
    }
    return sum;
}

/* The point at a share of the whole area, and a, b in its triangle. */
static Patch point_at(const Model *m, const double *sum, double share, double a, double b)
{
    uint32_t low = 0, high = m->triangle_count - 1;
    const double wanted = share * sum[m->triangle_count];
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (sum[middle + 1] > wanted)
            high = middle;
        else
            low = middle + 1;
    }
    const uint32_t *c = &m->corner[(size_t)3 * low];
    const Vec3 o = m->position[c[0]], e = vec3_sub(m->position[c[1]], o);
    const Vec3 f = vec3_sub(m->position[c[2]], o);
    double u, v;
    sampling_triangle(a, b, &u, &v);
    return (Patch){ .point = vec3_mad(vec3_mad(o, u, e), v, f),
                    .normal = vec3_unit(vec3_cross(e, f)) };
}

static uint64_t spread(uint64_t x)
{
    uint64_t r = 0;
    for (int b = 0; b < 16; b++)
        r |= (x >> b & 1) << 3 * b;
    return r;
}

static uint64_t morton(const Model *m, Vec3 p)
{
    const Vec3 size = vec3_sub(m->hi, m->lo);
    const double largest = fmax(fmax(size.x, size.y), size.z);
    uint64_t key = 0;
    for (int k = 0; k < 3; k++)
        key |= spread((uint64_t)(65535 * vec3_axis(vec3_sub(p, m->lo), k) / largest)) << k;
    return key;
}

static int by_key(const void *a, const void *b)
{
    const uint64_t x = ((const Patch *)a)->key, y = ((const Patch *)b)->key;
    return (x > y) - (x < y);
}

static Patch *make_patches(const Model *m, Error *err)
{
    double *sum = area_sums(m, err);
    Patch *patch = array_create(PATCHES, sizeof *patch, "patches", err);
    for (uint32_t i = 0; !error_is_set(err) && i < PATCHES; i++) {
        float x[2];
        sampling_sobol2(i, 7, x);
        patch[i] = point_at(m, sum, (i + 0.5) / PATCHES, x[0], x[1]);
        patch[i].key = morton(m, patch[i].point);
    }
    array_free(sum);
    if (patch != NULL)
        qsort(patch, PATCHES, sizeof *patch, by_key);
    return patch;
}

static double offset_of(const Model *m)
{
    return 1e-5 * vec3_length(vec3_sub(m->hi, m->lo));
}

static uint32_t every_other_bit(uint32_t x)
{
    uint32_t r = 0;
    for (uint32_t b = 0; b < 16; b++)
        r |= (x >> 2 * b & 1) << b;
    return r;
}

/* Jittered strata in Morton order; `ray` has the same at random within the patch. */
static void patch_rays(const Model *m, const Patch *p, uint32_t number, Ray *tiled, Ray *ray)
{
    Vec3 s, t;
    vec3_frame(p->normal, &s, &t);
    for (uint32_t k = 0; k < PER_PATCH; k++) {
        float x[2];
        sampling_sobol2(k, sampling_seed(number, 5, 0, 0), x);
        const double a = (every_other_bit(k) + (double)x[0]) / SIDE;
        const double b = (every_other_bit(k >> 1) + (double)x[1]) / SIDE;
        const Vec3 l = sampling_cosine(a, b);
        const Vec3 d = vec3_mad(vec3_mad(vec3_scale(s, l.x), l.y, t), l.z, p->normal);
        tiled[k] = ray_leaving(p->point, p->normal, offset_of(m), d, INFINITY);
        ray[k] = tiled[k];
    }
    for (uint32_t k = PER_PATCH - 1; k > 0; k--) {
        const uint32_t other = sampling_seed(number, k, 9, 0) % (k + 1);
        const Ray swap = ray[k];
        ray[k] = ray[other];
        ray[other] = swap;
    }
}

static bool make_hemispheres(RaySet *set, const Model *m, Error *err)
{
    Patch *patch = make_patches(m, err);
    set->count = TILES * TILE * PER_PATCH;
    set->batch = TILE / 4 * PER_PATCH;
    set->ray = array_create(set->count, sizeof *set->ray, "rays", err);
    set->tiled = array_create(set->count, sizeof *set->ray, "rays", err);
    set->mixed = array_create(set->count, sizeof *set->ray, "rays", err);
    for (uint32_t i = 0; !error_is_set(err) && i < TILES * TILE; i++) {
        /* Tiles in the middle of equal parts of the curve. */
        const uint32_t from = PATCHES / TILES * (i / TILE) + PATCHES / TILES / 2 + i % TILE;
        const uint32_t to = (uint32_t)((uint64_t)i * 5003 % (TILES * TILE)); /* a permutation */
        const size_t at = (size_t)i * PER_PATCH;
        patch_rays(m, &patch[from], i, set->tiled + at, set->ray + at);
        memcpy(set->mixed + (size_t)to * PER_PATCH, set->tiled + at, PER_PATCH * sizeof(Ray));
    }
    array_free(patch);
    return !error_is_set(err);
}

static bool make_segments(RaySet *set, const Model *m, Error *err)
{
    double *sum = area_sums(m, err);
    set->count = SEGMENTS;
    set->batch = 65536;
    set->ray = array_create(set->count, sizeof *set->ray, "rays", err);
    for (uint32_t i = 0, tries = 0; !error_is_set(err) && i < SEGMENTS; tries++) {
        float x[4], y[4];
        sampling_sobol4(tries, 21, x);
        sampling_sobol4(tries, 22, y);
        const Patch p = point_at(m, sum, (double)x[0], (double)x[1], (double)x[2]);
        const Patch q = point_at(m, sum, (double)y[0], (double)y[1], (double)y[2]);
        const Vec3 d = vec3_sub(q.point, p.point);
        if (tries < 64u * SEGMENTS && (vec3_dot(p.normal, d) <= 0 || vec3_dot(q.normal, d) >= 0))
            continue;
        set->ray[i++] = ray_between(p.point, p.normal, q.point, q.normal, offset_of(m));
    }
    array_free(sum);
    return !error_is_set(err);
}

static bool make_picture(RaySet *set, const Model *m, Error *err)
{
    const Vec3 ahead = vec3_unit(vec3_sub(m->target, m->eye));
    const Vec3 right = vec3_unit(vec3_cross(ahead, vec3(0, 1, 0))), up = vec3_cross(right, ahead);
    const double half = tan(m->fov * M_PI / 360);
    const uint32_t tiles = PICTURE / PICTURE_TILE, pixels = PICTURE_TILE * PICTURE_TILE;
    set->count = PICTURE * PICTURE;
    set->batch = 4096;
    set->ray = array_create(set->count, sizeof *set->ray, "rays", err);
    for (uint32_t i = 0; !error_is_set(err) && i < set->count; i++) {
        const uint32_t tile = i / pixels, k = i % pixels;
        const uint32_t px = tile % tiles * PICTURE_TILE + every_other_bit(k);
        const uint32_t py = tile / tiles * PICTURE_TILE + every_other_bit(k >> 1);
        const double x = 2 * (px + 0.5) / PICTURE - 1, y = 1 - 2 * (py + 0.5) / PICTURE;
        const Vec3 d = vec3_unit(vec3_mad(vec3_mad(ahead, half * x, right), half * y, up));
        set->ray[i] = (Ray){ .ox = (float)m->eye.x, .oy = (float)m->eye.y, .oz = (float)m->eye.z,
                             .dx = (float)d.x, .dy = (float)d.y, .dz = (float)d.z,
                             .t_max = INFINITY };
    }
    return !error_is_set(err);
}

bool rays_make(RaySet *set, const Model *model, Work work, Error *err)
{
    *set = (RaySet){ .work = work };
    if (work == WORK_HEMISPHERE)
        return make_hemispheres(set, model, err);
    const bool good = work == WORK_VISIBILITY ? make_segments(set, model, err)
                                              : make_picture(set, model, err);
    set->tiled = set->mixed = set->ray;
    return good;
}

void rays_clear(RaySet *set)
{
    if (set->tiled != set->ray) {
        array_free(set->tiled);
        array_free(set->mixed);
    }
    array_free(set->ray);
    *set = (RaySet){ 0 };
}
