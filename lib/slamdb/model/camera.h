// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "slamdb/model/carried.h"
#include "slamdb/model/ids.h"

namespace slamdb {

enum class CameraModel : std::uint32_t {
  kPinhole = 0,          // parameters fx, fy, cx, cy (pixels)
  kKannalaBrandt8 = 1,   // parameters fx, fy, cx, cy, k0, k1, k2, k3 (Kannala and Brandt, PAMI 2006)
  kEquirectangular = 2,  // of the fork super_SLAM3: 2 parameters; kept and written back, nothing is projected with it
};

// ORB-SLAM3: GeometricCamera and its classes Pinhole and KannalaBrandt8.
struct Camera {
  CameraId id;                                // mnId
  CameraModel model = CameraModel::kPinhole;  // the class that was stored
  std::uint32_t recorded_type = 0;            // mnType, which should agree with the class: 0 pinhole, 1 fisheye
  std::vector<float> parameters;              // mvParameters
  float precision = 1e-6F;                    // KannalaBrandt8 only: where its unprojection stops iterating
  Boxed<Carried> carried;                     // of a fork's file; null as a rule
};

}  // namespace slamdb
