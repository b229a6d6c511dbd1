// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/camera.h"

namespace slamdb::live {

struct Runtime;

// A camera with the names of ORB-SLAM3's GeometricCamera.
// The mathematics is slamdb::Project and Unproject; camera frame z forward, x right, y down; pixels.
// Immutable but for setParameter, which is not to be called while others use it.
class SLAMDB_EXPORT GeometricCamera {
 public:
  static constexpr unsigned int CAM_PINHOLE = 0;  // NOLINT(readability-identifier-naming): ORB-SLAM3's name
  static constexpr unsigned int CAM_FISHEYE = 1;  // NOLINT(readability-identifier-naming): ORB-SLAM3's name

  explicit GeometricCamera(slamdb::Camera record) : record_(std::move(record)) {}
  // A copy is of no atlas.
  GeometricCamera(const GeometricCamera& other) : record_(other.record_) {}
  GeometricCamera& operator=(const GeometricCamera&) = delete;

  // The pixel of a point in the camera frame; NaN when it has none (behind a pinhole).
  Eigen::Vector2f project(const Eigen::Vector3f& x_in_camera) const;
  Eigen::Vector2d project(const Eigen::Vector3d& x_in_camera) const;
  cv::Point2f project(const cv::Point3f& x_in_camera) const;

  // The viewing ray of a pixel, scaled to z = 1.
  Eigen::Vector3f unprojectEig(const cv::Point2f& pixel) const;
  cv::Point3f unproject(const cv::Point2f& pixel) const;

  Eigen::Matrix3f toK_() const;  // NOLINT(readability-identifier-naming): the calibration matrix
  cv::Mat toK() const;           // the same, CV_32F

  // Throw Error (kUsage) when there is no such parameter.
  float getParameter(int i) const { return record_.parameters[RequireParameter(static_cast<std::size_t>(i))]; }
  void setParameter(float value, std::size_t i) { record_.parameters[RequireParameter(i)] = value; }
  std::size_t size() const { return record_.parameters.size(); }
  unsigned int GetId() const { return static_cast<unsigned int>(record_.id.value()); }
  unsigned int GetType() const { return record_.recorded_type; }

  const slamdb::Camera& record() const { return record_; }

  // Whether both are the same camera: type, and parameters within 1e-6.
  bool IsEqual(const GeometricCamera& other) const;

  // Whether it belongs to the live atlas of that runtime.
  bool IsOf(const Runtime& runtime) const { return owner_ == &runtime; }

 private:
  friend class Atlas;  // gives it its id
  friend struct Bridge;

  std::size_t RequireParameter(std::size_t i) const;

  slamdb::Camera record_;
  const Runtime* owner_ = nullptr;  // of the atlas that took it over
};

// Parameters fx, fy, cx, cy.
class SLAMDB_EXPORT Pinhole : public GeometricCamera {
 public:
  explicit Pinhole(std::vector<float> parameters);
};

// Parameters fx, fy, cx, cy, k0, k1, k2, k3 (Kannala and Brandt, PAMI 2006); `precision` is where unprojecting stops
// iterating, radians.
class SLAMDB_EXPORT KannalaBrandt8 : public GeometricCamera {
 public:
  explicit KannalaBrandt8(std::vector<float> parameters, float precision = 1e-6F);
};

}  // namespace slamdb::live
