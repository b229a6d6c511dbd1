// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/notices.h"
#include "slamdb/edit/merge/join.h"
#include "slamdb/export.h"

namespace slamdb {

// What two maps have in common.
struct Anchors {
  std::vector<KeyFramePair> keyframes;
  std::vector<PlacePair> places;
};

// `12:7,30:41`: pairs of keyframe ids, first map's first.
//
// Throws Error (kUsage).
[[nodiscard]] SLAMDB_EXPORT Anchors ParseAnchors(std::string_view text);

// A table in any dialect of schema/tables.md with the columns `first,second` of keyframe ids, or
// `first_x,first_y,first_z,second_x,second_y,second_z` of a place in the coordinates of both maps, or all of them,
// where what does not apply is empty.
// Other columns are ignored. Without names two columns are keyframes, six places.
//
// Throws Error (kDamaged) with line and column.
[[nodiscard]] SLAMDB_EXPORT Anchors ParseAnchorsCsv(std::string_view csv);

// The pairs themselves, or a file that holds the table.
//
// Throws Error as the two above, of a file with its path.
[[nodiscard]] SLAMDB_EXPORT Anchors ReadAnchors(const std::string& text_or_path, Notices* notices = nullptr);

}  // namespace slamdb
