// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/index.h"

namespace slamdb {

// How a projected pixel moves with the point: the derivative of Project (derive.h) by the point in the camera frame.
// nullopt where Project has no value.
//
// Units: pixels per metre.
SLAMDB_EXPORT std::optional<Eigen::Matrix<double, 2, 3>> ProjectionJacobian(const Camera& camera,
                                                                            const Eigen::Vector3d& x_in_camera);

// How well a map's observations determine the positions of its points.
// Refers to the atlas, which must outlive it.
//
// Constant after construction: safe to use from many threads.
class SLAMDB_EXPORT PointCovariances {
 public:
  // `pixel_sigma`: standard deviation of a keypoint's position at octave 0, per axis.
  // At octave o it is `factor^o` times as large.
  // ORB-SLAM3 weighs its residuals as if it were 1 pixel.
  PointCovariances(const Atlas& atlas, const Map& map, double pixel_sigma = 1);

  // The covariance of a point's position, by first-order propagation of the noise of all its observations:
  // (sum of J^T S^-1 J)^-1 with J the derivative of a keypoint's position by the point's, and S its noise.
  // A stereo or depth measurement counts as ORB-SLAM3 has it: a third coordinate, u - baseline * fx / z.
  // Poses and scale are taken for exact.
  // nullopt when the observations do not determine the point: one ray, no parallax, or none that can be projected.
  //
  // Frame: the world. Units: metres^2.
  std::optional<Eigen::Matrix3d> Of(const MapPoint& point) const;

 private:
  struct Eye {
    const Camera* camera = nullptr;
    Eigen::Matrix3d rotation;  // eye_from_world
    Eigen::Vector3d translation;
  };
  struct View {
    const KeyFrame* keyframe;
    Eye left, right;
  };
  void Add(const View& view, const Eye& eye, std::int32_t row, const Eigen::Vector3d& x_in_world,
           Eigen::Matrix3d& information) const;

  std::vector<View> views_;  // one per keyframe, in the map's order
  IdTable rows_;             // keyframe id -> view
  double variance_;          // pixels^2 at octave 0
};

}  // namespace slamdb
