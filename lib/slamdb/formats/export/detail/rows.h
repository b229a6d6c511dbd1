// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <type_traits>

#include "slamdb/base/atomic_file.h"
#include "slamdb/formats/format.h"

namespace slamdb::detail {

template <class Buffer>
using AppendRows = std::type_identity_t<std::function<void(std::size_t begin, std::size_t end, Buffer& out)>>;

// Writes `count` rows to a file: `append(begin, end, out)` appends the rows of [begin, end) to `out` and is called from
// several threads at once, for blocks of at most `grain` rows; the blocks reach the file in order, so the bytes do not
// depend on the number of threads. Memory is bounded by a few blocks per thread. Calls options.progress in between.
//
// `Buffer`: std::string or Column<char>.
template <class Buffer = std::string>
void WriteRows(AtomicFile& file, std::size_t count, std::size_t grain, const WriteOptions& options,
               const AppendRows<Buffer>& append);

// How a format opens its output.
inline AtomicFileOptions FileOptions(const WriteOptions& options) {
  return {.overwrite = options.overwrite, .sync = options.sync, .before_commit = options.before_commit};
}

// `3,162 points, 41 bad ones left out`.
std::string CountWritten(std::size_t count, std::string_view noun, std::size_t bad);

}  // namespace slamdb::detail
