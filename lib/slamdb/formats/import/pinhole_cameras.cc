// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/import/detail/pinhole_cameras.h"

#include <bit>

namespace slamdb::detail {

CameraId PinholeCameras::IdOf(const std::array<float, 4>& parameters, Atlas& atlas) {
  const auto bits = std::bit_cast<std::array<std::uint32_t, 4>>(parameters);
  const auto [camera, is_new] = known_.try_emplace(bits, CameraId(known_.size()));
  if (is_new) atlas.cameras.push_back({.id = camera->second, .parameters = {parameters.begin(), parameters.end()}});
  return camera->second;
}

}  // namespace slamdb::detail
