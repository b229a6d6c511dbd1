// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

#include "slamdb/export.h"

namespace slamdb::detail {

// How many threads to use for a request: 0 means every core.
SLAMDB_EXPORT int ThreadCount(int requested);

// At most `count` threads that run `help`, and as many fewer, down to none, as the system does not let start: callers
// do the work that nobody helps with.
SLAMDB_EXPORT std::vector<std::jthread> StartHelpers(std::size_t count, const std::function<void()>& help);

// Calls work(begin, end) for blocks of at most `grain` that together cover [0, count), on `threads` threads (0: every
// core) of which the caller is one. Blocks start in ascending order. Returns when all are done; the first exception is
// rethrown then. With one thread, or one block, it runs in the caller alone.
SLAMDB_EXPORT void ParallelFor(std::size_t count, std::size_t grain, int threads,
                               const std::function<void(std::size_t begin, std::size_t end)>& work);

}  // namespace slamdb::detail
