// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <type_traits>

#include "slamdb/base/column.h"
#include "slamdb/export.h"

namespace slamdb::detail {

template <class Buffer>
using MakeBlock = std::type_identity_t<std::function<void(std::size_t i, Buffer& buffer)>>;
template <class Buffer>
using TakeBlock = std::type_identity_t<std::function<void(std::size_t i, const Buffer& buffer)>>;

// Makes `count` blocks of bytes on `threads` threads (0: every core) and hands them over in order: `make(i, buffer)`
// fills an empty buffer and may run on any thread, several at a time; `take(i, buffer)` always runs on the caller's.
// While the next block is not ready the caller makes it itself. At most a few blocks per thread exist at a time, so
// memory does not grow with `count`. The first exception, in order of blocks, is rethrown.
//
// `Buffer`: Column<char>, Pieces or std::string.
template <class Buffer = Column<char>>
SLAMDB_EXPORT void ProduceInOrder(std::size_t count, int threads, const MakeBlock<Buffer>& make,
                                  const TakeBlock<Buffer>& take);

}  // namespace slamdb::detail
