/* SPDX-License-Identifier: BSD-3-Clause */
/* The public face of the tree: making it, choosing the kernel, asking it. */
#include "raycast/bvh.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/array.h"
#include "raycast/build.h"
#include "raycast/pairs.h"
#include "raycast/probe.h"
#include "raycast/sort.h"

static double seconds_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* --- kernels --------------------------------------------------------------------------------- */

typedef struct {
    const Kernel *kernel;
    bool          usable;
} KernelChoice;

#define KERNELS 4

/* The best first. */
static void kernel_choices(KernelChoice choice[KERNELS])
{
    memset(choice, 0, KERNELS * sizeof *choice);
    int n = 0;
#ifdef ISOLUX_X86
    __builtin_cpu_init();
    const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")
                      && __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("popcnt");
    choice[n].kernel = &kernel_avx512;
    choice[n++].usable = avx2 && __builtin_cpu_supports("avx512f")
                         && __builtin_cpu_supports("avx512vl")
                         && __builtin_cpu_supports("avx512dq")
                         && __builtin_cpu_supports("avx512bw");
    choice[n++] = (KernelChoice){ &kernel_avx2, avx2 };
    choice[n++] = (KernelChoice){ &kernel_sse42, __builtin_cpu_supports("sse4.2") };
#endif
    choice[n] = (KernelChoice){ &kernel_scalar, true };
}

const Kernel *kernel_choose(Error *err)
{
    KernelChoice choice[KERNELS];
    kernel_choices(choice);
    const char *wish = getenv("ISOLUX_ISA");
    const bool any = wish == NULL || wish[0] == '\0';
    for (int i = 0; i < KERNELS; i++)
        if (choice[i].usable && (any || strcmp(wish, choice[i].kernel->name) == 0))
            return choice[i].kernel;
    error_set(err, ERROR_USAGE, "ISOLUX_ISA: this processor or build has no \"%.40s\" "
              "(there is avx512, avx2, sse4.2, scalar)", wish);
    return NULL;
}

/* --- the tree -------------------------------------------------------------------------------- */

/* The slower build; what it cannot hold within BVH_DEPTH the ordinary one can. Takes `ref`. */
static bool build_high(Bvh *bvh, const Primitives *in, Ref *ref, uint32_t count, unsigned threads,
                       Error *err)
{
    Pairs pairs;
    bool deep = false;
    bool good = pairs_build(&pairs, in, ref, count, threads, err)
                && pairs_reinsert(&pairs, threads, err)
                && pairs_collapse(bvh, &pairs, in, threads, &deep, err);
    array_free(pairs.pair);
    bvh->cut = good && !deep;
    if (good && deep) {
        ref = refs_create(in, threads, &count, err);
        good = ref != NULL && tree_build(bvh, in, ref, count, threads, err);
    }
    return good;
}

Bvh *bvh_create(const Primitives *primitives, unsigned threads, Error *err)
{
    return bvh_create_as(primitives, BVH_MEDIUM, threads, err);
}

Bvh *bvh_create_as(const Primitives *primitives, BvhQuality quality, unsigned threads, Error *err)
{
    assert(primitives != NULL && err != NULL);
    assert(primitives->triangle_count == 0
           || (primitives->corner != NULL && primitives->position != NULL));
    assert(primitives->shape_count == 0 || primitives->shape != NULL);
    if (error_is_set(err))
        return NULL;
    const double start = seconds_now();
    const Kernel *kernel = kernel_choose(err);
    Bvh *bvh = array_create(1, sizeof *bvh, "tree of boxes", err);
    if (bvh == NULL)
        return NULL;
    uint32_t count = 0;
    Ref *ref = refs_create(primitives, threads, &count, err);
    if (ref == NULL)
        return bvh_destroy(bvh);
    bvh->kernel = kernel;
    bvh->triangle_count = primitives->triangle_count;
    bvh->flat_count = primitives->triangle_count + primitives->shape_count - count;
    const bool good = quality == BVH_HIGH && count > 0
                          ? build_high(bvh, primitives, ref, count, threads, err)
                          : tree_build(bvh, primitives, ref, count, threads, err);
    bvh->seconds = seconds_now() - start;
    return good ? bvh : bvh_destroy(bvh);
}

Bvh *bvh_destroy(Bvh *bvh)
{
    if (bvh != NULL)
        array_free(bvh->memory);
    return array_free(bvh);
}

void bvh_stats(const Bvh *bvh, BvhStats *stats)
{
    assert(bvh != NULL && stats != NULL);
    *stats = (BvhStats){ .triangles = bvh->triangle_count, .shapes = bvh->shape_count,
                         .nodes = bvh->node_count, .bytes = bvh->bytes + sizeof *bvh,
                         .seconds = bvh->seconds };
}

const char *bvh_isa(const Bvh *bvh)
{
    assert(bvh != NULL);
    return bvh->kernel->name;
}

/* Rays that look for the nearest hit are sorted in blocks that stay in the cache next to a small
 * tree; a large tree does not fit anyway, and larger blocks have more rays that go the same way. */
#define SORT_BLOCK 16384u
#define SORT_TREE ((size_t)32 << 20)

/* Fewer rays than this are not worth sorting. */
#define SORT_LEAST 64u

#define CACHE_LINE 64u

/* --- queries --------------------------------------------------------------------------------- */

bool bvh_nearest(const Bvh *bvh, const Ray *ray, Hit *hit)
{
    assert(bvh != NULL && ray != NULL && hit != NULL);
    return bvh->kernel->nearest(bvh, ray, hit);
}

bool bvh_blocked(const Bvh *bvh, const Ray *ray)
{
    assert(bvh != NULL && ray != NULL);
    return bvh->kernel->blocked(bvh, ray);
}

/* Not cleared: that would take as long as the sorting. Without memory to sort in rays are traced as
 * they come: slower, the same answers. */
static Sorter *sorter_create(const Bvh *bvh, size_t count, size_t most)
{
    Error none = { 0 };
    void *memory = NULL;
    size_t capacity = 0;
    const size_t n = count < most ? count : most;
    const size_t words = 2 * n + SORT_FIRST(n);
    if (bvh->kernel->keys == NULL || count < SORT_LEAST
        || !array_reserve(&memory, &capacity,
                          CACHE_LINE + n * sizeof(Ray) + words * sizeof(uint32_t) + sizeof(Sorter)
                              + _Alignof(Sorter),
                          1, "order of rays", &none))
        return NULL;
    char *at = (char *)memory + (CACHE_LINE - (uintptr_t)memory % CACHE_LINE);
    Ray *sorted = (Ray *)(void *)at;
    uint32_t *word = (uint32_t *)(void *)(at + n * sizeof(Ray));
    char *rest = (char *)(word + words);
    rest += (_Alignof(Sorter) - (uintptr_t)rest % _Alignof(Sorter)) % _Alignof(Sorter);
    Sorter *sorter = (Sorter *)(void *)rest;
    *sorter = (Sorter){ .memory = memory, .most = n, .ray = sorted, .key = word,
                        .order = word + n, .first = word + 2 * n };
    return sorter;
}

static void sorter_destroy(Sorter *sorter)
{
    if (sorter != NULL)
        array_free(sorter->memory);
}

void bvh_nearest_many(const Bvh *bvh, const Ray *ray, Hit *hit, size_t count)
{
    assert(bvh != NULL && (count == 0 || (ray != NULL && hit != NULL)));
    const size_t most = bvh->bytes < SORT_TREE ? SORT_BLOCK : SORT_MOST;
    Sorter *sorter = sorter_create(bvh, count, most);
    if (sorter == NULL)
        bvh->kernel->nearest_many(bvh, ray, NULL, count, hit);
    for (size_t begin = 0; sorter != NULL && begin < count; begin += most) {
        const size_t n = count - begin < most ? count - begin : most;
        rays_sort(sorter, bvh, ray + begin, n);
        bvh->kernel->nearest_many(bvh, sorter->ray, sorter->order, n, hit + begin);
    }
    sorter_destroy(sorter);
}

void bvh_blocked_many(const Bvh *bvh, const Ray *ray, bool *blocked, size_t count)
{
    assert(bvh != NULL && (count == 0 || (ray != NULL && blocked != NULL)));
    Sorter *sorter = sorter_create(bvh, count, SORT_MOST);
    if (sorter == NULL)
        bvh->kernel->blocked_many(bvh, ray, NULL, count, blocked);
    for (size_t begin = 0; sorter != NULL && begin < count; begin += SORT_MOST) {
        const size_t n = count - begin < SORT_MOST ? count - begin : SORT_MOST;
        rays_sort(sorter, bvh, ray + begin, n);
        bvh->kernel->blocked_many(bvh, sorter->ray, sorter->order, n, blocked + begin);
    }
    sorter_destroy(sorter);
}

void bvh_nearest_beam(const Bvh *bvh, const Ray *ray, Hit *hit, size_t count)
{
    assert(bvh != NULL && (count == 0 || (ray != NULL && hit != NULL)));
    bvh->kernel->nearest_many(bvh, ray, NULL, count, hit);
}

void bvh_blocked_beam(const Bvh *bvh, const Ray *ray, bool *blocked, size_t count)
{
    assert(bvh != NULL && (count == 0 || (ray != NULL && blocked != NULL)));
    bvh->kernel->blocked_many(bvh, ray, NULL, count, blocked);
}
