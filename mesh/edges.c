/* SPDX-License-Identifier: BSD-3-Clause */
/* Edge table: uses are dealt into buckets by their smaller vertex, buckets sorted by the larger. */
#include "mesh/edges.h"

#include <assert.h>
#include <stdlib.h>

#include "base/array.h"

static int key_compare(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

void edges_sort_keys(uint64_t *key, uint32_t n)
{
    enum { SHORT = 24 }; /* below, moving neighbours is quicker than calling back */
    if (n > SHORT) {
        qsort(key, n, sizeof *key, key_compare);
        return;
    }
    for (uint32_t i = 1; i < n; i++) {
        const uint64_t k = key[i];
        uint32_t j = i;
        for (; j > 0 && key[j - 1] > k; j--)
            key[j] = key[j - 1];
        key[j] = k;
    }
}

static uint32_t min_u32(uint32_t a, uint32_t b) { return a < b ? a : b; }
static uint32_t max_u32(uint32_t a, uint32_t b) { return a > b ? a : b; }

/* key: larger vertex above, use below; bucket v holds bucket[v] .. bucket[v + 1] - 1. */
static void edges_deal(const uint32_t *from, const uint32_t *to, uint32_t use_count,
                       uint32_t vertex_count, uint32_t *bucket, uint64_t *key)
{
    for (uint32_t i = 0; i < use_count; i++)
        if (from[i] != to[i]) {
            assert(from[i] < vertex_count && to[i] < vertex_count);
            bucket[min_u32(from[i], to[i]) + 2]++;
        }
    for (uint32_t v = 2; v < vertex_count + 2; v++)
        bucket[v] += bucket[v - 1];
    /* Filling moves bucket[v + 1] from v's start to v's end, which is where v + 1 starts. */
    for (uint32_t i = 0; i < use_count; i++)
        if (from[i] != to[i]) {
            const uint32_t lo = min_u32(from[i], to[i]);
            key[bucket[lo + 1]++] = (uint64_t)max_u32(from[i], to[i]) << 32 | i;
        }
    for (uint32_t v = 0; v < vertex_count; v++)
        edges_sort_keys(key + bucket[v], bucket[v + 1] - bucket[v]);
}

static void edges_gather(Edges *edges, const uint32_t *bucket, const uint64_t *key,
                         uint32_t vertex_count)
{
    uint32_t count = 0;
    for (uint32_t v = 0; v < vertex_count; v++)
        for (uint32_t i = bucket[v]; i < bucket[v + 1]; i++) {
            if (i == bucket[v] || key[i] >> 32 != key[i - 1] >> 32)
                edges->first[count++] = i;
            edges->use[i] = (uint32_t)key[i];
            edges->edge[edges->use[i]] = count - 1;
        }
    edges->first[count] = bucket[vertex_count];
    edges->count = count;
}

bool edges_create(Edges *edges, const uint32_t *from, const uint32_t *to, uint32_t use_count,
                  uint32_t vertex_count, Error *err)
{
    assert(edges != NULL && err != NULL && (use_count == 0 || (from != NULL && to != NULL)));
    assert(vertex_count < UINT32_MAX - 2);
    *edges = (Edges){ .use_count = use_count };
    uint32_t *bucket = array_create((size_t)vertex_count + 2, sizeof *bucket, "edges", err);
    uint64_t *key = array_create(use_count, sizeof *key, "edges", err);
    edges->first = array_create((size_t)use_count + 1, sizeof *edges->first, "edges", err);
    edges->use = array_create(use_count, sizeof *edges->use, "edges", err);
    edges->edge = array_create(use_count, sizeof *edges->edge, "edges", err);
    if (!error_is_set(err)) {
        for (uint32_t i = 0; i < use_count; i++)
            edges->edge[i] = EDGE_NONE;
        edges_deal(from, to, use_count, vertex_count, bucket, key);
        edges_gather(edges, bucket, key, vertex_count);
    } else {
        edges_clear(edges);
    }
    array_free(bucket);
    array_free(key);
    return !error_is_set(err);
}

void edges_clear(Edges *edges)
{
    array_free(edges->first);
    array_free(edges->use);
    array_free(edges->edge);
    *edges = (Edges){ 0 };
}
