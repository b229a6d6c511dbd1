// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/file.h"
#include "slamdb/formats/sqlite/detail/database.h"

// Databases of other programs: read, never changed, with nothing laid beside them, and nothing of what they would run.
namespace slamdb::sqlite {

// A file as an image, or bytes in memory. Throws Error as Database does.
Database OpenForeign(const Source& source);

// The columns of a table; none where there is no such table, or a view or a virtual one has its name.
std::set<std::string, std::less<>> ColumnsOf(Database& database, std::string_view table);

// `SELECT a, NULL, c FROM "table"`: NULL for columns that are not there. Throws Error (kDamaged) when there is no such
// table.
std::string SelectColumns(Database& database, std::string_view table, const std::vector<std::string_view>& columns);

}  // namespace slamdb::sqlite
