/* SPDX-License-Identifier: BSD-3-Clause */
/* app/session.h -- one run of the program: what was asked, what was noticed, when it must stop. */
#ifndef APP_SESSION_H
#define APP_SESSION_H

#include <stdbool.h>
#include <stddef.h>

#include "app/options.h"
#include "app/progress.h"
#include "app/quality.h"
#include "base/monitor.h"

typedef struct {
    char *code, *where, *text; /* owned */
    bool  printed;
} Warning;

typedef struct Session {
    Options         options;
    Settings        settings;
    Monitor         monitor;   /* hand this to the library; its user is the Session */
    ProgressPrinter printer;
    Warning        *warnings;  /* [warning_count] */
    size_t          warning_count, warning_capacity;
    double          deadline;  /* clock of progress_now; INFINITY: none */
    bool            hurry;     /* a stop was seen: finish roughly, do not stop again */
    bool            abrupt;    /* who asks to stop wants nothing finished, however roughly */
    bool            quiet;     /* keep warnings, print none */
    bool            holding;   /* keep warnings until session_release: a file that turns out to be
                                  unreadable shall give one line, not ten */
    bool            told;      /* the command wrote its own summary */
    bool            broken;    /* what was to be saved cannot be: stop, whatever is asked */
    void          (*tick)(void *user); /* called with each progress; NULL: not */
    void           *tick_user;
} Session;

void session_init(Session *session, const Options *options);
void session_clear(Session *session);

/* Whether a signal or the time limit has asked to stop, also when in a hurry already. */
bool session_stopped(const Session *session);
/* "interrupted" or "time limit reached". */
const char *session_stop_reason(void);

/* Prints the warnings held back so far, and later ones at once. */
void session_release(Session *session);

/* A line on standard error, unless --progress none. */
void session_say(Session *session, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
