// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/optimize/detail/measurements.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "slamdb/edit/frame/detail/states.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/is_pose.h"

namespace slamdb::detail {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

std::optional<Lens> LensOf(const AtlasIndex& index, CameraId id) {
  const Camera* camera = index.FindCamera(id);
  return camera == nullptr ? std::nullopt : Lens::Of(*camera);
}

// 1 for what is no octave of the keyframe.
double InverseSigma(const ScalePyramid& pyramid, std::int32_t octave) {
  const auto row = static_cast<std::size_t>(std::max(octave, 0));
  if (row >= pyramid.inverse_sigma2.size()) return 1;
  const auto inverse_sigma2 = static_cast<double>(pyramid.inverse_sigma2[row]);
  return inverse_sigma2 > 1e-6 && inverse_sigma2 < 1e6 ? std::sqrt(inverse_sigma2) : 1;
}

// The column in the right image of a rectified pair, where a row has one.
double RightColumn(const Features& features, std::int32_t row) {
  const auto at = static_cast<std::size_t>(row);
  const float column = at < features.right_x.size() ? features.right_x[at] : -1;
  return column >= 0 && std::isfinite(column) ? static_cast<double>(column) : kNotANumber;
}

}  // namespace

template <int kRows>
bool Predict(const Measurement& measurement, const Eigen::Vector3d& in_left, Eigen::Matrix<double, kRows, 1>& error,
             Eigen::Matrix<double, kRows, 3>& by_point) {
  const Eye& eye = *measurement.eye;
  const Eigen::Vector3d point = eye.right ? Eigen::Vector3d(eye.rotation * in_left + eye.translation) : in_left;
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> pixel_by_point;
  if (!eye.lens.Project(point, pixel, pixel_by_point)) return false;
  error.template head<2>() = pixel - measurement.pixel;
  by_point.template topRows<2>() = pixel_by_point;
  if constexpr (kRows == 3) {
    const double disparity = eye.baseline_fx / point.z();
    error[2] = pixel.x() - disparity - measurement.right_x;
    by_point.row(2) = pixel_by_point.row(0);
    by_point(2, 2) += disparity / point.z();
  }
  error *= measurement.inverse_sigma;
  by_point *= measurement.inverse_sigma;
  if (eye.right) by_point *= eye.rotation;
  return true;
}

template bool Predict<2>(const Measurement&, const Eigen::Vector3d&, Eigen::Matrix<double, 2, 1>&,
                         Eigen::Matrix<double, 2, 3>&);
template bool Predict<3>(const Measurement&, const Eigen::Vector3d&, Eigen::Matrix<double, 3, 1>&,
                         Eigen::Matrix<double, 3, 3>&);

Measurements::Measurements(const AtlasIndex& index, std::size_t map_row) {
  const Map& map = index.atlas().maps[map_row];
  AddEyes(index, map);
  const IdTable keyframes = KeyFrameTable(map);
  for (std::uint32_t row = 0; row < map.points.size(); ++row) AddPoint(map, row, keyframes);
}

void Measurements::AddEyes(const AtlasIndex& index, const Map& map) {
  eyes_.resize(2 * map.keyframes.size());
  for (std::size_t row = 0; row < map.keyframes.size(); ++row) {
    const KeyFrame& keyframe = map.keyframes[row];
    if (!IsPosed(keyframe)) continue;
    if (const auto lens = LensOf(index, keyframe.camera)) {
      const auto baseline_fx = static_cast<double>(keyframe.intrinsics.baseline_fx);
      const bool rectified = lens->model == CameraModel::kPinhole && !keyframe.features.is_fisheye_stereo();
      eyes_[2 * row] = Eye{.lens = *lens, .baseline_fx = rectified && baseline_fx > 0 ? baseline_fx : 0};
    }
    const Rigid3f& mount = keyframe.left_from_right;
    const auto right = keyframe.features.is_fisheye_stereo() ? LensOf(index, keyframe.right_camera) : std::nullopt;
    if (!right || !IsPose(mount)) continue;
    const Eigen::Quaterniond turn = mount.rotation.cast<double>().normalized().conjugate();
    eyes_[2 * row + 1] = Eye{.lens = *right,
                             .right = true,
                             .rotation = turn.toRotationMatrix(),
                             .translation = -(turn * mount.translation.cast<double>())};
  }
}

void Measurements::AddPoint(const Map& map, std::uint32_t row, const IdTable& keyframes) {
  const MapPoint& point = map.points[row];
  if (!IsPlaced(point)) return;
  const std::size_t begin = all_.size();
  for (std::uint32_t i = 0; i < point.observations.size(); ++i) {
    const Observation& observation = point.observations[i];
    const std::uint32_t keyframe = keyframes.Find(observation.keyframe.value());
    if (keyframe == kNoRow) continue;
    for (const bool right : {false, true})
      Add(map.keyframes[keyframe], {.keyframe = keyframe,
                                    .point = row,
                                    .observation = i,
                                    .keypoint = right ? observation.right : observation.left,
                                    .right = right});
  }
  if (all_.size() - begin == 1 && !all_.back().has_depth()) all_.pop_back();
}

void Measurements::Add(const KeyFrame& keyframe, const Measurement& measurement) {
  const Keypoint* keypoint = ObservedKeypoint(keyframe, measurement.keypoint);
  if (keypoint == nullptr || !std::isfinite(keypoint->x) || !std::isfinite(keypoint->y)) return;
  const Features& features = keyframe.features;
  const bool right_eye = features.is_fisheye_stereo() && measurement.keypoint >= features.left_count;
  const std::optional<Eye>& eye = eyes_[2 * std::size_t{measurement.keyframe} + (right_eye ? 1 : 0)];
  if (!eye) return;
  Measurement& added = all_.emplace_back(measurement);
  added.eye = &*eye;
  added.pixel = Eigen::Vector2f(keypoint->x, keypoint->y).cast<double>();
  added.right_x = eye->baseline_fx > 0 ? RightColumn(features, measurement.keypoint) : kNotANumber;
  added.inverse_sigma = InverseSigma(keyframe.pyramid, keypoint->octave);
}

}  // namespace slamdb::detail
