/* SPDX-License-Identifier: BSD-3-Clause */
/* One run of the program. */
#include "app/session.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "app/signals.h"
#include "base/array.h"

static void print_warning(Session *session, const char *code, const char *where, const char *text)
{
    progress_clear(&session->printer);
    fprintf(stderr, "isolux: warning: %s%s%s [%s]\n", where, *where != '\0' ? ": " : "", text,
            code);
}

/* Keeps the warning for the summary and prints it; one that is said twice is kept once. */
static void take_warning(void *user, const char *code, const char *where, const char *text)
{
    Session *session = user;
    Error err = { 0 };
    assert(session != NULL && code != NULL && text != NULL);
    if (where == NULL)
        where = "";
    for (size_t i = 0; i < session->warning_count; i++)
        if (strcmp(session->warnings[i].code, code) == 0 &&
            strcmp(session->warnings[i].where, where) == 0 &&
            strcmp(session->warnings[i].text, text) == 0)
            return;
    const bool now = !session->quiet && !session->holding;
    if (now)
        print_warning(session, code, where, text);
    if (!array_reserve((void **)&session->warnings, &session->warning_capacity,
                       session->warning_count + 1, sizeof *session->warnings, "warnings", &err))
        return; /* it was printed at least */
    Warning *warning = &session->warnings[session->warning_count++];
    *warning = (Warning){ .code = array_string(code, &err), .where = array_string(where, &err),
                          .text = array_string(text, &err), .printed = now };
    if (error_is_set(&err)) {
        session->warning_count--;
        array_free(warning->code);
        array_free(warning->where);
        array_free(warning->text);
    }
}

void session_release(Session *session)
{
    session->holding = false;
    for (size_t i = 0; i < session->warning_count; i++) {
        Warning *warning = &session->warnings[i];
        if (!warning->printed && !session->quiet)
            print_warning(session, warning->code, warning->where, warning->text);
        warning->printed = true;
    }
}

static void take_progress(void *user, const Progress *progress)
{
    Session *session = user;
    progress_show(&session->printer, progress);
    if (session->tick != NULL)
        session->tick(session->tick_user);
}

bool session_stopped(const Session *session)
{
    return signals_seen() || progress_now() >= session->deadline;
}

static bool must_stop(void *user)
{
    const Session *session = user;
    return session->broken || (!session->hurry && session_stopped(session));
}

const char *session_stop_reason(void)
{
    return signals_seen() ? "interrupted" : "time limit reached";
}

void session_init(Session *session, const Options *options)
{
    assert(session != NULL && options != NULL);
    *session = (Session){ .options = *options, .settings = quality_settings(options) };
    session->monitor = (Monitor){ .user = session, .warn = take_warning,
                                  .progress = take_progress, .stop = must_stop };
    progress_init(&session->printer, (ProgressStyle)options->progress);
    session->deadline = INFINITY;
    if (options_given(options, OPTION_TIME_LIMIT))
        session->deadline = session->printer.start + options->time_limit;
}

void session_clear(Session *session)
{
    progress_end(&session->printer);
    for (size_t i = 0; i < session->warning_count; i++) {
        array_free(session->warnings[i].code);
        array_free(session->warnings[i].where);
        array_free(session->warnings[i].text);
    }
    session->warnings = array_free(session->warnings);
    session->warning_count = session->warning_capacity = 0;
}

void session_say(Session *session, const char *format, ...)
{
    if (session->options.progress == PROGRESS_NONE || session->options.progress == PROGRESS_JSON)
        return;
    va_list arguments;
    progress_clear(&session->printer);
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
}
