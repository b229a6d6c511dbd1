// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/detail/sights.h"

#include <algorithm>
#include <tuple>

#include "slamdb/model/derive.h"

namespace slamdb::detail {
namespace {

constexpr std::uint32_t kStays = 2;  // what must be left of the weight of a point that loses observers

}  // namespace

Sights::Sights(const AtlasIndex& index) : atlas_(&index.atlas()) {
  point_begins_.push_back(0);
  for (std::uint32_t map = 0; map < atlas_->maps.size(); ++map) {
    const auto first_keyframe = static_cast<std::uint32_t>(rows_.size());
    for (std::uint32_t row = 0; row < atlas_->maps[map].keyframes.size(); ++row) rows_.push_back({map, row});
    first_point_.push_back(static_cast<std::uint32_t>(needs_.size()));
    ListObservers(index, map, first_keyframe);
  }
  ListPoints();
}

void Sights::ListObservers(const AtlasIndex& index, std::size_t map, std::uint32_t first_keyframe) {
  for (const MapPoint& point : atlas_->maps[map].points) {
    for (const Observation& observation : point.observations) {
      const std::uint32_t row = point.bad ? kNoRow : index.KeyFrameRow(map, observation.keyframe);
      if (row == kNoRow || atlas_->maps[map].keyframes[row].bad) continue;
      const std::int32_t weight = ObservationWeight(atlas_->maps[map].keyframes[row], observation);
      by_point_.push_back({first_keyframe + row, static_cast<std::uint32_t>(weight)});
    }
    // A point that loses nothing stays, however little it weighs.
    const std::size_t seen = by_point_.size() - point_begins_.back();
    const bool one = seen == 1 && point.observations.size() == 1;
    needs_.push_back(one && by_point_.back().weight > 0 ? std::min(kStays, by_point_.back().weight) : kStays);
    point_begins_.push_back(by_point_.size());
  }
}

void Sights::ListPoints() {
  keyframe_begins_.assign(rows_.size() + 1, 0);
  for (const Sight& observer : by_point_) ++keyframe_begins_[observer.number + 1];
  for (std::size_t i = 1; i < keyframe_begins_.size(); ++i) keyframe_begins_[i] += keyframe_begins_[i - 1];
  std::vector<std::size_t> next(keyframe_begins_.begin(), keyframe_begins_.end() - 1);
  by_keyframe_.resize(by_point_.size());
  for (std::uint32_t point = 0; point < needs_.size(); ++point)
    for (const Sight& observer : ObserversOf(point)) by_keyframe_[next[observer.number]++] = {point, observer.weight};
}

std::vector<std::uint32_t> Sights::InOrder() const {
  std::vector<std::uint32_t> order;
  for (std::uint32_t keyframe = 0; keyframe < rows_.size(); ++keyframe)
    if (!KeyFrameOf(keyframe).bad) order.push_back(keyframe);
  std::ranges::stable_sort(
      order, {}, [&](std::uint32_t keyframe) { return std::tuple(rows_[keyframe].map, KeyFrameOf(keyframe).id); });
  return order;
}

}  // namespace slamdb::detail
