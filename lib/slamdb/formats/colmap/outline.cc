// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/colmap/detail/outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <unordered_set>
#include <utility>

#include "slamdb/formats/colmap/detail/lenses.h"
#include "slamdb/formats/colmap/detail/names.h"
#include "slamdb/formats/colmap/detail/poses.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/raw.h"
#include "slamdb/model/detail/is_pose.h"
#include "slamdb/model/index.h"

namespace slamdb::colmap {
namespace {

using detail::AppendRaw;

constexpr std::uint64_t kMostImages = 2147483646;  // ids of COLMAP are below

// With the parameters of its model, or those that the keyframe keeps of it.
slamdb::Camera CameraWithParameters(const Atlas& atlas, CameraId id, const KeyFrame& keyframe) {
  const auto found = std::ranges::find(atlas.cameras, id, &slamdb::Camera::id);
  if (id && found != atlas.cameras.end()) {
    const std::size_t needed = found->model == CameraModel::kPinhole ? 4 : 8;
    if (found->parameters.size() == needed) return *found;
  }
  slamdb::Camera camera;
  camera.id = id;
  const Intrinsics& k = keyframe.intrinsics;
  camera.parameters = {k.fx, k.fy, k.cx, k.cy};
  return camera;
}

// Maps of programs that keep no distortion have places without it all the same. Where lenses do not distort, both
// columns say the same.
bool IsUndistortedAlone(const Features& features, const CameraSettings& settings) {
  return settings.camera.model == CameraModel::kPinhole && !features.undistorted.empty() &&
         (features.keypoints.empty() || settings.distortion.empty());
}

Pose Recorded(const Rigid3f& transform) {
  return PoseOf(transform.rotation.cast<double>(), transform.translation.cast<double>());
}

Pose RightFromLeft(const KeyFrame& keyframe) { return Inverse(Recorded(keyframe.left_from_right)); }

// Makes the cameras and rigs of an outline, each distinct one once. A camera of COLMAP is in one rig alone.
class Cameras {
 public:
  Cameras(const Atlas& atlas, Outline& outline) : atlas_(atlas), outline_(outline) {}

  std::uint32_t RigOf(const KeyFrame& keyframe) {
    const bool pair = keyframe.features.is_fisheye_stereo();
    CameraSettings left = SettingsAt(keyframe, keyframe.camera);
    if (IsUndistortedAlone(keyframe.features, left)) left.distortion.clear();
    std::string key = KeyOf(left, keyframe);
    CameraSettings right;
    if (pair) {
      right = SettingsAt(keyframe, keyframe.right_camera);
      key += KeyOf(right, keyframe);
      for (const float value : keyframe.left_from_right.rotation.coeffs()) AppendRaw(key, value);
      for (const float value : keyframe.left_from_right.translation) AppendRaw(key, value);
    }
    const auto [at, is_new] = rigs_.emplace(std::move(key), static_cast<std::uint32_t>(outline_.rigs.size()));
    if (is_new) Add(keyframe, left, pair ? &right : nullptr);
    const OutlineRig& rig = outline_.rigs[at->second];
    Widen(rig.left, keyframe.features.keypoints, keyframe);
    if (pair) Widen(rig.right, keyframe.features.right_keypoints, keyframe);
    return at->second;
  }

  // Ids as in the atlas and one more, where that is not taken yet; a rig has the id of its first camera.
  void Number() {
    constexpr std::uint64_t kMost = ~std::uint32_t{0} - 1;
    std::uint64_t next = 1;
    for (const OutlineCamera& camera : outline_.cameras) {
      const std::uint64_t id = camera.settings.camera.id.value();
      if (id < kMost / 2) next = std::max(next, id + 2);
    }
    std::unordered_set<std::uint64_t> taken;
    for (OutlineCamera& camera : outline_.cameras) {
      const std::uint64_t wanted = camera.settings.camera.id.value() + 1;
      const bool fits = wanted > 0 && wanted <= kMost / 2 && taken.insert(wanted).second;
      camera.id = static_cast<std::uint32_t>(fits ? wanted : next++);
    }
    for (OutlineRig& rig : outline_.rigs) rig.id = outline_.cameras[rig.left].id;
  }

 private:
  CameraSettings SettingsAt(const KeyFrame& keyframe, CameraId id) const {
    CameraSettings settings{.camera = CameraWithParameters(atlas_, id, keyframe), .distortion = {}};
    if (settings.camera.model == CameraModel::kPinhole) settings.distortion = slamdb::DistortionOf(keyframe);
    return settings;
  }

  static std::string KeyOf(const CameraSettings& settings, const KeyFrame& keyframe) {
    std::string key;
    AppendRaw(key, settings.camera.id.value());
    AppendRaw(key, static_cast<std::uint32_t>(settings.camera.model));
    for (const float parameter : settings.camera.parameters) AppendRaw(key, parameter);
    AppendRaw(key, settings.distortion.size());
    for (const double parameter : settings.distortion) AppendRaw(key, parameter);
    const ImageBounds& bounds = keyframe.bounds;
    for (const std::int32_t side : {bounds.min_x, bounds.min_y, bounds.max_x, bounds.max_y}) AppendRaw(key, side);
    return key;
  }

  void Add(const KeyFrame& keyframe, CameraSettings& left, CameraSettings* right) {
    OutlineRig rig{.left = static_cast<std::uint32_t>(outline_.cameras.size())};
    rig.right = rig.left + (right == nullptr ? 0 : 1);
    if (right != nullptr) rig.right_from_left = RightFromLeft(keyframe);
    for (CameraSettings* settings : {&left, right}) {
      if (settings == nullptr) continue;
      EstimateSize(keyframe.bounds, *settings);
      const std::vector<float>& p = settings->camera.parameters;
      if (keyframe.bounds.max_x <= 0) settings->width = Side(2 * p[2] + 1);  // about in the middle
      if (keyframe.bounds.max_y <= 0) settings->height = Side(2 * p[3] + 1);
      outline_.cameras.push_back({.settings = std::move(*settings)});
    }
    outline_.rigs.push_back(rig);
  }

  static std::int32_t Side(float length) {
    return static_cast<std::int32_t>(std::clamp(std::ceil(length), 1.F, 100'000.F));
  }

  // Without bounds the keypoints tell how large images are at least.
  void Widen(std::uint32_t camera, const Column<Keypoint>& keypoints, const KeyFrame& keyframe) {
    if (keyframe.bounds.max_x > 0 && keyframe.bounds.max_y > 0) return;
    CameraSettings& settings = outline_.cameras[camera].settings;
    for (const Keypoint& keypoint : keypoints) {
      if (!std::isfinite(keypoint.x + keypoint.y)) continue;
      settings.width = std::max(settings.width, Side(keypoint.x + 1));
      settings.height = std::max(settings.height, Side(keypoint.y + 1));
    }
  }

  const Atlas& atlas_;
  Outline& outline_;
  std::map<std::string, std::uint32_t> rigs_;
};

void AddViews(const KeyFrame& keyframe, std::uint32_t rig, const Outline& outline, std::vector<View>& views) {
  const OutlineRig& cameras = outline.rigs[rig];
  views.push_back({.keyframe = &keyframe,
                   .camera = cameras.left,
                   .rig = rig,
                   .undistorted = IsUndistortedAlone(keyframe.features, outline.cameras[cameras.left].settings)});
  if (cameras.is_pair()) views.push_back({.keyframe = &keyframe, .camera = cameras.right, .rig = rig, .right = true});
}

// `id + 1` for left images, and behind the last of them for right ones; or by their order where that does not fit.
void NumberImages(Outline& outline) {
  std::vector<std::uint64_t> ids;
  for (const MapOutline& map : outline.maps)
    for (const View& view : map.views)
      if (!view.right) ids.push_back(view.keyframe->id.value());
  std::ranges::sort(ids);
  const std::uint64_t behind = ids.empty() ? 0 : ids.back() + 1;
  const bool unique = std::ranges::adjacent_find(ids) == ids.end();
  outline.renumbered = !unique || (!ids.empty() && (ids.back() >= kMostImages / 2));
  std::uint32_t next = 1;
  for (MapOutline& map : outline.maps)
    for (View& view : map.views) {
      const std::uint64_t id = view.keyframe->id.value() + 1 + (view.right ? behind : 0);
      view.image = outline.renumbered ? next++ : static_cast<std::uint32_t>(id);
    }
}

}  // namespace

Outline OutlineOf(const Atlas& atlas, const Target& target, const WriteOptions& options,
                  const KeyFramePictures& pictures) {
  Outline outline;
  Cameras cameras(atlas, outline);
  for (const Map* map : detail::ChooseMaps(atlas, options, target)) {
    if (map->keyframes.empty() && map->points.empty()) continue;
    MapOutline views{.map = map, .view_of_row = std::vector<std::uint32_t>(map->keyframes.size(), kNoRow)};
    for (std::size_t row = 0; row < map->keyframes.size(); ++row) {
      const KeyFrame& keyframe = map->keyframes[row];
      if (keyframe.bad) {
        ++outline.bad_keyframes;
      } else if (!detail::IsPose(keyframe.camera_from_world) ||
                 (keyframe.features.is_fisheye_stereo() && !detail::IsPose(keyframe.left_from_right))) {
        ++outline.not_finite;
      } else {
        views.view_of_row[row] = static_cast<std::uint32_t>(views.views.size());
        AddViews(keyframe, cameras.RigOf(keyframe), outline, views.views);
      }
    }
    outline.maps.push_back(std::move(views));
  }
  cameras.Number();
  NumberImages(outline);
  NameImages(outline, pictures);
  return outline;
}

std::size_t CountKeyFrames(std::span<const MapOutline> maps) {
  std::size_t count = 0;
  for (const MapOutline& map : maps)
    count += static_cast<std::size_t>(std::ranges::count(map.views, false, &View::right));
  return count;
}

ViewKeypoints KeypointsOf(const View& view) {
  const Features& features = view.keyframe->features;
  if (view.right) return {&features.right_keypoints, static_cast<std::size_t>(features.left_count)};
  return {view.undistorted ? &features.undistorted : &features.keypoints, 0};
}

Pose PoseOf(const View& view) {
  const Pose left = Recorded(view.keyframe->camera_from_world);
  return view.right ? Compose(RightFromLeft(*view.keyframe), left) : left;
}

}  // namespace slamdb::colmap
