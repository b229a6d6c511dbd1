// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "slamdb/build/build.h"
#include "slamdb/build/detail/columns.h"
#include "slamdb/build/detail/observing.h"
#include "slamdb/formats/import/detail/completed.h"
#include "slamdb/model/counters.h"
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

// What observations say of new points, held against a map.
class NewObservations {
 public:
  NewObservations(const Map& map, const NewPoints& given) : map_(map), points_(given.positions.size()) {
    for (std::size_t row = 0; row < given.observations.size(); ++row) {
      const auto& [point, keyframe, keypoint] = given.observations[row];
      if (point >= points_.size())
        RefuseRow("observations", row, "is of point ", point, ", but there are ", points_.size(), " positions");
      observing_.Add(point, keyframe, keypoint, row, points_[point]);
    }
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
    return map_.keyframes[observing_.RowOf(points_[point].front().keyframe)];
  }

  std::uint32_t RowOf(KeyFrameId keyframe) const { return observing_.RowOf(keyframe); }

 private:
  const Map& map_;
  detail::Observing observing_{map_, {.point = "observations", .keyframe = "observations", .keypoint = "observations"}};
  std::vector<Column<Observation>> points_;
};

// Puts points into the keypoints that they are. Rows of the keyframes that see any, ascending.
std::vector<std::uint32_t> FillSlots(Map& map, const NewPoints& given, const NewObservations& observations) {
  std::vector<std::uint8_t> touched(map.keyframes.size(), 0);
  for (const NewObservation& seen : given.observations) {
    const std::uint32_t row = observations.RowOf(seen.keyframe);
    map.keyframes[row].features.map_points[seen.keypoint] = given.ids[seen.point];
    touched[row] = 1;
  }
  std::vector<std::uint32_t> rows;
  for (std::uint32_t row = 0; row < touched.size(); ++row)
    if (touched[row] != 0) rows.push_back(row);
  return rows;
}

void RequireReferences(const NewPoints& given, const NewObservations& observations) {
  for (std::size_t row = 0; row < given.references.size(); ++row)
    if (std::ranges::find(observations.of(row), given.references[row], &Observation::keyframe) ==
        observations.of(row).end())
      RefuseRow("reference_keyframes", row, "is ", given.references[row].value(), ", which does not observe the point");
}

MapPoint PointOf(const NewPoints& given, std::size_t row, const NewObservations& observations) {
  MapPoint point;
  point.id = given.ids[row];
  point.position = given.positions[row];
  point.observations = observations.of(row);
  point.descriptor_form = given.descriptors.empty() ? MatrixForm::kEmpty : MatrixForm::kUsual;
  if (!given.descriptors.empty()) point.descriptor = given.descriptors[row];
  if (!given.normals.empty()) point.normal = given.normals[row];
  if (!given.min_distances.empty()) {
    point.min_distance = given.min_distances[row];
    point.max_distance = given.max_distances[row];
  }
  return point;
}

}  // namespace

std::vector<MapPointId> AddPoints(Atlas& atlas, MapId map_id, NewPoints given, int threads) {
  Map& map = detail::MapOf(atlas, map_id);
  RequireColumns(given);
  const AtlasIndex index(atlas);
  given.ids = detail::IdsOf(std::move(given.ids), given.positions.size(),
                            std::max(LeastCounters(atlas).map_point, atlas.next_ids.map_point), MapPointId::kNone,
                            [&](MapPointId id) { return static_cast<bool>(index.LocatePoint(id)); });
  const NewObservations observations(map, given);
  RequireReferences(given, observations);
  if (given.positions.empty()) return {};

  const std::size_t first = map.points.size();
  map.points.reserve(first + given.positions.size());
  for (std::size_t row = 0; row < given.positions.size(); ++row) {
    MapPoint& point = map.points.emplace_back(PointOf(given, row, observations));
    const KeyFrame& maker = observations.MakerOf(row);
    point.reference = given.references.empty() ? maker.id : given.references[row];
    point.first_keyframe = static_cast<std::int64_t>(maker.id.value());
    point.first_frame = static_cast<std::int64_t>(maker.frame_id);
  }
  const std::vector<std::uint32_t> touched = FillSlots(map, given, observations);
  detail::Completed completed;
  detail::SummarizePoints(map, first, threads, completed);
  detail::UpdateGraph(map, touched);
  RaiseCounters(atlas);
  return std::move(given.ids);
}

}  // namespace slamdb
