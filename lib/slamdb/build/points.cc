// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <set>

#include "slamdb/build/build.h"
#include "slamdb/build/detail/columns.h"
#include "slamdb/formats/import/detail/completed.h"
#include "slamdb/formats/import/detail/keypoints.h"
#include "slamdb/model/counters.h"
#include "slamdb/model/detail/covisibility.h"
#include "slamdb/model/detail/spanning_tree.h"
#include "slamdb/model/index.h"

namespace slamdb {
namespace {

using detail::RefuseRow;

constexpr float kFarthest = 1e18F;  // whose square a 32-bit float still holds

void RequireColumns(const NewPoints& given) {
  const std::size_t rows = given.positions.size();
  detail::RequireLengthOrNone("ids", given.ids, rows, "positions");
  detail::RequireLengthOrNone("descriptors", given.descriptors, rows, "positions");
  detail::RequireLengthOrNone("normals", given.normals, rows, "positions");
  detail::RequireLengthOrNone("reference_keyframes", given.references, rows, "positions");
  detail::RequireLengthOrNone("min_distances", given.min_distances, rows, "positions");
  detail::RequireLength("max_distances", given.max_distances, given.min_distances.size(), "min_distances");
  for (std::size_t row = 0; row < rows; ++row) {
    if (!(given.positions[row].norm() <= kFarthest))
      RefuseRow("positions", row, "is not finite, or too far away for 32-bit floats");
    if (!given.normals.empty() && !given.normals[row].allFinite()) RefuseRow("normals", row, "is not finite");
    if (given.min_distances.empty()) continue;
    const float low = given.min_distances[row], high = given.max_distances[row];
    if (!(low >= 0 && low <= high && high <= kFarthest))
      RefuseRow("min_distances", row, "is ", static_cast<double>(low), ", and max_distances ",
                static_cast<double>(high), "; they are 0 or more, and the first is not above the second");
  }
}

// The observations of new points: each held against the keyframes, then put into their slots.
class Observing {
 public:
  Observing(Map& map, std::size_t points) : map_(map), keyframes_(KeyFrameTable(map)), points_(points) {}

  void Require(const std::vector<NewObservation>& observations) {
    for (std::size_t row = 0; row < observations.size(); ++row) Require(observations[row], row);
    for (std::size_t point = 0; point < points_.size(); ++point) {
      if (points_[point].empty())
        RefuseRow("positions", point,
                  "is of a point that nothing observes; ORB-SLAM3 culls it: leave it out, or say "
                  "in observations who sees it");
      std::ranges::sort(points_[point], {}, &Observation::keyframe);
    }
  }

  const Column<Observation>& of(std::size_t point) const { return points_[point]; }

  // Of those that observe it, that of the lowest id.
  const KeyFrame& MakerOf(std::size_t point) const {
    return map_.keyframes[keyframes_.Find(points_[point].front().keyframe.value())];
  }

  // Rows of the keyframes that see any of the points, ascending.
  std::vector<std::uint32_t> Fill(const std::vector<NewObservation>& observations, const std::vector<MapPointId>& ids) {
    std::vector<std::uint8_t> touched(map_.keyframes.size(), 0);
    for (const NewObservation& seen : observations) {
      const std::uint32_t row = keyframes_.Find(seen.keyframe.value());
      map_.keyframes[row].features.map_points[seen.keypoint] = ids[seen.point];
      touched[row] = 1;
    }
    std::vector<std::uint32_t> rows;
    for (std::uint32_t row = 0; row < touched.size(); ++row)
      if (touched[row] != 0) rows.push_back(row);
    return rows;
  }

 private:
  void Require(const NewObservation& seen, std::size_t row) {
    if (seen.point >= points_.size())
      RefuseRow("observations", row, "is of point ", seen.point, ", but there are ", points_.size(), " positions");
    const std::uint32_t keyframe_row = keyframes_.Find(seen.keyframe.value());
    if (keyframe_row == kNoRow)
      RefuseRow("observations", row, "is by keyframe ", seen.keyframe.value(), ", which the map does not have");
    const Features& features = map_.keyframes[keyframe_row].features;
    if (seen.keypoint >= features.map_points.size())
      RefuseRow("observations", row, "is keypoint ", seen.keypoint, " of keyframe ", seen.keyframe.value(),
                ", which has ", features.map_points.size());
    if (features.map_points[seen.keypoint] || !taken_.emplace(keyframe_row, seen.keypoint).second)
      RefuseRow("observations", row, "is keypoint ", seen.keypoint, " of keyframe ", seen.keyframe.value(),
                ", which is another point already; a keypoint is one point");
    Record(seen, features, row);
  }

  void Record(const NewObservation& seen, const Features& features, std::size_t row) {
    Column<Observation>& list = points_[seen.point];
    auto known = std::ranges::find(list, seen.keyframe, &Observation::keyframe);
    if (known == list.end()) known = list.insert(list.end(), Observation{seen.keyframe});
    const bool is_right =
        features.is_fisheye_stereo() && seen.keypoint >= static_cast<std::size_t>(features.left_count);
    std::int32_t& keypoint = is_right ? known->right : known->left;
    if (keypoint >= 0)
      RefuseRow("observations", row, "is point ", seen.point, " once more in keyframe ", seen.keyframe.value(),
                "; a point is one keypoint of a picture");
    keypoint = static_cast<std::int32_t>(seen.keypoint);
  }

  Map& map_;
  const IdTable keyframes_;
  std::vector<Column<Observation>> points_;
  std::set<std::pair<std::uint32_t, std::uint64_t>> taken_;  // rows of keyframes, and of their keypoints
};

void RequireReferences(const NewPoints& given, const Observing& observing) {
  for (std::size_t row = 0; row < given.references.size(); ++row)
    if (std::ranges::find(observing.of(row), given.references[row], &Observation::keyframe) == observing.of(row).end())
      RefuseRow("reference_keyframes", row, "is ", given.references[row].value(), ", which does not observe the point");
}

MapPoint PointOf(const NewPoints& given, std::size_t row, const Observing& observing) {
  MapPoint point;
  point.id = given.ids[row];
  point.position = given.positions[row];
  point.observations = observing.of(row);
  point.descriptor_form = given.descriptors.empty() ? MatrixForm::kEmpty : MatrixForm::kUsual;
  if (!given.descriptors.empty()) point.descriptor = given.descriptors[row];
  if (!given.normals.empty()) point.normal = given.normals[row];
  if (!given.min_distances.empty()) {
    point.min_distance = given.min_distances[row];
    point.max_distance = given.max_distances[row];
  }
  return point;
}

// Keyframes that share points for the first time get the parent that they share most with.
void ChooseParents(Map& map, const std::vector<std::uint8_t>& was_alone) {
  for (std::size_t row = 0; row < map.keyframes.size(); ++row) {
    KeyFrame& keyframe = map.keyframes[row];
    if (was_alone[row] != 0 && !keyframe.connections.empty()) keyframe.parent = {};
  }
  detail::AdoptOrphans(map);
}

std::vector<std::uint8_t> AloneOf(const Map& map) {
  std::vector<std::uint8_t> alone;
  for (const KeyFrame& keyframe : map.keyframes) alone.push_back(keyframe.connections.empty() ? 1 : 0);
  return alone;
}

void MatchPairs(Map& map, const std::vector<std::uint32_t>& rows) {
  for (const std::uint32_t row : rows) {
    Features& features = map.keyframes[row].features;
    const auto matches = [](std::int32_t match) { return match >= 0; };
    if (features.is_fisheye_stereo() && std::ranges::none_of(features.right_of_left, matches))
      detail::MatchSides(features);
  }
}

}  // namespace

std::vector<MapPointId> AddPoints(Atlas& atlas, MapId map_id, NewPoints given, int threads) {
  Map& map = detail::MapOf(atlas, map_id);
  RequireColumns(given);
  const AtlasIndex index(atlas);
  given.ids = detail::IdsOf(std::move(given.ids), given.positions.size(),
                            std::max(LeastCounters(atlas).map_point, atlas.next_ids.map_point), MapPointId::kNone,
                            [&](MapPointId id) { return static_cast<bool>(index.LocatePoint(id)); });
  Observing observing(map, given.positions.size());
  observing.Require(given.observations);
  RequireReferences(given, observing);
  if (given.positions.empty()) return {};

  const std::size_t first = map.points.size();
  map.points.reserve(first + given.positions.size());
  for (std::size_t row = 0; row < given.positions.size(); ++row) {
    MapPoint& point = map.points.emplace_back(PointOf(given, row, observing));
    const KeyFrame& maker = observing.MakerOf(row);
    point.reference = given.references.empty() ? maker.id : given.references[row];
    point.first_keyframe = static_cast<std::int64_t>(maker.id.value());
    point.first_frame = static_cast<std::int64_t>(maker.frame_id);
  }
  const std::vector<std::uint32_t> touched = observing.Fill(given.observations, given.ids);
  detail::Completed completed;
  detail::SummarizePoints(map, first, threads, completed);
  MatchPairs(map, touched);
  const std::vector<std::uint8_t> was_alone = AloneOf(map);
  detail::UpdateCovisibility(map, touched);
  ChooseParents(map, was_alone);
  RaiseCounters(atlas);
  return std::move(given.ids);
}

}  // namespace slamdb
