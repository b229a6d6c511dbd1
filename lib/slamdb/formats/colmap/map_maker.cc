// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/colmap/detail/map_maker.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <optional>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/colmap/detail/names.h"
#include "slamdb/formats/colmap/detail/poses.h"
#include "slamdb/formats/import/detail/keypoints.h"
#include "slamdb/model/colors.h"
#include "slamdb/model/detail/matrix_types.h"
#include "slamdb/pictures/detail/record_camera.h"

namespace slamdb::colmap {

using detail::Concat;

MapMaker::MapMaker(const NamedModel& named, FeatureDatabase* database, const Ids& images, const Ids& cameras,
                   std::uint64_t points_above, Unread& unread)
    : model_(named.model),
      database_(database),
      images_(images),
      cameras_(cameras),
      points_above_(points_above),
      unread_(unread),
      places_(named.model) {
  for (const Camera& camera : model_.cameras) {
    if (const char* why = WhyNotRead(camera)) Refuse(named.path, camera, why);
    settings_.emplace(camera.id, SettingsOf(camera, CameraId(cameras_.Of(camera.id))));
    colmap_cameras_.emplace(camera.id, &camera);
  }
  if (places_.HasOtherRigs()) ++unread_.rigs;
}

Map MapMaker::Make(MapId id) {
  Map map;
  map.id = id;
  AddPoints(map);
  AddKeyFrames(map);
  return map;
}

void MapMaker::AddCameras(std::vector<slamdb::Camera>& cameras) const {
  for (const Camera& camera : model_.cameras) {
    const slamdb::Camera& made = settings_.at(camera.id).camera;
    if (std::ranges::find(cameras, made.id, &slamdb::Camera::id) == cameras.end()) cameras.push_back(made);
  }
}

void MapMaker::Refuse(const std::string& path, const Camera& camera, const char* why) {
  throw Error(ErrorKind::kUnsupported, path, Concat("camera ", camera.id),
              Concat("of model ", kCameraModels[static_cast<std::size_t>(camera.model)].name, " is not read: ", why));
}

void MapMaker::AddPoints(Map& map) {
  map.points.reserve(model_.points.size());
  known_points_.reserve(model_.points.size());
  std::unordered_set<std::uint64_t> seen;
  for (const Image& image : model_.images)
    for (const Point2& keypoint : image.points) seen.insert(keypoint.point);
  for (const Point& read : model_.points) {
    if (!known_points_.insert(read.id).second || read.id == kNoPoint) {
      ++unread_.points;
      continue;
    }
    if (!seen.contains(read.id)) {
      ++unread_.unseen;
      continue;
    }
    MapPoint& point = map.points.emplace_back();
    point.id = MapPointId(read.id + points_above_);
    for (std::size_t axis = 0; axis < 3; ++axis)
      point.position[static_cast<Eigen::Index>(axis)] = static_cast<float>(read.position[axis]);
    point.descriptor_form = MatrixForm::kEmpty;
    const bool is_grey = read.color == kNoColor || read.color == Color{};
    unread_.colors += is_grey ? 0 : 1;
  }
}

void MapMaker::AddKeyFrames(Map& map) {
  std::unordered_set<std::uint64_t> seen;
  for (std::uint32_t row = 0; row < model_.images.size(); ++row) {
    const Image& image = model_.images[row];
    if (!seen.insert(image.id).second || !settings_.contains(image.camera)) {
      ++unread_.images;
      continue;
    }
    if (places_[row].is_right) continue;
    unread_.rights += image.name.starts_with("right/") ? 1 : 0;
    map.keyframes.push_back(KeyFrameOf(row));
  }
}

KeyFrame MapMaker::KeyFrameOf(std::uint32_t row) {
  const Image& image = model_.images[row];
  const Place& place = places_[row];
  const CameraSettings& settings = settings_.at(image.camera);
  KeyFrame keyframe;
  keyframe.id = KeyFrameId(images_.Of(image.id));
  keyframe.frame_id = keyframe.id.value();
  keyframe.timestamp = TimeInName(image.name).value_or(std::numeric_limits<double>::quiet_NaN());
  keyframe.camera_from_world = RigidOf(place.camera_from_world);
  detail::RecordCamera(settings, keyframe);
  AddKeypoints(image, keyframe.features.keypoints, keyframe.features);
  if (place.right) AddRight(model_.images[*place.right], place, keyframe);
  Features& features = keyframe.features;
  features.undistorted = detail::WithoutDistortion(settings, features.keypoints);
  SetDescriptors(keyframe);
  return keyframe;
}

void MapMaker::SetDescriptors(KeyFrame& keyframe) {
  Features& features = keyframe.features;
  const std::size_t count = features.map_points.size();
  const bool whole = descriptor_bytes_ > 0 && descriptors_.size() == count * descriptor_bytes_;
  if (whole && descriptor_bytes_ == sizeof(Descriptor)) {
    features.descriptors.resize(count);
    if (count > 0) std::memcpy(features.descriptors.front().data(), descriptors_.data(), descriptors_.size());
  } else if (whole && count > 0) {
    keyframe.carried.Make().descriptors = {static_cast<std::int32_t>(count),
                                           static_cast<std::int32_t>(descriptor_bytes_), detail::kCv8U, true,
                                           descriptors_};
    unread_.descriptors += count;
  } else {
    unread_.undescribed += count;
  }
  descriptors_.clear();
}

void MapMaker::AddRight(const Image& image, const Place& place, KeyFrame& keyframe) {
  Features& features = keyframe.features;
  detail::RecordPair(settings_.at(image.camera).camera.id, RigidOf(Inverse(place.right_from_left)), keyframe);
  features.left_count = static_cast<std::int32_t>(features.keypoints.size());
  AddKeypoints(image, features.right_keypoints, features);
  detail::MatchSides(features);
  features.right_count = static_cast<std::int32_t>(features.right_keypoints.size());
}

void MapMaker::AddKeypoints(const Image& image, Column<Keypoint>& keypoints, Features& features) {
  const Camera& camera = *colmap_cameras_.at(image.camera);
  const bool strange = NeedsUndistorting(camera);
  keypoints.reserve(image.points.size());
  points_seen_.clear();
  for (const Point2& read : image.points) {
    Eigen::Vector2d at(read.x - kHalfPixel, read.y - kHalfPixel);
    if (strange) at = UndistortedBy(camera, at);
    keypoints.push_back(detail::KeypointAt(static_cast<float>(at.x()), static_cast<float>(at.y())));
    features.map_points.push_back(Seen(read.point));
  }
  if (strange) unread_.undistorted += image.points.size();
  features.count = static_cast<std::int32_t>(features.map_points.size());
  if (database_ != nullptr) AddKnown(image, keypoints);
}

void MapMaker::AddKnown(const Image& image, Column<Keypoint>& keypoints) {
  const std::optional<ImageFeatures> known = database_->Find(image);
  if (!known) {
    ++unread_.strangers;
    return;
  }
  for (std::size_t row = 0; row < known->scales.size(); ++row)
    SetShape(known->scales[row], known->angles[row], keypoints[row]);
  descriptor_bytes_ = known->descriptor_bytes;
  descriptors_.insert(descriptors_.end(), known->descriptors.begin(), known->descriptors.end());
}

void MapMaker::SetShape(float scale, float angle, Keypoint& keypoint) {
  constexpr float kTurn = 360, kFactor = 1.2F, kCoarsest = 7;
  const float degrees = angle * (kTurn / 2 / std::numbers::pi_v<float>);
  if (std::isfinite(degrees)) keypoint.angle = degrees - kTurn * std::floor(degrees / kTurn);
  if (!(scale > 0) || !std::isfinite(scale)) return;
  keypoint.octave =
      static_cast<std::int32_t>(std::clamp(std::round(std::log(scale) / std::log(kFactor)), 0.F, kCoarsest));
  keypoint.size = detail::kPatch * scale;
}

MapPointId MapMaker::Seen(std::uint64_t point) {
  if (point == kNoPoint) return {};
  if (known_points_.contains(point) && points_seen_.insert(point).second) return MapPointId(point + points_above_);
  ++unread_.keypoints;
  return {};
}

}  // namespace slamdb::colmap
