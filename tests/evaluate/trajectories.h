// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "slamdb/evaluate/evaluate.h"

// Trajectories for the tests of this folder.
namespace slamdb {

inline TrajectoryPose PoseAt(double time, double x, double y, double z,
                             const Eigen::Quaterniond& rotation = Eigen::Quaterniond::Identity()) {
  return {time, {x, y, z}, rotation};
}

// Along x, one metre a second, a pose at each time.
inline std::vector<TrajectoryPose> AlongX(const std::vector<double>& times) {
  std::vector<TrajectoryPose> poses;
  for (const double time : times) poses.push_back(PoseAt(time, time, 0, 0));
  return poses;
}

// A path that bends and turns, twenty poses a second, the same each time.
inline std::vector<TrajectoryPose> Walk(std::size_t count) {
  std::vector<TrajectoryPose> poses;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = 0.05 * static_cast<double>(i);
    const Eigen::Vector3d axis(std::sin(t), std::cos(2 * t), 1);
    poses.push_back(PoseAt(100 + t, 3 * std::sin(t), 2 * std::cos(1.3 * t), 0.4 * std::sin(2.7 * t) + 0.1 * t,
                           Eigen::Quaterniond(Eigen::AngleAxisd(0.7 * t, axis.normalized()))));
  }
  return poses;
}

// With errors of up to so many metres and radians, the same each time.
inline std::vector<TrajectoryPose> Disturbed(std::vector<TrajectoryPose> poses, double metres, double radians) {
  std::mt19937 draws(7);  // whose numbers the standard lays down
  const auto next = [&] { return static_cast<double>(draws()) / 4294967296.0 * 2 - 1; };
  for (TrajectoryPose& pose : poses) {
    pose.position += metres * Eigen::Vector3d(next(), next(), next());
    const Eigen::Vector3d axis(next(), next(), next() + 1.1);
    pose.rotation = pose.rotation * Eigen::AngleAxisd(radians * next(), axis.normalized());
  }
  return poses;
}

inline std::vector<TrajectoryPose> Moved(std::vector<TrajectoryPose> poses, const Similarity3d& by) {
  for (TrajectoryPose& pose : poses) {
    pose.position = by * pose.position;
    pose.rotation = by.rotation * pose.rotation;
  }
  return poses;
}

inline TrajectoryEvaluation Evaluated(const std::vector<TrajectoryPose>& estimate,
                                      const std::vector<TrajectoryPose>& truth, EvaluationOptions options = {}) {
  return EvaluateTrajectory({.map = {}, .poses = estimate}, truth, options);
}

}  // namespace slamdb
