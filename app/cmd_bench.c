/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux bench: rays per second of three kinds, then seconds and memory of each stage. */
#include <assert.h>
#include <math.h>

#include "app/commands.h"
#include "app/model.h"
#include "app/summary.h"
#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"

typedef enum { RAYS_CAMERA, RAYS_HEMISPHERE, RAYS_VISIBILITY, RAYS_KINDS } RayKind;

/* A chunk is what one thread takes at a time: enough rays to be traced in company. */
enum { RAY_CHUNK = 16384, RAYS_MOST = 1 << 20 };
/* Long enough that starting threads does not count. */
static const double BENCH_SECONDS = 1.0;

typedef struct {
    const Pipeline *pipeline;
    RayKind         kind;
    Ray            *ray;      /* [count] */
    Hit            *hit;      /* [count] */
    bool           *blocked;  /* [count] */
    uint32_t        count;
} Bench;

static const char *kind_name(RayKind kind)
{
    static const char *const names[] = { "camera", "hemisphere", "visibility" };
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
    any_point(bench->pipeline, i, 1, &p);
    if (bench->kind == RAYS_VISIBILITY) {
        any_point(bench->pipeline, i, 2, &q);
        return ray_between(p.point.point, p.point.normal, q.point.point, q.point.normal,
                           room->offset);
    }
    sampling_sobol2(i, sampling_seed(3, 1, 2, 3), a);
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

/* Rays per second of one kind, tracing alone: the rays are made before the clock starts. */
static double ray_rate(Bench *bench)
{
    const Session *session = bench->pipeline->session;
    const unsigned threads = session->settings.threads;
    double seconds = 0;
    uint64_t rays = 0;
    parallel_for(bench->count, RAY_CHUNK, threads, fill_chunk, bench, NULL, NULL);
    while (seconds < BENCH_SECONDS && !session_stopped(session)) {
        const double begin = progress_now();
        parallel_for(bench->count, RAY_CHUNK, threads, trace_chunk, bench, NULL, NULL);
        seconds += progress_now() - begin;
        rays += bench->count;
    }
    return seconds > 0 ? (double)rays / seconds : 0;
}

static bool bench_rays(Pipeline *pipeline, double rate[RAYS_KINDS], Error *err)
{
    Bench bench = { .pipeline = pipeline, .count = RAYS_MOST };
    bench.ray = array_create(bench.count, sizeof *bench.ray, "rays", err);
    bench.hit = array_create(bench.count, sizeof *bench.hit, "rays", err);
    bench.blocked = array_create(bench.count, sizeof *bench.blocked, "rays", err);
    for (RayKind kind = 0; kind < RAYS_KINDS && !error_is_set(err); kind++) {
        bench.kind = kind;
        rate[kind] = ray_rate(&bench);
        session_say(pipeline->session, "  %-11s%8.2f Mray/s", kind_name(kind), 1e-6 * rate[kind]);
    }
    array_free(bench.ray);
    array_free(bench.hit);
    array_free(bench.blocked);
    return !error_is_set(err);
}

static bool write_json(const Pipeline *pipeline, const double rate[RAYS_KINDS], int exit_code,
                       Error *err)
{
    Summary summary;
    if (!summary_begin(&summary, pipeline->session, exit_code, err, err))
        return false;
    if (summary.file == NULL)
        return true;
    Json *json = &summary.json;
    json_open(json, "rays_per_second", '{');
    for (RayKind kind = 0; kind < RAYS_KINDS; kind++)
        json_number(json, kind_name(kind), rate[kind]);
    json_close(json, '}');
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
    double rate[RAYS_KINDS] = { 0 };
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
    if (!bench_rays(pipeline, rate, err) || !pipeline_factors(pipeline, err) ||
        !pipeline_solve(pipeline, err))
        return false;
    for (Stage stage = 0; stage < STAGE_GATHER; stage++)
        session_say(session, "  %-11s%8.3f s  %8.0f MB", pipeline_stage_name(stage),
                    pipeline->seconds[stage], 1e-6 * (double)pipeline->peak[stage]);
    summary_print(pipeline);
    *exit_code = pipeline_exit_code(pipeline);
    session->told = true;
    return write_json(pipeline, rate, *exit_code, err);
}
