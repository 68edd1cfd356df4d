/* SPDX-License-Identifier: BSD-3-Clause */
/* The reference: the walk in plain C, one box and one triangle at a time. */
#include "raycast/internal.h"
#include "raycast/single_scalar.h"

#define node_push scalar_push
#define groups_test scalar_groups
#include "raycast/trace.h"

const Kernel kernel_scalar = KERNEL_TABLE("scalar", singles_nearest, singles_blocked, NULL,
                                           singles_nearest, singles_blocked);
