/* SPDX-License-Identifier: BSD-3-Clause */
/* app/signals.h -- the first Ctrl-C asks the work to stop and save, the second ends it at once. */
#ifndef APP_SIGNALS_H
#define APP_SIGNALS_H

#include <stdbool.h>

/* Takes SIGINT and SIGTERM; a closed pipe or a full quota become write errors instead. */
void signals_install(void);
/* Whether one has come. */
bool signals_seen(void);

#endif
