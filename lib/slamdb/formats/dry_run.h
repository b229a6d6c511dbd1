// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "slamdb/formats/format.h"

namespace slamdb {

// Options for writing in any format: with `bytes` all is done as it would be, notices and losses too, but nothing is
// written. Stores and custom formats are not asked: of them only WriteAtlas' own losses come.
struct DryRunOptions {
  std::uint64_t* bytes = nullptr;  // what the file would take; of several files the one that is named, of a folder all
};

namespace detail {

// The target, or in a dry run what counts the bytes in its place.
inline Target TargetOf(const Target& target, const WriteOptions& options) {
  std::uint64_t* bytes = options.of<DryRunOptions>().bytes;
  if (bytes == nullptr) return target;
  *bytes = 0;
  return {[bytes](Bytes more) { *bytes += more.size(); }, target.path};
}

// Whether the target is a file, or would be.
inline bool HasFile(const Target& target, const WriteOptions& options) {
  return target.path != "-" && (!target.sink || options.of<DryRunOptions>().bytes != nullptr);
}

}  // namespace detail
}  // namespace slamdb
