// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/formats/layouts/layout.h"

namespace slamdb {

// What a source says about the layout that was not understood.
struct SLAMDB_EXPORT LayoutQuestion {
  std::string file;  // in the folder; empty: it is about no file
  std::uint32_t line = 0;
  std::string text;

  friend bool operator==(const LayoutQuestion&, const LayoutQuestion&) = default;
};

struct SLAMDB_EXPORT DerivedLayout {
  Layout layout;  // types that were not understood are `?`, which ParseLayout does not take
  std::vector<LayoutQuestion> questions;
  std::vector<std::string> missing;  // what a layout needs and the sources do not have; a `?` is not among it
  std::string known;                 // the id of the known layout that it is where long and size_t have 8 bytes
  std::uint64_t files = 0;           // that were looked at
};

struct SLAMDB_EXPORT SourceText {
  std::string file, text;
};

// The layout of the archives that C++ sources write: their serialize, save and helper functions and the declarations of
// the members, from the function that makes the archive on. Nothing is compiled or guessed: a type or statement that is
// not understood is a question. Members of ORB-SLAM3's keep the names they have in v1.0.
//
// Time grows with the text alone. Thread-safe.
[[nodiscard]] SLAMDB_EXPORT DerivedLayout DeriveLayout(std::span<const SourceText> sources);

// Of the .h, .hh, .hpp, .hxx, .cc, .cpp and .cxx files in a folder and those in it, in the order of their names.
// Links are not followed.
//
// Throws Error: kNotFound, kUsage when it is no folder, kNotPossible when it has no such files, kOutOfResources when
// they are more than 20,000 or 256 MB.
[[nodiscard]] SLAMDB_EXPORT DerivedLayout DeriveLayoutOfFolder(const std::string& folder);

}  // namespace slamdb
