/* SPDX-License-Identifier: BSD-3-Clause */
/* app/progress.h -- how the program shows that it works: a live line, lines, JSON, or nothing.
 *
 * All on standard error. auto: one live line on a terminal; elsewhere a line every ten seconds, so
 * that a log never looks hung.
 */
#ifndef APP_PROGRESS_H
#define APP_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

#include "app/options.h"
#include "base/monitor.h"

typedef struct {
    ProgressStyle style;
    bool          live;       /* auto on a terminal */
    bool          shown;      /* a live line stands there */
    char          stage[16];  /* the one being shown */
    double        start;      /* of the program, clock of progress_now */
    double        stage_start;
    double        last;       /* when the last line was printed */
} ProgressPrinter;

/* Seconds on a clock that only goes forward. */
double progress_now(void);
/* Most memory this process has used so far, bytes. */
uint64_t progress_peak_bytes(void);

void progress_init(ProgressPrinter *printer, ProgressStyle style);
void progress_show(ProgressPrinter *printer, const Progress *progress);
/* Takes a live line away, before other text is printed. */
void progress_clear(ProgressPrinter *printer);

#endif
