// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/synthetic/detail/rig.h"

#include <cmath>

#include "slamdb/model/derive.h"
#include "slamdb/model/detail/distortion.h"

namespace slamdb::synthetic {
namespace {

constexpr int kWidth = 640, kHeight = 480;
constexpr int kFloatMatrix = 5;  // OpenCV's CV_32FC1

struct Lens {
  CameraModel model;
  std::vector<float> parameters;
};

Lens PinholeLens() { return {CameraModel::kPinhole, {420, 421, 319.5F, 239.5F}}; }
Lens LeftFisheyeLens() {
  return {CameraModel::kKannalaBrandt8, {281, 281.5F, 321.25F, 238.5F, 0.0035F, 0.0007F, -0.002F, 0.0002F}};
}
Lens RightFisheyeLens() {
  return {CameraModel::kKannalaBrandt8, {280.5F, 281, 318.75F, 240.25F, 0.0034F, 0.0017F, -0.0027F, 0.0005F}};
}

Camera MakeCamera(std::uint64_t id, const Lens& lens) {
  Camera camera;
  camera.id = CameraId(id);
  camera.model = lens.model;
  camera.recorded_type = static_cast<std::uint32_t>(lens.model);
  camera.parameters = lens.parameters;
  return camera;
}

double Baseline(Sensor sensor) {
  switch (sensor) {
    case Sensor::kMonocular:
      return 0;
    case Sensor::kRgbd:
      return 0.08;
    case Sensor::kStereo:
    case Sensor::kFisheyeStereo:
      break;
  }
  return 0.11;
}

Intrinsics MakeIntrinsics(const Camera& camera, double baseline) {
  constexpr float kDepthBaselines = 40;  // ThDepth of ORB-SLAM3's own settings
  Intrinsics k;
  k.fx = camera.parameters[0];
  k.fy = camera.parameters[1];
  k.cx = camera.parameters[2];
  k.cy = camera.parameters[3];
  k.inverse_fx = 1 / k.fx;
  k.inverse_fy = 1 / k.fy;
  k.baseline_fx = static_cast<float>(baseline) * k.fx;
  k.baseline = k.baseline_fx / k.fx;
  k.depth_threshold = k.baseline * kDepthBaselines;
  return k;
}

// The angle from the optical axis at `radius` focal lengths, by bisection of the lens's own curve.
double AngleAt(const Camera& camera, double radius) {
  if (camera.model == CameraModel::kPinhole) return ArcTangent(radius, 1);
  double low = 0, high = kPi / 2;
  const float* k = camera.parameters.data() + 4;
  for (int step = 0; step < 60; ++step) {
    const double theta = (low + high) / 2;
    (detail::KannalaBrandtRadius(k, theta) < radius ? low : high) = theta;
  }
  return low;
}

}  // namespace

std::optional<Eigen::Vector2d> Rig::Project(std::size_t camera, const Eigen::Vector3d& x) const {
  if (x.z() <= 0) return std::nullopt;
  const std::vector<float>& p = cameras[camera].parameters;
  Eigen::Vector2d focal(x.x() / x.z(), x.y() / x.z());
  if (cameras[camera].model == CameraModel::kKannalaBrandt8) {
    const double off_axis = std::sqrt(focal[0] * focal[0] + focal[1] * focal[1]);
    if (off_axis > 0) focal *= detail::KannalaBrandtRadius(p.data() + 4, ArcTangent(off_axis, 1)) / off_axis;
  }
  const Eigen::Vector2d pixel(p[0] * focal[0] + p[2], p[1] * focal[1] + p[3]);
  const bool is_inside = pixel[0] >= kImageMargin && pixel[0] < kWidth - kImageMargin && pixel[1] >= kImageMargin &&
                         pixel[1] < kHeight - kImageMargin;
  return is_inside ? std::optional(pixel) : std::nullopt;
}

Rig MakeRig(Sensor sensor) {
  Rig rig;
  rig.sensor = sensor;
  if (sensor == Sensor::kFisheyeStereo) {
    rig.cameras = {MakeCamera(0, LeftFisheyeLens()), MakeCamera(1, RightFisheyeLens())};
    rig.left_from_right = {Rotation({0.002, -0.004, 0.001}), {Baseline(sensor), -0.0004, 0.0007}};
  } else {
    rig.cameras = {MakeCamera(0, PinholeLens())};
  }
  rig.intrinsics = MakeIntrinsics(rig.cameras[0], Baseline(sensor));
  rig.bounds = {.grid_columns = 64,
                .grid_rows = 48,
                .inverse_cell_width = 64.0F / kWidth,
                .inverse_cell_height = 48.0F / kHeight,
                .min_x = 0,
                .min_y = 0,
                .max_x = kWidth,
                .max_y = kHeight};
  rig.pyramid = DerivePyramid(8, 1.2F);
  Eigen::Matrix3d camera_from_body;
  camera_from_body << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  rig.camera_from_body = {Product(Rotation({0.01, -0.02, 0.015}), camera_from_body), {0.05, -0.02, 0.01}};
  rig.half_width = AngleAt(rig.cameras[0], kWidth / 2.0 / rig.intrinsics.fx);
  rig.half_height = AngleAt(rig.cameras[0], kHeight / 2.0 / rig.intrinsics.fy);
  return rig;
}

KeyFrame BlankKeyFrame(const Rig& rig) {
  KeyFrame keyframe;
  keyframe.camera = rig.cameras[0].id;
  keyframe.intrinsics = rig.intrinsics;
  keyframe.calibration_matrix << rig.intrinsics.fx, 0, rig.intrinsics.cx, 0, rig.intrinsics.fy, rig.intrinsics.cy, 0, 0,
      1;
  keyframe.distortion = {4, 1, kFloatMatrix, true, Column<std::byte>(4 * sizeof(float), std::byte{0})};
  keyframe.half_baseline = rig.intrinsics.baseline / 2;
  keyframe.bounds = rig.bounds;
  keyframe.pyramid = rig.pyramid;
  if (rig.is_fisheye()) {
    keyframe.right_camera = rig.cameras[1].id;
    keyframe.left_from_right = rig.left_from_right.Recorded();
  }
  return keyframe;
}

}  // namespace slamdb::synthetic
