// SPDX-License-Identifier: BSD-3-Clause
// Which atlases match a query, by indexes: keyframe_by_time and keyframe_by_id for each map, the R*Tree for all at
// once.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/formats/sqlite/detail/summary.h"

namespace slamdb::sqlite {
namespace {

using Rows = std::set<std::int64_t>;  // of maps

Rows RowsOf(Statement& statement) {
  Rows rows;
  while (statement.Step()) rows.insert(statement.Integer(0));
  return rows;
}

// Only keyframes with a finite time count: 9e999 is infinite.
Rows MapsByTime(Database& database, const MapQuery::Times& times) {
  Statement statement(
      database,
      "SELECT row FROM map WHERE EXISTS (SELECT 1 FROM keyframe WHERE map = map.row AND timestamp <= ?1 "
      "AND timestamp > -9e999 AND timestamp < 9e999 AND bad = 0) AND EXISTS (SELECT 1 FROM keyframe "
      "WHERE map = map.row AND timestamp >= ?2 AND timestamp > -9e999 AND timestamp < 9e999 AND bad = 0)",
      "table keyframe");
  statement.BindReal(1, times.end).BindReal(2, times.begin);
  return RowsOf(statement);
}

Rows MapsByKeyframes(Database& database, const MapQuery::Ids& ids) {
  const std::string condition = IdCondition(ids.first, ids.last);
  Statement statement(
      database,
      "SELECT row FROM map WHERE EXISTS (SELECT 1 FROM keyframe WHERE map = map.row" + condition + " AND bad = 0)",
      "table keyframe");
  if (!condition.empty())
    statement.Bind(3, static_cast<std::int64_t>(ids.first)).Bind(4, static_cast<std::int64_t>(ids.last));
  return RowsOf(statement);
}

void BindBall(Statement& statement, const MapQuery::Ball& ball) {
  statement.BindReal(1, ball.center.x()).BindReal(2, ball.center.y()).BindReal(3, ball.center.z());
  statement.BindReal(4, ball.radius);
}

constexpr std::string_view kInBall = "(x - ?1) * (x - ?1) + (y - ?2) * (y - ?2) + (z - ?3) * (z - ?3) <= ?4 * ?4";

// Points by the box around the ball, then by their distance.
Rows MapsByPlace(Database& database, const MapQuery::Ball& ball) {
  Statement points(
      database,
      "SELECT DISTINCT map FROM map_point_box AS box CROSS JOIN map_point ON map_point.row = box.row WHERE "
      "max_x >= ?1 - ?4 AND min_x <= ?1 + ?4 AND max_y >= ?2 - ?4 AND min_y <= ?2 + ?4 AND max_z >= ?3 - "
      "?4 AND min_z <= ?3 + ?4 AND bad = 0 AND " +
          std::string(kInBall),
      "table map_point_box");
  BindBall(points, ball);
  Rows rows = RowsOf(points);
  Statement landmarks(database, "SELECT DISTINCT map FROM landmark WHERE " + std::string(kInBall), "table landmark");
  BindBall(landmarks, ball);
  rows.merge(RowsOf(landmarks));
  return rows;
}

void Intersect(std::optional<Rows>& maps, Rows others) {
  if (!maps) {
    maps = std::move(others);
    return;
  }
  std::erase_if(*maps, [&](std::int64_t row) { return !others.contains(row); });
}

}  // namespace

std::vector<std::string> FindAtlases(Database& database, const MapQuery& query) {
  std::optional<Rows> maps;
  if (query.times) Intersect(maps, MapsByTime(database, *query.times));
  if (query.keyframes) Intersect(maps, MapsByKeyframes(database, *query.keyframes));
  if (query.near) Intersect(maps, MapsByPlace(database, *query.near));
  Statement statement(database, "SELECT name, map.row FROM atlas LEFT JOIN map ON map.atlas = atlas.row ORDER BY name",
                      "table atlas");
  std::vector<std::string> names;
  while (statement.Step()) {
    if (maps && (statement.IsNull(1) || !maps->contains(statement.Integer(1)))) continue;
    std::string name = statement.Text(0);
    if (names.empty() || names.back() != name) names.push_back(std::move(name));
  }
  return names;
}

}  // namespace slamdb::sqlite
