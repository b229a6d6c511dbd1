// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "slamdb/model/atlas.h"

namespace slamdb::detail {

// What ORB-SLAM3 numbers its vertices by: an id beyond is damage.
inline constexpr std::uint64_t kLargestId = (std::uint64_t{1} << 31) - 1;

// Makes points anew that keyframes see in their slots and that no map holds: where two rays with a parallax meet, of
// different keyframes or of a fisheye stereo pair, or where a view's depth puts it. The place that most views agree
// with counts, in pixel and depth, by the limits that ORB-SLAM3 has for outliers, and is refined over them by least
// squares; the others are left out and their slots emptied. Where no place has more than half of the views, none is
// made. Normal, distances, descriptor and count are what ORB-SLAM3 computes of the observations. The points stand
// behind those of their map, by id. Views by cameras of unknown lenses tell nothing.
// Returns their ids. Cost: linear in the slots; the result is the same for any number of threads.
std::vector<MapPointId> TriangulateLostPoints(Atlas& atlas, const std::vector<CameraId>& unknown_lenses, int threads);

}  // namespace slamdb::detail
