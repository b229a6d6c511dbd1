// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "slamdb/model/atlas.h"

// Whether what was read of a damaged archive can be an object that is whole. It stands alone for those behind which
// nothing is.
namespace slamdb::orbslam3 {

bool LooksWhole(const KeyFrame& keyframe);
bool LooksWhole(const MapPoint& point);
bool LooksWhole(const Camera& camera);
// Of the members behind the lists of a map.
bool LooksWhole(const Map& tail, std::uint64_t largest_keyframe);

}  // namespace slamdb::orbslam3
