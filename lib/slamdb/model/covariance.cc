// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/covariance.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "slamdb/model/derive.h"

namespace slamdb {
namespace {

using Jacobian = Eigen::Matrix<double, 2, 3>;

// Worse conditioned than this, the information is that of one ray and rounding errors.
constexpr double kLeastCondition = 1e-12;

Jacobian PinholeJacobian(const Camera& camera, const Eigen::Vector3d& x) {
  const double fx = camera.parameters[0], fy = camera.parameters[1], depth = 1 / x.z();
  Jacobian jacobian;
  jacobian << fx * depth, 0, -fx * x.x() * depth * depth,  //
      0, fy * depth, -fy * x.y() * depth * depth;
  return jacobian;
}

// pixel = f * radius(theta) * direction + c, with theta the angle off the axis and direction = (x, y) / |(x, y)|.
Jacobian KannalaBrandtJacobian(const Camera& camera, const Eigen::Vector3d& x) {
  const double off_axis = x.head<2>().norm(), square = x.squaredNorm();
  if (off_axis < 1e-9 * x.z()) return PinholeJacobian(camera, x);  // its limit on the axis
  const double theta = std::atan2(off_axis, x.z()), theta2 = theta * theta;
  double radius = 0, slope = 0;  // of theta (1 + k0 theta^2 + k1 theta^4 + ...)
  for (int i = 3; i >= 0; --i) {
    const double k = camera.parameters[static_cast<std::size_t>(4 + i)];
    radius = theta2 * (k + radius);
    slope = theta2 * ((2 * i + 3) * k + slope);
  }
  radius = theta * (1 + radius);
  slope += 1;
  const Eigen::Vector2d direction = x.head<2>() / off_axis;
  Eigen::RowVector3d theta_by_x;
  theta_by_x << direction.transpose() * (x.z() / square), -off_axis / square;
  Jacobian jacobian = direction * (slope * theta_by_x);
  jacobian.leftCols<2>() += radius / off_axis * (Eigen::Matrix2d::Identity() - direction * direction.transpose());
  jacobian.row(0) *= static_cast<double>(camera.parameters[0]);
  jacobian.row(1) *= static_cast<double>(camera.parameters[1]);
  return jacobian;
}

const Camera* FindCamera(const Atlas& atlas, CameraId id) {
  const auto found =
      std::find_if(atlas.cameras.begin(), atlas.cameras.end(), [id](const Camera& camera) { return camera.id == id; });
  return !id || found == atlas.cameras.end() ? nullptr : &*found;
}

}  // namespace

std::optional<Jacobian> ProjectionJacobian(const Camera& camera, const Eigen::Vector3d& x_in_camera) {
  if (!Project(camera, x_in_camera.cast<float>())) return std::nullopt;
  return camera.model == CameraModel::kPinhole ? PinholeJacobian(camera, x_in_camera)
                                               : KannalaBrandtJacobian(camera, x_in_camera);
}

PointCovariances::PointCovariances(const Atlas& atlas, const Map& map, double pixel_sigma)
    : rows_(KeyFrameTable(map)), variance_(pixel_sigma * pixel_sigma) {
  views_.reserve(map.keyframes.size());
  for (const KeyFrame& keyframe : map.keyframes) {
    View view{.keyframe = &keyframe, .left = {}, .right = {}};
    const Rigid3f left = keyframe.camera_from_world.Normalized();
    view.left = {FindCamera(atlas, keyframe.camera), left.rotation.toRotationMatrix().cast<double>(),
                 left.translation.cast<double>()};
    if (keyframe.features.is_fisheye_stereo()) {
      const Rigid3f right = keyframe.left_from_right.Normalized().Inverse() * left;
      view.right = {FindCamera(atlas, keyframe.right_camera), right.rotation.toRotationMatrix().cast<double>(),
                    right.translation.cast<double>()};
    }
    views_.push_back(view);
  }
}

void PointCovariances::Add(const View& view, const Eye& eye, std::int32_t row, const Eigen::Vector3d& x_in_world,
                           Eigen::Matrix3d& information) const {
  const KeyFrame& keyframe = *view.keyframe;
  const Keypoint* keypoint = ObservedKeypoint(keyframe, row);
  if (eye.camera == nullptr || keypoint == nullptr || keypoint->octave < 0 ||
      static_cast<std::size_t>(keypoint->octave) >= keyframe.pyramid.sigma2.size())
    return;
  const Eigen::Vector3d x = eye.rotation * x_in_world + eye.translation;
  const std::optional<Jacobian> by_camera = ProjectionJacobian(*eye.camera, x);
  if (!by_camera) return;
  const double weight =
      1 / (variance_ * static_cast<double>(keyframe.pyramid.sigma2[static_cast<std::size_t>(keypoint->octave)]));
  const Jacobian jacobian = *by_camera * eye.rotation;
  information += weight * jacobian.transpose() * jacobian;
  const Column<float>& right_x = keyframe.features.right_x;
  if (keyframe.features.is_fisheye_stereo() || static_cast<std::size_t>(row) >= right_x.size() ||
      !(right_x[static_cast<std::size_t>(row)] >= 0))
    return;
  Eigen::RowVector3d right = by_camera->row(0);
  right.z() += static_cast<double>(keyframe.intrinsics.baseline_fx) / (x.z() * x.z());
  right *= eye.rotation;
  information += weight * right.transpose() * right;
}

std::optional<Eigen::Matrix3d> PointCovariances::Of(const MapPoint& point) const {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  const Eigen::Vector3d x = point.position.cast<double>();
  for (const Observation& observation : point.observations) {
    const std::uint32_t row = rows_.Find(observation.keyframe.value());
    if (row == kNoRow) continue;
    const View& view = views_[row];
    if (observation.left >= 0) Add(view, view.left, observation.left, x, information);
    if (observation.right >= 0) Add(view, view.right, observation.right, x, information);
  }
  if (!information.allFinite()) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(information);
  const Eigen::Vector3d values = solver.eigenvalues();  // ascending
  if (!(values[0] > kLeastCondition * values[2])) return std::nullopt;
  return solver.eigenvectors() * values.cwiseInverse().asDiagonal() * solver.eigenvectors().transpose();
}

}  // namespace slamdb
