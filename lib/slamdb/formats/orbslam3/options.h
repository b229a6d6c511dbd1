// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "slamdb/export.h"

namespace slamdb {

// How .osa files are read.
struct SLAMDB_EXPORT Orbslam3ReadOptions {
  // The layout of the file: the id of a known one, or its JSON (formats/layouts/layout.h). `v1.0` is ORB-SLAM3's own.
  // Empty: v1.0, and where the file is not of that, the known one that fits. So is a file read, with a note, that is
  // not of the layout given, but whole in one of these.
  std::string layout;
};

// How .osa files are written, binary and text.
struct SLAMDB_EXPORT Orbslam3WriteOptions {
  // Library version of the archive, 10 to 255: 12 loads in Boost 1.58 and later, 18 in 1.73 and later.
  // nullopt: as read.
  std::optional<std::uint32_t> boost_version;
  // 8, or 4 for a reader with sizeof(long) == 4: Windows and 32-bit ARM.
  // nullopt: as read.
  std::optional<int> long_bytes;
  // Write what ORB-SLAM3 itself reads safely: uninitialised members zeroed, repeated and empty maps dropped.
  bool sanitize = false;
  // The layout that is written: the id of a known one, or its JSON. `v1.0` is ORB-SLAM3's own.
  // nullopt: as read.
  std::optional<std::string> layout;
};

}  // namespace slamdb
