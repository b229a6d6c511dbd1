// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "slamdb/formats/rows/detail/list_order.h"
#include "slamdb/formats/sqlite/detail/database.h"

namespace slamdb::sqlite {

using rows::ListOrder;

// Of the `list` keyframe, point or landmark of a map. Stores before version 7 know no other than ascending rows.
ListOrder OrderOf(Database& database, std::int64_t map, std::string_view list);

// The rows of a list, which are those of `table`, in its order.
std::vector<std::int64_t> RowsInOrder(Database& database, std::int64_t map, std::string_view list,
                                      std::string_view table);

// The step from version 7 back to 6, which knows no order: gives the entries of lists that have one new rows, which
// ascend. Throws Error (kNotPossible) where a map has no more rows.
void MakeListsAscend(Database& database);

}  // namespace slamdb::sqlite
