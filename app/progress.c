/* SPDX-License-Identifier: BSD-3-Clause */
/* Progress on standard error. */
#include "app/progress.h"

#include <assert.h>
#include <math.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "app/json.h"

static const double LINE_SECONDS = 10;  /* a log gets a line at least this often */
static const double LIVE_SECONDS = 0.1; /* faster than an eye reads */
static const double JSON_SECONDS = 0.5;

double progress_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

uint64_t progress_peak_bytes(void)
{
    struct rusage usage;
    if (getrusage(RUSAGE_SELF, &usage) != 0)
        return 0;
    return (uint64_t)usage.ru_maxrss * 1024; /* Linux counts it in KiB */
}

void progress_init(ProgressPrinter *printer, ProgressStyle style)
{
    const double now = progress_now();
    *printer = (ProgressPrinter){ .style = style, .start = now, .stage_start = now, .last = now };
    printer->live = style == PROGRESS_AUTO && isatty(STDERR_FILENO) == 1;
    pthread_mutex_init(&printer->lock, NULL);
    pthread_cond_init(&printer->wake, NULL);
}

static void clear_line(ProgressPrinter *printer)
{
    if (printer->shown)
        fputs("\r\033[K", stderr);
    printer->shown = false;
}

void progress_clear(ProgressPrinter *printer)
{
    pthread_mutex_lock(&printer->lock);
    clear_line(printer);
    pthread_mutex_unlock(&printer->lock);
}

static void show_json(const ProgressPrinter *printer, const Progress *progress, double now,
                      double left)
{
    const double spent = now - printer->stage_start;
    Json json = { .out = stderr, .one_line = true };
    json_open(&json, NULL, '{');
    json_text(&json, "stage", progress->stage);
    if (printer->part[0] != '\0')
        json_text(&json, "part", printer->part);
    json_number(&json, "done", progress->done);
    json_number(&json, "energy_left", progress->energy_left < 0 ? NAN : progress->energy_left);
    json_number(&json, "elapsed", now - printer->start);
    json_number(&json, "remaining", left);
    json_number(&json, "rays_per_second", spent > 0 ? (double)progress->rays / spent : NAN);
    json_count(&json, "memory", progress_peak_bytes());
    json_close(&json, '}');
}

static void show_text(ProgressPrinter *printer, const Progress *progress, double now, double left)
{
    const double spent = now - printer->stage_start;
    char line[256];
    int n = snprintf(line, sizeof line, "isolux: %-8s %s%s%3.0f %%", progress->stage,
                     printer->part, printer->part[0] != '\0' ? ": " : "",
                     floor(100 * progress->done));
    if (progress->energy_left >= 0)
        n += snprintf(line + n, sizeof line - (size_t)n, ", %.3g %% of the light under way",
                      100 * progress->energy_left);
    n += snprintf(line + n, sizeof line - (size_t)n, ", %.1f s", now - printer->start);
    if (isfinite(left))
        n += snprintf(line + n, sizeof line - (size_t)n, ", %.0f s left", ceil(left));
    if (progress->rays > 0 && spent > 0)
        n += snprintf(line + n, sizeof line - (size_t)n, ", %.2f Mray/s",
                      1e-6 * (double)progress->rays / spent);
    snprintf(line + n, sizeof line - (size_t)n, ", %.0f MB",
             1e-6 * (double)progress_peak_bytes());
    if (printer->live)
        fprintf(stderr, "\r%s\033[K", line);
    else
        fprintf(stderr, "%s\n", line);
    printer->shown = printer->live;
    fflush(stderr);
}

/* Prints when it is time to; the lock is held. */
static void show(ProgressPrinter *printer, bool new_stage)
{
    const double now = progress_now();
    const Progress *progress = &printer->now;
    double wait = printer->live ? LIVE_SECONDS : LINE_SECONDS;
    if (printer->style == PROGRESS_JSON)
        wait = JSON_SECONDS;
    const bool each_stage = printer->style == PROGRESS_PLAIN || printer->style == PROGRESS_JSON;
    if (printer->style == PROGRESS_NONE || progress->stage == NULL ||
        (now - printer->last < wait && !(new_stage && each_stage)))
        return;
    printer->last = now;
    /* A guess out of a few per cent of the work is worse than none. */
    const double enough = 0.05, spent = now - printer->stage_start;
    const double left = progress->done >= enough ? spent * (1 / progress->done - 1) : NAN;
    if (printer->style == PROGRESS_JSON)
        show_json(printer, progress, now, left);
    else
        show_text(printer, progress, now, left);
}

void progress_show(ProgressPrinter *printer, const Progress *progress)
{
    assert(printer != NULL && progress != NULL && progress->stage != NULL);
    pthread_mutex_lock(&printer->lock);
    const bool new_stage = strncmp(printer->stage, progress->stage, sizeof printer->stage - 1) != 0;
    if (new_stage) {
        snprintf(printer->stage, sizeof printer->stage, "%s", progress->stage);
        printer->stage_start = progress_now();
    }
    printer->now = *progress;
    printer->now.stage = printer->stage;
    show(printer, new_stage);
    pthread_mutex_unlock(&printer->lock);
}

void progress_part(ProgressPrinter *printer, const char *part)
{
    pthread_mutex_lock(&printer->lock);
    snprintf(printer->part, sizeof printer->part, "%s", part);
    printer->stage[0] = '\0'; /* what comes next is another stage, whatever its name */
    printer->now.stage = NULL;
    pthread_mutex_unlock(&printer->lock);
}

/* Looks once a second whether a line is due. */
static void *beat(void *context)
{
    ProgressPrinter *printer = context;
    pthread_mutex_lock(&printer->lock);
    printer->begun = true;
    pthread_cond_signal(&printer->wake);
    while (!printer->ending) {
        struct timespec until;
        clock_gettime(CLOCK_REALTIME, &until);
        until.tv_sec++;
        pthread_cond_timedwait(&printer->wake, &printer->lock, &until);
        if (!printer->ending)
            show(printer, false);
    }
    pthread_mutex_unlock(&printer->lock);
    return NULL;
}

void progress_begin(ProgressPrinter *printer)
{
    assert(!printer->beating);
    if (printer->style == PROGRESS_NONE)
        return;
    /* Signals are for the main thread, so that a sleeping one does not swallow them. */
    sigset_t all, old;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &old);
    printer->beating = pthread_create(&printer->heart, NULL, beat, printer) == 0;
    pthread_sigmask(SIG_SETMASK, &old, NULL);
    /* A process that is copied while a thread is being set up (files of other programs are read in
     * a copy) can find memory locked for good under address sanitizers. */
    pthread_mutex_lock(&printer->lock);
    while (printer->beating && !printer->begun)
        pthread_cond_wait(&printer->wake, &printer->lock);
    pthread_mutex_unlock(&printer->lock);
}

void progress_end(ProgressPrinter *printer)
{
    pthread_mutex_lock(&printer->lock);
    clear_line(printer);
    printer->ending = true;
    pthread_cond_signal(&printer->wake);
    pthread_mutex_unlock(&printer->lock);
    if (printer->beating)
        pthread_join(printer->heart, NULL);
    printer->beating = false;
    pthread_cond_destroy(&printer->wake);
    pthread_mutex_destroy(&printer->lock);
}
