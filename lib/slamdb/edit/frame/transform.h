// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/similarity.h"

namespace slamdb {

// Moves a map into another world frame: everything in it that has a length, a direction or a pose, coherently, so that
// every point is seen at the same pixel as before. docs/transform.md says which field how.
// What the IMU measured stays metric, as in ORB-SLAM3's Map::ApplyScaledRotation.
// The identity changes no byte, and values that are not finite stay as recorded.
//
// Throws Error (kUsage), before it changes anything, when the transform is not finite or its scale not positive.
// Cost: linear, in place. `threads` 0: every core; the bytes are the same for any number.
SLAMDB_EXPORT void TransformMap(Map& map, const Similarity3d& target_from_source, int threads = 0);

// Throws the Error that TransformMap would throw.
SLAMDB_EXPORT void RequireTransform(const Similarity3d& target_from_source);

// What the owner of the map should know before it is moved so, one sentence each: gravity that no longer points along
// -z in a map with IMU, a change of scale where the IMU has the unit fixed.
[[nodiscard]] SLAMDB_EXPORT std::vector<std::string> TransformWarnings(const Map& map,
                                                                       const Similarity3d& target_from_source);

// What is lost when coordinates get so large that single precision has steps of more than a millimetre.
[[nodiscard]] SLAMDB_EXPORT std::optional<std::string> CoarseningLoss(const Map& map,
                                                                      const Similarity3d& target_from_source);

}  // namespace slamdb
