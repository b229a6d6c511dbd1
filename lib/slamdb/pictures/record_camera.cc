// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/pictures/detail/record_camera.h"

#include <algorithm>

#include "slamdb/model/detail/matrix_types.h"

namespace slamdb::detail {

void RecordCamera(const CameraSettings& settings, KeyFrame& keyframe) {
  const std::vector<float>& p = settings.camera.parameters;
  keyframe.camera = settings.camera.id;
  keyframe.intrinsics.fx = p[0];
  keyframe.intrinsics.fy = p[1];
  keyframe.intrinsics.cx = p[2];
  keyframe.intrinsics.cy = p[3];
  std::vector<double> distortion = settings.distortion;
  distortion.resize(std::max<std::size_t>(distortion.size(), 4), 0);
  keyframe.distortion = FloatColumn(distortion);
  keyframe.bounds = UndistortedBounds(settings, settings.width, settings.height);
}

void RecordPair(CameraId right, const Rigid3f& left_from_right, KeyFrame& keyframe) {
  keyframe.right_camera = right;
  keyframe.left_from_right = left_from_right;
  keyframe.intrinsics.baseline = left_from_right.translation.norm();
  keyframe.intrinsics.baseline_fx = keyframe.intrinsics.baseline * keyframe.intrinsics.fx;
  keyframe.half_baseline = keyframe.intrinsics.baseline / 2;
}

Column<Keypoint> WithoutDistortion(const CameraSettings& settings, Column<Keypoint> keypoints) {
  if (settings.distortion.empty() || settings.camera.model != CameraModel::kPinhole) return keypoints;
  for (Keypoint& keypoint : keypoints) {
    const Eigen::Vector2d at =
        Undistorted(settings, {static_cast<double>(keypoint.x), static_cast<double>(keypoint.y)});
    keypoint.x = static_cast<float>(at.x());
    keypoint.y = static_cast<float>(at.y());
  }
  return keypoints;
}

}  // namespace slamdb::detail
