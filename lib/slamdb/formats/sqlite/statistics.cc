// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/statistics.h"

#include <algorithm>
#include <filesystem>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/rows/detail/history_row.h"
#include "slamdb/formats/sqlite/detail/files_beside.h"
#include "slamdb/formats/sqlite/detail/migrations.h"

namespace slamdb::sqlite {
namespace {

// What a row takes in the file without its blobs, about: for telling sizes without reading every row.
constexpr std::uint64_t kPointBytes = 230;  // with its index entry and its place in the R*Tree
constexpr std::uint64_t kObservationBytes = 22;

std::uint64_t SizeOf(const std::string& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  return error ? 0 : size;
}

std::uint64_t Unsigned(const Statement& statement, int column) {
  return static_cast<std::uint64_t>(statement.Integer(column));
}

// Tables with their indexes; the R*Tree with its own tables.
std::vector<PartSize> TableSizes(Database& database) {
  Statement statement(database,
                      "SELECT CASE WHEN pages.name LIKE 'map_point_box%' THEN 'map_point_box' "
                      "ELSE coalesce(owner.tbl_name, pages.name) END AS part, sum(pages.pgsize) AS bytes "
                      "FROM dbstat AS pages LEFT JOIN sqlite_schema AS owner ON owner.name = pages.name "
                      "WHERE pages.aggregate = TRUE GROUP BY part ORDER BY bytes DESC, part");
  std::vector<PartSize> tables;
  while (statement.Step()) tables.push_back({statement.Text(0), Unsigned(statement, 1)});
  return tables;
}

// Of the history and its revisions, as HistoryEntryOf takes them: these are found by their key, as no index leads from
// a history to them.
constexpr std::string_view kEntries =
    "SELECT at, tool, action, coalesce(history.atlas, ''), provenance, history.maps, history.keyframes, "
    "history.points, history.observations, inserted, updated, deleted, unchanged, history.hash, coalesce(who, ''), "
    "coalesce(history.revision, 0), "
    "revision.number IS NOT NULL, (SELECT group_concat(tag.name, '\n') FROM tag WHERE tag.atlas = revision.atlas AND "
    "tag.number = revision.number), from_atlas, from_number, from_hash, keyframes_added, keyframes_removed, "
    "keyframes_moved, points_added, points_removed, points_moved, observations_added, observations_removed "
    "FROM history LEFT JOIN atlas AS its ON its.name = history.atlas "
    "LEFT JOIN revision ON revision.atlas = its.row AND revision.number = history.revision AND revision.history = "
    "history.row WHERE ";

}  // namespace

std::vector<PartSize> PartSizesOf(Database& database, std::int64_t atlas) {
  const auto sum = [&](const char* bytes, const char* table, const char* key) {
    Statement statement(database,
                        std::string("SELECT sum(") + bytes + ") FROM map JOIN " + table + " ON " + key +
                            " BETWEEN map.row << 32 AND (map.row << 32) + 4294967295 WHERE map.atlas = ?1",
                        std::string("table ") + table);
    return statement.Bind(1, atlas).Step() ? Unsigned(statement, 0) : 0;
  };
  Statement counts(database, "SELECT points, observations FROM atlas WHERE row = ?1", "table atlas");
  counts.Bind(1, atlas).Step();
  return {{"features", sum("length(points) + (SELECT length(columns) FROM picture WHERE picture.row = picture)",
                           "keyframe_features", "keyframe_features.keyframe")},
          {"keyframes", sum("length(details)", "keyframe", "keyframe.row")},
          {"points", Unsigned(counts, 0) * kPointBytes},
          {"observations", Unsigned(counts, 1) * kObservationBytes},
          {"landmarks", sum("length(features) + 144", "landmark", "landmark.row")}};
}

std::vector<HistoryEntry> ReadHistory(Database& database, const std::string& name) {
  Statement statement(database, detail::Concat(kEntries, "?1 = '' OR history.atlas = ?1 ORDER BY history.row"),
                      "table history");
  statement.BindText(1, name);
  std::vector<HistoryEntry> entries;
  while (statement.Step()) entries.push_back(rows::HistoryEntryOf(statement));
  return entries;
}

HistoryEntry ReadHistoryOf(Database& database, std::int64_t atlas, std::int64_t number) {
  Statement statement(database, detail::Concat(kEntries, "revision.atlas = ?1 AND revision.number = ?2"),
                      "table history");
  if (!statement.Bind(1, atlas).Bind(2, number).Step())
    throw Error(ErrorKind::kDamaged, database.path(), "table history",
                detail::Concat("tells nothing of revision ", number));
  return rows::HistoryEntryOf(statement);
}

StoreStats ReadStatistics(Database& database) {
  StoreStats stats;
  stats.version = VersionOf(database);
  stats.page_bytes = static_cast<std::uint64_t>(database.Integer("PRAGMA page_size"));
  stats.pages = static_cast<std::uint64_t>(database.Integer("PRAGMA page_count"));
  stats.free_pages = static_cast<std::uint64_t>(database.Integer("PRAGMA freelist_count"));
  stats.file_bytes = SizeOf(database.path());
  stats.log_bytes = SizeOf(FilesBeside(database.path()).log);
  if (sqlite3_compileoption_used("ENABLE_DBSTAT_VTAB") != 0) stats.tables = TableSizes(database);
  return stats;
}

}  // namespace slamdb::sqlite
