// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/detail/losses.h"

#include <array>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/model/detail/carried_members.h"

namespace slamdb::detail {
namespace {

struct Kind {
  Content content;
  std::string_view what;
};

// In the order of Content. The counts are of what the words name first.
constexpr std::array<Kind, 15> kKinds = {{
    {Content::kPoses, "keyframe poses"},
    {Content::kPoints, "map points"},
    {Content::kNormals, "normals and distance ranges of map points"},
    {Content::kObservations, "observations"},
    {Content::kKeypoints, "keypoints"},
    {Content::kDescriptors, "descriptors"},
    {Content::kBagOfWords, "bags of words"},
    {Content::kGraph, "edges between keyframes (covisibility, spanning tree, loops, merges)"},
    {Content::kInertial, "inertial data of keyframes"},
    {Content::kCameras, "cameras"},
    {Content::kMaps, "several maps"},
    {Content::kIdentity, "all ids and flags, the counters and the vocabulary's name"},
    {Content::kLandmarks, "landmarks"},
    {Content::kTracking, "origins and visible and found counts of map points"},
    {Content::kCarried, "members of a fork's classes"},
}};

using Counts = std::array<std::uint64_t, kKinds.size()>;

std::uint64_t& Count(Counts& counts, Content content) {
  std::size_t kind = 0;
  while (kKinds[kind].content != content) ++kind;
  return counts[kind];
}

bool HasInertialData(const KeyFrame& keyframe) {
  return keyframe.imu_calibration.is_set || keyframe.has_velocity || keyframe.imu_initialized ||
         !keyframe.preintegration.measurements.empty();
}

void CountKeyFrame(const KeyFrame& keyframe, Counts& counts) {
  const Features& features = keyframe.features;
  ++Count(counts, Content::kPoses);
  Count(counts, Content::kKeypoints) +=
      features.keypoints.size() + (features.is_fisheye_stereo() ? features.right_keypoints.size() : 0);
  Count(counts, Content::kDescriptors) += keyframe.descriptor_count();
  Count(counts, Content::kCarried) += HasMembers(keyframe.carried) ? 1 : 0;
  Count(counts, Content::kBagOfWords) += features.bag_of_words.words.empty() ? 0 : 1;
  Count(counts, Content::kGraph) += keyframe.connections.size() + (keyframe.parent ? 1 : 0) +
                                    keyframe.loop_edges.size() + keyframe.merge_edges.size();
  Count(counts, Content::kInertial) += HasInertialData(keyframe) ? 1 : 0;
}

void CountPoint(const MapPoint& point, Counts& counts) {
  ++Count(counts, Content::kPoints);
  const bool range = point.min_distance != 0 || point.max_distance != 0;
  Count(counts, Content::kNormals) += range || point.normal != Eigen::Vector3f::Zero() ? 1 : 0;
  Count(counts, Content::kObservations) += point.observations.size();
  Count(counts, Content::kDescriptors) += point.has_descriptor() || point.has_other_descriptor() ? 1 : 0;
  Count(counts, Content::kCarried) += HasMembers(point.carried) ? 1 : 0;
  Count(counts, Content::kTracking) += point.has_tracking() ? 1 : 0;
}

Counts CountContent(const Atlas& atlas, std::optional<MapId> chosen) {
  Counts counts{};
  for (const Map& map : atlas.maps) {
    if (chosen && map.id != *chosen) continue;
    ++Count(counts, Content::kMaps);
    Count(counts, Content::kLandmarks) += map.landmarks.size();
    Count(counts, Content::kCarried) += HasMembers(map.carried) ? 1 : 0;
    for (const KeyFrame& keyframe : map.keyframes) CountKeyFrame(keyframe, counts);
    for (const MapPoint& point : map.points) CountPoint(point, counts);
  }
  if (Count(counts, Content::kMaps) == 1) Count(counts, Content::kMaps) = 0;
  Count(counts, Content::kCameras) = atlas.cameras.size();
  Count(counts, Content::kCarried) += HasMembers(atlas.carried) ? 1 : 0;
  for (const Camera& camera : atlas.cameras) Count(counts, Content::kCarried) += HasMembers(camera.carried) ? 1 : 0;
  const std::uint64_t entities =
      Count(counts, Content::kPoses) + Count(counts, Content::kPoints) + atlas.cameras.size();
  Count(counts, Content::kIdentity) = entities == 0 ? 0 : entities + Count(counts, Content::kMaps);
  return counts;
}

// Those of the three that some point has: stella_vslam counts, and knows no origins.
std::string_view TrackingOf(const Atlas& atlas) {
  bool origins = false, counts = false;
  for (const Map& map : atlas.maps)
    for (const MapPoint& point : map.points) {
      origins |= point.origin_map != MapPoint::kNoOrigin;
      counts |= point.visible_count != MapPoint::kNoCount || point.found_count != MapPoint::kNoCount;
    }
  if (!origins) return "visible and found counts of map points";
  return counts ? "origins and visible and found counts of map points" : "origins of map points";
}

}  // namespace

Content ContentOf(const Atlas& atlas, std::optional<MapId> map) {
  Content content = Content::kNothing;
  const Counts counts = CountContent(atlas, map);
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind)
    if (counts[kind] > 0) content |= kKinds[kind].content;
  return content;
}

std::vector<std::string> LossesOf(const Atlas& atlas, const Format& format, const WriteOptions& options) {
  std::vector<std::string> losses;
  const Counts counts = CountContent(atlas, format.chooses_maps ? options.of<ExportOptions>().map : std::nullopt);
  const Content held = format.holds != nullptr ? format.holds(atlas, options) : format.writes;
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
    if (counts[kind] == 0 || HasAny(held, kKinds[kind].content)) continue;
    std::string loss = std::string(format.id) + " cannot hold " +
                       std::string(kKinds[kind].content == Content::kTracking ? TrackingOf(atlas) : kKinds[kind].what);
    if (kKinds[kind].content != Content::kIdentity) loss += " (" + Thousands(counts[kind]) + ")";
    losses.push_back(std::move(loss));
  }
  return losses;
}

}  // namespace slamdb::detail
