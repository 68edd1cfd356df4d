/* SPDX-License-Identifier: BSD-3-Clause */
/* app/adapt_report.h -- how patches were divided where light changes, for summaries. */
#ifndef APP_ADAPT_REPORT_H
#define APP_ADAPT_REPORT_H

#include <stdbool.h>
#include <stdint.h>

enum { ADAPT_PASSES = 8 };

typedef struct {
    unsigned passes;
    uint32_t patches[ADAPT_PASSES + 1]; /* at first, and after each pass; all 0: not adapted */
    double   error[ADAPT_PASSES];       /* before each pass: estimated error of irradiance by the
                                           division, rms over the area / mean, luminance */
    double   seconds;                   /* of solving and estimating in between, not of casting */
    bool     stopped;                   /* asked to stop: fewer patches than wanted */
} AdaptReport;

#endif
