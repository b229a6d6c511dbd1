// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>

#include "slamdb/base/column.h"

namespace slamdb::detail {

// Makes `count` blocks of bytes on `threads` threads (0: every core) and hands them over in order: `make(i, buffer)`
// fills an empty buffer and may run on any thread, several at a time; `take(i, buffer)` always runs on the caller's.
// While the next block is not ready the caller makes it itself. At most a few blocks per thread exist at a time, so
// memory does not grow with `count`. The first exception, in order of blocks, is rethrown.
void ProduceInOrder(std::size_t count, int threads,
                    const std::function<void(std::size_t i, Column<char>& buffer)>& make,
                    const std::function<void(std::size_t i, const Column<char>& buffer)>& take);

}  // namespace slamdb::detail
