// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "slamdb/edit/merge/detail/branch_landmarks.h"
#include "slamdb/edit/merge/three_way.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/index.h"

// Which things of three atlases are in what is made of two of them. Equal ids are one thing in all maps.
namespace slamdb::detail {

// Points that a side replaced by others. All that go into one form a class, which goes by the name of one of them: of
// those that ours has, else of those that theirs has, the one of the lowest id.
class PointClasses {
 public:
  PointClasses() = default;
  PointClasses(const AtlasIndex& base, const AtlasIndex& ours, const AtlasIndex& theirs);

  MapPointId Of(MapPointId id) const {
    const auto found = classes_.find(id.value());
    return found == classes_.end() ? id : MapPointId(found->second);
  }
  // {gone, the name of its class}, ascending.
  std::vector<std::pair<MapPointId, MapPointId>> Gone() const;

 private:
  std::unordered_map<std::uint64_t, std::uint64_t> classes_;
};

struct StructureOptions {
  BranchSide prefer = BranchSide::kOurs;
  BranchGeometry geometry = BranchGeometry::kAlign;
  bool flags_of_ours = false;  // those of the IMU stay as ours has them: the frame is that of ours, and theirs is not
  bool theirs_has_no_members = false;  // of a fork, because its layout has none: those of the base are no deletion
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
