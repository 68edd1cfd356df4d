/* SPDX-License-Identifier: BSD-3-Clause */
/* base/parallel.h -- a loop over all cores whose result does not depend on how many there are.
 *
 * The range is cut into chunks of a fixed length; threads take chunks in order. What a chunk
 * computes must depend on its index range alone and be written to places of its own; sums over
 * chunks are formed afterwards in the order of the chunks.
 *
 * Threads  may be called from any thread, also from several at once; not from inside a chunk.
 */
#ifndef BASE_PARALLEL_H
#define BASE_PARALLEL_H

#include <stdbool.h>
#include <stdint.h>

#include "base/monitor.h"

/* begin..end-1 of the range; `worker` < parallel_threads(...) names the thread: scratch space. */
typedef void (*ParallelBody)(void *context, uint32_t begin, uint32_t end, unsigned worker);

/* How many threads a wish stands for: 0 is one per core that this process may use. At most 1024. */
unsigned parallel_threads(unsigned wished);

/* Runs body over 0..count-1 in chunks of `chunk` > 0. When `base` is not NULL, the calling thread
 * reports *base with `done` and `rays` scaled by the share of chunks finished, several times a
 * second.
 * Returns true when all was done, false when the monitor said stop (chunks begun are finished). */
bool parallel_for(uint32_t count, uint32_t chunk, unsigned threads, ParallelBody body,
                  void *context, const Monitor *monitor, const Progress *base);

#endif
