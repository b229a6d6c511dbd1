// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>

#include "slamdb/formats/sqlite/detail/box_tree.h"
#include "slamdb/formats/sqlite/detail/carried.h"
#include "slamdb/formats/sqlite/detail/save.h"

namespace slamdb::sqlite {
namespace {

constexpr std::size_t kReportEvery = 4096;

// One row of the table map_point.
class PointWriter {
 public:
  explicit PointWriter(Database& database)
      : insert_(database,
                "INSERT OR REPLACE INTO map_point VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, "
                "?15, ?16, ?17, ?18, ?19, ?20, ?21, ?22, ?23, ?24, ?25, ?26)",
                "table map_point"),
        carried_(database, CarriedKind::kPoint) {}

  void Write(std::int64_t map, const ListPlan::Entry& entry, const MapPoint& point, std::int64_t hash,
             std::int64_t observations_hash) {
    insert_.Bind(1, entry.row).Bind(2, map).Bind(3, ToColumn(point.id));
    insert_.Bind(4, entry.unique ? ToReference(point.id) : std::nullopt).Bind(5, hash).Bind(6, observations_hash);
    const std::array<float, 8> reals{point.position.x(), point.position.y(), point.position.z(), point.normal.x(),
                                     point.normal.y(),   point.normal.z(),   point.min_distance, point.max_distance};
    bool fits = true;
    for (std::size_t i = 0; i < reals.size(); ++i) {
      fits = fits && FitsReal(reals[i]);
      insert_.BindReal(7 + static_cast<int>(i), reals[i]);
    }
    insert_.Bind(15, ToReference(point.reference)).Bind(16, ToReference(point.replaced_by));
    insert_.Bind(17, point.first_keyframe).Bind(18, point.first_frame).Bind(19, std::int64_t{point.observation_count});
    insert_.Bind(20, std::int64_t{point.bad.recorded}).BindBlob(21, std::as_bytes(std::span(point.descriptor)));
    insert_.Bind(22, std::int64_t{static_cast<std::uint8_t>(point.descriptor_form)});
    if (fits) {
      insert_.BindNull(23);
    } else {
      insert_.BindBlob(23, std::as_bytes(std::span(reals)));
    }
    BindRecorded(24, point.origin_map, MapPoint::kNoOrigin);
    BindRecorded(25, point.visible_count, MapPoint::kNoCount);
    BindRecorded(26, point.found_count, MapPoint::kNoCount);
    insert_.Run();
    if (entry.stored != nullptr) carried_.Remove(entry.row);
    carried_.Write(entry.row, point.carried);
  }

 private:
  template <class Integer>
  void BindRecorded(int column, Integer value, Integer not_recorded) {
    insert_.Bind(column, value == not_recorded ? std::nullopt : std::optional<std::int64_t>(value));
  }

  Statement insert_;
  CarriedWriter carried_;
};

// The rows of observation. They are many and small, so they go in by the batch: a statement of several rows costs
// little more than one of a single row. Flush() after the last.
class ObservationWriter {
 public:
  explicit ObservationWriter(Database& database)
      : database_(database),
        remove_(database, "DELETE FROM observation WHERE point = ?1", "table observation"),
        insert_(database, InsertOf(1), "table observation"),
        insert_batch_(database, InsertOf(kBatch), "table observation") {}

  std::uint64_t Remove(std::int64_t row) {
    remove_.Bind(1, row).Run();
    return static_cast<std::uint64_t>(sqlite3_changes(database_.handle()));
  }
  void Write(std::int64_t map, std::int64_t row, const Column<Observation>& observations) {
    const auto keypoint = [](std::int32_t index) {
      return index == Observation::kAbsent ? std::nullopt : std::optional<std::int64_t>(index);
    };
    for (std::size_t i = 0; i < observations.size(); ++i) {
      const Observation& observation = observations[i];
      rows_.push_back({row, static_cast<std::int64_t>(i), map, ToReference(observation.keyframe),
                       keypoint(observation.left), keypoint(observation.right)});
      if (rows_.size() == kBatch) {
        for (std::size_t k = 0; k < kBatch; ++k) BindRow(insert_batch_, static_cast<int>(k), rows_[k]);
        insert_batch_.Run();
        rows_.clear();
      }
    }
  }
  void Flush() {
    for (const Row& row : rows_) {
      BindRow(insert_, 0, row);
      insert_.Run();
    }
    rows_.clear();
  }

 private:
  static constexpr std::size_t kBatch = 64;
  using Row = std::array<std::optional<std::int64_t>, 6>;

  static std::string InsertOf(std::size_t rows) {
    std::string sql = "INSERT INTO observation VALUES (?, ?, ?, ?, ?, ?)";
    for (std::size_t i = 1; i < rows; ++i) sql += ", (?, ?, ?, ?, ?, ?)";
    return sql;
  }
  static void BindRow(Statement& statement, int index, const Row& row) {
    for (int i = 0; i < 6; ++i) statement.Bind(6 * index + i + 1, row[static_cast<std::size_t>(i)]);
  }

  Database& database_;
  Statement remove_, insert_, insert_batch_;
  std::vector<Row> rows_;
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
    deleted_observations.deleted += observations.Remove(row);
    box.Bind(1, row).Run();
    point.Bind(1, row).Run();
    carried.Remove(row);
  }
  context.changes["map_point"].deleted += rows.size();
}

// Writes the rows of map_point that differ; returns the indices of those points.
std::vector<std::size_t> WritePoints(SaveContext& context, std::int64_t row, const ListPlan& plan, const Map& map,
                                     const AtlasHashes::OfMap& hashes) {
  PointWriter points(context.database);
  TableChanges& changes = context.changes["map_point"];
  std::vector<std::size_t> changed;
  for (std::size_t i = 0; i < plan.entries.size(); ++i) {
    const ListPlan::Entry& entry = plan.entries[i];
    const StoredRow* old = entry.stored;
    const bool same_row = old != nullptr && old->hash == hashes.points[i] && old->unique == entry.unique;
    const bool same = same_row && old->details == hashes.observations[i];
    ++(same ? changes.unchanged : old != nullptr ? changes.updated : changes.inserted);
    if (!same) points.Write(row, entry, map.points[i], hashes.points[i], hashes.observations[i]);
    if (!same_row) changed.push_back(i);
    if (i % kReportEvery == kReportEvery - 1) context.Report(kReportEvery / 2);
  }
  return changed;
}

}  // namespace

void SavePoints(SaveContext& context, std::int64_t row, const Map& map, const AtlasHashes::OfMap& hashes) {
  const std::vector<StoredRow> stored =
      ReadStoredRows(context.database, "map_point", "observations_hash", row, map.points.size());
  std::vector<std::int64_t> ids;
  ids.reserve(map.points.size());
  for (const MapPoint& point : map.points) ids.push_back(ToColumn(point.id));
  const ListPlan plan = PlanList(ids, stored, FirstRowOfMap(row));
  ObservationWriter observations(context.database);
  RemovePoints(context, observations, plan.removed);
  WriteBoxes(context, plan, map, WritePoints(context, row, plan, map, hashes));

  TableChanges& changes = context.changes["observation"];
  for (std::size_t i = 0; i < plan.entries.size(); ++i) {
    const ListPlan::Entry& entry = plan.entries[i];
    if (entry.stored != nullptr && entry.stored->details == hashes.observations[i]) {
      changes.unchanged += map.points[i].observations.size();
    } else {
      if (entry.stored != nullptr) changes.deleted += observations.Remove(entry.row);
      observations.Write(row, entry.row, map.points[i].observations);
      changes.inserted += map.points[i].observations.size();
    }
    if (i % kReportEvery == kReportEvery - 1) context.Report(kReportEvery / 2);
  }
  observations.Flush();
  context.Report(map.points.size() % kReportEvery);
}

}  // namespace slamdb::sqlite
