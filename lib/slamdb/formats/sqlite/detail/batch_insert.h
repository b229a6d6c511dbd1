// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "slamdb/formats/sqlite/detail/database.h"

namespace slamdb::sqlite {

// What a column of a row holds.
class Value {
 public:
  Value(std::int64_t value) : value_(value) {}
  Value(std::optional<std::int64_t> value) {
    if (value) value_ = *value;
  }
  Value(double value) : value_(value) {}  // NaN becomes NULL
  Value(std::string_view text) : value_(text) {}
  Value(Bytes blob) : value_(blob) {}
  static Value Null() { return Value(std::optional<std::int64_t>()); }

  void BindTo(Statement& statement, int index) const;

 private:
  std::variant<std::monostate, std::int64_t, double, std::string_view, Bytes> value_;
};

// Inserts new rows into a table, by the batch: a statement of many rows takes half of what as many statements take, or
// less where a constraint of the table is made ready once for each statement.
//
// A row that is there already is an error, which takes the transaction back: SQLite need not keep what each statement
// alone has changed.
class BatchInsert {
 public:
  BatchInsert(Database& database, std::string table, std::size_t columns)
      : database_(database), table_(std::move(table)), columns_(columns) {}

  // All columns of a row, in order. Texts and blobs must live until Flush().
  void Add(std::span<const Value> row);
  // Inserts the rows that still wait, to be called after the last.
  void Flush();

 private:
  Statement StatementOf(std::size_t rows) const;

  Database& database_;
  std::string table_;
  std::size_t columns_;
  std::vector<Value> waiting_;
  std::optional<Statement> batch_, single_;  // prepared when they are needed: most saves change few rows
};

}  // namespace slamdb::sqlite
