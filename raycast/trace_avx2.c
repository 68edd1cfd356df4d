/* SPDX-License-Identifier: BSD-3-Clause */
/* The walk with AVX2: one ray against a whole node, or 8 rays together. */
#include "raycast/internal.h"
#include "raycast/probe.h"

#ifdef ISOLUX_X86

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma,bmi2,popcnt"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,fma,bmi2,popcnt")
#endif

#include "raycast/single_avx2.h"

#include "raycast/trace.h"

#include "raycast/stream.h"

#include "raycast/herd.h"

#include "raycast/lanes_avx2.h"

#include "raycast/packet_many.h"

const Kernel kernel_avx2 = KERNEL_TABLE("avx2", packets_nearest, packets_blocked,
                                         packets_keys, stream_nearest, stream_blocked);

#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

#else
typedef int trace_avx2_is_empty_here; /* a file must declare something */
#endif
