// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "slamdb/align/detail/map_views.h"
#include "slamdb/align/detail/match_points.h"
#include "slamdb/model/similarity.h"

namespace slamdb::detail {

// In which ways the transform between two maps may differ.
enum class Freedom {
  kSimilarity,  // rotation, translation, scale: one of the maps has no scale of its own
  kRigid,       // rotation and translation
  kUpright,     // rotation about the vertical and translation: both maps know gravity
};

// Least squares of a transform first_from_second over where the points of each map are seen in pictures of the other.
struct Fit {
  Similarity3d first_from_second;
  double cost = 0;            // sum of robust squared errors, in standard deviations of keypoints
  std::size_t residuals = 0;  // numbers, two for each reprojection
  // Covariance of a small motion of the second map's points in the first map, about `center`:
  // rotation vector (radians), translation (first map's units), log of the scale. Zero where the transform is not free.
  Eigen::Matrix<double, 7, 7> covariance = Eigen::Matrix<double, 7, 7>::Zero();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // of the matched points, in the first map
};

// Reprojections of one match, in standard deviations of its keypoints, squared; infinite behind a camera.
struct MatchErrors {
  double in_first, in_second;
};

// What is known of two maps between which a transform is sought.
class PairGeometry {
 public:
  PairGeometry(const MapViews& first, const MapViews& second) : first_(first), second_(second) {}

  Freedom freedom() const;
  MatchErrors ErrorsOf(const PointMatch& match, const Similarity3d& first_from_second) const;
  // Whether both errors are below what 99 of 100 true matches have.
  bool IsInlier(const PointMatch& match, const Similarity3d& first_from_second) const;
  std::vector<PointMatch> InliersOf(std::span<const PointMatch> matches, const Similarity3d& first_from_second) const;

  // A transform that many matches agree on, by trying three at a time; nullopt when fewer than `fewest` do.
  // The same seed gives the same result.
  std::optional<Similarity3d> FindTransform(std::span<const PointMatch> matches, std::size_t fewest,
                                            std::uint64_t seed) const;

  // The best transform near a given one, by Levenberg-Marquardt with Huber's loss.
  Fit Refine(std::span<const PointMatch> matches, const Similarity3d& start, int iterations = 10) const;

 private:
  const MapViews &first_, &second_;
};

}  // namespace slamdb::detail
