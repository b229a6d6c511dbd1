// SPDX-License-Identifier: BSD-3-Clause
#include "tests/formats/formats/in_memory.h"

#include "slamdb/formats/geographic/options.h"

namespace slamdb {

std::string Encoded(const Format& format, const Atlas& atlas, const WriteOptions& options, Notices& notices) {
  std::string encoded;
  const auto append = [&encoded](Bytes bytes) {
    encoded.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  format.write(atlas, Target(append, "memory"), options, notices);
  return encoded;
}

std::string Encoded(const Format& format, const Atlas& atlas, const WriteOptions& options) {
  Notices ignored;
  return Encoded(format, atlas, options, ignored);
}

bool TellsOfKeyFrames(const Format& format) { return format.id == "ply" || format.id == "pcd"; }

WriteOptions ForAnyFormat(const WriteOptions& options) {
  return options.With(GeographicOptions{.origin = Geodetic{48.15, 11.57, 519}});
}

Atlas Decoded(const Format& format, std::string_view bytes, const ReadOptions& options) {
  Notices ignored;
  return format.read({std::as_bytes(std::span(bytes)), "memory"}, options, ignored);
}

}  // namespace slamdb
