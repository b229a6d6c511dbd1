// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "slamdb/model/atlas.h"
#include "slamdb/synthetic/detail/portable.h"
#include "slamdb/synthetic/synthesize.h"

namespace slamdb::synthetic {

// The cameras of a sensor and what every keyframe repeats about them. Immutable once made.
struct Rig {
  Sensor sensor = Sensor::kMonocular;
  std::vector<Camera> cameras;  // one, or the two of a fisheye pair
  Intrinsics intrinsics;
  ImageBounds bounds;
  ScalePyramid pyramid;
  Pose left_from_right;                    // fisheye pair
  Pose camera_from_body;                   // body: x forward, y left, z up, at the IMU
  double half_width = 0, half_height = 0;  // field of view, radians from the optical axis

  bool is_fisheye() const { return cameras.size() == 2; }
  bool has_depth() const { return sensor == Sensor::kStereo || sensor == Sensor::kRgbd; }

  // The pixel of a point in the frame of cameras[camera], when it lies at least kImageMargin inside the image.
  std::optional<Eigen::Vector2d> Project(std::size_t camera, const Eigen::Vector3d& x_in_camera) const;
};

inline constexpr double kImageMargin = 16;  // pixels; the ORB detector keeps off the border

Rig MakeRig(Sensor sensor);

// A keyframe that holds all that is the same for every keyframe of the rig.
KeyFrame BlankKeyFrame(const Rig& rig);

}  // namespace slamdb::synthetic
