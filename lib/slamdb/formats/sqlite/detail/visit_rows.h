// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

#include "slamdb/formats/sqlite/detail/database.h"

// Reading many small rows: SQLite calls us with each of them, which takes half of stepping from one to the next.
namespace slamdb::sqlite {

// A row that is visited.
class Row {
 public:
  explicit Row(sqlite3_value** columns) : columns_(columns) {}

  bool IsNull(int column) const { return sqlite3_value_type(columns_[column]) == SQLITE_NULL; }
  std::int64_t Integer(int column) const { return sqlite3_value_int64(columns_[column]); }
  double Real(int column) const;            // NaN for NULL
  std::string_view Text(int column) const;  // as long as the row is visited
  Bytes Blob(int column) const;             // as long

 private:
  sqlite3_value** columns_;
};

// Calls `visit` for each row that `select` finds, which is `SELECT slamdb_visit(?1, COLUMNS) FROM ...`. An aggregate
// knows no ORDER BY, and to sort in a subquery takes as long as to step: where the order matters, the table is INDEXED
// BY its primary key, or NOT INDEXED but by row number.
void VisitRows(Statement& select, const std::function<void(const Row&)>& visit);

// Lets a connection visit rows.
void RegisterVisit(sqlite3* handle);

}  // namespace slamdb::sqlite
