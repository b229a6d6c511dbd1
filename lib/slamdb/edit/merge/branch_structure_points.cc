// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>

#include "slamdb/edit/merge/detail/branch_structure_merge.h"
#include "slamdb/edit/merge/detail/refresh_points.h"
#include "slamdb/edit/part/subset.h"
#include "slamdb/model/detail/observed.h"

namespace slamdb::detail {

void StructureMerge::MergePoints() {
  CollectObservations();
  for (Class& of : class_list_) {
    if (of.ours == kNoRow || of.theirs == kNoRow || of.fate == Fate::kGone) continue;
    MergePoint(of, ours_map_.points[of.ours], theirs_map_.points[of.theirs]);
  }
  report_.own_points = ours_map_.points.size();
  for (Class& of : class_list_) {
    if (of.fate == Fate::kGone) continue;
    if (of.ours != kNoRow) {
      SetObservations(of, ours_map_.points[of.ours]);
    } else {
      MapPoint& point = ours_map_.points.emplace_back(theirs_map_.points[of.theirs]);
      point.id = of.id;
      point.replaced_by = classes_.Of(point.replaced_by);
      SetObservations(of, point);
      changed_ = report_.took_any = true;
    }
  }
  MarkGonePoints();
  CullPoints();
}

void StructureMerge::CollectExtras() {
  extras_.resize(class_list_.size());
  for (const View* side : {&ours_, &theirs_})
    for (const MapPoint& point : side->map->points) {
      const std::size_t row = class_rows_.at(classes_.Of(point.id).value());
      if (side == &theirs_ && class_list_[row].ours != kNoRow) continue;
      for (const Observation& observation : point.observations) {
        const KeyFrame* keyframe = side->Find(observation.keyframe);
        if (keyframe == nullptr)
          ++report_.dangling;
        else if (Stays(observation.keyframe) && !Sightings::Sees(*keyframe, observation.left, point.id) &&
                 !Sightings::Sees(*keyframe, observation.right, point.id))
          extras_[row].push_back(observation);
      }
    }
}

void StructureMerge::CollectObservations() {
  std::vector<std::uint32_t> order(ours_map_.keyframes.size());
  for (std::uint32_t row = 0; row < order.size(); ++row) order[row] = row;
  std::ranges::sort(order, {}, [&](std::uint32_t row) { return ours_map_.keyframes[row].id; });
  for (const std::uint32_t row : order) {
    const KeyFrame& keyframe = ours_map_.keyframes[row];
    for (std::size_t slot = 0; slot < slots_[row].size(); ++slot) {
      if (!slots_[row][slot] || !listed_[row][slot]) continue;
      std::vector<Observation>& observations = ClassOf(slots_[row][slot]).observations;
      if (observations.empty() || observations.back().keyframe != keyframe.id)
        observations.push_back({.keyframe = keyframe.id});
      (IsRight(keyframe, slot) ? observations.back().right : observations.back().left) =
          static_cast<std::int32_t>(slot);
    }
  }
  for (std::size_t row = 0; row < extras_.size(); ++row)
    for (const Observation& extra : extras_[row]) {
      std::vector<Observation>& observations = class_list_[row].observations;
      const auto place = std::ranges::lower_bound(observations, extra.keyframe, {}, &Observation::keyframe);
      if (place == observations.end() || place->keyframe != extra.keyframe) observations.insert(place, extra);
    }
}

void StructureMerge::SetObservations(const Class& of, MapPoint& point) {
  const auto differs = [&](const Column<Observation>& list) { return !std::ranges::equal(list, of.observations); };
  if (of.theirs != kNoRow && differs(theirs_map_.points[of.theirs].observations)) seen_otherwise_.push_back(point.id);
  if (of.ours != kNoRow && differs(point.observations)) seen_otherwise_.push_back(point.id);
  if (of.ours == kNoRow || of.theirs == kNoRow) of_one_side_.push_back(point.id);
  if (!differs(point.observations)) return;
  point.observations.assign(of.observations.begin(), of.observations.end());
  changed_points_.push_back(point.id);
  changed_ = true;
}

void StructureMerge::CullPoints() {
  const IdTable keyframes = KeyFrameTable(ours_map_), points = PointTable(ours_map_);
  for (const MapPointId id : changed_points_) {
    MapPoint& point = ours_map_.points[points.Find(id.value())];
    std::int32_t weight = 0;
    for (const Observation& observation : point.observations)
      if (const std::uint32_t row = keyframes.Find(observation.keyframe.value()); row != kNoRow)
        weight += ObservationWeight(ours_map_.keyframes[row], observation);
    const std::int32_t before = point.observation_count;
    point.observation_count = weight;
    Class& of = ClassOf(classes_.Of(id));
    const MapPoint* there = of.theirs == kNoRow ? nullptr : &theirs_map_.points[of.theirs];
    if (weight > kCulledAt || std::max(before, there ? there->observation_count : 0) <= kCulledAt ||
        (there && std::ranges::equal(there->observations, point.observations)))
      continue;
    of.fate = Fate::kGone;
    gone_points_[points.Find(id.value())] = 1;
    for (const Observation& observation : point.observations)
      if (const std::uint32_t row = keyframes.Find(observation.keyframe.value()); row != kNoRow)
        std::ranges::replace(ours_map_.keyframes[row].features.map_points, id, MapPointId());
  }
}

void StructureMerge::MergePoint(const Class& of, MapPoint& ours, const MapPoint& theirs) {
  const MapPoint* before = base_.map ? base_.Find(ours.id) : nullptr;
  if (ours.id != theirs.id) before = nullptr;
  if (before != nullptr) {
    const auto merge = [&](auto field, std::string_view what) {
      const auto equal = [](const auto& a, const auto& b) { return a == b; };
      const Pick pick = PickOf(&(before->*field), ours.*field, theirs.*field, equal);
      if (pick == Pick::kOurs) return false;
      if (pick == Pick::kConflict) Conflict({.point = of.id}, what, options_.prefer);
      if (pick == Pick::kConflict && options_.prefer == BranchSide::kOurs) return false;
      ours.*field = theirs.*field;
      changed_ = report_.took_any = true;
      return true;
    };
    merge(&MapPoint::bad, "flags");
    merge(&MapPoint::replaced_by, "replacement");
    merge(&MapPoint::first_keyframe, "first keyframe");
    merge(&MapPoint::first_frame, "first frame");
    Restore(*before, ours);
    if (theirs.origin_map != MapPoint::kNoOrigin) merge(&MapPoint::origin_map, "origin map");
    merge(&MapPoint::carried, "members of a fork");
    MergeReference(*before, theirs, ours);
    AddCounts(*before, theirs, &MapPoint::visible_count, ours);
    AddCounts(*before, theirs, &MapPoint::found_count, ours);
  }
  MergePosition(of, ours, theirs);
}

// What an .osa file has no place for is not deleted in one.
void StructureMerge::Restore(const MapPoint& before, MapPoint& ours) {
  const auto restore = [&](auto field, auto none) {
    if (ours.*field != none || before.*field == none) return;
    ours.*field = before.*field;
    changed_ = true;
  };
  restore(&MapPoint::origin_map, MapPoint::kNoOrigin);
  restore(&MapPoint::visible_count, MapPoint::kNoCount);
  restore(&MapPoint::found_count, MapPoint::kNoCount);
}

void StructureMerge::AddCounts(const MapPoint& before, const MapPoint& theirs, std::int32_t MapPoint::*count,
                               MapPoint& ours) {
  if (theirs.*count == before.*count || theirs.*count == MapPoint::kNoCount) return;
  if (ours.*count == MapPoint::kNoCount || before.*count == MapPoint::kNoCount) {
    ours.*count = std::max(ours.*count, theirs.*count);
  } else {
    const std::int64_t sum = std::int64_t{ours.*count} + theirs.*count - before.*count;
    ours.*count = static_cast<std::int32_t>(std::clamp<std::int64_t>(sum, 0, std::numeric_limits<std::int32_t>::max()));
  }
  changed_ = report_.took_any = true;
}

void StructureMerge::MergeReference(const MapPoint& before, const MapPoint& theirs, MapPoint& ours) {
  const KeyFrameId was = before.reference, our = Restored(ours_, was, ours.reference),
                   their = Restored(theirs_, was, theirs.reference);
  const Pick pick = PickOf(&was, our, their);
  const bool take = pick == Pick::kTheirs || (pick == Pick::kConflict && options_.prefer == BranchSide::kTheirs);
  const KeyFrameId now = take ? their : our;
  if (now == ours.reference) return;
  ours.reference = now;
  moved_points_.push_back(ours.id);
  changed_ = true;
}

void StructureMerge::MergePosition(const Class& of, MapPoint& ours, const MapPoint& theirs) {
  const bool by_ours = moved_by_ours_[of.ours] != 0, by_theirs = moved_by_theirs_[of.theirs] != 0;
  Eigen::Vector3f position = ours.position;
  if (options_.geometry == BranchGeometry::kTheirs || (AlignsPoints() && by_theirs && !by_ours)) {
    position = theirs.position;
  } else if (AlignsPoints() && by_theirs) {
    const auto weight_of_ours = static_cast<float>(ours.observations.size() + 1),
               weight_of_theirs = static_cast<float>(theirs.observations.size() + 1);
    position =
        (weight_of_ours * ours.position + weight_of_theirs * theirs.position) / (weight_of_ours + weight_of_theirs);
  }
  if (position == ours.position || !position.allFinite()) return;
  ours.position = position;
  moved_points_.push_back(ours.id);
  changed_ = true;
}

bool StructureMerge::AlignsPoints() const {
  return options_.geometry == BranchGeometry::kAlign || options_.geometry == BranchGeometry::kOptimize;
}

void StructureMerge::MarkGonePoints() {
  gone_points_.assign(ours_map_.points.size(), 0);
  for (std::size_t row = 0; row < report_.own_points; ++row) {
    const MapPointId id = ours_map_.points[row].id;
    const Class& of = ClassOf(classes_.Of(id));
    if (of.fate != Fate::kGone && of.ours == row) continue;
    gone_points_[row] = 1;
    changed_ = true;
  }
}

}  // namespace slamdb::detail
