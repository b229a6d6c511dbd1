// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/salvage.h"
#include "slamdb/formats/sqlite/detail/database.h"

namespace slamdb::sqlite {

// Reads what can be read of the atlas of row `atlas`. The connection says whether edited rows are accepted.
Salvage SalvageRows(Database& database, std::int64_t atlas);

}  // namespace slamdb::sqlite

namespace slamdb::detail {

// Reads what SQLite can still read of one atlas of a damaged store: row by row, each compared with its hash, so that
// what it returns is what was saved; or, with StoreReadOptions::accept_edits, what stands there now. The atlas' own
// row, its cameras and its repeated entries have no hash of their own: where they may differ, it says so. `name` empty:
// the only atlas. Never changes the file. Throws Error when the store's tables or the list of its atlases cannot be
// read. Thread-safe.
Salvage SalvageStore(const std::string& path, const std::string& name, const ReadOptions& options);

}  // namespace slamdb::detail
