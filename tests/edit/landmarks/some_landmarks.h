// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "slamdb/edit/landmarks/landmarks.h"

namespace slamdb {

// Without features, its errors independent of each other.
inline Landmark LandmarkAt(const Eigen::Vector3d& mean, const Eigen::Vector3d& variances, std::uint32_t seen = 1) {
  Landmark landmark;
  landmark.mean = mean;
  landmark.cov_11 = variances.x();
  landmark.cov_22 = variances.y();
  landmark.cov_33 = variances.z();
  landmark.seen_count = seen;
  return landmark;
}

// Landmarks of an atlas alone, as a file of MRPT has them.
inline Atlas LandmarksOf(Atlas atlas) {
  MakeLandmarks(atlas);
  Atlas file;
  for (Map& map : atlas.maps) {
    file.maps.emplace_back().id = map.id;
    file.maps.back().landmarks = std::move(map.landmarks);
  }
  return file;
}

}  // namespace slamdb
