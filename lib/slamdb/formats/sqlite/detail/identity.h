// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "slamdb/formats/sqlite/detail/database.h"

namespace slamdb::sqlite {

// What the first 100 bytes of a file say.
struct Header {
  bool is_sqlite = false;
  std::int64_t application_id = 0;
  std::int64_t version = 0;  // PRAGMA user_version
};
Header HeaderOf(std::string_view head);

// Whether the database has a table of that name with rows of its own, or the R*Tree of a store. A view, another virtual
// table, or columns that are computed would run what the file says.
bool HasPlainTable(Database& database, std::string_view table);

enum class Older { kRefuse, kAccept };
// Tables that follow from others, the R*Tree and the words of keyframes; and `carried`, empty in most stores.
enum class Derived { kNeeded, kNotNeeded };

// Throws Error unless `database` is a store of version `newest`: says whose database it is (COLMAP, RTAB-Map,
// stella_vslam, ...), names both versions when the store is newer, and asks to migrate when it is older and that is not
// accepted. An empty file is no store.
void CheckIsStore(Database& database, int newest, Older older = Older::kRefuse, Derived derived = Derived::kNeeded);

}  // namespace slamdb::sqlite
