/* SPDX-License-Identifier: BSD-3-Clause */
/* Signals: one flag. */
#include "app/signals.h"

#include <signal.h>
#include <stddef.h>

/* The one variable of file scope in the program: a handler has no other way to tell. */
static volatile sig_atomic_t signal_seen;

static void take_signal(int number)
{
    signal_seen = 1;
    /* The next one finds no handler and ends the program. */
    signal(SIGINT, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
    (void)number;
}

void signals_install(void)
{
    struct sigaction action = { .sa_handler = take_signal, .sa_flags = SA_RESTART };
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
}

bool signals_seen(void)
{
    return signal_seen != 0;
}
