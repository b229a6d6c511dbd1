// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/save.h"

#include <algorithm>
#include <iterator>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/rows/detail/map_rows.h"
#include "slamdb/formats/rows/detail/match_maps.h"
#include "slamdb/formats/rows/detail/revision_names.h"
#include "slamdb/formats/rows/detail/row_changes.h"
#include "slamdb/formats/sqlite/detail/carried.h"
#include "slamdb/formats/sqlite/detail/list_order.h"
#include "slamdb/formats/sqlite/detail/pictures.h"
#include "slamdb/formats/sqlite/detail/place_words.h"
#include "slamdb/formats/sqlite/detail/summary.h"
#include "slamdb/formats/sqlite/detail/visit_rows.h"
#include "slamdb/formats/sqlite/detail/writer_lock.h"

namespace slamdb::sqlite {
namespace {

using rows::KeyframeKey;
using rows::StoredMap;
using rows::Value;

struct StoredHead {
  std::int64_t row = 0, revision = 0, hash = 0;
};

std::optional<StoredHead> AtlasNamed(Database& database, const std::string& name) {
  Statement statement(database, "SELECT row, revision, hash FROM atlas WHERE name = ?1", "table atlas");
  if (!statement.BindText(1, name).Step()) return std::nullopt;
  return StoredHead{statement.Integer(0), statement.Integer(1), statement.Integer(2)};
}

// Writes the row of the atlas.
std::int64_t SaveHeader(SaveContext& context, const std::string& name, const Atlas& atlas, const AtlasSummary& summary,
                        const SaveReport& report, const std::optional<StoredHead>& stored) {
  Statement statement(
      context.database,
      detail::Concat(
          "INSERT INTO atlas (row, name, ", rows::kHeaderColumns,
          ", revision, saved_at, maps, keyframes, points, observations, hash) VALUES (?1, ?2, ?3, ?4, ?5, "
          "?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?22, ?16, ?17, ?18, ?19, ?20, ?21) ON CONFLICT (row) "
          "DO UPDATE SET (",
          rows::kHeaderColumns,
          ") = (?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15), revision = ?22, "
          "saved_at = ?16, maps = ?17, keyframes = ?18, points = ?19, observations = ?20, hash = ?21 "
          "RETURNING row"),
      "table atlas");
  std::vector<Value> columns{stored ? Value(stored->row) : Value(), std::string_view(name)};
  std::ranges::copy(rows::HeaderRow(atlas), std::back_inserter(columns));
  columns.emplace_back(std::string_view(context.at));
  for (const std::uint64_t count : {summary.maps, summary.keyframes, summary.points, summary.observations})
    columns.emplace_back(ToColumn(count));
  columns.emplace_back(ToColumn(report.hash));
  columns.emplace_back(ToColumn(report.revision));
  statement.BindAll(columns);
  statement.Step();
  const std::int64_t row = statement.Integer(0);
  while (statement.Step()) {
  }
  ++(stored ? context.changes["atlas"].updated : context.changes["atlas"].inserted);
  return row;
}

// Cameras are few: all or nothing.
void SaveCameras(SaveContext& context, const Atlas& atlas) {
  context.past.Keep(Part::kCameras, context.atlas);
  Statement remove(context.database, "DELETE FROM camera WHERE atlas = ?1", "table camera");
  remove.Bind(1, context.atlas).Run();
  context.changes["camera"].deleted += static_cast<std::uint64_t>(sqlite3_changes(context.database.handle()));
  Statement insert(context.database, "INSERT INTO camera VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)", "table camera");
  const rows::CameraRows cameras(context.atlas, atlas.cameras);
  for (const auto& row : cameras.rows()) insert.BindAll(row).Run();
  context.changes["camera"].inserted += atlas.cameras.size();
}

void SaveRepeated(SaveContext& context, const char* list, std::int64_t map, const std::vector<RepeatedEntry>& entries) {
  Statement insert(context.database, "INSERT INTO repeated_entry VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)",
                   "table repeated_entry");
  for (std::size_t i = 0; i < entries.size(); ++i) {
    insert.BindAll(rows::RepeatedRow(context.atlas, list, map, i, entries[i])).Run();
    ++context.changes["repeated_entry"].inserted;
  }
}

void SaveAllRepeated(SaveContext& context, const Atlas& atlas, const std::vector<std::int64_t>& map_rows) {
  context.past.Keep(Part::kRepeated, context.atlas);
  Statement remove(context.database, "DELETE FROM repeated_entry WHERE atlas = ?1", "table repeated_entry");
  remove.Bind(1, context.atlas).Run();
  const auto deleted = static_cast<std::uint64_t>(sqlite3_changes(context.database.handle()));
  if (deleted > 0) context.changes["repeated_entry"].deleted += deleted;
  SaveRepeated(context, "maps", 0, atlas.repeated_maps);
  SaveRepeated(context, "cameras", 0, atlas.repeated_cameras);
  for (std::size_t i = 0; i < atlas.maps.size(); ++i) {
    SaveRepeated(context, "keyframes", map_rows[i], atlas.maps[i].repeated_keyframes);
    SaveRepeated(context, "points", map_rows[i], atlas.maps[i].repeated_points);
  }
}

void SaveOrigins(SaveContext& context, std::int64_t row, const Map& map) {
  Statement remove(context.database, "DELETE FROM map_origin WHERE map = ?1", "table map_origin");
  remove.Bind(1, row).Run();
  const auto deleted = static_cast<std::uint64_t>(sqlite3_changes(context.database.handle()));
  Statement insert(context.database, "INSERT INTO map_origin VALUES (?1, ?2, ?3)", "table map_origin");
  for (std::size_t i = 0; i < map.origins.size(); ++i) {
    insert.Bind(1, row).Bind(2, static_cast<std::int64_t>(i)).Bind(3, ToReference(map.origins[i])).Run();
  }
  if (deleted + map.origins.size() == 0) return;
  context.changes["map_origin"].deleted += deleted;
  context.changes["map_origin"].inserted += map.origins.size();
}

// All or nothing: nearly always there is nothing.
void SaveCarried(SaveContext& context, const Atlas& atlas) {
  context.past.Keep(Part::kCarriedByAtlas, context.atlas);
  context.past.Keep(Part::kCarriedByCameras, context.atlas);
  const auto replace = [&](CarriedKind kind, std::int64_t first, std::int64_t last, const auto& write) {
    DeleteCarried(context.database, kind, first, last);
    CarriedWriter writer(context.database, kind);
    write(writer);
  };
  replace(CarriedKind::kAtlas, context.atlas, context.atlas,
          [&](CarriedWriter& writer) { writer.Write(context.atlas, atlas.carried); });
  const std::int64_t first = CarriedCameraRow(context.atlas, 0);
  replace(CarriedKind::kCamera, first, first | 0xffffffff, [&](CarriedWriter& writer) {
    for (std::size_t i = 0; i < atlas.cameras.size(); ++i)
      writer.Write(CarriedCameraRow(context.atlas, i), atlas.cameras[i].carried);
  });
}

std::vector<StoredMap> ReadStoredMaps(Database& database, std::int64_t atlas) {
  Statement statement(database, "SELECT row, id, position, hash FROM map WHERE atlas = ?1 ORDER BY position",
                      "table map");
  statement.Bind(1, atlas);
  std::vector<StoredMap> maps;
  while (statement.Step()) {
    maps.push_back({statement.Integer(0), statement.Integer(1), statement.Integer(2), statement.Integer(3), {}, false});
  }
  return maps;
}

void WriteMapRow(SaveContext& context, std::int64_t row, std::size_t position, const Map& map, std::int64_t hash) {
  Statement insert(context.database,
                   "INSERT OR REPLACE INTO map VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, "
                   "NULL, NULL, NULL)",
                   "table map");
  insert.BindAll(rows::MapRow(row, context.atlas, position, map, hash)).Run();
}

// Deletes the rows of one list of a map, and what hangs on them.
void DeleteRange(Database& database, const char* table, const char* key, std::int64_t map, ChangeCounter& changes) {
  Statement remove(database, std::string("DELETE FROM ") + table + " WHERE " + key + " BETWEEN ?1 AND ?2",
                   std::string("table ") + table);
  remove.Bind(1, FirstRowOfMap(map)).Bind(2, LastRowOfMap(map)).Run();
  changes[table].deleted += static_cast<std::uint64_t>(sqlite3_changes(database.handle()));
}

void DeleteMap(Database& database, std::int64_t map, ChangeCounter& changes) {
  DeleteCarried(database, CarriedKind::kMap, map, map);
  DeleteCarried(database, CarriedKind::kKeyframe, FirstRowOfMap(map), LastRowOfMap(map));
  DeleteCarried(database, CarriedKind::kPoint, FirstRowOfMap(map), LastRowOfMap(map));
  DeleteRange(database, "observation", "point", map, changes);
  DeleteRange(database, "map_point_box", "row", map, changes);
  DeleteRange(database, "map_point", "row", map, changes);
  DeleteRange(database, "landmark", "row", map, changes);
  DeleteRange(database, "keyframe_link", "keyframe", map, changes);
  DeleteRange(database, "keyframe_features", "keyframe", map, changes);
  DeleteRange(database, "keyframe_words", "keyframe", map, changes);
  DeleteRange(database, "keyframe", "row", map, changes);
  Statement origins(database, "DELETE FROM map_origin WHERE map = ?1", "table map_origin");
  origins.Bind(1, map).Run();
  Statement remove(database, "DELETE FROM map WHERE row = ?1", "table map");
  remove.Bind(1, map).Run();
  ++changes["map"].deleted;
}

void RemoveMap(SaveContext& context, std::int64_t map) {
  const auto deleted = [&](const char* table) { return context.changes[table].deleted; };
  const std::uint64_t keyframes = deleted("keyframe"), points = deleted("map_point"), seen = deleted("observation");
  context.past.KeepMap(map);
  DeleteMap(context.database, map, context.changes);
  context.map.keyframes_removed += deleted("keyframe") - keyframes;
  context.map.points_removed += deleted("map_point") - points;
  context.map.observations_removed += deleted("observation") - seen;
}

std::vector<KeyframeKey> StoredKeys(Database& database, std::int64_t map) {
  Statement statement(database, "SELECT id, timestamp FROM keyframe WHERE row BETWEEN ?1 AND ?2", "table keyframe");
  statement.Bind(1, FirstRowOfMap(map)).Bind(2, LastRowOfMap(map));
  std::vector<KeyframeKey> keys;
  while (statement.Step())
    if (!statement.IsNull(1)) keys.push_back({statement.Integer(0), statement.Real(1)});
  return keys;
}

// Rows of maps are never used again, in what is kept of earlier revisions either, and must leave room for 2^32 places.
std::int64_t NextRowOfMap(Database& database) {
  return std::max(database.Integer("SELECT max(row) FROM map"),
                  database.Integer("SELECT max(row) FROM past INDEXED BY past_maps WHERE part = 3")) +
         1;
}

// Deletes stored maps that are in the atlas no more, and writes the rows of maps that differ. Returns the rows.
std::vector<std::int64_t> SaveMapRows(SaveContext& context, const Atlas& atlas, const AtlasHashes& hashes) {
  std::vector<StoredMap> stored = ReadStoredMaps(context.database, context.atlas);
  for (StoredMap& map : stored) map.keys = StoredKeys(context.database, map.row);
  const std::vector<const StoredMap*> match = rows::MatchMaps(atlas, stored);
  std::int64_t next_row = NextRowOfMap(context.database);
  for (const StoredMap& map : stored)
    if (!map.used) RemoveMap(context, map.row);
  std::vector<std::int64_t> rows;
  for (std::size_t i = 0; i < atlas.maps.size(); ++i) {
    const std::int64_t row = match[i] != nullptr ? match[i]->row : next_row++;
    if (row < 1 || row > 0x7fffffff)
      throw Error(ErrorKind::kNotPossible, context.database.path(), "table map", "no more row numbers");
    rows.push_back(row);
    const bool same = match[i] != nullptr && rows::HasMap(*match[i], hashes.maps[i].header, i);
    rows::Count(context.changes["map"], same, match[i] == nullptr);
    if (same) continue;
    for (const Part part : {Part::kMap, Part::kOrigins, Part::kCarriedByMap}) context.past.Keep(part, row);
    WriteMapRow(context, row, i, atlas.maps[i], hashes.maps[i].header);
    SaveOrigins(context, row, atlas.maps[i]);
    DeleteCarried(context.database, CarriedKind::kMap, row, row);
    CarriedWriter(context.database, CarriedKind::kMap).Write(row, atlas.maps[i].carried);
  }
  return rows;
}

void CountAllUnchanged(const Atlas& atlas, ChangeCounter& changes) {
  rows::CountUnchanged(atlas, changes);
  std::uint64_t links = 0, observations = 0;
  for (const Map& map : atlas.maps) {
    for (const KeyFrame& keyframe : map.keyframes) links += CountLinks(keyframe);
    for (const MapPoint& point : map.points) observations += point.observations.size();
  }
  changes["keyframe_link"].unchanged += links;
  changes["observation"].unchanged += observations;
}

// They are in no hash: what somebody deleted comes back with every save.
void SaveWordsAlone(SaveContext& context, const Atlas& atlas, const AtlasHashes& hashes) {
  const std::vector<StoredMap> maps = ReadStoredMaps(context.database, context.atlas);
  for (std::size_t i = 0; i < std::min(maps.size(), atlas.maps.size()); ++i) {
    if (HasAllPlaceWords(context.database, maps[i].row, hashes.maps[i].features)) continue;
    const std::vector<std::int64_t> rows = RowsInOrder(context.database, maps[i].row, "keyframe", "keyframe");
    if (rows.size() == atlas.maps[i].keyframes.size())
      SavePlaceWords(context, maps[i].row, atlas.maps[i], rows, hashes.maps[i].features);
  }
}

// An atlas that is there as it is makes no revision: the log alone tells of the save.
void SaveUnchanged(SaveContext& context, const Atlas& atlas, const AtlasHashes& hashes) {
  CountAllUnchanged(atlas, context.changes);
  SaveWordsAlone(context, atlas, hashes);
}

void SaveContent(SaveContext& context, const Atlas& atlas, const AtlasHashes& hashes) {
  const std::vector<std::int64_t> rows = SaveMapRows(context, atlas, hashes);
  SaveCameras(context, atlas);
  SaveCarried(context, atlas);
  SaveAllRepeated(context, atlas, rows);
  for (std::size_t i = 0; i < atlas.maps.size(); ++i) {
    const std::vector<std::int64_t> keyframes = SaveKeyframes(context, rows[i], atlas.maps[i], hashes.maps[i]);
    SavePlaceWords(context, rows[i], atlas.maps[i], keyframes, hashes.maps[i].features);
    SavePoints(context, rows[i], atlas.maps[i], hashes.maps[i]);
    SaveLandmarks(context, rows[i], atlas.maps[i], hashes.maps[i]);
  }
}

// Whether an atlas has anything of a fork's file.
bool Carries(const Atlas& atlas) {
  return !atlas.layout.empty() || atlas.carried ||
         std::ranges::any_of(atlas.cameras, [](const Camera& camera) { return bool{camera.carried}; }) ||
         std::ranges::any_of(atlas.maps, [](const Map& map) {
           return map.carried ||
                  std::ranges::any_of(map.keyframes, [](const KeyFrame& keyframe) { return bool{keyframe.carried}; }) ||
                  std::ranges::any_of(map.points, [](const MapPoint& point) { return bool{point.carried}; });
         });
}

}  // namespace

void SaveContext::Report(std::size_t done) {
  entities_done += done;
  if (options.progress && entities > 0) {
    options.progress("saving", static_cast<double>(entities_done) / static_cast<double>(entities));
  }
}

std::vector<StoredRow> ReadStoredRows(Database& database, const std::string& table, const std::string& details_hash,
                                      std::int64_t map, std::size_t expected) {
  Statement statement(database,
                      detail::Concat("SELECT slamdb_visit(?1, row, id, unique_id IS NOT NULL, hash, ", details_hash,
                                     ") FROM ", table, " NOT INDEXED WHERE row BETWEEN ?2 AND ?3"),
                      "table " + table);
  statement.Bind(2, FirstRowOfMap(map)).Bind(3, LastRowOfMap(map));
  std::vector<StoredRow> rows;
  rows.reserve(expected);
  VisitRows(statement, [&rows](const Row& row) {
    rows.push_back({row.Integer(0), row.Integer(1), row.Integer(2) != 0, row.Integer(3), row.Integer(4)});
  });
  return rows;
}

void SaveOrder(SaveContext& context, std::int64_t map, std::string_view list, const ListPlan& plan) {
  std::vector<std::int64_t> rows;
  rows.reserve(plan.entries.size());
  for (const ListPlan::Entry& entry : plan.entries) rows.push_back(entry.row);
  const std::string order = ListOrder::Encode(rows);
  const Bytes bytes = std::as_bytes(std::span(order));
  Statement select(context.database, detail::Concat("SELECT ", list, "_order FROM map WHERE row = ?1"), "table map");
  select.Bind(1, map).Step();
  if (std::ranges::equal(select.Blob(0), bytes)) return;
  context.past.Keep(Part::kMap, map);
  Statement update(context.database, detail::Concat("UPDATE map SET ", list, "_order = ?2 WHERE row = ?1"),
                   "table map");
  update.Bind(1, map);
  order.empty() ? update.BindNull(2) : update.BindBlob(2, bytes);
  update.Run();
}

namespace {

// Whether it was made of another atlas, which no revision tells of yet: that makes a revision, though the atlas stays
// as it is, so that what went on from there counts as merged.
bool HasNewSource(Database& database, std::int64_t atlas, const std::string& name, const SaveOptions& options) {
  if (!options.from || options.from->atlas == name) return false;
  Statement known(database, "SELECT 1 FROM revision WHERE atlas = ?1 AND from_atlas = ?2 AND from_number = ?3",
                  "table revision");
  return !known.Bind(1, atlas).BindText(2, options.from->atlas).Bind(3, ToColumn(options.from->number)).Step();
}

}  // namespace

void SaveAtlas(Database& database, const std::string& name, const Atlas& atlas, const AtlasHashes& hashes,
               const std::string& at, const SaveOptions& options, Rewrite rewrite, SaveReport& report) {
  ChangeCounter changes;
  const std::optional<StoredHead> stored = AtlasNamed(database, name);
  report.hash = static_cast<std::uint64_t>(hashes.Combined());
  report.replaced = stored.has_value();
  report.revision =
      static_cast<std::uint64_t>(rows::NextNumber(database.path(), options.recorded, stored ? stored->revision : 0));
  PastWriter past(database, stored ? stored->row : 0, static_cast<std::int64_t>(report.revision), Carries(atlas));
  SaveContext context{
      .database = database, .options = options, .changes = changes, .past = past, .map = report.map, .at = at};
  for (const Map& map : atlas.maps) context.entities += 100 * map.keyframes.size() + map.points.size();
  if (stored && !options.recorded && rewrite == Rewrite::kWhatDiffers && stored->hash == hashes.Combined() &&
      !HasNewSource(database, stored->row, name, options)) {
    context.atlas = stored->row;
    report.unchanged = true;
    report.revision = static_cast<std::uint64_t>(stored->revision);
    SaveUnchanged(context, atlas, hashes);
    report.tables = changes.Take();
    return;
  }
  if (stored) past.Keep(Part::kAtlas, stored->row);
  if (stored && rewrite == Rewrite::kAll)
    for (const StoredMap& map : ReadStoredMaps(database, stored->row)) RemoveMap(context, map.row);
  const AtlasSummary summary = Summarize(atlas);
  context.atlas = SaveHeader(context, name, atlas, summary, report, stored);
  SaveContent(context, atlas, hashes);
  SaveSummary(database, context.atlas, summary);
  report.tables = changes.Take();
}

void DeleteAtlas(Database& database, std::int64_t atlas, ChangeCounter& changes) {
  const std::vector<std::int64_t> pictures = PicturesOf(database, atlas);
  DeleteCarried(database, CarriedKind::kAtlas, atlas, atlas);
  DeleteCarried(database, CarriedKind::kCamera, CarriedCameraRow(atlas, 0), CarriedCameraRow(atlas, 0xffffffff));
  for (const StoredMap& map : ReadStoredMaps(database, atlas)) DeleteMap(database, map.row, changes);
  for (const char* table : {"camera", "repeated_entry", "past", "tag", "revision"}) {
    Statement remove(database, std::string("DELETE FROM ") + table + " WHERE atlas = ?1",
                     std::string("table ") + table);
    remove.Bind(1, atlas).Run();
  }
  DeleteUnused(database, pictures);
  Statement remove(database, "DELETE FROM atlas WHERE row = ?1", "table atlas");
  remove.Bind(1, atlas).Run();
  ++changes["atlas"].deleted;
}

}  // namespace slamdb::sqlite
