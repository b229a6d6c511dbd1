// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/detail/archive_size.h"

namespace slamdb::detail {
namespace {

constexpr std::uint64_t kAtlasBytes = 300;  // header, vocabulary, counters, what is written before firsts of classes
constexpr std::uint64_t kMapBytes = 94;
constexpr std::uint64_t kCameraBytes = 58;
constexpr std::uint64_t kKeyFrameBytes = 2831;  // with empty columns; 2,188 of them preintegrated motion
constexpr std::uint64_t kPointBytes = 152;      // without observations

std::uint64_t GridBytes(const FeatureGrid& grid) {
  return 12 * grid.column_sizes.size() + 8 * grid.cell_sizes.size() + 8 * grid.keypoints.size();
}

}  // namespace

std::uint64_t ArchiveBytes(const KeyFrame& keyframe) {
  const Features& features = keyframe.features;
  std::uint64_t bytes = kKeyFrameBytes + keyframe.distortion.data.size() + 12 * keyframe.pyramid.factors.size();
  bytes += 28 * (features.keypoints.size() + features.undistorted.size() + features.right_keypoints.size());
  bytes += 4 * (features.right_x.size() + features.depth.size());
  bytes += 4 * (features.right_of_left.size() + features.left_of_right.size());
  bytes += 32 * features.descriptors.size() + 8 * features.map_points.size();
  bytes += GridBytes(features.grid) + GridBytes(features.right_grid);
  bytes += 12 * (features.bag_of_words.words.size() + features.feature_vector.nodes.size());
  bytes += 4 * features.feature_vector.features.size();
  bytes += 12 * keyframe.connections.size();
  bytes += 8 * (keyframe.children.size() + keyframe.loop_edges.size() + keyframe.merge_edges.size());
  if (keyframe.carried) bytes += keyframe.carried->members.size() + keyframe.carried->descriptors.data.size();
  return bytes + 28 * keyframe.preintegration.measurements.size();
}

std::uint64_t ArchiveBytes(const MapPoint& point) {
  return kPointBytes + kArchiveBytesPerObservation * point.observations.size();
}

std::uint64_t ArchiveBytes(const Atlas& atlas) {
  std::uint64_t bytes = kAtlasBytes + kMapBytes * atlas.maps.size() + kCameraBytes * atlas.cameras.size();
  for (const Map& map : atlas.maps) {
    for (const KeyFrame& keyframe : map.keyframes) bytes += ArchiveBytes(keyframe);
    for (const MapPoint& point : map.points) bytes += ArchiveBytes(point);
  }
  return bytes;
}

}  // namespace slamdb::detail
