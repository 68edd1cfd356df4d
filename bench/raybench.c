/* SPDX-License-Identifier: BSD-3-Clause */
/* Rays per second against Embree's best mode and order, in turns over the same rays.
 *
 *   raybench [-j 1,2] [-n PAIRS] [-w hvp] [-b medium|high] [-o FILE.json] [-a] [-v] [-c] SCENE...
 *   raybench -i COPIES -o FILE.png SCENE    a picture of so many copies of one tree
 *
 * -b high makes the better trees and compares them with the ordinary ones too; -a leaves Embree out.
 * Every mode of Embree is tried once or twice; the best is then measured in turns with ours, PAIRS
 * times. A pair's ratio is ours over Embree's; min, median and max over the pairs are told. */
#include <assert.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/array.h"
#include "base/parallel.h"
#include "bench/bench.h"

enum { PAIRS_MAX = 99, SUMS = 64 };

typedef struct {
    unsigned    threads[8];
    int         thread_counts, pairs;
    const char *works, *out;
    BvhQuality  quality;
    uint32_t    copies; /* 0: measure rays */
    bool        verbose, alone; /* alone: Embree is left out */
} Settings;

/* With -c: of the processor, for machines on which others run too; use with one thread. */
static clockid_t clock_used = CLOCK_MONOTONIC;

double bench_now(void)
{
    struct timespec t;
    clock_gettime(clock_used, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* --- ours ------------------------------------------------------------------------------------ */

typedef struct {
    const Bvh    *bvh;
    const RaySet *set;
    Hit          *hit;     /* [batch] of each thread */
    bool         *blocked; /* likewise */
    Traced        sum[SUMS];
} Job;

static void trace_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Job *job = context;
    const Ray *ray = job->set->ray + begin;
    Hit *hit = job->hit + (size_t)worker * job->set->batch;
    bool *blocked = job->blocked + (size_t)worker * job->set->batch;
    Traced *sum = &job->sum[worker];
    if (job->set->work == WORK_VISIBILITY) {
        bvh_blocked_many(job->bvh, ray, blocked, end - begin);
        for (uint32_t i = 0; i < end - begin; i++)
            sum->hits += blocked[i];
        return;
    }
    if (job->set->work == WORK_PRIMARY)
        bvh_nearest_beam(job->bvh, ray, hit, end - begin);
    else
        bvh_nearest_many(job->bvh, ray, hit, end - begin);
    for (uint32_t i = 0; i < end - begin; i++) {
        const bool found = hit[i].primitive != RAY_MISS;
        sum->hits += found;
        sum->primitives += found ? hit[i].primitive : 0;
    }
}

static Traced our_trace(const Bvh *bvh, const RaySet *set, unsigned threads, Error *err)
{
    Job job = { .bvh = bvh, .set = set };
    job.hit = array_create((size_t)threads * set->batch, sizeof *job.hit, "hits", err);
    job.blocked = array_create((size_t)threads * set->batch, sizeof *job.blocked, "hits", err);
    const double begin = bench_now();
    if (!error_is_set(err))
        parallel_for(set->count, set->batch, threads, trace_chunk, &job, NULL, NULL);
    Traced all = { .seconds = bench_now() - begin };
    for (int i = 0; i < SUMS; i++) {
        all.hits += job.sum[i].hits;
        all.primitives += job.sum[i].primitives;
    }
    array_free(job.hit);
    array_free(job.blocked);
    return all;
}

/* --- the pairs ------------------------------------------------------------------------------- */

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *value, int count)
{
    qsort(value, (size_t)count, sizeof *value, by_value);
    return value[count / 2];
}

typedef struct {
    const Model    *model;
    const Bvh      *bvh, *plain; /* plain: of medium quality, when bvh is better; else NULL */
    const Peer     *peer;
    const Settings *settings;
    FILE           *out;
    int             rows;
    /* of the tree, per number of threads; ours and Embree's */
    double build[8], peer_build[8], bytes, peer_bytes;
} Bench;

/* The fastest of Embree's ways; the three best of the first round run again. */
static int best_mode(const Bench *b, const RaySet *set, unsigned threads, const PeerMode *mode,
                     int modes)
{
    double seconds[PEER_MODES_MAX], sorted[PEER_MODES_MAX];
    int best = 0;
    for (int i = 0; i < modes; i++)
        seconds[i] = sorted[i] = peer_trace(b->peer, set, &mode[i], threads).seconds;
    if (modes > 0)
        median(sorted, modes);
    for (int i = 0; i < modes; i++) {
        if (seconds[i] <= sorted[modes < 3 ? modes - 1 : 2]) {
            const double again = peer_trace(b->peer, set, &mode[i], threads).seconds;
            seconds[i] = again < seconds[i] ? again : seconds[i];
        }
        if (b->settings->verbose)
            printf("    %-36s %7.2f\n", mode[i].name, 1e-6 * set->count / seconds[i]);
        best = seconds[i] < seconds[best] ? i : best;
    }
    return best;
}

static void write_row(Bench *b, const RaySet *set, int threads, double ours, double theirs,
                      const char *mode, const double ratio[3])
{
    double nodes, triangles;
    rays_count(b->bvh, set, &nodes, &triangles);
    fprintf(b->out,
            "%s\n  { \"scene\": \"%s\", \"triangles\": %u, \"workload\": \"%s\", "
            "\"threads\": %u,\n    \"isolux_mrays\": %.3f, \"embree_mrays\": %.3f, "
            "\"embree_mode\": \"%s\", \"ratio\": [%.3f, %.3f, %.3f],\n"
            "    \"nodes_per_ray\": %.2f, \"triangles_per_ray\": %.2f, "
            "\"bytes_per_triangle\": %.1f, \"embree_bytes_per_triangle\": %.1f, "
            "\"build_seconds\": %.4f, \"embree_build_seconds\": %.4f }",
            b->rows++ > 0 ? "," : "", b->model->name, b->model->triangle_count,
            work_name(set->work), b->settings->threads[threads], ours, theirs, mode, ratio[0],
            ratio[1], ratio[2], nodes, triangles, b->bytes, b->peer_bytes, b->build[threads],
            b->peer_build[threads]);
}

/* The better tree against the ordinary one, in turns. */
static void measure_plain(const Bench *b, const RaySet *set, unsigned threads, Error *err)
{
    double ratio[PAIRS_MAX], nodes[2], triangles[2], least[2] = { INFINITY, INFINITY };
    const int pairs = b->settings->pairs;
    for (int i = 0; i < pairs && !error_is_set(err); i++) {
        const double plain = our_trace(b->plain, set, threads, err).seconds;
        const double better = our_trace(b->bvh, set, threads, err).seconds;
        ratio[i] = plain / better;
        least[0] = plain < least[0] ? plain : least[0];
        least[1] = better < least[1] ? better : least[1];
    }
    if (error_is_set(err))
        return;
    const double m = median(ratio, pairs);
    rays_count(b->plain, set, &nodes[0], &triangles[0]);
    rays_count(b->bvh, set, &nodes[1], &triangles[1]);
    printf("    against medium quality: %.2f [%.2f %.2f], best times %.2f; nodes a ray %.1f, then "
           "%.1f; triangles %.1f, then %.1f\n", m, ratio[0], ratio[pairs - 1],
           least[0] / least[1], nodes[0], nodes[1], triangles[0], triangles[1]);
}

static bool measure(Bench *b, const RaySet *set, int which, Error *err)
{
    const unsigned threads = b->settings->threads[which];
    PeerMode mode[PEER_MODES_MAX];
    const int modes = b->settings->alone ? 0 : peer_modes(set->work, mode);
    const int best = best_mode(b, set, threads, mode, modes), pairs = b->settings->pairs;
    double ours[PAIRS_MAX], theirs[PAIRS_MAX], ratio[PAIRS_MAX] = { 0 };
    Traced mine = our_trace(b->bvh, set, threads, err), other = { 0 };
    for (int i = 0; i < pairs && !error_is_set(err); i++) {
        mine = our_trace(b->bvh, set, threads, err);
        ours[i] = 1e-6 * set->count / mine.seconds;
        if (modes == 0)
            continue;
        other = peer_trace(b->peer, set, &mode[best], threads);
        theirs[i] = 1e-6 * set->count / other.seconds;
        ratio[i] = ours[i] / theirs[i];
    }
    if (error_is_set(err))
        return false;
    const double m = median(ours, pairs), e = modes > 0 ? median(theirs, pairs) : 0;
    median(ratio, pairs);
    printf("%-16s %-10s %u  %8.2f  %8.2f  %5.2f [%4.2f %4.2f]  %s\n", b->model->name,
           work_name(set->work), threads, m, e, ratio[pairs / 2], ratio[0], ratio[pairs - 1],
           modes > 0 ? mode[best].name : "no Embree here");
    if (b->plain != NULL)
        measure_plain(b, set, threads, err);
    if (modes > 0 && b->settings->verbose)
        printf("    hits %llu / %llu, sum of primitives off by %g\n",
               (unsigned long long)mine.hits, (unsigned long long)other.hits,
               (double)mine.primitives / (double)(other.primitives + 1) - 1);
    fflush(stdout);
    const double ends[3] = { ratio[0], ratio[pairs / 2], ratio[pairs - 1] };
    if (b->out != NULL)
        write_row(b, set, which, m, e, modes > 0 ? mode[best].name : "", ends);
    return true;
}

static Primitives model_primitives(const Model *m)
{
    return (Primitives){ .position = m->position, .corner = m->corner,
                         .vertex_count = m->vertex_count, .triangle_count = m->triangle_count };
}

/* The tree once more for each pair of builds; the last ones stay. */
static bool builds(Bench *b, int which, Bvh **bvh, Peer **peer, Error *err)
{
    const unsigned threads = b->settings->threads[which];
    const Model *m = b->model;
    const Primitives in = model_primitives(m);
    double ours[3], theirs[3] = { 0 };
    BvhStats stats = { 0 };
    uint64_t bytes = 0;
    for (int i = 0; i < 3; i++) {
        bvh_destroy(*bvh);
        const double begin = bench_now();
        *bvh = bvh_create_as(&in, b->settings->quality, threads, err);
        ours[i] = bench_now() - begin;
        if (*bvh == NULL)
            return false;
        bvh_stats(*bvh, &stats);
        *peer = peer_destroy(*peer);
        if (!b->settings->alone)
            *peer = peer_create(m, threads, &theirs[i], &bytes);
    }
    const double a = median(ours, 3), e = median(theirs, 3);
    b->build[which] = a;
    b->peer_build[which] = e;
    b->bytes = (double)stats.bytes / m->triangle_count;
    b->peer_bytes = (double)bytes / m->triangle_count;
    printf("%-16s build      %u  %8.4f  %8.4f s  %5.2f   %.1f bytes a triangle, Embree %.1f\n",
           m->name, threads, a, e, e > 0 ? a / e : 0, b->bytes, b->peer_bytes);
    return true;
}

static bool bench_scene(Bench *b, const char *name, Error *err)
{
    const Settings *s = b->settings;
    Model model;
    Bvh *bvh = NULL, *plain = NULL;
    Peer *peer = NULL;
    if (!model_read(&model, name, err))
        return false;
    b->model = &model;
    bool good = true;
    for (int i = 0; good && i < s->thread_counts; i++)
        good = builds(b, i, &bvh, &peer, err);
    if (good && s->quality != BVH_MEDIUM) {
        const Primitives in = model_primitives(&model);
        plain = bvh_create(&in, s->threads[0], err);
        good = plain != NULL;
    }
    b->bvh = bvh;
    b->plain = plain;
    b->peer = peer;
    for (Work work = 0; good && work < WORKS; work++) {
        RaySet set;
        if (strchr(s->works, work_name(work)[0]) == NULL)
            continue;
        good = rays_make(&set, &model, work, err);
        for (int i = 0; good && i < s->thread_counts; i++)
            good = measure(b, &set, i, err);
        rays_clear(&set);
    }
    peer_destroy(peer);
    bvh_destroy(bvh);
    bvh_destroy(plain);
    model_clear(&model);
    return good;
}

static Settings read_options(int argc, char **argv)
{
    Settings s = { .threads = { 1, 2 }, .thread_counts = 2, .pairs = 7, .works = "hvp" };
    int c;
    while ((c = getopt(argc, argv, "j:n:w:o:i:b:avc")) != -1) {
        if (c == 'j') {
            s.thread_counts = 0;
            for (char *p = strtok(optarg, ","); p != NULL && s.thread_counts < 8;
                 p = strtok(NULL, ","))
                s.threads[s.thread_counts++] = parallel_threads((unsigned)atoi(p));
        } else if (c == 'n')
            s.pairs = atoi(optarg);
        else if (c == 'w')
            s.works = optarg;
        else if (c == 'o')
            s.out = optarg;
        else if (c == 'c')
            clock_used = CLOCK_PROCESS_CPUTIME_ID;
        else if (c == 'i')
            s.copies = (uint32_t)strtoul(optarg, NULL, 10);
        else if (c == 'b' && (strcmp(optarg, "medium") == 0 || strcmp(optarg, "high") == 0))
            s.quality = optarg[0] == 'h' ? BVH_HIGH : BVH_MEDIUM;
        else if (c == 'a')
            s.alone = true;
        else if (c == 'v')
            s.verbose = true;
        else
            s.pairs = 0;
    }
    for (int i = 0; i < s.thread_counts; i++)
        if (s.threads[i] > SUMS)
            s.threads[i] = SUMS;
    if (s.pairs < 1 || s.pairs > PAIRS_MAX || s.thread_counts == 0 || optind >= argc) {
        fprintf(stderr, "usage: raybench [-j 1,2] [-n PAIRS] [-w hvp] [-b medium|high] "
                        "[-o FILE] [-a] [-v] [-c] SCENE...\n"
                        "       raybench -i COPIES -o FILE.png SCENE\n"
                        "SCENE: cornell, cornell100k, room, room12m, solids or a file\n");
        exit(2);
    }
    return s;
}

static int draw_copies(const Settings *s, const char *name)
{
    Error err = { 0 };
    Model model;
    if (model_read(&model, name, &err))
        copies_draw(&model, s->copies, s->threads[s->thread_counts - 1],
                    s->out != NULL ? s->out : "copies.png", &err);
    model_clear(&model);
    if (error_is_set(&err))
        fprintf(stderr, "raybench: %s\n", err.text);
    return error_is_set(&err) ? 1 : 0;
}

int main(int argc, char **argv)
{
    const Settings s = read_options(argc, argv);
    Error err = { 0 };
    if (s.copies > 0)
        return draw_copies(&s, argv[optind]);
    Bench b = { .settings = &s, .out = s.out != NULL ? fopen(s.out, "w") : NULL };
    if (b.out != NULL)
        fputc('[', b.out);
    printf("%-16s %-10s %s  %8s  %8s  ratio [min max]\n", "Mrays/s", "", "threads", "isolux",
           "Embree");
    for (int i = optind; i < argc && !error_is_set(&err); i++)
        bench_scene(&b, argv[i], &err);
    if (b.out != NULL) {
        fputs("\n]\n", b.out);
        fclose(b.out);
    }
    if (error_is_set(&err))
        fprintf(stderr, "raybench: %s\n", err.text);
    return error_is_set(&err) ? 1 : 0;
}
