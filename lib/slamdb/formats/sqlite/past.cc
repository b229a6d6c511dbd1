// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/past.h"

#include <algorithm>
#include <unordered_set>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/formats/sqlite/detail/revisions.h"
#include "slamdb/formats/sqlite/detail/row_pack.h"

namespace slamdb::sqlite {
namespace {

constexpr std::array<PartRows, kParts> kRowsOf = {{
    {"atlas", "row = ?1"},
    {"camera", "atlas = ?1"},
    {"repeated_entry", "atlas = ?1"},
    {"map", "row = ?1"},
    {"map_origin", "map = ?1"},
    {"keyframe", "row = ?1"},
    {"keyframe_features", "keyframe = ?1"},
    {"keyframe_link", "keyframe = ?1"},
    {"map_point", "row = ?1"},
    {"observation", "point = ?1"},
    {"landmark", "row = ?1"},
    {"carried", "kind = 0 AND row = ?1"},
    {"carried", "kind = 1 AND row BETWEEN ?1 << 32 AND (?1 << 32) + 4294967295"},
    {"carried", "kind = 2 AND row = ?1"},
    {"carried", "kind = 3 AND row = ?1"},
    {"carried", "kind = 4 AND row = ?1"},
}};

std::size_t IndexOf(Part part) { return static_cast<std::size_t>(part); }

bool IsCarried(Part part) { return part >= Part::kCarriedByAtlas; }

// The parts of an entity beside the row that says that it is there.
constexpr Part kOfKeyframe[] = {Part::kFeatures, Part::kLinks, Part::kCarriedByKeyframe};
constexpr Part kOfPoint[] = {Part::kObservations, Part::kCarriedByPoint};

// Fills the database of a PastRows.
class Restorer {
 public:
  Restorer(Database& database, std::int64_t atlas, std::int64_t revision)
      : database_(database),
        atlas_(atlas),
        revision_(revision),
        past_{Database::Temporary(database.path()), {}, {}},
        reader_(database) {
    past_.rows.Execute("BEGIN");
    MakeTables(past_.rows);
  }

  PastRows Run() {
    TakeKept();
    for (const Part part :
         {Part::kAtlas, Part::kCameras, Part::kRepeated, Part::kCarriedByAtlas, Part::kCarriedByCameras})
      Complete(part, atlas_);
    for (const std::int64_t map : RowsOfMaps(database_, atlas_)) {
      Complete(Part::kMap, map);
      for (const std::int64_t row : RowsOfList(database_, "landmark", map)) Complete(Part::kLandmark, row);
    }
    Statement maps(past_.rows, "SELECT row FROM map ORDER BY row", "table past");
    while (maps.Step())
      for (const Part part : {Part::kOrigins, Part::kCarriedByMap}) Complete(part, maps.Integer(0));
    past_.keyframes = CompleteEntities(Part::kKeyframe, kOfKeyframe);
    past_.points = CompleteEntities(Part::kPoint, kOfPoint);
    CopyPictures();
    CompareHash();
    past_.rows.Execute("COMMIT");
    return std::move(past_);
  }

 private:
  // Of each part, what it was before the first save behind the revision that changed it.
  void TakeKept() {
    Statement kept(database_,
                   "SELECT part, row, until, rows FROM past WHERE atlas = ?1 AND until > ?2 ORDER BY until, part, row",
                   "table past");
    kept.Bind(1, atlas_).Bind(2, revision_);
    std::array<std::unordered_set<std::int64_t>, kParts> taken;
    while (kept.Step()) {
      const std::int64_t part = kept.Integer(0);
      if (part < 0 || part >= static_cast<std::int64_t>(kParts)) throw Damaged(kept.Integer(2), "an unknown part");
      if (!taken[static_cast<std::size_t>(part)].insert(kept.Integer(1)).second) continue;
      try {
        Insert(static_cast<Part>(part), kept.Blob(3));
      } catch (const Error& error) {
        throw Damaged(kept.Integer(2), error.problem());
      }
    }
    for (std::size_t i = 0; i < kParts; ++i) {
      kept_[i].assign(taken[i].begin(), taken[i].end());
      std::ranges::sort(kept_[i]);
    }
  }
  Error Damaged(std::int64_t until, const std::string& problem) {
    return Error(ErrorKind::kDamaged, database_.path(), detail::Concat("table past, revision ", until - 1),
                 problem + ": the store is damaged");
  }

  void Insert(Part part, Bytes rows) {
    std::optional<PackedRows>& packed = inserts_[IndexOf(part)];
    if (!packed) packed.emplace(past_.rows, RowsOf(part).table);
    packed->Insert(rows);
  }
  // What was not kept is as it is now.
  void Complete(Part part, std::int64_t row) {
    if (!std::ranges::binary_search(kept_[IndexOf(part)], row)) Insert(part, reader_.Read(part, row));
  }
  // The entities of which any part was kept, ascending.
  std::vector<std::int64_t> CompleteEntities(Part entity, std::span<const Part> parts) {
    std::vector<std::int64_t> touched = kept_[IndexOf(entity)];
    for (const Part part : parts)
      touched.insert(touched.end(), kept_[IndexOf(part)].begin(), kept_[IndexOf(part)].end());
    std::ranges::sort(touched);
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    for (const std::int64_t row : touched) {
      Complete(entity, row);
      if (IsThere(entity, row))
        for (const Part part : parts) Complete(part, row);
    }
    return touched;
  }
  bool IsThere(Part entity, std::int64_t row) {
    std::optional<Statement>& select = is_there_[entity == Part::kKeyframe ? 0 : 1];
    if (!select) select.emplace(past_.rows, detail::Concat("SELECT 1 FROM ", RowsOf(entity).table, " WHERE row = ?1"));
    const bool found = select->Bind(1, row).Step();
    select->Reset();
    return found;
  }
  // Rows of `past` that are gone leave another revision, which is sound in itself.
  void CompareHash() {
    const std::optional<std::int64_t> logged = HashOfRevision(database_, atlas_, revision_);
    if (logged && *logged != past_.rows.Integer("SELECT hash FROM atlas"))
      throw Error(ErrorKind::kDamaged, database_.path(), "table past",
                  "what is kept is not what the log says was saved: the store is damaged");
  }
  void CopyPictures() {
    Statement wanted(past_.rows, "SELECT DISTINCT picture FROM keyframe_features");
    Statement select(database_, "SELECT * FROM picture WHERE row = ?1", "table picture");
    PackedRows insert(past_.rows, "picture");
    detail::ByteWriter packed;
    while (wanted.Step()) {
      packed.Clear();
      PackRows(select.Bind(1, wanted.Integer(0)), packed);
      insert.Insert(packed.bytes());
    }
  }

  Database& database_;
  std::int64_t atlas_, revision_;
  PastRows past_;
  PartReader reader_;
  std::array<std::vector<std::int64_t>, kParts> kept_;  // rows, ascending
  std::array<std::optional<PackedRows>, kParts> inserts_;
  std::array<std::optional<Statement>, 2> is_there_;
};

}  // namespace

const PartRows& RowsOf(Part part) { return kRowsOf[IndexOf(part)]; }

Bytes PartReader::Read(Part part, std::int64_t row) {
  std::optional<Statement>& select = selects_[IndexOf(part)];
  const auto& [table, where] = RowsOf(part);
  if (!select)
    select.emplace(database_, detail::Concat("SELECT * FROM ", table, " WHERE ", where),
                   detail::Concat("table ", table));
  packed_.Clear();
  PackRows(select->Bind(1, row), packed_);
  return packed_.bytes();
}

PastWriter::PastWriter(Database& database, std::int64_t atlas, std::int64_t revision, bool carries)
    : database_(database),
      atlas_(atlas),
      revision_(revision),
      has_carried_(carries || database.Integer("SELECT EXISTS (SELECT 1 FROM carried)") != 0),
      reader_(database),
      insert_(database,
              "INSERT OR IGNORE INTO past VALUES (?1, ?2, ?3, ?4, CASE ?3 WHEN 6 THEN (SELECT picture FROM "
              "keyframe_features WHERE keyframe = ?4) END, ?5)",
              "table past") {
  static_assert(static_cast<int>(Part::kFeatures) == 6);
}

void PastWriter::Keep(Part part, std::int64_t row) {
  if (!keeps() || (IsCarried(part) && !has_carried_)) return;
  const Bytes rows = reader_.Read(part, row);
  insert_.Bind(1, atlas_).Bind(2, revision_).Bind(3, static_cast<std::int64_t>(part)).Bind(4, row);
  insert_.BindBlob(5, rows).Run();
}

void PastWriter::KeepMap(std::int64_t map) {
  if (!keeps()) return;
  for (const Part part : {Part::kMap, Part::kOrigins, Part::kCarriedByMap}) Keep(part, map);
  const auto keep_list = [&](Part entity, std::span<const Part> parts) {
    for (const std::int64_t row : RowsOfList(database_, RowsOf(entity).table, map)) {
      Keep(entity, row);
      for (const Part part : parts) Keep(part, row);
    }
  };
  keep_list(Part::kKeyframe, kOfKeyframe);
  keep_list(Part::kPoint, kOfPoint);
  keep_list(Part::kLandmark, {});
}

PastRows ReadPast(Database& database, std::int64_t atlas, std::int64_t revision) {
  return Restorer(database, atlas, revision).Run();
}

void IndexBoxes(Database& rows) {
  rows.Execute(
      "INSERT INTO map_point_box SELECT row, x, x, y, y, z, z FROM map_point "
      "WHERE x IS NOT NULL AND y IS NOT NULL AND z IS NOT NULL");
}

}  // namespace slamdb::sqlite
