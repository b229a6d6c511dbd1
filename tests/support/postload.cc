// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/postload.h"

#include <cmath>
#include <set>

#include "slamdb/base/detail/concat.h"

namespace slamdb {
namespace {

using detail::Concat;

class PostLoad {
 public:
  PostLoad(const Atlas& atlas, std::uint64_t words) : words_(words) {
    if (!atlas.repeated_maps.empty()) Tell("a map is loaded twice");
    for (const Camera& camera : atlas.cameras) cameras_.insert(camera.id);
    for (const Map& map : atlas.maps) LoadMap(map);
  }
  std::vector<std::string> troubles;

 private:
  template <class... Parts>
  void Tell(const Parts&... parts) {
    troubles.push_back(Concat(parts...));
  }

  void LoadMap(const Map& map) {
    keyframes_.clear();
    points_.clear();
    if (!map.repeated_keyframes.empty() || !map.repeated_points.empty()) Tell(map.id, " lists an object twice");
    for (const KeyFrame& keyframe : map.keyframes)
      if (!keyframes_.insert(keyframe.id).second || keyframe.bad) Tell(keyframe.id, " comes twice or is bad");
    for (const MapPoint& point : map.points)
      if (!points_.insert(point.id).second || point.bad) Tell(point.id, " comes twice or is bad");
    for (const MapPoint& point : map.points) LoadPoint(point);
    for (const KeyFrame& keyframe : map.keyframes) LoadKeyFrame(keyframe);
    NeedKeyFrame(map.first_keyframe, "initial keyframe");
    NeedKeyFrame(map.lowest_keyframe, "lowest keyframe");
    for (const KeyFrameId origin : map.origins) NeedKeyFrame(origin, "origin");
  }

  void LoadPoint(const MapPoint& point) {
    NeedKeyFrame(point.reference, "reference keyframe");
    if (point.replaced_by && !points_.contains(point.replaced_by)) Tell(point.id, " is replaced by none");
    for (const Observation& observation : point.observations) {
      NeedKeyFrame(observation.keyframe, "observer");
      if (observation.left == Observation::kAbsent || observation.right == Observation::kAbsent)
        Tell(point.id, " has one side of an observation");
    }
  }

  void LoadKeyFrame(const KeyFrame& keyframe) {
    const Features& features = keyframe.features;
    const float norm = keyframe.camera_from_world.rotation.norm();
    if (!(norm > 0.5F) || !keyframe.camera_from_world.translation.allFinite()) Tell(keyframe.id, " has no pose");
    if (features.map_points.size() != static_cast<std::size_t>(features.count)) Tell(keyframe.id, " lacks slots");
    for (const MapPointId point : features.map_points)
      if (point && !points_.contains(point)) Tell(keyframe.id, " has a null slot for ", point);
    if (!cameras_.contains(keyframe.camera)) Tell(keyframe.id, " has no camera");
    if (features.is_fisheye_stereo() && !cameras_.contains(keyframe.right_camera))
      Tell(keyframe.id, " has no right camera");
    for (const Connection& connection : keyframe.connections) NeedKeyFrame(connection.keyframe, "covisible keyframe");
    for (const auto* list : {&keyframe.children, &keyframe.loop_edges, &keyframe.merge_edges})
      for (const KeyFrameId id : *list) NeedKeyFrame(id, "linked keyframe");
    for (const KeyFrameId id : {keyframe.parent, keyframe.previous, keyframe.next})
      if (id) NeedKeyFrame(id, "parent or neighbour");
    for (const std::uint32_t word : features.bag_of_words.words)
      if (word >= words_) Tell(keyframe.id, " has word ", word, " of ", words_);
    for (const std::uint32_t row : features.feature_vector.features)
      if (row >= features.descriptors.size()) Tell(keyframe.id, " has feature ", row, " in its feature vector");
  }

  void NeedKeyFrame(KeyFrameId id, std::string_view what) {
    if (!keyframes_.contains(id)) Tell(what, " ", id, " is null");
  }

  const std::uint64_t words_;
  std::set<CameraId> cameras_;
  std::set<KeyFrameId> keyframes_;
  std::set<MapPointId> points_;
};

}  // namespace

std::vector<std::string> LoadTroubles(const Atlas& atlas, std::uint64_t words) {
  return PostLoad(atlas, words).troubles;
}

}  // namespace slamdb
