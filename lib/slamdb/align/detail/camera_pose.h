// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "slamdb/align/detail/map_views.h"

namespace slamdb::detail {

// camera_from_world.
struct CameraPose {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d center() const { return -(rotation.transpose() * translation); }
  friend Eigen::Vector3d operator*(const CameraPose& pose, const Eigen::Vector3d& point) {
    return pose.rotation * point + pose.translation;
  }
};

CameraPose PoseOf(const View& view);
void SetPose(View& view, const CameraPose& pose);

// "Keypoint `keypoint` of the picture is point `point` of the map", and in how many bits their descriptors differ.
struct PictureMatch {
  std::uint32_t keypoint, point;
  int bits = 0;
};

// The poses from which three points are seen along three unit rays of the camera frame: four at most.
// None where the points are on a line.
// After Grunert (1841), as Haralick et al. (IJCV 1994) review it.
std::vector<CameraPose> SolveP3p(const std::array<Eigen::Vector3d, 3>& rays,
                                 const std::array<Eigen::Vector3d, 3>& points);

struct PoseFit {
  CameraPose pose;
  double cost = 0;            // sum of robust squared errors, in standard deviations of keypoints
  std::size_t residuals = 0;  // numbers, two for each match
  // Covariance of a small motion of the camera, in the world's axes and about its own centre: rotation vector
  // (radians), then translation (map units).
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

// By what factor the focal length of a picture would have to be another, to fit best; and its standard deviation.
struct FocalFit {
  double factor = 1, deviation = 0;
};

// Where the picture of a view was taken, by what of a map it shows. The view's own pose means nothing.
class PoseFinder {
 public:
  // Refers to both. `rays`: of the view's keypoints, unit length.
  PoseFinder(const MapViews& map, const View& view, std::span<const Eigen::Vector3d> rays)
      : map_(map), view_(view), rays_(rays) {}

  // In standard deviations of the keypoint, squared; infinite behind the camera.
  double SquaredError(const PictureMatch& match, const CameraPose& pose) const;
  // Those whose error is below what 99 of 100 true matches have.
  std::vector<PictureMatch> InliersOf(std::span<const PictureMatch> matches, const CameraPose& pose) const;

  // A pose that many matches agree on, by trying three at a time (RANSAC), the better ones sooner (PROSAC; Chum and
  // Matas, CVPR 2005); nullopt when fewer than `fewest` do. Matches ascend by how doubtful they are. The same seed
  // gives the same result.
  std::optional<CameraPose> Find(std::span<const PictureMatch> matches, std::size_t fewest, std::uint64_t seed) const;

  // The best pose near a given one, by Levenberg-Marquardt with Huber's loss.
  PoseFit Refine(std::span<const PictureMatch> matches, const CameraPose& start, int iterations = 10) const;

  // The same with the focal length free.
  FocalFit FitFocalLength(std::span<const PictureMatch> matches, const CameraPose& start) const;

 private:
  const MapViews& map_;
  const View& view_;
  const std::span<const Eigen::Vector3d> rays_;
};

}  // namespace slamdb::detail
