/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux bench: rays per second of three kinds on one thread and on all, what a ray meets, then
 * seconds and memory of each stage. */
#include <assert.h>
#include <math.h>
#include <time.h>

#include "app/commands.h"
#include "app/model.h"
#include "app/summary.h"
#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"

typedef enum { RAYS_CAMERA, RAYS_HEMISPHERE, RAYS_VISIBILITY, RAYS_KINDS } RayKind;

/* A chunk is what one thread takes at a time: enough rays to be traced in company. */
enum { RAY_CHUNK = 16384, RAYS_MOST = 1 << 20 };
/* Hemisphere rays come as a solver casts them: patch by patch, tiles of neighbouring patches. */
enum { PATCH_RAYS = 256, TILE_PATCHES = 512, TILES = RAYS_MOST / PATCH_RAYS / TILE_PATCHES };
/* Rays that are counted what they meet: one in so many, and no divisor of the above. */
enum { COUNT_STEP = 61 };
/* Long enough that starting threads does not count. */
static const double BENCH_SECONDS = 0.5;
enum { PASSES_LEAST = 3 };

typedef struct {
    const Pipeline *pipeline;
    RayKind         kind;
    Ray            *ray;      /* [count] */
    Hit            *hit;      /* [count] */
    bool           *blocked;  /* [count] */
    uint32_t        count;
} Bench;

/* What came out for one kind. */
typedef struct {
    double alone, all;       /* rays per second on one thread, on all */
    double nodes, triangles; /* that a ray meets when it is traced alone */
} RayFigures;

static const char *kind_name(RayKind kind)
{
    static const char *const names[] = { "primary", "hemisphere", "visibility" };
    assert((unsigned)kind < RAYS_KINDS);
    return names[kind];
}

/* A random point of a random patch. */
static void any_point(const Pipeline *pipeline, uint32_t i, uint32_t salt, PatchPoint *out)
{
    float a[4];
    sampling_sobol4(i, sampling_seed(salt, 1, 2, 3), a);
    uint32_t patch = (uint32_t)(a[0] * (double)pipeline->patches->count);
    if (patch >= pipeline->patches->count)
        patch = pipeline->patches->count - 1;
    patches_point(pipeline->patches, pipeline->surfaces, patch, a[1], a[2], out);
}

/* The point that hemisphere ray i leaves from: tiles begin at equal distances among the patches. */
static void tile_point(const Pipeline *pipeline, uint32_t i, PatchPoint *out)
{
    float a[2];
    const uint32_t at = i / PATCH_RAYS, count = pipeline->patches->count;
    const uint64_t first = (uint64_t)(at / TILE_PATCHES) * count / TILES;
    sampling_sobol2(i % PATCH_RAYS, sampling_seed(4, at, 2, 3), a);
    patches_point(pipeline->patches, pipeline->surfaces,
                  (uint32_t)((first + at % TILE_PATCHES) % count), (double)a[0], (double)a[1],
                  out);
}

static Ray camera_ray(const Bench *bench, uint32_t i)
{
    const Camera *c = &bench->pipeline->camera;
    const Vec3 ahead = vec3_unit(vec3_sub(c->target, c->eye));
    const Vec3 right = vec3_unit(vec3_cross(ahead, c->up)), up = vec3_cross(right, ahead);
    /* Neighbours in a picture are neighbours here: a square of rays, row by row. */
    const uint32_t side = (uint32_t)sqrt((double)bench->count) + 1;
    const double half = tan(c->vertical_fov * 3.14159265358979323846 / 360);
    const double x = 2.0 * (i % side) / side - 1, y = 1 - 2.0 * (i / side) / side;
    const Vec3 d = vec3_mad(vec3_mad(ahead, half * x, right), half * y, up);
    return (Ray){ .ox = (float)c->eye.x, .oy = (float)c->eye.y, .oz = (float)c->eye.z,
                  .dx = (float)d.x, .dy = (float)d.y, .dz = (float)d.z, .t_max = INFINITY };
}

static Ray make_ray(const Bench *bench, uint32_t i)
{
    const Room *room = &bench->pipeline->room;
    PatchPoint p, q;
    float a[2];
    Vec3 s, t;
    if (bench->kind == RAYS_CAMERA)
        return camera_ray(bench, i);
    if (bench->kind == RAYS_VISIBILITY) {
        any_point(bench->pipeline, i, 1, &p);
        any_point(bench->pipeline, i, 2, &q);
        return ray_between(p.point.point, p.point.normal, q.point.point, q.point.normal,
                           room->offset);
    }
    tile_point(bench->pipeline, i, &p);
    sampling_sobol2(i % PATCH_RAYS, sampling_seed(3, i / PATCH_RAYS, 2, 3), a);
    const Vec3 local = sampling_cosine(a[0], a[1]);
    vec3_frame(p.point.normal, &s, &t);
    const Vec3 d = vec3_mad(vec3_mad(vec3_scale(s, local.x), local.y, t), local.z, p.point.normal);
    return ray_leaving(p.point.point, p.point.normal, room->offset, d, INFINITY);
}

static void fill_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Bench *bench = context;
    (void)worker;
    for (uint32_t i = begin; i < end; i++)
        bench->ray[i] = make_ray(bench, i);
}

static void trace_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Bench *bench = context;
    (void)worker;
    if (bench->kind == RAYS_VISIBILITY)
        bvh_blocked_many(bench->pipeline->bvh, bench->ray + begin, bench->blocked + begin,
                         end - begin);
    else
        (bench->kind == RAYS_CAMERA ? bvh_nearest_beam : bvh_nearest_many)(
            bench->pipeline->bvh, bench->ray + begin, bench->hit + begin, end - begin);
}

/* For one thread that of the processor: what else the machine does counts less. */
static double clock_seconds(unsigned threads)
{
    struct timespec t;
    clock_gettime(threads == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Rays per second of one kind, tracing alone: rays are made before the clock starts. The fastest
 * pass over all of them counts: what else the machine does only ever makes one slower. */
static double ray_rate(Bench *bench, unsigned threads)
{
    double seconds = 0, least = INFINITY;
    for (int pass = 0; pass < PASSES_LEAST || seconds < BENCH_SECONDS; pass++) {
        if (session_stopped(bench->pipeline->session))
            return 0;
        const double begin = clock_seconds(threads);
        parallel_for(bench->count, RAY_CHUNK, threads, trace_chunk, bench, NULL, NULL);
        const double took = clock_seconds(threads) - begin;
        seconds += took;
        least = fmin(least, took);
    }
    return least > 0 ? bench->count / least : 0;
}

static void ray_cost(const Bench *bench, RayFigures *figures)
{
    BvhCost cost = { 0 };
    uint32_t rays = 0;
    for (uint32_t i = 0; i < bench->count; i += COUNT_STEP, rays++)
        bvh_cost(bench->pipeline->bvh, &bench->ray[i], bench->kind == RAYS_VISIBILITY, &cost);
    figures->nodes = (double)cost.nodes / rays;
    figures->triangles = (double)cost.triangles / rays;
}

static RayFigures ray_figures(Bench *bench)
{
    Session *session = bench->pipeline->session;
    const unsigned threads = parallel_threads(session->settings.threads);
    RayFigures figures = { 0 };
    parallel_for(bench->count, RAY_CHUNK, threads, fill_chunk, bench, NULL, NULL);
    ray_cost(bench, &figures);
    figures.alone = figures.all = ray_rate(bench, 1);
    if (threads > 1)
        figures.all = ray_rate(bench, threads);
    session_say(session, "  %-11s%8.2f Mray/s, one thread %.2f; a ray meets %.1f nodes, "
                "%.1f triangles", kind_name(bench->kind), 1e-6 * figures.all,
                1e-6 * figures.alone, figures.nodes, figures.triangles);
    return figures;
}

static bool bench_rays(Pipeline *pipeline, RayFigures figures[RAYS_KINDS], Error *err)
{
    Bench bench = { .pipeline = pipeline, .count = RAYS_MOST };
    bench.ray = array_create(bench.count, sizeof *bench.ray, "rays", err);
    bench.hit = array_create(bench.count, sizeof *bench.hit, "rays", err);
    bench.blocked = array_create(bench.count, sizeof *bench.blocked, "rays", err);
    for (RayKind kind = 0; kind < RAYS_KINDS && !error_is_set(err); kind++) {
        bench.kind = kind;
        figures[kind] = ray_figures(&bench);
    }
    array_free(bench.ray);
    array_free(bench.hit);
    array_free(bench.blocked);
    return !error_is_set(err);
}

static void put_rays(Json *json, const char *workload, unsigned threads, double rate,
                     const RayFigures *figures)
{
    json_open(json, NULL, '{');
    json_text(json, "workload", workload);
    json_count(json, "threads", threads);
    json_number(json, "rays_per_second", rate);
    json_number(json, "nodes_per_ray", figures->nodes);
    json_number(json, "triangles_per_ray", figures->triangles);
    json_close(json, '}');
}

static void put_tree(Json *json, const Pipeline *pipeline)
{
    BvhStats stats;
    bvh_stats(pipeline->bvh, &stats);
    json_text(json, "kernel", bvh_isa(pipeline->bvh));
    json_text(json, "tree", pipeline->session->settings.tree == BVH_HIGH ? "high" : "medium");
    json_number(json, "build_seconds", stats.seconds);
    json_number(json, "bytes_per_triangle",
                stats.triangles > 0 ? (double)stats.bytes / (double)stats.triangles : NAN);
}

static bool write_json(const Pipeline *pipeline, const RayFigures figures[RAYS_KINDS],
                       int exit_code, Error *err)
{
    const unsigned threads = parallel_threads(pipeline->session->settings.threads);
    Summary summary;
    if (!summary_begin(&summary, pipeline->session, exit_code, err, err))
        return false;
    if (summary.file == NULL)
        return true;
    Json *json = &summary.json;
    json_open(json, "bench", '[');
    for (RayKind kind = 0; kind < RAYS_KINDS; kind++) {
        put_rays(json, kind_name(kind), 1, figures[kind].alone, &figures[kind]);
        if (threads > 1)
            put_rays(json, kind_name(kind), threads, figures[kind].all, &figures[kind]);
    }
    json_close(json, ']');
    put_tree(json, pipeline);
    summary_pipeline(json, pipeline);
    json_open(json, "peak_bytes", '{');
    for (Stage stage = 0; stage < STAGE_GATHER; stage++)
        json_count(json, pipeline_stage_name(stage), pipeline->peak[stage]);
    json_close(json, '}');
    return summary_finish(&summary, pipeline->session, err);
}

bool cmd_bench(Pipeline *pipeline, int *exit_code, Error *err)
{
    Session *session = pipeline->session;
    RayFigures figures[RAYS_KINDS] = { 0 };
    if (session->options.scene == NULL) {
        session->options.scene = "the built-in Cornell box";
        pipeline->scene = model_cornell(err);
    } else
        pipeline_read(pipeline, err);
    if (error_is_set(err) || !pipeline_mesh(pipeline, err) || !pipeline_camera(pipeline, err) ||
        !pipeline_patches(pipeline, err))
        return false;
    session_say(session, "isolux: %s, %u threads", session->options.scene,
                parallel_threads(session->settings.threads));
    if (!bench_rays(pipeline, figures, err) || !pipeline_factors(pipeline, err) ||
        !pipeline_solve(pipeline, err))
        return false;
    for (Stage stage = 0; stage < STAGE_GATHER; stage++)
        session_say(session, "  %-11s%8.3f s  %8.0f MB", pipeline_stage_name(stage),
                    pipeline->seconds[stage], 1e-6 * (double)pipeline->peak[stage]);
    summary_print(pipeline);
    *exit_code = pipeline_exit_code(pipeline);
    session->told = true;
    return write_json(pipeline, figures, *exit_code, err);
}
