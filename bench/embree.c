/* SPDX-License-Identifier: BSD-3-Clause */
/* Embree 3 on the same rays. Filling its ray structures is part of the time: whoever calls it has
 * rays in another form first. */
#ifdef BENCH_EMBREE

#include <embree3/rtcore.h>
#include <math.h>
#include <pmmintrin.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xmmintrin.h>

#include "base/parallel.h"
#include "bench/bench.h"

enum { STREAM = 1024, GRAB = 4096, SUMS = 64 };

struct Peer {
    RTCDevice device;
    RTCScene  scene;
    atomic_llong bytes;
};

static bool count_bytes(void *user, ssize_t bytes, bool post)
{
    (void)post;
    atomic_fetch_add(&((Peer *)user)->bytes, bytes);
    return true;
}

int peer_modes(Work work, PeerMode mode[PEER_MODES_MAX])
{
    static const struct {
        const char *name;
        int         width;
        bool        coherent;
    } way[] = { { "1", 1, false }, { "8", 8, false }, { "16", 16, false }, { "1M", -1, false },
                { "NM", 0, false }, { "8 coherent", 8, true }, { "16 coherent", 16, true },
                { "1M coherent", -1, true }, { "NM coherent", 0, true } };
    static const char *const order[] = { "random", "tiled", "tiled, patches at random" };
    static char names[WORKS][PEER_MODES_MAX][64];
    int count = 0;
    for (int o = 0; o < (work == WORK_HEMISPHERE ? 3 : 1); o++)
        for (size_t w = 0; w < sizeof way / sizeof *way; w++) {
            snprintf(names[work][count], sizeof names[work][count], "%s, %s", way[w].name,
                     work == WORK_HEMISPHERE ? order[o] : "as given");
            mode[count] = (PeerMode){ names[work][count], way[w].width, o, way[w].coherent };
            count++;
        }
    return count;
}

Peer *peer_create(const Model *model, unsigned threads, double *build_seconds, uint64_t *bytes)
{
    char config[64];
    Peer *peer = calloc(1, sizeof *peer);
    snprintf(config, sizeof config, "threads=%u", threads);
    peer->device = rtcNewDevice(config);
    rtcSetDeviceMemoryMonitorFunction(peer->device, count_bytes, peer);
    RTCGeometry g = rtcNewGeometry(peer->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *v = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                       3 * sizeof *v, model->vertex_count);
    for (uint32_t i = 0; i < model->vertex_count; i++)
        for (int k = 0; k < 3; k++)
            v[3 * (size_t)i + (size_t)k] = (float)vec3_axis(model->position[i], k);
    uint32_t *c = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          3 * sizeof *c, model->triangle_count);
    memcpy(c, model->corner, (size_t)3 * model->triangle_count * sizeof *c);
    const long long before = atomic_load(&peer->bytes);
    const double begin = bench_now();
    rtcCommitGeometry(g);
    peer->scene = rtcNewScene(peer->device);
    rtcAttachGeometry(peer->scene, g);
    rtcCommitScene(peer->scene);
    *build_seconds = bench_now() - begin;
    *bytes = (uint64_t)(atomic_load(&peer->bytes) - before);
    rtcReleaseGeometry(g);
    return peer;
}

Peer *peer_destroy(Peer *peer)
{
    if (peer == NULL)
        return NULL;
    rtcReleaseScene(peer->scene);
    rtcReleaseDevice(peer->device);
    free(peer);
    return NULL;
}

typedef struct {
    const Peer     *peer;
    const Ray      *ray;
    const PeerMode *mode;
    bool            any;
    Traced          sum[SUMS]; /* of each thread */
} Job;

/* --- one width after the other --------------------------------------------------------------- */

static void single(const Job *job, const Ray *ray, uint32_t n, struct RTCIntersectContext *c,
                   Traced *sum)
{
    for (uint32_t i = 0; i < n; i++) {
        struct RTCRayHit h = {
            .ray = { .org_x = ray[i].ox, .org_y = ray[i].oy, .org_z = ray[i].oz,
                     .dir_x = ray[i].dx, .dir_y = ray[i].dy, .dir_z = ray[i].dz,
                     .tnear = ray[i].t_min, .tfar = ray[i].t_max, .mask = ~0u } };
        h.hit.geomID = h.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        if (job->any) {
            rtcOccluded1(job->peer->scene, c, &h.ray);
            sum->hits += h.ray.tfar < 0;
            continue;
        }
        rtcIntersect1(job->peer->scene, c, &h);
        if (h.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
            sum->hits++;
            sum->primitives += h.hit.primID;
        }
    }
}

#define PACKETS(WIDTH)                                                                          \
    static void packets##WIDTH(const Job *job, const Ray *ray, uint32_t n,                      \
                               struct RTCIntersectContext *c, Traced *sum)                      \
    {                                                                                           \
        int valid[WIDTH] __attribute__((aligned(64)));                                          \
        for (int k = 0; k < WIDTH; k++)                                                         \
            valid[k] = -1;                                                                      \
        for (uint32_t i = 0; i < n; i += WIDTH) {                                               \
            struct RTCRayHit##WIDTH p;                                                          \
            for (uint32_t k = 0; k < WIDTH; k++) {                                              \
                const Ray *r = &ray[i + k];                                                     \
                p.ray.org_x[k] = r->ox, p.ray.org_y[k] = r->oy, p.ray.org_z[k] = r->oz;         \
                p.ray.dir_x[k] = r->dx, p.ray.dir_y[k] = r->dy, p.ray.dir_z[k] = r->dz;         \
                p.ray.tnear[k] = r->t_min, p.ray.tfar[k] = r->t_max;                            \
                p.ray.time[k] = 0, p.ray.mask[k] = ~0u;                                         \
                p.ray.id[k] = p.ray.flags[k] = 0;                                               \
                p.hit.geomID[k] = p.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;                 \
            }                                                                                   \
            if (job->any)                                                                       \
                rtcOccluded##WIDTH(valid, job->peer->scene, c, (struct RTCRay##WIDTH *)&p);     \
            else                                                                                \
                rtcIntersect##WIDTH(valid, job->peer->scene, c, &p);                            \
            for (uint32_t k = 0; k < WIDTH; k++) {                                              \
                const bool hit = job->any ? p.ray.tfar[k] < 0                                   \
                                          : p.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;         \
                sum->hits += hit;                                                               \
                sum->primitives += hit && !job->any ? p.hit.primID[k] : 0;                      \
            }                                                                                   \
        }                                                                                       \
    }

PACKETS(8)
PACKETS(16)

static void stream(const Job *job, const Ray *ray, uint32_t n, struct RTCIntersectContext *c,
                   Traced *sum)
{
    static _Thread_local struct RTCRayHit h[STREAM];
    for (uint32_t i = 0; i < n; i++) {
        h[i].ray = (struct RTCRay){ .org_x = ray[i].ox, .org_y = ray[i].oy, .org_z = ray[i].oz,
                                    .dir_x = ray[i].dx, .dir_y = ray[i].dy, .dir_z = ray[i].dz,
                                    .tnear = ray[i].t_min, .tfar = ray[i].t_max, .mask = ~0u };
        h[i].hit.geomID = h[i].hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    }
    if (job->any)
        rtcOccluded1M(job->peer->scene, c, &h[0].ray, n, sizeof *h);
    else
        rtcIntersect1M(job->peer->scene, c, h, n, sizeof *h);
    for (uint32_t i = 0; i < n; i++) {
        const bool hit = job->any ? h[i].ray.tfar < 0 : h[i].hit.geomID != RTC_INVALID_GEOMETRY_ID;
        sum->hits += hit;
        sum->primitives += hit && !job->any ? h[i].hit.primID : 0;
    }
}

/* Arrays of coordinates: RTCRayHitN has 12 of a ray, then Ng, u, v, primID, geomID, instID. */
static void stream_arrays(const Job *job, const Ray *ray, uint32_t n,
                          struct RTCIntersectContext *c, Traced *sum)
{
    static _Thread_local float b[20 * STREAM] __attribute__((aligned(64)));
    uint32_t *u = (uint32_t *)b;
    for (uint32_t i = 0; i < n; i++) {
        const float *r = (const float *)&ray[i];
        for (uint32_t k = 0; k < 7; k++)
            b[k * n + i] = r[k];
        b[7 * n + i] = 0;
        b[8 * n + i] = ray[i].t_max;
        u[9 * n + i] = ~0u;
        u[10 * n + i] = u[11 * n + i] = 0;
        u[18 * n + i] = u[19 * n + i] = RTC_INVALID_GEOMETRY_ID;
    }
    if (job->any)
        rtcOccludedNM(job->peer->scene, c, (struct RTCRayN *)b, n, 1, 20 * n * sizeof *b);
    else
        rtcIntersectNM(job->peer->scene, c, (struct RTCRayHitN *)b, n, 1, 20 * n * sizeof *b);
    for (uint32_t i = 0; i < n; i++) {
        const bool hit = job->any ? b[8 * n + i] < 0 : u[18 * n + i] != RTC_INVALID_GEOMETRY_ID;
        sum->hits += hit;
        sum->primitives += hit && !job->any ? u[17 * n + i] : 0;
    }
}

static void trace_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Job *job = context;
    struct RTCIntersectContext c;
    rtcInitIntersectContext(&c);
    c.flags = job->mode->coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                  : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    /* Embree's manual asks every tracing thread for this. */
    const unsigned state = _mm_getcsr();
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    Traced *sum = &job->sum[worker];
    for (uint32_t i = begin; i < end; i += STREAM) {
        const uint32_t n = end - i < STREAM ? end - i : STREAM;
        const int w = job->mode->width;
        (w == 1    ? single
         : w == 8  ? packets8
         : w == 16 ? packets16
         : w == 0  ? stream_arrays
                   : stream)(job, job->ray + i, n, &c, sum);
    }
    _mm_setcsr(state);
}

Traced peer_trace(const Peer *peer, const RaySet *set, const PeerMode *mode, unsigned threads)
{
    Job job = { .peer = peer, .mode = mode, .any = set->work == WORK_VISIBILITY };
    job.ray = mode->order == 0 ? set->ray : mode->order == 1 ? set->tiled : set->mixed;
    const double begin = bench_now();
    parallel_for(set->count, GRAB, threads, trace_chunk, &job, NULL, NULL);
    Traced all = { .seconds = bench_now() - begin };
    for (int i = 0; i < SUMS; i++) {
        all.hits += job.sum[i].hits;
        all.primitives += job.sum[i].primitives;
    }
    return all;
}

#else

#include "bench/bench.h"

int peer_modes(Work work, PeerMode mode[PEER_MODES_MAX])
{
    (void)work, (void)mode;
    return 0;
}
Peer *peer_create(const Model *model, unsigned threads, double *build_seconds, uint64_t *bytes)
{
    (void)model, (void)threads, (void)build_seconds, (void)bytes;
    return NULL;
}
Peer *peer_destroy(Peer *peer) { return peer; }
Traced peer_trace(const Peer *peer, const RaySet *set, const PeerMode *mode, unsigned threads)
{
    (void)peer, (void)set, (void)mode, (void)threads;
    return (Traced){ 0 };
}

#endif
