// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "slamdb/edit/merge/detail/branch_landmarks.h"
#include "slamdb/edit/merge/detail/point_classes.h"
#include "slamdb/edit/merge/three_way.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/index.h"

// Which things of three atlases are in what is made of two of them. Equal ids are one thing in all maps.
namespace slamdb::detail {

struct StructureOptions {
  BranchSide prefer = BranchSide::kOurs;
  BranchGeometry geometry = BranchGeometry::kAlign;
  bool flags_of_ours = false;  // those of the IMU stay as ours has them: the frame is that of ours, and theirs is not
  const LandmarkPlan& landmarks;
  int threads = 0;
};

struct StructureReport {
  std::vector<BranchConflict> conflicts;
  std::uint64_t dangling = 0;   // references that led nowhere
  std::uint64_t recounted = 0;  // keyframes whose covisibility was counted anew
  std::size_t own_points = 0;   // those from this row on are of theirs alone
  bool took_any = false;        // something of theirs is in the result
  // Points of both sides that one keypoint sees: {of the side that is taken, the other}.
  std::vector<std::pair<MapPointId, MapPointId>> coincide;
};

// Merges the changes from `base` to `theirs` into `ours`, which both lie already where the result is. `base` may be
// null. `moved_by_ours` and `moved_by_theirs`: whether a point, by row, is elsewhere than in the base.
//
// Cost: linear, but for sorting.
StructureReport MergeStructure(const Map* base, Map& ours, Map& theirs, const PointClasses& classes,
                               const std::vector<std::uint8_t>& moved_by_ours,
                               const std::vector<std::uint8_t>& moved_by_theirs, const StructureOptions& options);

}  // namespace slamdb::detail
