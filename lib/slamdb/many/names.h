// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/export.h"
#include "slamdb/formats/location.h"

namespace slamdb {

// The longest suffix of a format that the path ends with (`.keyframes.csv`), or what stands behind its last dot.
[[nodiscard]] SLAMDB_EXPORT std::string SuffixOf(const std::string& path);

// The file's name without that suffix and its folders: what its atlas is called in a store.
[[nodiscard]] SLAMDB_EXPORT std::string StemOf(const std::string& path);

// What an atlas is called: `lab` of maps/lab.osa.txt and of maps.db#lab.
[[nodiscard]] SLAMDB_EXPORT std::string NameOf(const Location& atlas);

}  // namespace slamdb
