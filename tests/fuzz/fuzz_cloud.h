// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "slamdb/formats/format.h"
#include "tests/fuzz/require.h"

namespace slamdb::fuzz {

inline std::string WrittenCloud(const Format& format, const Atlas& atlas) {
  std::string bytes;
  Notices notices;
  const Target::Sink sink = [&](Bytes block) {
    bytes.append(reinterpret_cast<const char*>(block.data()), block.size());
  };
  format.write(atlas, {sink, "fuzz"}, {.threads = 1}, notices);
  return bytes;
}

inline Atlas ReadCloud(const Format& format, std::string_view bytes) {
  Notices notices;
  return format.read({std::as_bytes(std::span(bytes)), "fuzz"}, {.threads = 1}, notices);
}

// Any bytes as a point cloud. They are read or fail with an Error; what was read is written to a file that reads to the
// same file again, once ids above 2^53 are those that a double tells from others.
inline void TryCloud(const Format& format, std::string_view bytes) {
  MayRefuse([&] {
    const std::string once = WrittenCloud(format, ReadCloud(format, WrittenCloud(format, ReadCloud(format, bytes))));
    Require(WrittenCloud(format, ReadCloud(format, once)) == once, "what was written reads to the same");
  });
}

}  // namespace slamdb::fuzz
