// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

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
};

// Where another program has a map point. World coordinates.
struct PointPosition {
  MapPointId point;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

}  // namespace slamdb
