/* SPDX-License-Identifier: BSD-3-Clause */
/* A child process for work that may crash, hang or eat all memory; and how its end is told. */
#include "scenes/import_child.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

/* AddressSanitizer reserves terabytes of address space: a limit on it would stop everything. */
#if defined(__SANITIZE_ADDRESS__)
#define CHILD_LIMITS_MEMORY 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define CHILD_LIMITS_MEMORY 0
#else
#define CHILD_LIMITS_MEMORY 1
#endif
#else
#define CHILD_LIMITS_MEMORY 1
#endif

/* The pipe's end in the child: the lowest number after the three standard ones. */
#define CHILD_PIPE 3

/* --- in the child ----------------------------------------------------------------------------- */

/* Address space that the process has already: the limit counts it. */
static uint64_t memory_mapped(void)
{
    unsigned long long pages = 0;
    FILE *file = fopen("/proc/self/statm", "re");

    if (file == NULL)
        return 0;
    if (fscanf(file, "%llu", &pages) != 1)
        pages = 0;
    fclose(file);
    return (uint64_t)pages * (uint64_t)sysconf(_SC_PAGESIZE);
}

static void limit_set(int resource, uint64_t value)
{
    struct rlimit limit;

    if (getrlimit((__rlimit_resource_t)resource, &limit) != 0)
        return;
    if (limit.rlim_max == RLIM_INFINITY || value < limit.rlim_max)
        limit.rlim_cur = limit.rlim_max = value;
    else
        limit.rlim_cur = limit.rlim_max;
    (void)setrlimit((__rlimit_resource_t)resource, &limit);
}

static void limits_set(const ChildLimits *limits)
{
    limit_set(RLIMIT_CORE, 0);
    limit_set(RLIMIT_CPU, (uint64_t)ceil(limits->seconds) + 1);
    if (CHILD_LIMITS_MEMORY)
        limit_set(RLIMIT_AS, memory_mapped() + limits->memory);
}

/* The program's own handlers make no sense here, and an interrupt from the keyboard is for the
 * parent to answer: it ends the child when it wants to stop. */
static void signals_reset(void)
{
    static const int plain[] = { SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTERM, SIGHUP,
                                 SIGALRM, SIGXCPU, SIGPIPE, SIGUSR1, SIGUSR2, SIGTRAP, SIGSYS };
    sigset_t none;

    for (size_t i = 0; i < sizeof plain / sizeof *plain; i++)
        signal(plain[i], SIG_DFL);
    signal(SIGINT, SIG_IGN);
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
}

/* Leaves the pipe and nothing else open, and nothing to print to. */
static void files_close(int pipe_end)
{
    const int nothing = open("/dev/null", O_RDWR);

    for (int fd = 0; fd < CHILD_PIPE && nothing >= 0; fd++)
        dup2(nothing, fd);
    if (pipe_end != CHILD_PIPE)
        dup2(pipe_end, CHILD_PIPE);
    closefrom(CHILD_PIPE + 1);
}

static _Noreturn void child_main(const ImportChild *child, ImportWork work, const char *path,
                                 int pipe_end)
{
    PipeWriter out = { .fd = CHILD_PIPE, .wish = child->limits.wish };
    Error err = { 0 };

    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
    signals_reset();
    files_close(pipe_end);
    limits_set(&child->limits);
    if (!work(path, &out, &err)) {
        if (!error_is_set(&err))
            error_at(&err, ERROR_INPUT, path, 0, "cannot be read");
        pipe_put_kind(&out, RECORD_ERROR);
        pipe_put_u32(&out, (uint32_t)err.code);
        pipe_put_text(&out, err.text);
    }
    pipe_flush(&out);
    _exit(0);
}

/* --- in the parent ---------------------------------------------------------------------------- */

/* A pipe whose ends are not the standard files, even in a program that closed those. */
static bool pipe_open(int ends[2])
{
    int raw[2];

    if (pipe2(raw, O_CLOEXEC) != 0)
        return false;
    for (int i = 0; i < 2; i++) {
        ends[i] = fcntl(raw[i], F_DUPFD_CLOEXEC, CHILD_PIPE);
        close(raw[i]);
    }
    if (ends[0] >= 0 && ends[1] >= 0)
        return true;
    for (int i = 0; i < 2; i++)
        if (ends[i] >= 0)
            close(ends[i]);
    return false;
}

bool child_start(ImportChild *child, const ChildLimits *limits, ImportWork work, const char *path,
                 Error *err)
{
    assert(child != NULL && limits != NULL && work != NULL && path != NULL && err != NULL);
    assert(limits->seconds > 0 && limits->memory > 0);
    int ends[2];

    *child = (ImportChild){ .limits = *limits, .pid = -1, .fd = -1 };
    if (!pipe_open(ends))
        return error_set(err, ERROR_FAILED, "%s: no pipe for the importer: %s", path,
                         strerror(errno));
    child->pid = fork();
    if (child->pid == 0)
        child_main(child, work, path, ends[1]);
    close(ends[1]);
    if (child->pid < 0) {
        close(ends[0]);
        return error_set(err, ERROR_FAILED, "%s: no process for the importer: %s", path,
                         strerror(errno));
    }
    child->fd = ends[0];
    return true;
}

void child_kill(ImportChild *child)
{
    assert(child != NULL && child->pid > 0);
    (void)kill(child->pid, SIGKILL);
}

/* A program that ignores SIGCHLD gets no status: then what came through the pipe decides. */
static bool child_wait(const ImportChild *child, int *status)
{
    for (;;) {
        const pid_t got = waitpid(child->pid, status, 0);
        if (got == child->pid)
            return true;
        if (got < 0 && errno != EINTR)
            return false;
    }
}

static const char *signal_words(int number)
{
    switch (number) {
    case SIGSEGV: return "segmentation fault";
    case SIGBUS: return "bus error";
    case SIGFPE: return "arithmetic error";
    case SIGILL: return "illegal instruction";
    case SIGABRT: return "abort";
    default: return "signal";
    }
}

bool child_finish(ImportChild *child, const char *path, Error *err)
{
    assert(child != NULL && child->pid > 0 && child->fd >= 0);
    int status = 0;

    close(child->fd);
    child->fd = -1;
    const bool known = child_wait(child, &status);
    child->pid = -1;
    if (error_is_set(err) || !known || (WIFEXITED(status) && WEXITSTATUS(status) == 0))
        return !error_is_set(err);
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
        return error_at(err, ERROR_INPUT, path, 0, "the importer needed more than %g seconds",
                        child->limits.seconds);
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
        return error_at(err, ERROR_INPUT, path, 0,
                        "the importer was killed, perhaps because memory ran out");
    if (WIFSIGNALED(status))
        return error_at(err, ERROR_INPUT, path, 0,
                        "the importer crashed (%s); the file is damaged or uses something it "
                        "cannot read", signal_words(WTERMSIG(status)));
    return error_at(err, ERROR_INPUT, path, 0, "the importer gave up (exit %d); the file is "
                    "damaged or uses something it cannot read", WEXITSTATUS(status));
}
