// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <tuple>
#include <unordered_map>

#include "slamdb/formats/postgresql/detail/save.h"
#include "slamdb/formats/rows/detail/point_row.h"

namespace slamdb::postgresql {

using rows::ListPlan;
using rows::StoredRow;
using rows::ToColumn;

namespace {

constexpr std::size_t kReportEvery = 4096;

using SeenKey = std::tuple<std::int64_t, std::int32_t, std::int32_t>;  // keyframe, left and right keypoint

std::vector<SeenKey> KeysOf(const Column<Observation>& observations) {
  std::vector<SeenKey> keys;
  for (const Observation& each : observations) keys.emplace_back(ToColumn(each.keyframe), each.left, each.right);
  std::ranges::sort(keys);
  return keys;
}

std::vector<SeenKey> StoredKeys(const Row& row, std::size_t column) {
  std::vector<std::int64_t> seen_by;
  std::vector<std::int32_t> left, right;
  row.Integers64(column, seen_by);
  row.Integers32(column + 1, left);
  row.Integers32(column + 2, right);
  std::vector<SeenKey> keys;
  for (std::size_t i = 0; i < std::min({seen_by.size(), left.size(), right.size()}); ++i)
    keys.emplace_back(seen_by[i], left[i], right[i]);
  std::ranges::sort(keys);
  return keys;
}

// Ends them, and counts what became of points that were there before, and of observations.
void EndPoints(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans,
               const ListPlaces& changed, const std::vector<std::int64_t>& ended) {
  std::unordered_map<std::int64_t, const MapPoint*> by_row;
  for (const auto& [i, k] : changed) {
    const ListPlan::Entry& entry = plans[i].points.entries[k];
    const MapPoint& point = maps[i].map.points[k];
    if (entry.stored != nullptr)
      by_row[entry.row] = &point;
    else
      context.map.observations_added += point.observations.size();
  }
  const std::optional<Result> found =
      EndRows(context, "map_point", ended, "row, x, y, z, seen_by, left_keypoints, right_keypoints");
  for (std::size_t r = 0; found && r < found->rows(); ++r) {
    const Row row = (*found)[r];
    const std::vector<SeenKey> before = StoredKeys(row, 4);
    const auto point = by_row.find(row.Integer(0));
    if (point == by_row.end()) {  // it is gone
      context.map.observations_removed += before.size();
      continue;
    }
    const std::vector<SeenKey> now = KeysOf(point->second->observations);
    std::vector<SeenKey> both;
    std::ranges::set_intersection(before, now, std::back_inserter(both));
    context.map.observations_added += now.size() - both.size();
    context.map.observations_removed += before.size() - both.size();
    const Eigen::Vector3f& position = point->second->position;
    for (int axis = 0; axis < 3; ++axis) {
      const auto stored = static_cast<float>(row.Real(1 + static_cast<std::size_t>(axis)));
      if (stored == position[axis] || (std::isnan(stored) && std::isnan(position[axis]))) continue;
      ++context.map.points_moved;
      break;
    }
  }
}

void WritePoints(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans,
                 const ListPlaces& changed) {
  if (changed.empty()) return;
  CopyIn copy(context.connection, PointTable().target, PointTable().types, context.way());
  rows::PointRow columns;
  CarriedColumn carried;
  std::vector<std::int64_t> seen_by;
  std::vector<std::int32_t> left, right;
  std::size_t done = 0;
  for (const auto& [i, k] : changed) {
    const MapPoint& point = maps[i].map.points[k];
    const ListPlan::Entry& entry = plans[i].points.entries[k];
    for (auto* list : {&left, &right}) list->clear();
    seen_by.clear();
    for (const Observation& each : point.observations) {
      seen_by.push_back(ToColumn(each.keyframe));
      left.push_back(each.left);
      right.push_back(each.right);
    }
    copy.Begin();
    PutColumns(copy, columns.Of({entry.row, maps[i].row, entry.unique, maps[i].hashes.points[k],
                                 maps[i].hashes.observations[k]},
                                point));
    copy.Put(std::span<const std::int64_t>(seen_by));
    copy.Put(std::span<const std::int32_t>(left));
    copy.Put(std::span<const std::int32_t>(right));
    copy.Put(carried.Of(point.carried));
    copy.Put(context.atlas);
    copy.Put(context.revision);
    copy.End();
    if (++done % kReportEvery == 0) context.Report(kReportEvery);
  }
  copy.Finish();
}

}  // namespace

void SavePoints(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans) {
  ListPlaces changed;
  std::vector<std::int64_t> ended;
  TableChanges& changes = context.changes["map_point"];
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const ListPlan& plan = plans[i].points;
    const AtlasHashes::OfMap& hashes = maps[i].hashes;
    for (std::size_t k = 0; k < plan.entries.size(); ++k) {
      const ListPlan::Entry& entry = plan.entries[k];
      const StoredRow* old = entry.stored;
      const bool same = rows::HasRow(entry, hashes.points[k]) && rows::HasDetails(entry, hashes.observations[k]);
      rows::Count(changes, same, old == nullptr);
      if (old == nullptr) ++context.map.points_added;
      if (same) continue;
      changed.emplace_back(i, k);
      if (old != nullptr) ended.push_back(entry.row);
    }
    context.map.points_removed += plan.removed.size();
    changes.deleted += plan.removed.size();
    ended.insert(ended.end(), plan.removed.begin(), plan.removed.end());
  }
  EndPoints(context, maps, plans, changed, ended);
  WritePoints(context, maps, plans, changed);
}

}  // namespace slamdb::postgresql
