// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/rows/detail/plan.h"
#include "slamdb/formats/sqlite/detail/load.h"

namespace slamdb::sqlite {
namespace {

constexpr std::int64_t kLeastDetailsBytes = 256;  // of a sound keyframe.details; before memory is spent on its row

bool LimitsTime(const Selection& selection) {
  return selection.begin_time > -std::numeric_limits<double>::infinity() ||
         selection.end_time < std::numeric_limits<double>::infinity();
}

// An unbounded box holds points that the R*Tree does not order well, at infinity: they are looked at one by one.
std::vector<std::int64_t> PointRowsByScan(Database& database, std::int64_t map, const Eigen::AlignedBox3f& box) {
  Statement statement(
      database,
      "SELECT row FROM map_point WHERE row BETWEEN ?1 AND ?2 AND x BETWEEN ?3 AND ?4 AND y BETWEEN ?5 AND "
      "?6 AND z BETWEEN ?7 AND ?8 ORDER BY row",
      "table map_point");
  statement.Bind(1, FirstRowOfMap(map)).Bind(2, LastRowOfMap(map));
  for (int axis = 0; axis < 3; ++axis) {
    statement.BindReal(3 + 2 * axis, box.min()[axis]).BindReal(4 + 2 * axis, box.max()[axis]);
  }
  return statement.Integers();
}

}  // namespace

std::vector<std::int64_t> RowsOfList(Database& database, std::string_view table, std::int64_t map) {
  Statement statement(database, detail::Concat("SELECT row FROM ", table, " WHERE row BETWEEN ?1 AND ?2 ORDER BY row"),
                      detail::Concat("table ", table));
  return statement.Bind(1, FirstRowOfMap(map)).Bind(2, LastRowOfMap(map)).Integers();
}

std::string IdCondition(std::uint64_t first, std::uint64_t last) {
  constexpr std::uint64_t kSignBit = std::uint64_t{1} << 63;
  if (first == 0 && last == std::numeric_limits<std::uint64_t>::max()) return "";
  const bool wraps = first < kSignBit && last >= kSignBit;
  return wraps ? " AND (id >= ?3 OR id <= ?4)" : " AND id BETWEEN ?3 AND ?4";
}

std::vector<std::int64_t> KeyframeRows(Database& database, std::int64_t map, const Selection& selection) {
  // `+` keeps the row range from being the way in where an index on id or time is the better one.
  const std::string ids = IdCondition(selection.first_keyframe, selection.last_keyframe);
  const bool by_time = LimitsTime(selection);
  std::string sql = "SELECT row, length(details) FROM keyframe WHERE ";
  sql += ids.empty() && !by_time ? "row BETWEEN ?1 AND ?2" : "map = ?5 AND +row BETWEEN ?1 AND ?2";
  sql += ids;
  if (by_time) sql += " AND timestamp BETWEEN ?6 AND ?7";
  Statement statement(database, sql + " ORDER BY row", "table keyframe");
  statement.Bind(1, FirstRowOfMap(map)).Bind(2, LastRowOfMap(map));
  if (!ids.empty() || by_time) statement.Bind(5, map);
  if (!ids.empty()) {
    statement.Bind(3, static_cast<std::int64_t>(selection.first_keyframe));
    statement.Bind(4, static_cast<std::int64_t>(selection.last_keyframe));
  }
  if (by_time) statement.BindReal(6, selection.begin_time).BindReal(7, selection.end_time);
  std::vector<std::int64_t> rows;
  while (statement.Step()) {
    rows.push_back(statement.Integer(0));
    if (statement.Integer(1) < kLeastDetailsBytes) throw DamagedRow(database, "keyframe", rows.back());
  }
  return rows;
}

std::vector<std::int64_t> PointRows(Database& database, std::int64_t map, const Selection& selection) {
  if (!selection.box) return RowsOfList(database, "map_point", map);
  const Eigen::AlignedBox3f& box = *selection.box;
  if (!box.min().allFinite() || !box.max().allFinite()) return PointRowsByScan(database, map, box);
  Statement statement(
      database,
      "SELECT row FROM map_point_box WHERE min_x >= ?3 AND max_x <= ?4 AND min_y >= ?5 AND max_y <= ?6 AND "
      "min_z >= ?7 AND max_z <= ?8 AND +row BETWEEN ?1 AND ?2 ORDER BY row",
      "table map_point_box");
  statement.Bind(1, FirstRowOfMap(map)).Bind(2, LastRowOfMap(map));
  for (int axis = 0; axis < 3; ++axis) {
    statement.BindReal(3 + 2 * axis, box.min()[axis]).BindReal(4 + 2 * axis, box.max()[axis]);
  }
  return statement.Integers();
}

}  // namespace slamdb::sqlite
