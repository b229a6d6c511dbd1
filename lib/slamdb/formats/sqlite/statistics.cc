// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/statistics.h"

#include <algorithm>
#include <filesystem>

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
  return {{"features", sum("length(columns)", "keyframe_features", "keyframe_features.keyframe")},
          {"keyframes", sum("length(details)", "keyframe", "keyframe.row")},
          {"points", Unsigned(counts, 0) * kPointBytes},
          {"observations", Unsigned(counts, 1) * kObservationBytes},
          {"landmarks", sum("length(features) + 144", "landmark", "landmark.row")}};
}

std::vector<HistoryEntry> ReadHistory(Database& database, const std::string& name) {
  Statement statement(
      database,
      "SELECT at, tool, action, coalesce(atlas, ''), provenance, maps, keyframes, points, observations, "
      "inserted, updated, deleted, unchanged, hash FROM history WHERE ?1 = '' OR atlas = ?1 ORDER BY row",
      "table history");
  statement.BindText(1, name);
  std::vector<HistoryEntry> entries;
  while (statement.Step()) {
    HistoryEntry& entry = entries.emplace_back();
    int column = 0;
    for (std::string* text : {&entry.at, &entry.tool, &entry.action, &entry.atlas, &entry.provenance}) {
      *text = statement.Text(column++);
    }
    for (std::uint64_t* value : {&entry.maps, &entry.keyframes, &entry.points, &entry.observations, &entry.inserted,
                                 &entry.updated, &entry.deleted, &entry.unchanged, &entry.hash}) {
      *value = Unsigned(statement, column++);
    }
  }
  return entries;
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
