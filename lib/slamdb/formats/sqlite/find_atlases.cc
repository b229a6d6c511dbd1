// SPDX-License-Identifier: BSD-3-Clause
// Which atlases match a query, by indexes: keyframe_by_time and keyframe_by_id for each map, the R*Tree for all at
// once.
#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "slamdb/formats/rows/detail/plan.h"
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

// Of points the R*Tree has the place to the bit; whether one is bad is looked up until a map has a good one.
Rows MapsOfPoints(Database& database, const MapQuery::Ball& ball) {
  Statement points(
      database,
      "SELECT row FROM map_point_box WHERE max_x >= ?1 - ?4 AND min_x <= ?1 + ?4 AND max_y >= ?2 - ?4 AND "
      "min_y <= ?2 + ?4 AND max_z >= ?3 - ?4 AND min_z <= ?3 + ?4 AND (min_x - ?1) * (min_x - ?1) + (min_y "
      "- ?2) * (min_y - ?2) + (min_z - ?3) * (min_z - ?3) <= ?4 * ?4",
      "table map_point_box");
  BindBall(points, ball);
  Statement is_good(database, "SELECT 1 FROM map_point WHERE row = ?1 AND bad = 0", "table map_point");
  Rows maps;
  while (points.Step()) {
    const std::int64_t row = points.Integer(0);
    if (maps.contains(MapOfRow(row))) continue;
    if (is_good.Bind(1, row).Step()) maps.insert(MapOfRow(row));
    is_good.Reset();
  }
  return maps;
}

Rows MapsOfLandmarks(Database& database, const MapQuery::Ball& ball) {
  Statement landmarks(database,
                      "SELECT DISTINCT map FROM landmark WHERE (x - ?1) * (x - ?1) + (y - ?2) * (y - ?2) + (z - ?3) * "
                      "(z - ?3) <= ?4 * ?4",
                      "table landmark");
  BindBall(landmarks, ball);
  return RowsOf(landmarks);
}

Rows MapsByPlace(Database& database, const MapQuery::Ball& ball) {
  Rows maps = MapsOfPoints(database, ball);
  maps.merge(MapsOfLandmarks(database, ball));
  return maps;
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
