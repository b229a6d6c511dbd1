// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/index.h"

namespace slamdb {

// How far the observations of a map's points are from where the points project to.
// Refers to the atlas, which must outlive it.
//
// Units: pixels of the full-size image.
// Constant after construction: safe to use from many threads.
class SLAMDB_EXPORT Reprojection {
 public:
  // Both of one observation.
  // NaN where it has no such side, where keyframe, keypoint or camera is missing, or the point is behind the camera.
  struct Errors {
    float left, right;
  };

  Reprojection(const Atlas& atlas, const Map& map);

  // The keyframe of that id in the map, the first of several; null when there is none.
  const KeyFrame* Find(KeyFrameId id) const;

  Errors Of(const MapPoint& point, const Observation& observation) const;

  // Over all observations of a point, left and right; NaN when none can be projected.
  float Mean(const MapPoint& point) const;

 private:
  // One camera of a keyframe with its pose as a matrix: what projecting needs, and nothing else.
  struct Eye {
    const Camera* camera = nullptr;
    Eigen::Matrix3f rotation;  // eye_from_world
    Eigen::Vector3f translation;
  };
  struct View {
    const KeyFrame* keyframe;
    Eye left, right;
  };

  const View* FindView(KeyFrameId id) const {
    const std::uint32_t row = rows_.Find(id.value());
    return row == kNoRow ? nullptr : &views_[row];
  }
  static float Error(const Eye& eye, const MapPoint& point, const Keypoint* keypoint);

  std::vector<View> views_;  // one per keyframe, in the map's order
  IdTable rows_;             // keyframe id -> view
};

}  // namespace slamdb
