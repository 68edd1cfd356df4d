/* SPDX-License-Identifier: BSD-3-Clause */
/* app/progress.h -- how the program shows that it works: a live line, lines, JSON, or nothing.
 *
 * All on standard error. auto: one live line on a terminal; elsewhere a line every ten seconds, so
 * that a log never looks hung. A thread of its own says so too when the work is long silent.
 */
#ifndef APP_PROGRESS_H
#define APP_PROGRESS_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#include "app/options.h"
#include "base/monitor.h"

typedef struct {
    ProgressStyle style;
    bool          live;       /* auto on a terminal */
    bool          shown;      /* a live line stands there */
    char          stage[16];  /* the one being shown */
    char          part[80];   /* of several that the stage is done for, as a camera; "": one */
    double        start;      /* of the program, clock of progress_now */
    double        stage_start;
    double        last;       /* when the last line was printed */
    Progress      now;        /* what was reported last; its stage is `stage` above */
    pthread_t     heart;      /* prints when nothing else does; only when beating */
    bool          beating, begun, ending;
    pthread_mutex_t lock;     /* of all above; held only to look, set and print */
    pthread_cond_t  wake;
} ProgressPrinter;

/* Seconds on a clock that only goes forward. */
double progress_now(void);
/* Most memory this process has used so far, bytes. */
uint64_t progress_peak_bytes(void);

/* The printer must not move until progress_end. */
void progress_init(ProgressPrinter *printer, ProgressStyle style);
/* Starts the thread that speaks when the work is silent. */
void progress_begin(ProgressPrinter *printer);
void progress_end(ProgressPrinter *printer);
/* What stages are done for from now on, told with them; "": nothing that needs telling. */
void progress_part(ProgressPrinter *printer, const char *part);
void progress_show(ProgressPrinter *printer, const Progress *progress);
/* Takes a live line away, before other text is printed. */
void progress_clear(ProgressPrinter *printer);

#endif
