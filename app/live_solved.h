/* SPDX-License-Identifier: BSD-3-Clause */
/* app/live_solved.h -- a solution out of a file in place of the solver: read, shown, read again. */
#ifndef APP_LIVE_SOLVED_H
#define APP_LIVE_SOLVED_H

#include <pthread.h>

#include "app/session.h"
#include "viewer/control.h"
#include "viewer/snapshot.h"

typedef struct {
    Session   *session;
    Mailbox   *mailbox;
    Control   *control;
    pthread_t  thread;
} LiveSolved;

/* What is asked for can be had from a solved mesh.
 * fails  false; ERROR_USAGE: an option that belongs to solving. */
bool live_solved_allowed(const Options *options, Error *err);
/* Reads the file once, sets the session's units to those of the file, and begins a thread that
 * reads it again when it is asked to; what goes wrong then is told in the window.
 * fails  false; as reading, ERROR_FAILED without a thread. */
bool live_solved_start(LiveSolved *live, Session *session, Mailbox *mailbox, Control *control,
                       Error *err);
/* Waits for the end, after control->quit. */
void live_solved_join(LiveSolved *live);

#endif
