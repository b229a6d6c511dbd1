// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/detail/remains.h"

#include <algorithm>

#include "slamdb/edit/part/detail/archive_size.h"
#include "slamdb/edit/part/detail/free_features.h"

namespace slamdb::detail {
namespace {

// Of an atlas without its keyframes and points.
std::uint64_t BytesAround(const Atlas& atlas) {
  Atlas around;
  around.cameras = atlas.cameras;
  around.maps.resize(atlas.maps.size());
  return ArchiveBytes(around);
}

}  // namespace

Remains::Remains(const Sights& sights, const KeyFrameBudget& budget)
    : sights_(sights),
      budget_(budget),
      kept_(sights.keyframes(), 0),
      own_bytes_(sights.keyframes()),
      all_bytes_(sights.keyframes(), 0),
      view_bytes_(sights.keyframes(), 0),
      views_(sights.keyframes(), 0),
      weights_(sights.points(), 0),
      is_dropped_(sights.points(), 0),
      bytes_(BytesAround(sights.atlas())) {
  for (std::uint32_t row = 0; row < sights.keyframes(); ++row) {
    const KeyFrame& keyframe = sights.KeyFrameOf(row);
    const std::uint64_t measurements = sizeof(ImuMeasurement) * keyframe.preintegration.measurements.size();
    own_bytes_[row] = ArchiveBytes(keyframe) - measurements;
    if (!budget.lean) bytes_ += measurements;  // joined over gaps, all may stay
    if (!budget.lean) continue;
    const FeatureSizes sizes = SizesOf(keyframe.features);
    own_bytes_[row] -= sizes.all + sizes.unused;
    all_bytes_[row] = sizes.all;
    view_bytes_[row] = sizes.of_view;
  }
  for (const std::uint32_t keyframe : sights.InOrder()) {
    kept_[keyframe] = 1;
    ++keyframes_;
    for (const auto& [point, weight] : sights.PointsOf(keyframe)) weights_[point] += weight;
  }
  for (std::uint32_t point = 0; point < sights.points(); ++point) {
    if (!Stays(point)) continue;
    ++points_;
    bytes_ += ArchiveBytes(MapPoint()) + kArchiveBytesPerObservation * sights.ObserversOf(point).size();
    for (const Sights::Sight& observer : sights.ObserversOf(point)) ++views_[observer.number];
  }
  for (std::uint32_t keyframe = 0; keyframe < sights.keyframes(); ++keyframe)
    if (Keeps(keyframe)) bytes_ += KeyFrameBytes(keyframe, views_[keyframe]);
}

std::uint64_t Remains::KeyFrameBytes(std::uint32_t keyframe, std::uint32_t views) const {
  // A keyframe that sees nothing keeps its features, see DropFreeFeatures.
  const std::uint64_t features = views == 0 ? all_bytes_[keyframe] : view_bytes_[keyframe] * views;
  return own_bytes_[keyframe] + std::min(features, all_bytes_[keyframe]);
}

std::vector<std::uint32_t> Remains::GoingWith(std::uint32_t keyframe) const {
  std::vector<std::uint32_t> going;
  const std::span<const Sights::Sight> seen = sights_.PointsOf(keyframe);
  for (std::size_t i = 0; i < seen.size();) {
    const std::uint32_t point = seen[i].number;
    std::uint32_t weight = 0;  // a damaged map may have a point twice
    for (; i < seen.size() && seen[i].number == point; ++i) weight += seen[i].weight;
    if (Stays(point) && weights_[point] - weight < sights_.Need(point)) going.push_back(point);
  }
  return going;
}

std::uint64_t Remains::BytesOf(std::uint32_t keyframe, std::span<const std::uint32_t> going) const {
  static const std::uint64_t point_bytes = ArchiveBytes(MapPoint());
  std::uint64_t bytes = KeyFrameBytes(keyframe, views_[keyframe]) + kArchiveBytesPerObservation * views_[keyframe];
  for (const std::uint32_t point : going) {
    bytes += point_bytes;
    for (const Sights::Sight& observer : sights_.ObserversOf(point))
      if (observer.number != keyframe && Keeps(observer.number))
        bytes += kArchiveBytesPerObservation + view_bytes_[observer.number];
  }
  return bytes;
}

void Remains::Remove(std::uint32_t keyframe, std::span<const std::uint32_t> going) {
  bytes_ -= KeyFrameBytes(keyframe, views_[keyframe]) + kArchiveBytesPerObservation * views_[keyframe];
  kept_[keyframe] = 0;
  --keyframes_;
  for (const std::uint32_t point : going) TakeOffBytes(point);
  for (const auto& [point, weight] : sights_.PointsOf(keyframe)) weights_[point] -= weight;
}

void Remains::Drop(std::span<const std::uint32_t> points) {
  for (const std::uint32_t point : points) {
    TakeOffBytes(point);
    is_dropped_[point] = 1;
  }
}

// Of the point, and of what keyframes that are kept see of it.
void Remains::TakeOffBytes(std::uint32_t point) {
  --points_;
  bytes_ -= ArchiveBytes(MapPoint());
  for (const Sights::Sight& observer : sights_.ObserversOf(point)) {
    if (!Keeps(observer.number)) continue;
    bytes_ -= KeyFrameBytes(observer.number, views_[observer.number]) + kArchiveBytesPerObservation;
    bytes_ += KeyFrameBytes(observer.number, --views_[observer.number]);
  }
}

Subset Remains::ToSubset() const {
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
