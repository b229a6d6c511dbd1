// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "slamdb/formats/rows/detail/value.h"
#include "slamdb/formats/sqlite/detail/database.h"

namespace slamdb::sqlite {

using rows::Value;
using rows::ValueOrNull;

// Inserts new rows into a table, by the batch: SQL selects them from memory (a virtual table), which takes less than
// half of binding them to a statement one by one.
//
// A row that is there already is an error, which takes the transaction back: SQLite need not keep what each statement
// alone has changed.
class BatchInsert {
 public:
  // At most 26 columns.
  BatchInsert(Database& database, std::string table, std::size_t columns);
  BatchInsert(const BatchInsert&) = delete;
  BatchInsert& operator=(const BatchInsert&) = delete;

  // All columns of a row, in order. Texts and blobs must live until Flush().
  void Add(std::span<const Value> row);
  // Inserts the rows that still wait, to be called after the last.
  void Flush();

 private:
  Database& database_;
  std::string table_;
  std::size_t columns_;
  std::vector<Value> waiting_;
  std::optional<Statement> insert_;  // prepared when it is needed: most saves change few rows
};

// Lets a connection insert so.
void RegisterRows(sqlite3* handle);

}  // namespace slamdb::sqlite
