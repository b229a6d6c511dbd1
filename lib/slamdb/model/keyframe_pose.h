// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "slamdb/model/ids.h"
#include "slamdb/model/similarity.h"

namespace slamdb {

// Where another program has a keyframe, in double precision.
struct KeyFramePose {
  KeyFrameId keyframe;   // none: known by its time
  double timestamp = 0;  // seconds
  // Its scale is how many lengths of the world one of the keyframe's map is: 1 unless the program estimates one for
  // each keyframe.
  Similarity3d world_from_camera;
  bool has_time = false;     // with an id: the time is known too, and is not the place in an order
  std::vector<double> lens;  // fx, fy, cx, cy, pixels, then the distortion, that the program has; empty: not known
};

// Where another program has a map point. World coordinates.
struct PointPosition {
  MapPointId point;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  // One keypoint that it is, by which it is told whether the id still means the same point: programs that make points
  // anew number them from 1 on. No keyframe: the id is believed.
  KeyFrameId seen_by;
  std::int32_t keypoint = -1;
};

}  // namespace slamdb
