// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/batch_insert.h"

namespace slamdb::sqlite {
namespace {

constexpr std::size_t kRows = 64;

void InsertRow(Statement& statement, std::span<const Value> values) {
  int index = 1;
  for (const Value& value : values) value.BindTo(statement, index++);
  statement.Run();
}

}  // namespace

void Value::BindTo(Statement& statement, int index) const {
  if (const auto* integer = std::get_if<std::int64_t>(&value_))
    statement.Bind(index, *integer);
  else if (const auto* real = std::get_if<double>(&value_))
    statement.BindReal(index, *real);
  else if (const auto* text = std::get_if<std::string_view>(&value_))
    statement.BindText(index, *text);
  else if (const auto* blob = std::get_if<Bytes>(&value_))
    statement.BindBlob(index, *blob);
  else
    statement.BindNull(index);
}

void BatchInsert::Add(std::span<const Value> row) {
  waiting_.insert(waiting_.end(), row.begin(), row.end());
  if (waiting_.size() < kRows * columns_) return;
  if (!batch_) batch_.emplace(StatementOf(kRows));
  InsertRow(*batch_, waiting_);
  waiting_.clear();
}

void BatchInsert::Flush() {
  if (!single_ && !waiting_.empty()) single_.emplace(StatementOf(1));
  for (std::size_t first = 0; first < waiting_.size(); first += columns_)
    InsertRow(*single_, std::span(waiting_).subspan(first, columns_));
  waiting_.clear();
}

Statement BatchInsert::StatementOf(std::size_t rows) const {
  std::string row = "(?";
  for (std::size_t i = 1; i < columns_; ++i) row += ",?";
  row += ")";
  std::string sql = "INSERT OR ROLLBACK INTO " + table_ + " VALUES " + row;
  for (std::size_t i = 1; i < rows; ++i) sql += "," + row;
  return Statement(database_, sql, "table " + table_);
}

}  // namespace slamdb::sqlite
