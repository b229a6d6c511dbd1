// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

#include "slamdb/edit/merge/join.h"

namespace slamdb {

// What two maps have in common.
struct Anchors {
  std::vector<KeyFramePair> keyframes;
  std::vector<PlacePair> places;
};

// `12:7,30:41`: pairs of keyframe ids, first map's first. Throws Error.
Anchors ParseAnchors(std::string_view text);

// A CSV table with the columns `first,second` of keyframe ids, or
// `first_x,first_y,first_z,second_x,second_y,second_z` of a place in the coordinates of both maps, or all of them,
// where what does not apply is empty. Other columns are ignored. Throws Error with the line.
Anchors ParseAnchorsCsv(std::string_view csv);

}  // namespace slamdb
