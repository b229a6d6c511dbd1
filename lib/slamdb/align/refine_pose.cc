// SPDX-License-Identifier: BSD-3-Clause
// A step is a small motion of the camera in the world, about its own centre, and of the logarithm of its focal length.
#include <cmath>

#include "slamdb/align/detail/camera_pose.h"
#include "slamdb/align/detail/huber.h"
#include "slamdb/model/detail/rotations.h"

namespace slamdb::detail {
namespace {

using Vector7 = Eigen::Matrix<double, 7, 1>;

struct Shot {
  CameraPose pose;
  double focal_factor = 1;  // of the focal length that the lens has
};

Shot Moved(const Shot& shot, const Vector7& step) {
  const Eigen::Quaterniond world_from_camera(shot.pose.rotation.transpose());
  Shot moved{.focal_factor = shot.focal_factor * std::exp(step[6])};
  moved.pose.rotation = (Turn(step.head<3>()) * world_from_camera).normalized().toRotationMatrix().transpose();
  moved.pose.translation = -(moved.pose.rotation * (shot.pose.center() + step.segment<3>(3)));
  return moved;
}

RobustNormal<7> Linearised(const MapViews& map, const View& view, std::span<const PictureMatch> matches,
                           const Shot& shot) {
  RobustNormal<7> normal;
  const Eigen::Vector3d camera_center = shot.pose.center();
  const Eigen::Vector2d image_center(view.lens.cx, view.lens.cy);
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> by_point;
  Eigen::Matrix<double, 3, 6> motion;  // of a point, seen from the camera that moves, in the world's axes
  motion.rightCols<3>() = -Eigen::Matrix3d::Identity();
  for (const PictureMatch& match : matches) {
    const Eigen::Vector3d& point = map.points()[match.point].position;
    if (!view.lens.Project(shot.pose * point, pixel, by_point)) {
      normal.AddBehind();
      continue;
    }
    motion.leftCols<3>() = Hat(point - camera_center);
    const Keypoint& keypoint = view.keypoints[match.keypoint];
    const double inverse_sigma = 1 / view.ScaleOf(keypoint.octave);
    const Eigen::Vector2d place = PixelOf(keypoint), from_center = shot.focal_factor * (pixel - image_center);
    Eigen::Matrix<double, 2, 7> jacobian;
    jacobian.leftCols<6>() = shot.focal_factor * by_point * shot.pose.rotation * motion;
    jacobian.col(6) = from_center;
    normal.Add((image_center + from_center - place) * inverse_sigma, inverse_sigma * jacobian);
  }
  return normal;
}

}  // namespace

PoseFit PoseFinder::Refine(std::span<const PictureMatch> matches, const CameraPose& start, int iterations) const {
  const Eigen::MatrixXd pose_alone = Eigen::MatrixXd::Identity(7, 6);
  const auto linearise = [&](const Shot& shot) { return Linearised(map_, view_, matches, shot); };
  Shot shot{.pose = start};
  const RobustNormal<7> normal = MinimiseRobustly<7>(shot, iterations, pose_alone, linearise, Moved);
  PoseFit fit{.pose = shot.pose, .cost = normal.cost, .residuals = normal.residuals};
  fit.covariance = normal.Covariance(pose_alone).topLeftCorner<6, 6>();
  return fit;
}

FocalFit PoseFinder::FitFocalLength(std::span<const PictureMatch> matches, const CameraPose& start) const {
  const Eigen::MatrixXd all = Eigen::MatrixXd::Identity(7, 7);
  const auto linearise = [&](const Shot& shot) { return Linearised(map_, view_, matches, shot); };
  Shot shot{.pose = start};
  const RobustNormal<7> normal = MinimiseRobustly<7>(shot, 10, all, linearise, Moved);
  return {shot.focal_factor, std::sqrt(std::max(0.0, normal.Covariance(all)(6, 6)))};
}

}  // namespace slamdb::detail
