/* SPDX-License-Identifier: BSD-3-Clause */
/* base/monitor.h -- how long work tells where it is, what it noticed, and learns that it must stop.
 *
 * The library never prints: it calls back. A NULL Monitor, or a NULL callback, is silent and never
 * stops.
 *
 * Threads  callbacks are made from the thread that called the library, never from workers, except
 *          `stop`, which may be called from any thread and must not block, unless all of the work
 *          is to rest for a while: then it may in every thread that asks.
 */
#ifndef BASE_MONITOR_H
#define BASE_MONITOR_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    const char *stage;        /* "read", "mesh", "bvh", "factors", "solve", "gather", "write" */
    double      done;         /* share of the stage's work that is done, 0..1 */
    double      energy_left;  /* share of the emitted power still unshot; < 0: not known here */
    uint64_t    rays;         /* cast in this stage so far */
} Progress;

typedef struct Monitor {
    void *user;
    /* Something a user should know: a stable code ("no-emitter"), a place or "", a sentence. */
    void (*warn)(void *user, const char *code, const char *where, const char *text);
    void (*progress)(void *user, const Progress *progress);
    bool (*stop)(void *user); /* true: finish the chunk and return */
} Monitor;

/* Each makes its call if there is anyone to call; monitor_stop is false when there is not. */
void monitor_warn(const Monitor *monitor, const char *code, const char *where, const char *format,
                  ...) __attribute__((format(printf, 4, 5)));
void monitor_progress(const Monitor *monitor, const Progress *progress);
bool monitor_stop(const Monitor *monitor);

#endif
