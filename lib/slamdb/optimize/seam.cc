// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <set>

#include "slamdb/base/error.h"
#include "slamdb/model/index.h"
#include "slamdb/optimize/bundle_adjustment.h"
#include "slamdb/optimize/detail/find_map.h"

namespace slamdb {
namespace detail {

std::size_t FindMap(const Atlas& atlas, MapId id) {
  const auto found = std::ranges::find(atlas.maps, id, &Map::id);
  if (found == atlas.maps.end()) throw Error(ErrorKind::kNotFound, "there is no " + ToString(id));
  return static_cast<std::size_t>(found - atlas.maps.begin());
}

std::vector<std::uint32_t> RowsOf(const Map& map, std::span<const KeyFrameId> ids) {
  const IdTable table = KeyFrameTable(map);
  std::vector<std::uint32_t> rows;
  for (const KeyFrameId id : ids) {
    const std::uint32_t row = table.Find(id.value());
    if (row == kNoRow) throw Error(ErrorKind::kNotFound, ToString(map.id) + " has no " + ToString(id));
    rows.push_back(row);
  }
  return rows;
}

}  // namespace detail

namespace {

std::vector<KeyFrameId> Joints(const Map& map) {
  std::vector<KeyFrameId> joints;
  for (const KeyFrame& keyframe : map.keyframes)
    if (!keyframe.merge_edges.empty() || !keyframe.loop_edges.empty()) joints.push_back(keyframe.id);
  return joints;
}

// Those that share most points with a keyframe, of equals the lowest id.
std::vector<KeyFrameId> BestNeighbours(const Map& map, const IdTable& points, const KeyFrame& keyframe,
                                       std::size_t count) {
  std::map<KeyFrameId, std::uint32_t> shared;
  for (const MapPointId slot : keyframe.features.map_points) {
    const std::uint32_t row = slot ? points.Find(slot.value()) : kNoRow;
    if (row == kNoRow) continue;
    for (const Observation& observation : map.points[row].observations)
      if (observation.keyframe != keyframe.id) ++shared[observation.keyframe];
  }
  std::vector<std::pair<KeyFrameId, std::uint32_t>> neighbours(shared.begin(), shared.end());
  std::ranges::stable_sort(neighbours, [](const auto& a, const auto& b) { return a.second > b.second; });
  if (neighbours.size() > count) neighbours.resize(count);
  std::vector<KeyFrameId> best;
  for (const auto& neighbour : neighbours) best.push_back(neighbour.first);
  return best;
}

}  // namespace

std::string_view NameOf(Gauge gauge) {
  switch (gauge) {
    case Gauge::kKeyFrame:
      return "keyframe";
    case Gauge::kKeyFrameAndScale:
      return "keyframe-and-scale";
    case Gauge::kHeading:
      return "heading";
    case Gauge::kNeighbours:
      return "neighbours";
    case Gauge::kPoints:
      return "points";
  }
  return "?";
}

std::vector<KeyFrameId> SeamKeyFrames(const Map& map, std::span<const KeyFrameId> given, std::size_t neighbours) {
  const std::vector<KeyFrameId> joints = given.empty() ? Joints(map) : std::vector(given.begin(), given.end());
  const IdTable points = PointTable(map), keyframes = KeyFrameTable(map);
  std::set<KeyFrameId> seam;
  for (const std::uint32_t row : detail::RowsOf(map, joints)) {
    seam.insert(map.keyframes[row].id);
    for (const KeyFrameId id : BestNeighbours(map, points, map.keyframes[row], neighbours))
      if (keyframes.Find(id.value()) != kNoRow) seam.insert(id);
  }
  return {seam.begin(), seam.end()};
}

}  // namespace slamdb
