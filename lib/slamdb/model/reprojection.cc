// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/reprojection.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "slamdb/model/derive.h"

namespace slamdb {
namespace {

constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN();

const Camera* FindCamera(const Atlas& atlas, CameraId id) {
  if (!id) return nullptr;
  const auto found =
      std::find_if(atlas.cameras.begin(), atlas.cameras.end(), [id](const Camera& camera) { return camera.id == id; });
  return found == atlas.cameras.end() ? nullptr : &*found;
}

}  // namespace

Reprojection::Reprojection(const Atlas& atlas, const Map& map) {
  views_.reserve(map.keyframes.size());
  for (const KeyFrame& keyframe : map.keyframes) {
    const Rigid3f left = keyframe.camera_from_world.Normalized();
    View view{.keyframe = &keyframe, .left = {}, .right = {}};
    view.left = {FindCamera(atlas, keyframe.camera), left.rotation.toRotationMatrix(), left.translation};
    if (keyframe.features.is_fisheye_stereo()) {
      const Rigid3f right = keyframe.left_from_right.Normalized().Inverse() * left;
      view.right = {FindCamera(atlas, keyframe.right_camera), right.rotation.toRotationMatrix(), right.translation};
    }
    views_.push_back(view);
  }
  rows_ = KeyFrameTable(map);
}

const KeyFrame* Reprojection::Find(KeyFrameId id) const {
  const View* view = FindView(id);
  return view == nullptr ? nullptr : view->keyframe;
}

float Reprojection::Error(const Eye& eye, const MapPoint& point, const Keypoint* keypoint) {
  if (eye.camera == nullptr || keypoint == nullptr) return kNotANumber;
  const auto pixel = Project(*eye.camera, eye.rotation * point.position + eye.translation);
  if (!pixel) return kNotANumber;
  return (*pixel - Eigen::Vector2f(keypoint->x, keypoint->y)).norm();
}

Reprojection::Errors Reprojection::Of(const MapPoint& point, const Observation& observation) const {
  const View* view = FindView(observation.keyframe);
  if (view == nullptr) return {kNotANumber, kNotANumber};
  return {Error(view->left, point, ObservedKeypoint(*view->keyframe, observation.left)),
          Error(view->right, point, ObservedKeypoint(*view->keyframe, observation.right))};
}

float Reprojection::Mean(const MapPoint& point) const {
  double sum = 0;
  int count = 0;
  for (const Observation& observation : point.observations) {
    const Errors errors = Of(point, observation);
    for (const float error : {errors.left, errors.right}) {
      if (std::isnan(error)) continue;
      sum += error;
      ++count;
    }
  }
  return count == 0 ? kNotANumber : static_cast<float>(sum / count);
}

}  // namespace slamdb
