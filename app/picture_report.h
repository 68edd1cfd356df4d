/* SPDX-License-Identifier: BSD-3-Clause */
/* app/picture_report.h -- what a run tells of each of its pictures. */
#ifndef APP_PICTURE_REPORT_H
#define APP_PICTURE_REPORT_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    char     camera[64];
    char     exr[4096], png[4096], values[4096]; /* the last: in false colours; "": none */
    int      width, height;
    double   samples, error;    /* per pixel, the mean; standard error, 0 or NAN: not known */
    double   exposure, seconds;
    uint64_t rays;
    bool     made;              /* in this run; an earlier one may have made it */
    double   records_error; /* of RenderReport */
} PictureReport;

#endif
