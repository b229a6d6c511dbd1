// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/dry_run.h"

namespace slamdb::detail {

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

}  // namespace slamdb::detail
