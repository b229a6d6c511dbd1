// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/build/detail/observing.h"

#include <algorithm>

#include "slamdb/build/detail/columns.h"
#include "slamdb/formats/import/detail/keypoints.h"
#include "slamdb/model/detail/covisibility.h"
#include "slamdb/model/detail/spanning_tree.h"

namespace slamdb::detail {
namespace {

std::vector<std::uint8_t> AloneOf(const Map& map) {
  std::vector<std::uint8_t> alone;
  for (const KeyFrame& keyframe : map.keyframes) alone.push_back(keyframe.connections.empty() ? 1 : 0);
  return alone;
}

// Keyframes that share points for the first time get the parent that they share most with.
void ChooseParents(Map& map, const std::vector<std::uint8_t>& was_alone) {
  for (std::size_t row = 0; row < map.keyframes.size(); ++row) {
    KeyFrame& keyframe = map.keyframes[row];
    if (was_alone[row] != 0 && !keyframe.connections.empty()) keyframe.parent = {};
  }
  AdoptOrphans(map);
}

void MatchPairs(Map& map, const std::vector<std::uint32_t>& rows) {
  for (const std::uint32_t row : rows) {
    Features& features = map.keyframes[row].features;
    const auto matches = [](std::int32_t match) { return match >= 0; };
    if (features.is_fisheye_stereo() && std::ranges::none_of(features.right_of_left, matches)) MatchSides(features);
  }
}

}  // namespace

const Features& Observing::FeaturesOf(KeyFrameId keyframe, std::size_t row) const {
  const std::uint32_t found = RowOf(keyframe);
  if (found == kNoRow)
    RefuseRow(names_.keyframe, row, "is by keyframe ", keyframe.value(), ", which the map does not have");
  if (map_.keyframes[found].bad)
    RefuseRow(names_.keyframe, row, "is by keyframe ", keyframe.value(), ", which is culled; `repair` removes it");
  return map_.keyframes[found].features;
}

void Observing::Add(std::uint64_t point, KeyFrameId keyframe, std::uint64_t keypoint, std::size_t row,
                    Column<Observation>& observations) {
  const Features& features = FeaturesOf(keyframe, row);
  if (keypoint >= features.map_points.size())
    RefuseRow(names_.keypoint, row, "is keypoint ", keypoint, " of keyframe ", keyframe.value(), ", which has ",
              features.map_points.size());
  auto known = std::ranges::find(observations, keyframe, &Observation::keyframe);
  if (known == observations.end()) known = observations.insert(observations.end(), Observation{keyframe});
  const bool is_right = features.is_fisheye_stereo() && keypoint >= static_cast<std::size_t>(features.left_count);
  std::int32_t& side = is_right ? known->right : known->left;
  if (side >= 0)
    RefuseRow(names_.point, row, "is point ", point, " once more in keyframe ", keyframe.value(),
              "; a point is one keypoint of a picture");
  if (features.map_points[keypoint] || !taken_.emplace(keyframe, keypoint).second)
    RefuseRow(names_.keypoint, row, "is keypoint ", keypoint, " of keyframe ", keyframe.value(),
              ", which is another point already; a keypoint is one point");
  side = static_cast<std::int32_t>(keypoint);
}

void UpdateGraph(Map& map, const std::vector<std::uint32_t>& rows) {
  MatchPairs(map, rows);
  const std::vector<std::uint8_t> was_alone = AloneOf(map);
  UpdateCovisibility(map, rows);
  ChooseParents(map, was_alone);
}

}  // namespace slamdb::detail
