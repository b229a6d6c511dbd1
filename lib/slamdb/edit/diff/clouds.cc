// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "slamdb/edit/diff/diff.h"

namespace slamdb {
namespace {

// What points of a cloud have; other programs keep less than slamdb writes.
struct CloudContent {
  bool normals = false, ranges = false;
  bool ids = false;  // not just the numbers of rows
  friend bool operator==(const CloudContent&, const CloudContent&) = default;
};

bool IsCloud(const Atlas& atlas) {
  const auto has_points_alone = [](const Map& map) { return map.keyframes.empty() && map.landmarks.empty(); };
  return atlas.cameras.empty() && std::ranges::all_of(atlas.maps, has_points_alone) &&
         std::ranges::any_of(atlas.maps, [](const Map& map) { return !map.points.empty(); });
}

CloudContent ContentOf(const Atlas& atlas) {
  CloudContent content;
  std::uint64_t row = 0;
  for (const Map& map : atlas.maps)
    for (const MapPoint& point : map.points) {
      content.normals |= !point.normal.isZero(0);
      content.ranges |= point.max_distance != 0;
      content.ids |= point.id != MapPointId(row++);
    }
  content.ids |= atlas.maps.size() > 1;
  return content;
}

// As a cloud of that content holds it; points flagged bad are in none.
Atlas PointsAlone(const Atlas& atlas, const CloudContent& content) {
  Atlas points;
  std::uint64_t row = 0;
  for (const Map& from : atlas.maps) {
    if (content.ids || points.maps.empty()) points.maps.emplace_back().id = content.ids ? from.id : MapId(0);
    for (const MapPoint& point : from.points) {
      if (point.bad) continue;
      MapPoint& kept = points.maps.back().points.emplace_back();
      kept.id = content.ids ? point.id : MapPointId(row++);
      kept.position = point.position;
      if (content.normals) kept.normal = point.normal;
      if (content.ranges) kept.min_distance = point.min_distance, kept.max_distance = point.max_distance;
      kept.descriptor_form = MatrixForm::kEmpty;
    }
  }
  std::erase_if(points.maps, [](const Map& map) { return map.points.empty(); });
  return points;
}

}  // namespace

bool KeepWhatCloudsHold(Atlas& before, Atlas& after) {
  const bool clouds[] = {IsCloud(before), IsCloud(after)};
  if (!clouds[0] && !clouds[1]) return false;
  const CloudContent all{.normals = true, .ranges = true, .ids = true};
  const CloudContent a = clouds[0] ? ContentOf(before) : all, b = clouds[1] ? ContentOf(after) : all;
  if (clouds[0] && clouds[1] && a == b) return false;
  const CloudContent both{.normals = a.normals && b.normals, .ranges = a.ranges && b.ranges, .ids = a.ids && b.ids};
  before = PointsAlone(before, both);
  after = PointsAlone(after, both);
  return true;
}

}  // namespace slamdb
