// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/foreign.h"

#include <filesystem>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/sqlite/detail/files_beside.h"
#include "slamdb/formats/sqlite/detail/identity.h"

namespace slamdb::sqlite {
namespace {

// SQLite takes a page in which the file ends for zeros.
void RequireWhole(Database& database, std::uint64_t bytes) {
  const std::int64_t expected =
      database.Integer("SELECT page_count * page_size FROM pragma_page_count, pragma_page_size");
  if (expected > 0 && bytes < static_cast<std::uint64_t>(expected))
    throw Error(ErrorKind::kDamaged, database.path(), "",
                detail::Concat("the file was cut: ", bytes, " of its ", expected, " bytes are there"));
}

}  // namespace

Database OpenForeign(const Source& source) {
  if (source.memory) {
    Database database = Database::OfBytes(*source.memory, source.path);
    RequireWhole(database, source.memory->size());
    return database;
  }
  Database database(source.path, Access::kImage, 0);
  const FilesBeside beside(source.path);
  std::error_code failed;
  const std::uintmax_t bytes = std::filesystem::file_size(source.path, failed);
  if (!failed && !HasContent(beside.log) && !HasContent(beside.journal)) RequireWhole(database, bytes);
  return database;
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
