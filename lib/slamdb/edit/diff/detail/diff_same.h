// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>

#include "slamdb/model/atlas.h"

namespace slamdb {

// Whether values mean the same: numbers within a tolerance, NaNs whatever their bits, quaternions up to their sign.
class Sameness {
 public:
  explicit Sameness(double tolerance) : tolerance_(tolerance) {}

  bool operator()(double a, double b) const {
    if (a == b || (std::isnan(a) && std::isnan(b))) return true;
    return tolerance_ > 0 && std::abs(a - b) <= tolerance_ * std::max({1.0, std::abs(a), std::abs(b)});
  }
  bool operator()(float a, float b) const { return (*this)(static_cast<double>(a), static_cast<double>(b)); }

  template <int kRows, int kColumns>
  bool operator()(const Eigen::Matrix<float, kRows, kColumns>& a,
                  const Eigen::Matrix<float, kRows, kColumns>& b) const {
    return AllSame(a.data(), b.data(), static_cast<std::size_t>(a.size()));
  }

  bool operator()(const Quaternionf& a, const Quaternionf& b) const {
    const Eigen::Vector4f first = a.coeffs(), second = b.coeffs();
    return (*this)(first, second) || (*this)(first, Eigen::Vector4f(-second));
  }
  bool operator()(const Rigid3f& a, const Rigid3f& b) const {
    return (*this)(a.rotation, b.rotation) && (*this)(a.translation, b.translation);
  }
  bool operator()(const Keypoint& a, const Keypoint& b) const {
    return (*this)(a.x, b.x) && (*this)(a.y, b.y) && (*this)(a.angle, b.angle) && (*this)(a.size, b.size) &&
           (*this)(a.response, b.response) && a.class_id == b.class_id && a.octave == b.octave;
  }
  bool operator()(const ImuMeasurement& a, const ImuMeasurement& b) const {
    return (*this)(a.acceleration, b.acceleration) && (*this)(a.angular_velocity, b.angular_velocity) &&
           (*this)(a.duration, b.duration);
  }
  template <class T, class Allocator>
  bool operator()(const std::vector<T, Allocator>& a, const std::vector<T, Allocator>& b) const {
    return a.size() == b.size() && AllSame(a.data(), b.data(), a.size());
  }

  bool operator()(const Intrinsics& a, const Intrinsics& b) const {
    return (*this)(a.fx, b.fx) && (*this)(a.fy, b.fy) && (*this)(a.inverse_fx, b.inverse_fx) &&
           (*this)(a.inverse_fy, b.inverse_fy) && (*this)(a.cx, b.cx) && (*this)(a.cy, b.cy) &&
           (*this)(a.baseline_fx, b.baseline_fx) && (*this)(a.baseline, b.baseline) &&
           (*this)(a.depth_threshold, b.depth_threshold);
  }
  bool operator()(const Matrix& a, const Matrix& b) const {
    return a.rows == b.rows && a.columns == b.columns && a.type == b.type && a.data == b.data;
  }
  bool operator()(const ImageBounds& a, const ImageBounds& b) const {
    return a.grid_columns == b.grid_columns && a.grid_rows == b.grid_rows && a.min_x == b.min_x && a.min_y == b.min_y &&
           a.max_x == b.max_x && a.max_y == b.max_y && (*this)(a.inverse_cell_width, b.inverse_cell_width) &&
           (*this)(a.inverse_cell_height, b.inverse_cell_height);
  }
  bool operator()(const ScalePyramid& a, const ScalePyramid& b) const {
    return a.levels == b.levels && (*this)(a.factor, b.factor) && (*this)(a.log_factor, b.log_factor) &&
           (*this)(a.factors, b.factors) && (*this)(a.sigma2, b.sigma2) && (*this)(a.inverse_sigma2, b.inverse_sigma2);
  }
  bool operator()(const BagOfWords& a, const BagOfWords& b) const {
    return a.words == b.words && (*this)(a.weights, b.weights);
  }
  bool operator()(const ImuBias& a, const ImuBias& b) const {
    return (*this)(a.accelerometer, b.accelerometer) && (*this)(a.gyroscope, b.gyroscope);
  }
  bool operator()(const ImuCalibration& a, const ImuCalibration& b) const {
    return (*this)(a.camera_from_body, b.camera_from_body) && (*this)(a.body_from_camera, b.body_from_camera) &&
           (*this)(a.noise, b.noise) && (*this)(a.walk_noise, b.walk_noise) && a.is_set == b.is_set;
  }
  bool operator()(const ImuPreintegration& a, const ImuPreintegration& b) const {
    return (*this)(a.duration, b.duration) && (*this)(a.covariance, b.covariance) &&
           (*this)(a.information, b.information) && (*this)(a.noise, b.noise) && (*this)(a.walk_noise, b.walk_noise) &&
           (*this)(a.bias, b.bias) && (*this)(a.rotation, b.rotation) && (*this)(a.velocity, b.velocity) &&
           (*this)(a.position, b.position) && (*this)(a.rotation_by_gyro, b.rotation_by_gyro) &&
           (*this)(a.velocity_by_gyro, b.velocity_by_gyro) && (*this)(a.velocity_by_acc, b.velocity_by_acc) &&
           (*this)(a.position_by_gyro, b.position_by_gyro) && (*this)(a.position_by_acc, b.position_by_acc) &&
           (*this)(a.mean_acceleration, b.mean_acceleration) &&
           (*this)(a.mean_angular_velocity, b.mean_angular_velocity) && (*this)(a.updated_bias, b.updated_bias) &&
           (*this)(a.bias_change, b.bias_change) && (*this)(a.measurements, b.measurements);
  }

  // Keypoints, descriptors, depths and grids: all but which map points they see.
  bool operator()(const Features& a, const Features& b) const {
    return a.count == b.count && a.left_count == b.left_count && a.right_count == b.right_count &&
           (*this)(a.keypoints, b.keypoints) && (*this)(a.undistorted, b.undistorted) &&
           (*this)(a.right_x, b.right_x) && (*this)(a.depth, b.depth) && a.descriptors == b.descriptors &&
           (*this)(a.right_keypoints, b.right_keypoints) && a.right_of_left == b.right_of_left &&
           a.left_of_right == b.left_of_right && a.grid == b.grid && a.right_grid == b.right_grid;
  }

 private:
  // Most of what is compared is equal to the last bit. The elements hold nothing but numbers, without padding.
  template <class T>
  bool AllSame(const T* a, const T* b, std::size_t count) const {
    if (count == 0 || std::memcmp(static_cast<const void*>(a), static_cast<const void*>(b), count * sizeof(T)) == 0)
      return true;
    for (std::size_t i = 0; i < count; ++i)
      if (!(*this)(a[i], b[i])) return false;
    return true;
  }

  double tolerance_;
};

}  // namespace slamdb
