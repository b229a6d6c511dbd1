// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/foreign.h"

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/sqlite/detail/identity.h"

namespace slamdb::sqlite {

Database OpenForeign(const Source& source) {
  if (source.memory) return Database::OfBytes(*source.memory, source.path);
  return Database(source.path, Access::kImage, 0);
}

std::set<std::string, std::less<>> ColumnsOf(Database& database, std::string_view table) {
  std::set<std::string, std::less<>> columns;
  if (!HasPlainTable(database, table)) return columns;
  Statement statement(database, "SELECT name FROM pragma_table_info(?1)");
  statement.BindText(1, table);
  while (statement.Step()) columns.insert(statement.Text(0));
  return columns;
}

std::string SelectColumns(Database& database, std::string_view table, const std::vector<std::string_view>& columns) {
  const auto there = ColumnsOf(database, table);
  if (there.empty()) throw Error(ErrorKind::kDamaged, database.path(), detail::Concat("table ", table), "missing");
  std::string sql;
  for (const std::string_view column : columns) {
    sql += sql.empty() ? "SELECT " : ", ";
    sql += there.contains(column) ? detail::Concat('"', column, '"') : "NULL";
  }
  return detail::Concat(sql, " FROM \"", table, "\"");
}

}  // namespace slamdb::sqlite
