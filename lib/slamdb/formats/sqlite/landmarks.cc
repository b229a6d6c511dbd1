// SPDX-License-Identifier: BSD-3-Clause
// Saving and loading the landmarks of a map.
#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/rows/detail/landmark_row.h"
#include "slamdb/formats/sqlite/detail/list_order.h"
#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/formats/sqlite/detail/save.h"

namespace slamdb::sqlite {
namespace {

constexpr const char* kTable = "landmark";
// One row of the table.
class LandmarkWriter {
 public:
  explicit LandmarkWriter(Database& database)
      : insert_(database,
                "INSERT OR REPLACE INTO landmark VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, "
                "?15, ?16, ?17, ?18, ?19, ?20, ?21)",
                "table landmark") {}

  void Write(std::int64_t map, const ListPlan::Entry& entry, const Landmark& landmark, std::int64_t hash) {
    insert_.BindAll(row_.Of({entry.row, map, entry.unique, hash}, landmark)).Run();
  }

 private:
  Statement insert_;
  rows::LandmarkRow row_;
};

Landmark ReadLandmark(Database& database, const Statement& row) {
  const std::int64_t number = row.Integer(0);
  try {
    Landmark landmark;
    const bool same = rows::ReadLandmark(row, landmark, [&] { return DamagedRow(database, kTable, number); });
    RequireSame(database, kTable, number, landmark.id.value(), same);
    return landmark;
  } catch (const Error& error) {
    if (!error.path().empty()) throw;
    throw Error(error.kind(), database.path(), PlaceOf(kTable, number), error.problem());
  }
}

// The landmarks of some rows, one behind the other.
class LandmarkReader {
 public:
  explicit LandmarkReader(Database& database)
      : database_(database),
        select_(database,
                detail::Concat("SELECT ", rows::kLandmarkColumns,
                               " FROM landmark WHERE row BETWEEN ?1 AND ?2 ORDER BY row"),
                "table landmark") {}

  void Start(std::int64_t first, std::int64_t last) {
    select_.Reset();
    select_.Bind(1, first).Bind(2, last);
  }

  // The next one and its hash, which is compared with the stored one. False: there is no further one.
  bool Read(Landmark& landmark, std::int64_t& hash) {
    if (!select_.Step()) return false;
    landmark = ReadLandmark(database_, select_);
    hash = detail::HashOf(landmark);
    RequireSame(database_, kTable, row(), landmark.id.value(), hash == select_.Integer(2));
    return true;
  }
  std::int64_t row() const { return select_.Integer(0); }

 private:
  Database& database_;
  Statement select_;
};

}  // namespace

void SaveLandmarks(SaveContext& context, std::int64_t row, const Map& map, const AtlasHashes::OfMap& hashes) {
  const std::vector<StoredRow> stored = ReadStoredRows(context.database, kTable, "hash", row, map.landmarks.size());
  if (stored.empty() && map.landmarks.empty()) return;
  std::vector<std::int64_t> ids;
  ids.reserve(map.landmarks.size());
  for (const Landmark& landmark : map.landmarks) ids.push_back(ToColumn(landmark.id));
  const ListPlan plan = PlanList(ids, stored, FirstRowOfMap(row));
  Statement remove(context.database, "DELETE FROM landmark WHERE row = ?1", "table landmark");
  for (const std::int64_t removed : plan.removed) {
    context.past.Keep(Part::kLandmark, removed);
    remove.Bind(1, removed).Run();
  }
  TableChanges& changes = context.changes[kTable];
  changes.deleted += plan.removed.size();
  LandmarkWriter writer(context.database);
  for (std::size_t i = 0; i < plan.entries.size(); ++i) {
    const ListPlan::Entry& entry = plan.entries[i];
    const StoredRow* old = entry.stored;
    const bool same = old != nullptr && old->hash == hashes.landmarks[i] && old->unique == entry.unique;
    ++(same ? changes.unchanged : old != nullptr ? changes.updated : changes.inserted);
    if (same) continue;
    context.past.Keep(Part::kLandmark, entry.row);
    writer.Write(row, entry, map.landmarks[i], hashes.landmarks[i]);
  }
  SaveOrder(context, row, "landmark", plan);
}

void LoadLandmarks(Database& database, std::int64_t map, const Selection& selection, std::vector<Landmark>& landmarks,
                   std::vector<std::int64_t>& hashes) {
  LandmarkReader reader(database);
  reader.Start(FirstRowOfMap(map), LastRowOfMap(map));
  std::vector<std::int64_t> rows;
  Landmark landmark;
  for (std::int64_t hash = 0; reader.Read(landmark, hash);) {
    if (selection.box && !selection.box->contains(landmark.mean.cast<float>())) continue;
    landmarks.push_back(std::move(landmark));
    hashes.push_back(hash);
    rows.push_back(reader.row());
  }
  OrderOf(database, map, "landmark").Sort(rows, landmarks, hashes);
}

void LoadLandmarkRows(Database& database, std::span<const std::int64_t> rows, std::span<Landmark> landmarks) {
  LandmarkReader reader(database);
  ForEachRun(rows, [&](std::size_t first, std::size_t count) {
    reader.Start(rows[first], rows[first + count - 1]);
    std::int64_t hash = 0;
    for (std::size_t i = first; i < first + count; ++i)
      if (!reader.Read(landmarks[i], hash) || reader.row() != rows[i]) throw DamagedRow(database, kTable, rows[i]);
  });
}

}  // namespace slamdb::sqlite
