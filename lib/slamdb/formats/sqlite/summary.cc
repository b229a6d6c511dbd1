// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/summary.h"

#include <optional>
#include <unordered_map>
#include <variant>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/rows/detail/atlas_conditions.h"
#include "slamdb/formats/rows/detail/summary_columns.h"
#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/formats/sqlite/detail/save.h"
#include "slamdb/formats/sqlite/detail/statistics.h"
#include "slamdb/formats/sqlite/detail/visit_rows.h"

namespace slamdb::sqlite {
namespace {

using slamdb::detail::Concat;

std::optional<double> RealOrNone(const Statement& statement, int column) {
  return statement.IsNull(column) ? std::nullopt : std::optional(statement.Real(column));
}

void BindRealOrNone(Statement& statement, int index, std::optional<double> value) {
  value ? statement.BindReal(index, *value) : statement.BindNull(index);
}

std::uint64_t BytesOf(Database& database, std::int64_t atlas) {
  std::uint64_t bytes = 0;
  for (const PartSize& part : PartSizesOf(database, atlas)) bytes += part.bytes;
  return bytes;
}

// What rows of an atlas can be there at most.
struct MostRows {
  std::uint64_t maps = 0, keyframes = 0, points = 0, landmarks = 0;
};

// Of each atlas, by its row: by the highest row of each map.
std::unordered_map<std::int64_t, MostRows> CountMostRows(Database& database) {
  const auto highest = [](std::string_view table) {
    return Concat(", (SELECT row FROM ", table,
                  " WHERE row BETWEEN map.row << 32 AND (map.row << 32) + 4294967295 ORDER BY row DESC LIMIT 1)");
  };
  Statement maps(database,
                 Concat("SELECT slamdb_visit(?1, atlas, row", highest("keyframe"), highest("map_point"),
                        highest("landmark"), ") FROM map"),
                 "table map");
  std::unordered_map<std::int64_t, MostRows> most;
  VisitRows(maps, [&most](const Row& map) {
    const auto rows_up_to = [&](int column) {
      return map.IsNull(column) ? 0
                                : static_cast<std::uint64_t>(map.Integer(column) - FirstRowOfMap(map.Integer(1)) + 1);
    };
    MostRows& of = most[map.Integer(0)];
    ++of.maps;
    of.keyframes += rows_up_to(2);
    of.points += rows_up_to(3);
    of.landmarks += rows_up_to(4);
  });
  return most;
}

// What the row of the atlas says that cannot be; empty: nothing.
std::string ProblemOf(const StoredAtlas& atlas, const MostRows& most) {
  std::string problem;
  const auto check = [&](std::string_view what, std::uint64_t told, std::uint64_t at_most) {
    if (told > at_most && problem.empty())
      problem = Concat(static_cast<std::int64_t>(told), " ", what, " where at most ", at_most, " can be");
  };
  check("maps", atlas.maps, most.maps);
  check("keyframes", atlas.keyframes, most.keyframes);
  check("points", atlas.points, most.points);
  check("landmarks", atlas.landmarks, most.landmarks);
  return problem;
}

// A pattern without sets of letters, which GLOB has.
std::string GlobOf(std::string_view text) {
  std::string glob;
  for (const char letter : text) glob += letter == '[' ? "[[]" : std::string(1, letter);
  return glob;
}

}  // namespace

void SaveSummary(Database& database, std::int64_t atlas, const AtlasSummary& summary) {
  Statement update(database,
                   "UPDATE atlas SET sensors = ?2, has_imu = ?3, is_metric = ?4, landmarks = ?5, trajectory_length = "
                   "?6, duration = ?7, begin_time = ?8, end_time = ?9, bytes = ?10 WHERE row = ?1",
                   "table atlas");
  update.Bind(1, atlas).Bind(2, rows::BitsOf(summary.sensors)).Bind(3, std::int64_t{summary.has_imu});
  update.Bind(4, std::int64_t{summary.is_metric}).Bind(5, ToColumn(summary.landmarks));
  update.BindReal(6, summary.trajectory_length).BindReal(7, summary.duration);
  BindRealOrNone(update, 8, summary.begin_time);
  BindRealOrNone(update, 9, summary.end_time);
  update.Bind(10, ToColumn(BytesOf(database, atlas))).Run();
}

void SaveMissingSummaries(Database& database) {
  for (const std::int64_t row :
       Statement(database, "SELECT row FROM atlas WHERE sensors IS NULL", "table atlas").Integers()) {
    try {
      // One thread, as no other connection sees what the transaction has changed.
      SaveSummary(database, row,
                  Summarize(LoadAtlas(database, row, {.features = FeatureColumns::kGeometry, .threads = 1})));
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kDamaged) throw;
    }
  }
}

std::vector<std::string> FindAtlases(Database& database, const AtlasQuery& query) {
  const rows::AtlasConditions conditions =
      rows::ConditionsOf(query, {.parameter = '?', .matches = "GLOB", .pattern = GlobOf});
  Statement select(database, Concat("SELECT name FROM atlas WHERE ", conditions.sql, " ORDER BY name"), "table atlas");
  for (std::size_t i = 0; i < conditions.parameters.size(); ++i) {
    const int number = static_cast<int>(i) + 1;
    if (const auto* text = std::get_if<std::string>(&conditions.parameters[i]))
      select.BindText(number, *text);
    else
      select.BindReal(number, std::get<double>(conditions.parameters[i]));
  }
  std::vector<std::string> names;
  while (select.Step()) names.push_back(select.Text(0));
  return names;
}

std::vector<StoredAtlas> ListAtlases(Database& database) {
  Statement statement(database,
                      "SELECT row, name, maps, keyframes, points, observations, revision, hash, saved_at, sensors, "
                      "has_imu, is_metric, landmarks, trajectory_length, duration, begin_time, end_time, bytes "
                      "FROM atlas ORDER BY name",
                      "table atlas");
  std::vector<StoredAtlas> atlases;
  std::unordered_map<std::int64_t, MostRows> most = CountMostRows(database);
  atlases.reserve(most.size());
  while (statement.Step()) {
    StoredAtlas& atlas = atlases.emplace_back();
    int column = 1;
    const auto number = [&] { return static_cast<std::uint64_t>(statement.Integer(column++)); };
    atlas.name = statement.Text(column++);
    for (std::uint64_t* value :
         {&atlas.maps, &atlas.keyframes, &atlas.points, &atlas.observations, &atlas.revision, &atlas.hash})
      *value = number();
    atlas.saved_at = statement.Text(column++);
    if (statement.IsNull(column)) {
      atlas.bytes = BytesOf(database, statement.Integer(0));
    } else {
      atlas.sensors = rows::SensorsOf(statement.Integer(column++));
      atlas.has_imu = number() != 0;
      atlas.is_metric = number() != 0;
      atlas.landmarks = number();
      atlas.trajectory_length = statement.Real(column++);
      atlas.duration = statement.Real(column++);
      atlas.begin_time = RealOrNone(statement, column++);
      atlas.end_time = RealOrNone(statement, column++);
      atlas.bytes = number();
    }
    atlas.problem = ProblemOf(atlas, most[statement.Integer(0)]);
    if (atlas.problem.empty()) atlas.problem = rows::ProblemOf(atlas);
  }
  return atlases;
}

}  // namespace slamdb::sqlite
