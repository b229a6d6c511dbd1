// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "slamdb/model/detail/lens.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {

// One camera of a keyframe, as a measurement is predicted with it.
struct Eye {
  Lens lens;
  double baseline_fx = 0;  // of a rectified pair or a depth camera, pixels times lengths; 0: it has no depth
  bool right = false;      // of a fisheye pair: the transform below is not the identity
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  // eye_from_left_camera
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

// Where a keyframe sees a point.
struct Measurement {
  std::uint32_t keyframe, point;  // rows
  std::uint32_t observation;      // row in the point's list
  std::int32_t keypoint;          // row of Features::map_points
  bool right;                     // Observation::right says so, not left
  const Eye* eye = nullptr;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double right_x = 0;  // column in the right image of a rectified pair; NaN: not measured
  double inverse_sigma = 1;

  bool has_depth() const { return right_x >= 0; }
  int size() const { return has_depth() ? 3 : 2; }
};

// Of ORB-SLAM3's bundle adjustment: chi-square, 95 %, of two and three numbers.
inline constexpr double kChiSquare2 = 5.991, kChiSquare3 = 7.815;
inline double Limit(const Measurement& measurement) { return measurement.has_depth() ? kChiSquare3 : kChiSquare2; }

// Error of the prediction of a point in the left camera's frame, in standard deviations, and its derivative by the
// point. Two rows, or three with depth; false where the point is not in front of the camera.
template <int kRows>
bool Predict(const Measurement& measurement, const Eigen::Vector3d& in_left, Eigen::Matrix<double, kRows, 1>& error,
             Eigen::Matrix<double, kRows, 3>& by_point);

// The measurements of a map that hold: a good keyframe that is posed and has a camera, a good point that is somewhere,
// a keypoint that is there. Points that nothing tells the depth of, with one measurement alone, have none.
// Refers to nothing of the atlas.
class Measurements {
 public:
  Measurements(const AtlasIndex& index, std::size_t map);

  const std::vector<Measurement>& all() const { return all_; }  // point by point, in the order of the lists

 private:
  void AddEyes(const AtlasIndex& index, const Map& map);
  void AddPoint(const Map& map, std::uint32_t row, const IdTable& keyframes);
  void Add(const KeyFrame& keyframe, const Measurement& measurement);

  std::vector<std::optional<Eye>> eyes_;  // of keyframe k: left 2k, right 2k + 1
  std::vector<Measurement> all_;
};

}  // namespace slamdb::detail
