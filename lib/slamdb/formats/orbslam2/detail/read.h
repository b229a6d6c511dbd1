// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::orbslam2 {

// A file as it is: one map with all objects that its pointers lead to, by id; links are ids.
struct RecordedMap {
  Map map;
  std::uint64_t next_keyframe = 0, next_point = 0;  // static members, the largest recorded
  std::uint64_t without_pose = 0;                   // keyframes
  // Neither flagged bad nor in the map's own sets.
  std::uint64_t loose_keyframes = 0, loose_points = 0;
};

// Throws Error.
// Memory: that of the atlas, and of one record for each object that is not yet read to its end.
RecordedMap ReadMap(const Source& source, const ReadOptions& options);

}  // namespace slamdb::orbslam2
