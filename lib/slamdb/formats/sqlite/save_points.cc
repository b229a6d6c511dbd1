// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>

#include "slamdb/formats/sqlite/save.h"

namespace slamdb::sqlite {
namespace {

constexpr std::size_t kReportEvery = 4096;

// One row of the table map_point.
class PointWriter {
 public:
  explicit PointWriter(Database& database)
      : insert_(database,
                "INSERT OR REPLACE INTO map_point VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, "
                "?15, ?16, ?17, ?18, ?19, ?20, ?21, ?22, ?23)",
                "table map_point") {}

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
    insert_.Run();
  }

 private:
  Statement insert_;
};

// The rows of observation of one point.
class ObservationWriter {
 public:
  explicit ObservationWriter(Database& database)
      : database_(database),
        remove_(database, "DELETE FROM observation WHERE point = ?1", "table observation"),
        insert_(database, "INSERT INTO observation VALUES (?1, ?2, ?3, ?4, ?5, ?6)", "table observation") {}

  std::uint64_t Remove(std::int64_t row) {
    remove_.Bind(1, row).Run();
    return static_cast<std::uint64_t>(sqlite3_changes(database_.handle()));
  }
  std::uint64_t Write(std::int64_t map, std::int64_t row, const Column<Observation>& observations) {
    insert_.Bind(1, row).Bind(3, map);
    const auto keypoint = [](std::int32_t index) {
      return index == Observation::kAbsent ? std::nullopt : std::optional<std::int64_t>(index);
    };
    for (std::size_t i = 0; i < observations.size(); ++i) {
      const Observation& observation = observations[i];
      insert_.Bind(2, static_cast<std::int64_t>(i)).Bind(4, ToReference(observation.keyframe));
      insert_.Bind(5, keypoint(observation.left)).Bind(6, keypoint(observation.right)).Run();
    }
    return observations.size();
  }

 private:
  Database& database_;
  Statement remove_, insert_;
};

// Every third bit of the result is a bit of `value`'s lowest 21.
std::uint64_t Spread(std::uint64_t value) {
  value &= 0x1fffff;
  value = (value | value << 32) & 0x1f00000000ffff;
  value = (value | value << 16) & 0x1f0000ff0000ff;
  value = (value | value << 8) & 0x100f00f00f00f00f;
  value = (value | value << 4) & 0x10c30c30c30c30c3;
  return (value | value << 2) & 0x1249249249249249;
}

// Enters the positions of points into the R*Tree in Morton order, so that neighbours come after each other and the tree
// is built of tight nodes with few splits far apart.
void WriteBoxes(SaveContext& context, const ListPlan& plan, const Map& map, const std::vector<std::size_t>& changed) {
  struct Item {
    std::uint64_t code;
    std::size_t index;
  };
  Eigen::AlignedBox3f box;
  for (const std::size_t i : changed) {
    if (map.points[i].position.allFinite()) box.extend(map.points[i].position);
  }
  const Eigen::Vector3f scale = 2097151.0F * box.sizes().cwiseMax(1e-30F).cwiseInverse();
  std::vector<Item> items;
  items.reserve(changed.size());
  Statement remove(context.database, "DELETE FROM map_point_box WHERE row = ?1", "table map_point_box");
  for (const std::size_t i : changed) {
    const Eigen::Vector3f& position = map.points[i].position;
    if (position.hasNaN()) {
      if (plan.entries[i].stored != nullptr) remove.Bind(1, plan.entries[i].row).Run();
      continue;
    }
    std::uint64_t code = 0;
    if (position.allFinite()) {
      const Eigen::Vector3f cell = (position - box.min()).cwiseProduct(scale).cwiseMax(0.0F).cwiseMin(2097151.0F);
      code = Spread(static_cast<std::uint64_t>(cell.x())) | Spread(static_cast<std::uint64_t>(cell.y())) << 1 |
             Spread(static_cast<std::uint64_t>(cell.z())) << 2;
    }
    items.push_back({code, i});
  }
  std::sort(items.begin(), items.end(),
            [](const Item& a, const Item& b) { return a.code != b.code ? a.code < b.code : a.index < b.index; });
  Statement insert(context.database, "INSERT OR REPLACE INTO map_point_box VALUES (?1, ?2, ?2, ?3, ?3, ?4, ?4)",
                   "table map_point_box");
  for (const Item& item : items) {
    const Eigen::Vector3f& position = map.points[item.index].position;
    insert.Bind(1, plan.entries[item.index].row).BindReal(2, position.x()).BindReal(3, position.y());
    insert.BindReal(4, position.z()).Run();
  }
}

void RemovePoints(SaveContext& context, ObservationWriter& observations, const std::vector<std::int64_t>& rows) {
  if (rows.empty()) return;
  Statement box(context.database, "DELETE FROM map_point_box WHERE row = ?1", "table map_point_box");
  Statement point(context.database, "DELETE FROM map_point WHERE row = ?1", "table map_point");
  TableChanges& deleted_observations = context.changes["observation"];
  for (const std::int64_t row : rows) {
    deleted_observations.deleted += observations.Remove(row);
    box.Bind(1, row).Run();
    point.Bind(1, row).Run();
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
  const std::vector<StoredRow> stored = ReadStoredRows(context.database, "map_point", "observations_hash", row);
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
      changes.inserted += observations.Write(row, entry.row, map.points[i].observations);
    }
    if (i % kReportEvery == kReportEvery - 1) context.Report(kReportEvery / 2);
  }
  context.Report(map.points.size() % kReportEvery);
}

}  // namespace slamdb::sqlite
