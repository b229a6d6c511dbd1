// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/detail/kept_views.h"

#include <algorithm>

#include "slamdb/edit/part/detail/archive_size.h"

namespace slamdb::detail {

std::uint64_t PointBytes(std::uint64_t observers) {
  static const std::uint64_t alone = ArchiveBytes(MapPoint());
  return alone + kArchiveBytesPerObservation * observers;
}

KeptViews::KeptViews(const Sights& sights, std::size_t min_points, std::uint64_t bytes,
                     const std::vector<std::uint64_t>& keyframe_bytes)
    : sights_(sights),
      min_points_(min_points),
      keyframe_bytes_(keyframe_bytes),
      kept_(sights.keyframes(), 0),
      views_(sights.keyframes(), 0),
      weights_(sights.points(), 0),
      observers_(sights.points(), 0),
      bytes_(bytes) {}

void KeptViews::Remove(std::uint32_t keyframe) {
  kept_[keyframe] = 0;
  --keyframes_;
  for (const auto& [point, weight] : sights_.PointsOf(keyframe)) {
    const bool stayed = Stays(point);
    weights_[point] -= weight;
    --observers_[point];
    if (!stayed || Stays(point)) continue;
    --quality_.points;
    for (const Sights::Sight& place : sights_.ObserversOf(point))
      if (views_[place.number]-- == min_points_) --quality_.covered;
  }
  bytes_ -= BytesWith(keyframe) - bytes_;
}

std::uint64_t KeptViews::BytesWith(std::uint32_t keyframe) const {
  std::uint64_t bytes = bytes_ + keyframe_bytes_[keyframe];
  for (const auto& [point, weight] : sights_.PointsOf(keyframe)) {
    if (Stays(point))
      bytes += kArchiveBytesPerObservation;
    else if (weights_[point] + weight >= sights_.Need(point))
      bytes += PointBytes(observers_[point] + 1);
  }
  return bytes;
}

Subset KeptViews::ToSubset() const {
  Subset subset = Subset::Nothing(sights_.atlas());
  for (std::uint32_t keyframe = 0; keyframe < kept_.size(); ++keyframe)
    subset.maps[sights_.RowOf(keyframe).map].keyframes[sights_.RowOf(keyframe).row] = kept_[keyframe];
  for (std::size_t map = 0; map < subset.maps.size(); ++map) {
    Subset::MapRows& rows = subset.maps[map];
    for (std::uint32_t row = 0; row < rows.points.size(); ++row)
      rows.points[row] = Stays(sights_.FirstPoint(map) + row) ? 1 : 0;
    if (rows.keyframes.empty() || std::ranges::count(rows.keyframes, 1) > 0)
      std::ranges::fill(rows.landmarks, std::uint8_t{1});
  }
  return subset;
}

}  // namespace slamdb::detail
