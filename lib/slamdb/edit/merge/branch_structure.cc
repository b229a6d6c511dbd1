// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/detail/branch_structure.h"

#include <algorithm>
#include <utility>

#include "slamdb/edit/merge/detail/branch_structure_merge.h"
#include "slamdb/edit/merge/detail/refresh_points.h"
#include "slamdb/edit/part/subset.h"
#include "slamdb/model/detail/covisibility.h"
#include "slamdb/model/detail/observed.h"

namespace slamdb::detail {

StructureReport StructureMerge::Run() {
  ListClasses();
  DecideKeyFrames();
  DecidePoints();
  CollectExtras();
  MergeKeypoints();
  MergeKeyFrames();
  MergePoints();
  MergeHeader();
  if (changed_) Close();
  return std::move(report_);
}

StructureMerge::Class* StructureMerge::FindClass(MapPointId id) {
  const auto found = id ? class_rows_.find(id.value()) : class_rows_.end();
  return found == class_rows_.end() ? nullptr : &class_list_[found->second];
}

void StructureMerge::ListClasses() {
  const auto each = [&](const View& view, const auto& note) {
    if (view.map == nullptr) return;
    for (std::uint32_t row = 0; row < view.map->points.size(); ++row) {
      const MapPointId point = view.map->points[row].id, id = classes_.Of(point);
      const auto [found, is_new] = class_rows_.emplace(id.value(), class_list_.size());
      if (is_new) class_list_.push_back({.id = id});
      note(class_list_[found->second], row, point == id);
    }
  };
  each(ours_, [](Class& of, std::uint32_t row, bool own) {
    if (of.ours == kNoRow || own) of.ours = row;
  });
  each(base_, [](Class& of, std::uint32_t, bool) { of.in_base = true; });
  each(theirs_, [](Class& of, std::uint32_t row, bool own) {
    if (of.theirs == kNoRow || own) of.theirs = row;
  });
}

bool StructureMerge::IsExtended(const View& side, const KeyFrame& before, const KeyFrame& now) const {
  bool gains = false;
  ForEachGain(side, side.Row(now.id), [&](MapPointId) { gains = true; });
  const auto is_new_child = [&](KeyFrameId child) { return side.Find(child) && !base_.Find(child); };
  return gains || HasMore(now.loop_edges, before.loop_edges) || HasMore(now.merge_edges, before.merge_edges) ||
         std::ranges::any_of(now.children, is_new_child);
}

void StructureMerge::Conflict(Place place, std::string_view what, BranchSide taken) {
  place.map = ours_map_.id;
  report_.conflicts.push_back({place, what, taken});
}

void StructureMerge::DecideKeyFrames() {
  gone_keyframes_.assign(ours_map_.keyframes.size(), 0);
  taken_keyframes_.assign(theirs_map_.keyframes.size(), 0);
  for (std::uint32_t row = 0; row < ours_map_.keyframes.size(); ++row) {
    const KeyFrame& keyframe = ours_map_.keyframes[row];
    const KeyFrame* before = base_.map ? base_.Find(keyframe.id) : nullptr;
    if (before == nullptr || theirs_.Find(keyframe.id)) continue;
    if (IsExtended(ours_, *before, keyframe)) {
      Conflict({.keyframe = keyframe.id}, "deletion", BranchSide::kOurs);
    } else {
      gone_keyframes_[row] = 1;
      changed_ = true;
    }
  }
  for (std::uint32_t row = 0; row < theirs_map_.keyframes.size(); ++row) {
    const KeyFrame& keyframe = theirs_map_.keyframes[row];
    if (ours_.Find(keyframe.id)) continue;
    const KeyFrame* before = base_.map ? base_.Find(keyframe.id) : nullptr;
    if (before != nullptr && !IsExtended(theirs_, *before, keyframe)) continue;
    if (before != nullptr) Conflict({.keyframe = keyframe.id}, "deletion", BranchSide::kTheirs);
    taken_keyframes_[row] = 1;
    changed_ = report_.took_any = true;
  }
}

bool StructureMerge::Stays(KeyFrameId id) const {
  if (const std::uint32_t row = ours_.Row(id); row != kNoRow) return !gone_keyframes_[row];
  const std::uint32_t row = theirs_.Row(id);
  return row != kNoRow && taken_keyframes_[row];
}

void StructureMerge::DecidePoints() {
  const auto gains = [&](const View& side, bool Class::*extended) {
    for (std::uint32_t row = 0; row < side.map->keyframes.size(); ++row)
      if (Stays(side.map->keyframes[row].id))
        ForEachGain(side, row, [&](MapPointId id) {
          if (Class* of = FindClass(id)) of->*extended = true;
        });
  };
  gains(ours_, &Class::extended_by_ours);
  gains(theirs_, &Class::extended_by_theirs);
  for (Class& of : class_list_) {
    if (of.ours != kNoRow && of.theirs != kNoRow) continue;
    if (of.ours == kNoRow && of.theirs == kNoRow) {
      of.fate = Fate::kGone;
    } else if (of.in_base) {
      const bool is_ours = of.ours != kNoRow;
      of.fate = (is_ours ? of.extended_by_ours : of.extended_by_theirs) ? Fate::kKept : Fate::kGone;
      if (of.fate == Fate::kKept)
        Conflict({.point = of.id}, "deletion", is_ours ? BranchSide::kOurs : BranchSide::kTheirs);
    }
  }
}

void StructureMerge::Close() {
  RefreshPoints(ours_map_, changed_points_);
  RecountCovisibility();
  RefreshViews();
  CutOut();
}

void StructureMerge::RecountCovisibility() {
  const IdTable keyframes = KeyFrameTable(ours_map_), points = PointTable(ours_map_);
  std::vector<std::uint32_t> rows;
  const auto add = [&](const std::vector<MapPointId>& list, const auto& counts) {
    for (const MapPointId id : list)
      for (const Observation& observation : ours_map_.points[points.Find(id.value())].observations)
        if (const std::uint32_t row = keyframes.Find(observation.keyframe.value()); row != kNoRow && counts(row))
          rows.push_back(row);
  };
  add(seen_otherwise_, [](std::uint32_t) { return true; });
  add(of_one_side_,
      [&](std::uint32_t row) { return row < own_keyframes_ && theirs_.Find(ours_map_.keyframes[row].id); });
  std::ranges::sort(rows);
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  UpdateCovisibility(ours_map_, rows);
  report_.recounted = rows.size();
}

void StructureMerge::RefreshViews() {
  const IdTable keyframes = KeyFrameTable(ours_map_), points = PointTable(ours_map_);
  const auto find = [&](KeyFrameId id) -> const KeyFrame* {
    const std::uint32_t row = keyframes.Find(id.value());
    return row == kNoRow ? nullptr : &ours_map_.keyframes[row];
  };
  for (const MapPointId id : moved_points_)
    if (const std::uint32_t row = points.Find(id.value()); row != kNoRow)
      RefreshView(find, /*own_normal=*/false, /*own_range=*/false, ours_map_.points[row]);
}

void StructureMerge::CutOut() {
  Atlas alone;
  alone.maps.push_back(std::move(ours_map_));
  Subset subset = Subset::Everything(alone);
  Subset::MapRows& rows = subset.maps.front();
  for (std::size_t row = 0; row < gone_keyframes_.size(); ++row) rows.keyframes[row] = !gone_keyframes_[row];
  for (std::size_t row = 0; row < gone_points_.size(); ++row) rows.points[row] = !gone_points_[row];
  report_.own_points -= static_cast<std::size_t>(std::count_if(
      alone.maps.front().points.begin(),
      alone.maps.front().points.begin() + static_cast<std::ptrdiff_t>(report_.own_points), [&](const MapPoint& point) {
        const auto row = static_cast<std::size_t>(&point - alone.maps.front().points.data());
        return gone_points_[row] || point.observations.empty();
      }));
  KeepSubset(alone, subset, options_.threads);
  if (!alone.maps.empty()) ours_map_ = std::move(alone.maps.front());
}

StructureReport MergeStructure(const Map* base, Map& ours, Map& theirs, const PointClasses& classes,
                               const std::vector<std::uint8_t>& moved_by_ours,
                               const std::vector<std::uint8_t>& moved_by_theirs, const StructureOptions& options) {
  return StructureMerge(base, ours, theirs, classes, moved_by_ours, moved_by_theirs, options).Run();
}

}  // namespace slamdb::detail
