// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unordered_map>
#include <unordered_set>

#include "slamdb/formats/colmap/detail/database.h"
#include "slamdb/formats/colmap/detail/ids.h"
#include "slamdb/formats/colmap/detail/lenses.h"
#include "slamdb/formats/colmap/detail/models.h"
#include "slamdb/formats/colmap/detail/places.h"
#include "slamdb/formats/colmap/detail/unread.h"

namespace slamdb::colmap {

// One model on its way to a map.
class MapMaker {
 public:
  MapMaker(const NamedModel& named, FeatureDatabase* database, const Ids& images, const Ids& cameras,
           std::uint64_t points_above, Unread& unread);

  Map Make(MapId id);

  // The cameras that no model before had, in the model's order.
  void AddCameras(std::vector<slamdb::Camera>& cameras) const;

 private:
  [[noreturn]] static void Refuse(const std::string& path, const Camera& camera, const char* why);
  void AddPoints(Map& map);
  void AddKeyFrames(Map& map);
  KeyFrame KeyFrameOf(std::uint32_t row);
  // Of all keypoints or of none: ORB's are columns, others travel along.
  void SetDescriptors(KeyFrame& keyframe);
  void AddRight(const Image& image, const Place& place, KeyFrame& keyframe);
  // Behind those that are there. Of a lens that we have not, where a pinhole would see them.
  void AddKeypoints(const Image& image, Column<Keypoint>& keypoints, Features& features);
  // What the database has of the image.
  void AddKnown(const Image& image, Column<Keypoint>& keypoints);
  // Pyramids are of eight levels of 1.2, as ORB-SLAM3's examples have them.
  static void SetShape(float scale, float angle, Keypoint& keypoint);
  MapPointId Seen(std::uint64_t point);

  const Model& model_;
  FeatureDatabase* database_;
  const Ids &images_, &cameras_;
  std::uint64_t points_above_;
  Unread& unread_;
  Places places_;
  std::unordered_map<std::uint32_t, CameraSettings> settings_;
  std::unordered_map<std::uint32_t, const Camera*> colmap_cameras_;
  std::unordered_set<std::uint64_t> known_points_, points_seen_;
  Column<std::byte> descriptors_;  // of the keyframe so far
  std::size_t descriptor_bytes_ = 0;
};

}  // namespace slamdb::colmap
