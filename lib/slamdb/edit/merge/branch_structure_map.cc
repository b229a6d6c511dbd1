// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "slamdb/edit/landmarks/landmarks.h"
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
  if (theirs_map_.landmarks.empty() && ours_map_.landmarks.empty()) return;
  std::unordered_map<std::uint64_t, const Landmark*> before, ours, theirs;
  const auto list = [](const std::vector<Landmark>& landmarks, auto& table) {
    for (const Landmark& landmark : landmarks)
      if (landmark.is_numbered()) table.emplace(landmark.id.value(), &landmark);
  };
  if (base_.map != nullptr) list(base_.map->landmarks, before);
  list(theirs_map_.landmarks, theirs);
  const auto find = [](const auto& table, LandmarkId id) {
    const auto found = table.find(id.value());
    return found == table.end() ? nullptr : found->second;
  };
  const auto differ = [](const Landmark& a, const Landmark& b) { return HashOf(a) != HashOf(b); };
  const std::size_t removed = std::erase_if(ours_map_.landmarks, [&](Landmark& ours_one) {
    const Landmark *was = find(before, ours_one.id), *other = find(theirs, ours_one.id);
    if (other != nullptr) MergeLandmark(was, *other, ours_one);
    if (was == nullptr || other != nullptr) return false;
    if (differ(*was, ours_one)) Conflict({.landmark = ours_one.id}, "deletion", BranchSide::kOurs);
    return !differ(*was, ours_one);
  });
  list(ours_map_.landmarks, ours);
  std::vector<Landmark> added;
  for (const Landmark& landmark : theirs_map_.landmarks) {
    if (find(ours, landmark.id) != nullptr) continue;
    const Landmark* was = find(before, landmark.id);
    if (was != nullptr && !differ(*was, landmark)) continue;
    if (was != nullptr) Conflict({.landmark = landmark.id}, "deletion", BranchSide::kTheirs);
    added.push_back(landmark);
  }
  changed_ |= removed + added.size() > 0;
  report_.took_any |= !added.empty();
  TakeLandmarks(ours_map_.landmarks, added);
}

void StructureMerge::MergeLandmark(const Landmark* before, const Landmark& theirs, Landmark& ours) {
  const std::int64_t was = before != nullptr ? HashOf(*before) : 0, our = HashOf(ours), their = HashOf(theirs);
  const Pick pick = PickOf(before != nullptr ? &was : nullptr, our, their);
  if (pick == Pick::kConflict) Conflict({.landmark = ours.id}, "landmark", options_.prefer);
  if (pick == Pick::kOurs || (pick == Pick::kConflict && options_.prefer == BranchSide::kOurs)) return;
  ours = theirs;
  changed_ = report_.took_any = true;
}

}  // namespace slamdb::detail
