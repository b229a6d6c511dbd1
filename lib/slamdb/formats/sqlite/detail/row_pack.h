// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "slamdb/formats/sqlite/detail/database.h"
#include "slamdb/model/detail/packing.h"

// Rows of a table as bytes, and back. Layout: schema/store.md, `past.rows`.
namespace slamdb::sqlite {

// Packs every row that `select` finds, all its columns; none gives no bytes at all. `select` is bound, and is reset.
void PackRows(Statement& select, detail::ByteWriter& out);

// Inserts packed rows into a table. Columns that the table has got since they were packed are NULL.
class PackedRows {
 public:
  PackedRows(Database& database, std::string_view table);

  // Throws Error (kDamaged) where the bytes are no rows, or not of that table.
  void Insert(Bytes rows);

 private:
  int columns_;
  Statement insert_;
  std::vector<std::string> inflated_;  // what is bound
};

}  // namespace slamdb::sqlite
