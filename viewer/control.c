/* SPDX-License-Identifier: BSD-3-Clause */
/* Requests and reports between window and solver. */
#include "viewer/control.h"

#include <assert.h>
#include <stdio.h>

void control_init(Control *control)
{
    assert(control != NULL);
    *control = (Control){ .report = { .doing = "reading", .done = -1, .unshot = -1,
                                      .residual = -1, .left = -1 } };
    knobs_init(&control->knobs);
    easel_init(&control->easel);
    pthread_mutex_init(&control->lock, NULL);
}

void control_clear(Control *control)
{
    knobs_clear(&control->knobs);
    easel_clear(&control->easel);
    pthread_mutex_destroy(&control->lock);
}

void control_report(Control *control, const Report *report)
{
    assert(report->doing != NULL);
    pthread_mutex_lock(&control->lock);
    control->report = *report;
    pthread_mutex_unlock(&control->lock);
}

void control_read(Control *control, Report *report)
{
    pthread_mutex_lock(&control->lock);
    *report = control->report;
    pthread_mutex_unlock(&control->lock);
}

void control_say(Control *control, const char *line)
{
    assert(line != NULL);
    pthread_mutex_lock(&control->lock);
    snprintf(control->said, sizeof control->said, "%s", line);
    control->sayings++;
    pthread_mutex_unlock(&control->lock);
}

bool control_heard(Control *control, unsigned *sayings, char *line, size_t size)
{
    pthread_mutex_lock(&control->lock);
    const bool another = control->sayings != *sayings;
    *sayings = control->sayings;
    if (another)
        snprintf(line, size, "%s", control->said);
    pthread_mutex_unlock(&control->lock);
    return another;
}
