/* SPDX-License-Identifier: BSD-3-Clause */
/* A parallel loop: threads live as long as the loop and take chunks off one counter. */
#include "base/parallel.h"

#include <assert.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stddef.h>
#include <time.h>
#include <unistd.h>

enum { THREADS_MAX = 1024 };

/* Five reports a second look smooth and cost nothing. */
static const double report_seconds = 0.2;

typedef struct {
    uint32_t       count, chunk, chunks;
    ParallelBody   body;
    void          *context;
    const Monitor *monitor;
    const Progress *base;
    _Atomic uint32_t next;     /* first chunk nobody has taken */
    _Atomic uint32_t finished; /* chunks */
    atomic_bool      stopped;
} Loop;

typedef struct {
    Loop     *loop;
    unsigned  index;
    pthread_t thread;
} Worker;

unsigned parallel_threads(unsigned wished)
{
    if (wished > 0)
        return wished < THREADS_MAX ? wished : THREADS_MAX;
    cpu_set_t set;
    long cores = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set)
                                                             : sysconf(_SC_NPROCESSORS_ONLN);
    if (cores < 1)
        cores = 1;
    return cores < THREADS_MAX ? (unsigned)cores : THREADS_MAX;
}

static double clock_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec / 1e9;
}

static void loop_report(Loop *loop)
{
    Progress progress = *loop->base;
    const double share = (double)atomic_load(&loop->finished) / loop->chunks;
    progress.done *= share;
    progress.rays = (uint64_t)(share * (double)progress.rays);
    monitor_progress(loop->monitor, &progress);
}

/* Takes and runs the next chunk; false when there is none left or the monitor says stop. */
static bool loop_step(Loop *loop, unsigned worker)
{
    if (atomic_load(&loop->stopped))
        return false;
    if (atomic_load(&loop->next) >= loop->chunks)
        return false;
    if (monitor_stop(loop->monitor)) {
        atomic_store(&loop->stopped, true);
        return false;
    }
    /* Bounded by chunks + THREADS_MAX, which the limit on chunks in parallel_for keeps below
     * 2^32. */
    const uint32_t mine = atomic_fetch_add(&loop->next, 1);
    if (mine >= loop->chunks)
        return false;
    const uint32_t begin = mine * loop->chunk;
    const uint32_t end = loop->count - begin < loop->chunk ? loop->count : begin + loop->chunk;
    loop->body(loop->context, begin, end, worker);
    atomic_fetch_add(&loop->finished, 1);
    return true;
}

static void *worker_run(void *argument)
{
    const Worker *worker = argument;
    while (loop_step(worker->loop, worker->index))
        ;
    return NULL;
}

/* The calling thread works too, and is the only one that reports. */
static void caller_run(Loop *loop)
{
    double last = clock_seconds();

    while (loop_step(loop, 0)) {
        if (loop->base == NULL)
            continue;
        const double now = clock_seconds();
        if (now - last >= report_seconds) {
            loop_report(loop);
            last = now;
        }
    }
}

bool parallel_for(uint32_t count, uint32_t chunk, unsigned threads, ParallelBody body,
                  void *context, const Monitor *monitor, const Progress *base)
{
    assert(chunk > 0);
    assert(body != NULL);
    Loop loop = { .count = count, .chunk = chunk, .chunks = count / chunk + (count % chunk != 0),
                  .body = body, .context = context, .monitor = monitor, .base = base };
    assert(loop.chunks <= UINT32_MAX - THREADS_MAX);

    unsigned wanted = parallel_threads(threads);
    if (wanted > loop.chunks)
        wanted = loop.chunks > 0 ? loop.chunks : 1;
    Worker workers[THREADS_MAX];
    unsigned started = 1;
    for (; started < wanted; started++) {
        Worker *worker = &workers[started];
        *worker = (Worker){ .loop = &loop, .index = started };
        /* Fewer threads than wished give the same result, only later. */
        if (pthread_create(&worker->thread, NULL, worker_run, worker) != 0)
            break;
    }
    caller_run(&loop);
    for (unsigned i = 1; i < started; i++)
        pthread_join(workers[i].thread, NULL);
    if (base != NULL && loop.chunks > 0)
        loop_report(&loop);
    return atomic_load(&loop.finished) == loop.chunks;
}
