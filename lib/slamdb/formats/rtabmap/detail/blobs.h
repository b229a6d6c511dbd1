// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "slamdb/base/file.h"
#include "slamdb/model/geodetic.h"

// What the blobs of RTAB-Map's databases hold.
namespace slamdb::rtabmap {

// Where a blob stands, for errors.
struct Place {
  const std::string& path;
  std::string where;                                         // `table Node, row 12`
  [[noreturn]] void Fail(const std::string& problem) const;  // kDamaged
  void Require(const std::string& why_not) const;            // fails unless it is empty
};

struct Version {
  int major = 0, minor = 0, patch = 0;
  friend auto operator<=>(const Version&, const Version&) = default;
};

using Pose = Eigen::Isometry3d;

// 12 floats, the rows of a 3x4 matrix; the rotation made one again. nullopt: no blob, or what RTAB-Map takes for its
// null transform: zeros, or NaN.
std::optional<Pose> PoseOf(Bytes blob, const Place& place);
// Of 12 numbers.
std::optional<Pose> PoseOf(const float* rows, const Place& place);

// Six doubles: time, longitude, latitude, altitude, accuracy, bearing. `stamp`: of the node, where the fix has no time.
// nullopt: no blob, or no place on earth.
std::optional<GpsFix> FixOf(Bytes blob, double stamp, const Place& place);

// What is in a compressed matrix, which must be of this OpenCV type.
std::vector<std::int32_t> IntegersOf(Bytes blob, const Place& place);
std::vector<float> FloatsOf(Bytes blob, const Place& place);

// A camera of a node. Pictures are rectified.
struct NodeCamera {
  float fx = 0, fy = 0, cx = 0, cy = 0;  // pixels
  std::int32_t width = 0, height = 0;    // 0: not recorded
  float baseline = 0;                    // metres; 0: no stereo camera
  Pose base_from_camera = Pose::Identity();

  // As RTAB-Map says it. Others are not calibrated.
  bool is_valid() const { return fx > 0 && fy > 0 && cx > 0 && cy > 0; }
};

// All cameras of a calibration, as that version of RTAB-Map wrote it.
std::vector<NodeCamera> CalibrationOf(Bytes blob, const Version& version, const Place& place);

}  // namespace slamdb::rtabmap
