// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>

#include "slamdb/model/atlas.h"

namespace slamdb::detail {

// The cameras of files in which each keyframe says its own: those of the same numbers, to the bit, are one.
class PinholeCameras {
 public:
  // fx fy cx cy, pixels. A new camera is added to the atlas.
  CameraId IdOf(const std::array<float, 4>& parameters, Atlas& atlas);

 private:
  std::map<std::array<std::uint32_t, 4>, CameraId> known_;
};

}  // namespace slamdb::detail
