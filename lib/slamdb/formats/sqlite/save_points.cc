// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <tuple>
#include <vector>

#include "slamdb/formats/rows/detail/point_row.h"
#include "slamdb/formats/rows/detail/row_changes.h"
#include "slamdb/formats/sqlite/detail/batch_insert.h"
#include "slamdb/formats/sqlite/detail/box_tree.h"
#include "slamdb/formats/sqlite/detail/carried.h"
#include "slamdb/formats/sqlite/detail/save.h"

namespace slamdb::sqlite {
namespace {

constexpr std::size_t kReportEvery = 4096;

// The rows of map_point. Flush() after the last.
class PointWriter {
 public:
  explicit PointWriter(SaveContext& context)
      : past_(context.past),
        remove_(context.database, "DELETE FROM map_point WHERE row = ?1", "table map_point"),
        is_at_(context.database, "SELECT 1 FROM map_point WHERE row = ?1 AND x IS ?2 AND y IS ?3 AND z IS ?4",
               "table map_point"),
        insert_(context.database, "map_point", rows::PointRow::kColumns),
        carried_(context.database, CarriedKind::kPoint) {}

  // Whether the position that is stored is another one.
  bool Moves(std::int64_t row, const MapPoint& point) {
    is_at_.Bind(1, row);
    for (int axis = 0; axis < 3; ++axis) is_at_.BindReal(2 + axis, point.position[axis]);
    const bool is_there = is_at_.Step();
    is_at_.Reset();
    return !is_there;
  }

  void Write(std::int64_t map, const ListPlan::Entry& entry, const MapPoint& point, std::int64_t hash,
             std::int64_t observations_hash) {
    past_.Keep(Part::kPoint, entry.row);
    past_.Keep(Part::kCarriedByPoint, entry.row);
    if (entry.stored != nullptr) {
      remove_.Bind(1, entry.row).Run();
      carried_.Remove(entry.row);
    }
    insert_.Add(row_.Of({entry.row, map, entry.unique, hash, observations_hash}, point));
    carried_.Write(entry.row, point.carried);
  }
  void Flush() { insert_.Flush(); }

 private:
  PastWriter& past_;
  Statement remove_, is_at_;
  BatchInsert insert_;
  CarriedWriter carried_;
  rows::PointRow row_;
};

// The rows of observation. Flush() after the last.
class ObservationWriter {
 public:
  explicit ObservationWriter(SaveContext& context)
      : database_(context.database),
        past_(context.past),
        select_(context.database,
                "SELECT coalesce(keyframe, -1), left_keypoint, right_keypoint FROM observation WHERE point = ?1",
                "table observation"),
        remove_(context.database, "DELETE FROM observation WHERE point = ?1", "table observation"),
        insert_(context.database, "observation", 6) {}

  // How many of the observations that are stored the point has no more.
  std::uint64_t CountGone(std::int64_t row, const Column<Observation>& observations) {
    std::vector<Key> now;
    for (const Observation& each : observations) now.push_back(KeyOf(each));
    std::ranges::sort(now);
    select_.Bind(1, row);
    std::uint64_t gone = 0;
    while (select_.Step()) {
      const auto keypoint = [&](int column) {
        return select_.IsNull(column) ? Observation::kAbsent : static_cast<std::int32_t>(select_.Integer(column));
      };
      const Key key{select_.Integer(0), keypoint(1), keypoint(2)};
      gone += std::ranges::binary_search(now, key) ? 0 : 1;
    }
    select_.Reset();
    return gone;
  }
  std::uint64_t Remove(std::int64_t row) {
    past_.Keep(Part::kObservations, row);
    remove_.Bind(1, row).Run();
    return static_cast<std::uint64_t>(sqlite3_changes(database_.handle()));
  }
  void Write(std::int64_t map, std::int64_t row, const Column<Observation>& observations) {
    const auto keypoint = [](std::int32_t index) {
      return index == Observation::kAbsent ? Value() : Value(std::int64_t{index});
    };
    std::int64_t position = 0;
    for (const Observation& observation : observations)
      insert_.Add(std::array<Value, 6>{row, position++, map, ValueOrNull(ToReference(observation.keyframe)),
                                       keypoint(observation.left), keypoint(observation.right)});
  }
  void Flush() { insert_.Flush(); }

 private:
  using Key = std::tuple<std::int64_t, std::int32_t, std::int32_t>;  // keyframe, left and right keypoint
  static Key KeyOf(const Observation& each) { return {ToColumn(each.keyframe), each.left, each.right}; }

  Database& database_;
  PastWriter& past_;
  Statement select_, remove_;
  BatchInsert insert_;
};

// Brings the R*Tree up to date with the points that changed. Points with a NaN coordinate are not in it.
void WriteBoxes(SaveContext& context, const ListPlan& plan, const Map& map, const std::vector<std::size_t>& changed) {
  Statement remove(context.database, "DELETE FROM map_point_box WHERE row = ?1", "table map_point_box");
  std::vector<PointBox> boxes;
  boxes.reserve(changed.size());
  for (const std::size_t i : changed) {
    if (!map.points[i].position.hasNaN()) {
      boxes.push_back({plan.entries[i].row, map.points[i].position});
    } else if (plan.entries[i].stored != nullptr) {
      remove.Bind(1, plan.entries[i].row).Run();
    }
  }
  UpdateBoxes(context.database, std::move(boxes));
}

void RemovePoints(SaveContext& context, ObservationWriter& observations, const std::vector<std::int64_t>& rows) {
  if (rows.empty()) return;
  Statement box(context.database, "DELETE FROM map_point_box WHERE row = ?1", "table map_point_box");
  Statement point(context.database, "DELETE FROM map_point WHERE row = ?1", "table map_point");
  CarriedWriter carried(context.database, CarriedKind::kPoint);
  TableChanges& deleted_observations = context.changes["observation"];
  for (const std::int64_t row : rows) {
    for (const Part part : {Part::kPoint, Part::kCarriedByPoint}) context.past.Keep(part, row);
    deleted_observations.deleted += observations.Remove(row);
    box.Bind(1, row).Run();
    point.Bind(1, row).Run();
    carried.Remove(row);
  }
  context.map.points_removed += rows.size();
  context.changes["map_point"].deleted += rows.size();
}

// Writes the rows of map_point that differ; returns the indices of those points.
std::vector<std::size_t> WritePoints(SaveContext& context, std::int64_t row, const ListPlan& plan, const Map& map,
                                     const AtlasHashes::OfMap& hashes) {
  PointWriter points(context);
  TableChanges& changes = context.changes["map_point"];
  std::vector<std::size_t> changed;
  for (std::size_t i = 0; i < plan.entries.size(); ++i) {
    const ListPlan::Entry& entry = plan.entries[i];
    const StoredRow* old = entry.stored;
    const bool same_row = rows::HasRow(entry, hashes.points[i]);
    const bool same = same_row && rows::HasDetails(entry, hashes.observations[i]);
    rows::Count(changes, same, old == nullptr);
    if (old == nullptr) ++context.map.points_added;
    if (old != nullptr && !same_row && points.Moves(entry.row, map.points[i])) ++context.map.points_moved;
    if (!same) points.Write(row, entry, map.points[i], hashes.points[i], hashes.observations[i]);
    if (!same_row) changed.push_back(i);
    if (i % kReportEvery == kReportEvery - 1) context.Report(kReportEvery / 2);
  }
  points.Flush();
  return changed;
}

}  // namespace

void SavePoints(SaveContext& context, std::int64_t row, const Map& map, const AtlasHashes::OfMap& hashes) {
  const std::vector<StoredRow> stored =
      ReadStoredRows(context.database, "map_point", "observations_hash", row, map.points.size());
  const ListPlan plan = rows::PlanOf(map.points, stored, row);
  TableChanges& changes = context.changes["observation"];
  const TableChanges before = changes;
  std::uint64_t stayed = 0;  // of points that have others besides
  ObservationWriter observations(context);
  RemovePoints(context, observations, plan.removed);
  WriteBoxes(context, plan, map, WritePoints(context, row, plan, map, hashes));

  for (std::size_t i = 0; i < plan.entries.size(); ++i) {
    const ListPlan::Entry& entry = plan.entries[i];
    if (rows::HasDetails(entry, hashes.observations[i])) {
      changes.unchanged += map.points[i].observations.size();
    } else {
      if (entry.stored != nullptr) {
        const std::uint64_t gone = observations.CountGone(entry.row, map.points[i].observations);
        const std::uint64_t were = observations.Remove(entry.row);
        stayed += were - gone;
        changes.deleted += were;
      }
      observations.Write(row, entry.row, map.points[i].observations);
      changes.inserted += map.points[i].observations.size();
    }
    if (i % kReportEvery == kReportEvery - 1) context.Report(kReportEvery / 2);
  }
  observations.Flush();
  context.map.observations_added += changes.inserted - before.inserted - stayed;
  context.map.observations_removed += changes.deleted - before.deleted - stayed;
  SaveOrder(context, row, "point", plan);
  context.Report(map.points.size() % kReportEvery);
}

}  // namespace slamdb::sqlite
