// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "slamdb/model/camera.h"

namespace slamdb::detail {

// Whether two cameras are the same: model and parameters, as ORB-SLAM3 compares them.
inline bool IsSameCamera(const Camera& a, const Camera& b) {
  constexpr float kSameParameter = 1e-6F;
  const auto close = [](float x, float y) { return std::abs(x - y) <= kSameParameter; };
  return a.model == b.model && std::ranges::equal(a.parameters, b.parameters, close) &&
         (a.model != CameraModel::kKannalaBrandt8 || close(a.precision, b.precision));
}

}  // namespace slamdb::detail
