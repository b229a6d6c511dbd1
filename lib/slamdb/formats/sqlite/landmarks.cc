// SPDX-License-Identifier: BSD-3-Clause
// Saving and loading the landmarks of a map.
#include <array>
#include <cstring>

#include "slamdb/formats/sqlite/detail/list_order.h"
#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/formats/sqlite/detail/save.h"
#include "slamdb/model/detail/record.h"

namespace slamdb::sqlite {
namespace {

constexpr const char* kTable = "landmark";
using Reals = std::array<double, 12>;

Reals RealsOf(const Landmark& landmark) {
  const Eigen::Vector3d &mean = landmark.mean, &normal = landmark.normal;
  return {mean.x(),        mean.y(),        mean.z(),        normal.x(),      normal.y(),      normal.z(),
          landmark.cov_11, landmark.cov_22, landmark.cov_33, landmark.cov_12, landmark.cov_13, landmark.cov_23};
}

void SetReals(const Reals& reals, Landmark& landmark) {
  landmark.mean = {reals[0], reals[1], reals[2]};
  landmark.normal = {reals[3], reals[4], reals[5]};
  std::size_t next = 6;
  for (double* value :
       {&landmark.cov_11, &landmark.cov_22, &landmark.cov_33, &landmark.cov_12, &landmark.cov_13, &landmark.cov_23})
    *value = reals[next++];
}

// One row of the table.
class LandmarkWriter {
 public:
  explicit LandmarkWriter(Database& database)
      : insert_(database,
                "INSERT OR REPLACE INTO landmark VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, "
                "?15, ?16, ?17, ?18, ?19, ?20, ?21)",
                "table landmark") {}

  void Write(std::int64_t map, const ListPlan::Entry& entry, const Landmark& landmark, std::int64_t hash) {
    insert_.Bind(1, entry.row).Bind(2, map).Bind(3, ToColumn(landmark.id));
    insert_.Bind(4, entry.unique ? ToReference(landmark.id) : std::nullopt).Bind(5, hash);
    const Reals reals = RealsOf(landmark);
    bool fits = true;
    for (std::size_t i = 0; i < reals.size(); ++i) {
      fits = fits && FitsReal(reals[i]);
      insert_.BindReal(6 + static_cast<int>(i), reals[i]);
    }
    features_.Clear();
    detail::EncodeLandmarkFeatures(landmark.features, features_);
    insert_.Bind(18, ToColumn(landmark.last_seen)).Bind(19, std::int64_t{landmark.seen_count});
    insert_.BindBlob(20, features_.bytes());
    if (fits) {
      insert_.BindNull(21);
    } else {
      insert_.BindBlob(21, std::as_bytes(std::span(reals)));
    }
    insert_.Run();
  }

 private:
  Statement insert_;
  detail::ByteWriter features_;
};

void ReadReals(Database& database, const Statement& row, Landmark& landmark) {
  Reals reals;
  const Bytes exact = row.Blob(17);
  if (exact.empty()) {
    for (std::size_t i = 0; i < reals.size(); ++i) reals[i] = row.Real(3 + static_cast<int>(i));
  } else {
    if (exact.size() != sizeof(reals)) throw DamagedRow(database, kTable, row.Integer(0));
    std::memcpy(reals.data(), exact.data(), sizeof(reals));
    RequireSame(database, kTable, row.Integer(0), landmark.id.value(), TakeColumns(row, 3, reals));
  }
  SetReals(reals, landmark);
}

Landmark ReadLandmark(Database& database, const Statement& row) {
  Landmark landmark;
  landmark.id = LandmarkId(static_cast<std::uint64_t>(row.Integer(1)));
  ReadReals(database, row, landmark);
  landmark.last_seen = static_cast<std::uint64_t>(row.Integer(15));
  landmark.seen_count = static_cast<std::uint32_t>(row.Integer(16));
  try {
    landmark.features = detail::DecodeLandmarkFeatures(row.Blob(18));
  } catch (const Error& error) {
    throw Error(error.kind(), database.path(), PlaceOf(kTable, row.Integer(0)), error.problem());
  }
  return landmark;
}

// The landmarks of some rows, one behind the other.
class LandmarkReader {
 public:
  explicit LandmarkReader(Database& database)
      : database_(database),
        select_(database,
                "SELECT row, id, hash, x, y, z, nx, ny, nz, cov_11, cov_22, cov_33, cov_12, cov_13, cov_23, "
                "last_seen, seen_count, exact, features FROM landmark WHERE row BETWEEN ?1 AND ?2 ORDER BY row",
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
  ListOrder::Of(database, map, "landmark").Sort(rows, landmarks, hashes);
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
