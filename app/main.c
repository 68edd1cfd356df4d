/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux: reads the command line, runs the command, says how it ended. */
#include <string.h>

#include "app/commands.h"
#include "app/output.h"
#include "app/saving.h"
#include "app/signals.h"
#include "app/summary.h"
#include "viewer/bindings.h"

typedef bool (*CommandRun)(Pipeline *pipeline, int *exit_code, Error *err);

static CommandRun command_run(Command command)
{
    switch (command) {
    case COMMAND_RENDER:
        return cmd_render;
    case COMMAND_SOLVE:
        return cmd_solve;
    case COMMAND_FACTORS:
        return cmd_factors;
    case COMMAND_MEASURE:
        return cmd_measure;
    case COMMAND_CHECK:
        return cmd_check;
    case COMMAND_VALIDATE:
        return cmd_validate;
    case COMMAND_BENCH:
        return cmd_bench;
    case COMMAND_COMPARE:
        return cmd_compare;
    case COMMAND_DEVELOP:
        return cmd_develop;
    case COMMAND_VIEW:
        return cmd_view;
    case COMMAND_NONE:
        break;
    }
    return NULL;
}

/* One line on standard error, whatever the text holds. */
static int tell_error(const Error *err)
{
    fputs("isolux: ", stderr);
    for (const char *p = err->text; *p != '\0'; p++)
        fputc((unsigned char)*p < ' ' ? ' ' : *p, stderr);
    fputc('\n', stderr);
    return (int)err->code;
}

/* Runs the command of a session; the exit code. */
static int run(Session *session)
{
    Pipeline pipeline = { .session = session };
    Saving saving;
    Error err = { 0 }, summary_error = { 0 };
    int code = 0;
    session->holding = true;
    output_probe(session->options.json, &session->options, &err);
    output_probe(session->options.output, &session->options, &err);
    saving_begin(&saving, &pipeline, &err);
    progress_begin(&session->printer);
    if (!error_is_set(&err))
        command_run(session->options.command)(&pipeline, &code, &err);
    progress_clear(&session->printer);
    if (error_is_set(&saving.error))
        err = saving.error;
    /* A stop kills the importing child, or anything else that then fails: it is still a stop. */
    if (error_is_set(&err))
        code = session_stopped(session) && err.code == ERROR_FAILED && !session->broken
                   ? ERROR_STOPPED : (int)err.code;
    if (code != ERROR_INPUT)
        session_release(session);
    if (!session->told && !summary_write(&pipeline, code, &err, &summary_error) &&
        !error_is_set(&err)) {
        err = summary_error;
        code = (int)err.code;
    }
    if (error_is_set(&err))
        tell_error(&err);
    saving_end(&saving, code == 0 || code == 4);
    pipeline_clear(&pipeline);
    return code;
}

/* Data on standard output counts only when it arrived there. */
static int close_output(int code)
{
    if (fflush(stdout) != 0 || ferror(stdout)) {
        if (code == 0)
            fputs("isolux: standard output cannot be written\n", stderr);
        return code == 0 ? ERROR_FAILED : code;
    }
    return code;
}

int main(int argc, char **argv)
{
    Options options;
    Session session;
    Error err = { 0 };
    if (argc < 2) {
        help_program(stderr);
        return ERROR_USAGE;
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 ||
        strcmp(argv[1], "help") == 0) {
        help_program(stdout);
        return close_output(0);
    }
    if (strcmp(argv[1], "--version") == 0) {
        help_version(stdout);
        return close_output(0);
    }
    if (!options_parse(&options, argc - 1, argv + 1, &err))
        return tell_error(&err);
    if (options.help) {
        help_command(stdout, options.command);
        return close_output(0);
    }
    signals_install();
    session_init(&session, &options);
    int code = 0;
    if (options.list_bindings)
        bindings_list(stdout);
    else if (options.print_config)
        quality_print(stdout, &options, &session.settings);
    else
        code = run(&session);
    session_clear(&session);
    return close_output(code);
}
