/* SPDX-License-Identifier: BSD-3-Clause */
/* Calls back to whoever watches the work, when there is anyone. */
#include "base/monitor.h"

#include <assert.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

void monitor_warn(const Monitor *monitor, const char *code, const char *where, const char *format,
                  ...)
{
    assert(code != NULL && where != NULL && format != NULL);
    if (monitor == NULL || monitor->warn == NULL)
        return;
    char text[512];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    monitor->warn(monitor->user, code, where, text);
}

void monitor_progress(const Monitor *monitor, const Progress *progress)
{
    assert(progress != NULL && progress->stage != NULL);
    if (monitor != NULL && monitor->progress != NULL)
        monitor->progress(monitor->user, progress);
}

bool monitor_stop(const Monitor *monitor)
{
    return monitor != NULL && monitor->stop != NULL && monitor->stop(monitor->user);
}
