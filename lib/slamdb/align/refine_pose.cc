// SPDX-License-Identifier: BSD-3-Clause
// A step is a small motion of the camera in the world, about its own centre.
#include <Eigen/Geometry>
#include <cmath>

#include "slamdb/align/detail/camera_pose.h"
#include "slamdb/align/detail/huber.h"

namespace slamdb::detail {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

CameraPose Moved(const CameraPose& pose, const Vector6& step) {
  const Eigen::Vector3d turn = step.head<3>();
  const double angle = turn.norm();
  const Eigen::Quaterniond world_from_camera(pose.rotation.transpose());
  const Eigen::Quaterniond rotation(angle > 0 ? Eigen::AngleAxisd(angle, turn / angle) : Eigen::AngleAxisd::Identity());
  CameraPose moved;
  moved.rotation = (rotation * world_from_camera).normalized().toRotationMatrix().transpose();
  moved.translation = -(moved.rotation * (pose.center() + step.tail<3>()));
  return moved;
}

}  // namespace

PoseFit PoseFinder::Refine(std::span<const PictureMatch> matches, const CameraPose& start, int iterations) const {
  const auto linearise = [&](const CameraPose& pose) {
    RobustNormal<6> normal;
    const Eigen::Vector3d center = pose.center();
    Eigen::Vector2d pixel;
    Eigen::Matrix<double, 2, 3> by_point;
    Eigen::Matrix<double, 3, 6> motion;  // of a point, seen from the camera that moves, in the world's axes
    motion.rightCols<3>() = -Eigen::Matrix3d::Identity();
    for (const PictureMatch& match : matches) {
      const Eigen::Vector3d& point = map_.points()[match.point].position;
      if (!view_.lens.Project(pose * point, pixel, by_point)) {
        normal.AddBehind();
        continue;
      }
      motion.leftCols<3>() = Skew(point - center);
      const Keypoint& keypoint = view_.keypoints[match.keypoint];
      const double inverse_sigma = 1 / view_.ScaleOf(keypoint.octave);
      const Eigen::Vector2d place(static_cast<double>(keypoint.x), static_cast<double>(keypoint.y));
      normal.Add((pixel - place) * inverse_sigma, inverse_sigma * by_point * pose.rotation * motion);
    }
    return normal;
  };
  const Eigen::MatrixXd all = Eigen::MatrixXd::Identity(6, 6);
  PoseFit fit{.pose = start};
  const RobustNormal<6> normal = MinimiseRobustly<6>(fit.pose, iterations, all, linearise, Moved);
  fit.cost = normal.cost;
  fit.residuals = normal.residuals;
  fit.covariance = normal.Covariance(all);
  return fit;
}

}  // namespace slamdb::detail
