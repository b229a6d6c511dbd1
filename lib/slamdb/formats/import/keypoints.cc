// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/import/detail/keypoints.h"

#include <cmath>
#include <unordered_map>

namespace slamdb::detail {

float PatchAt(std::int32_t octave, const ScalePyramid& pyramid) {
  const bool is_level = octave >= 0 && static_cast<std::size_t>(octave) < pyramid.factors.size();
  return std::floor(kPatch * (is_level ? pyramid.factors[static_cast<std::size_t>(octave)] : 1));
}

void MatchSides(Features& features) {
  const auto left = static_cast<std::size_t>(features.left_count);
  features.right_of_left.assign(left, -1);
  features.left_of_right.assign(features.right_keypoints.size(), -1);
  std::unordered_map<std::uint64_t, std::size_t> left_of_point;
  for (std::size_t row = 0; row < left; ++row)
    if (features.map_points[row]) left_of_point.emplace(features.map_points[row].value(), row);
  for (std::size_t row = left; row < features.map_points.size(); ++row) {
    const auto match = left_of_point.find(features.map_points[row].value());
    if (match == left_of_point.end()) continue;
    features.right_of_left[match->second] = static_cast<std::int32_t>(row - left);
    features.left_of_right[row - left] = static_cast<std::int32_t>(match->second);
  }
}

}  // namespace slamdb::detail
