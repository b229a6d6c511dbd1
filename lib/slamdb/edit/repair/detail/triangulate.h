// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/model/atlas.h"

namespace slamdb::detail {

// Makes points anew that keyframes see in their slots and that no map holds: from two views with a parallax, of
// different keyframes or of a fisheye stereo pair, or from a view with a depth. A view that the point does not project
// to, by the limit that ORB-SLAM3 has for outliers, is left out and its slot emptied. Normal, distances, descriptor and
// count are what ORB-SLAM3 computes of the observations. The points stand behind those of their map, by id.
// Views by cameras of unknown lenses tell nothing.
// Returns their ids. Cost: linear in the slots; the result is the same for any number of threads.
std::vector<MapPointId> TriangulateLostPoints(Atlas& atlas, const std::vector<CameraId>& unknown_lenses, int threads);

}  // namespace slamdb::detail
