// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "slamdb/edit/merge/detail/branch_structure_merge.h"
#include "slamdb/model/detail/row_hash.h"

namespace slamdb::detail {
namespace {

Map HeaderOf(const Map& map) {
  Map header;
  ForEachField(&map, [&](std::string_view, auto member) { header.*member = map.*member; });
  return header;
}

}  // namespace

void StructureMerge::MergeHeader() {
  const Map* before = base_.map;
  const Map& theirs = theirs_map_;
  const auto merge = [&](auto field) {
    if (before == nullptr) return;
    const Pick pick = PickOf(&(before->*field), ours_map_.*field, theirs.*field);
    if (pick == Pick::kTheirs || (pick == Pick::kConflict && options_.prefer == BranchSide::kTheirs))
      ours_map_.*field = theirs.*field;
  };
  const Map was = HeaderOf(ours_map_);
  merge(&Map::initial_keyframe);
  merge(&Map::first_keyframe);
  merge(&Map::carried);
  if (!options_.flags_of_ours)
    for (const auto flag : {&Map::imu_initialized, &Map::inertial, &Map::imu_ba1, &Map::imu_ba2}) merge(flag);
  if (before != nullptr)
    ours_map_.big_change_index = static_cast<std::int32_t>(
        std::int64_t{ours_map_.big_change_index} + (std::int64_t{theirs.big_change_index} - before->big_change_index));
  for (const KeyFrameId origin : theirs.origins)
    if (std::ranges::find(ours_map_.origins, origin) == ours_map_.origins.end() &&
        (before == nullptr || std::ranges::find(before->origins, origin) == before->origins.end()))
      ours_map_.origins.push_back(origin);
  MergeLandmarks();
  if (report_.took_any) {
    ours_map_.max_keyframe_id = std::max(ours_map_.max_keyframe_id, theirs.max_keyframe_id);
    for (const KeyFrame& keyframe : theirs.keyframes)
      if (keyframe.id < ours_map_.lowest_keyframe && Stays(keyframe.id)) ours_map_.lowest_keyframe = keyframe.id;
  }
  changed_ |= HashOfHeader(HeaderOf(ours_map_)) != HashOfHeader(was);
}

void StructureMerge::MergeLandmarks() {
  const LandmarkPlan& plan = options_.landmarks;
  for (const BranchConflict& conflict : plan.conflicts) Conflict(conflict.place, conflict.what, conflict.taken);
  const bool took_any = plan.Apply(ours_map_.landmarks, theirs_map_.landmarks);
  changed_ |= took_any || std::ranges::find(plan.ours_stays, 0) != plan.ours_stays.end();
  report_.took_any |= took_any;
}

}  // namespace slamdb::detail
