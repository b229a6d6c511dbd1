// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/edit/part/subset.h"
#include "slamdb/export.h"

namespace slamdb {

// With how many points in view ORB-SLAM3 takes itself to be found again: the inliers of its relocalisation.
inline constexpr std::size_t kPointsToLocalize = 50;

// From where a camera can still be localised.
// Each good keyframe of the whole atlas stands for its place; the place is covered when at least `min_points` of the
// points that the keyframe observes are kept and observed by a kept keyframe.
struct Coverage {
  std::size_t min_points = kPointsToLocalize;
  std::uint64_t places = 0;          // good keyframes of the whole atlas
  std::uint64_t covered_before = 0;  // with everything
  std::uint64_t covered = 0;         // with the part

  // Whether fewer than 80% of the places that were covered still are: a camera will often not be found.
  bool poor() const { return covered * 5 < covered_before * 4; }
};

// Of the part that `kept` is of the atlas.
//
// Cost: linear in the observations.
[[nodiscard]] SLAMDB_EXPORT Coverage MeasureCoverage(const AtlasIndex& index, const Subset& kept,
                                                     std::size_t min_points = kPointsToLocalize);

}  // namespace slamdb
