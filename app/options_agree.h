/* SPDX-License-Identifier: BSD-3-Clause */
/* Options that say nothing beside others of the same line are refused, not passed over. */
#ifndef APP_OPTIONS_AGREE_H
#define APP_OPTIONS_AGREE_H

#include "app/options.h"

/* False with ERROR_USAGE and one line for the first option that nothing would read. */
bool options_agree(const Options *options, Error *err);

#endif
