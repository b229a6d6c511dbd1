// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/salvage.h"

namespace slamdb::detail {

// Reads what SQLite can still read of one atlas of a damaged store: row by row, each compared with its hash, so that
// what it returns is what was saved. `name` empty: the only atlas. Never changes the file. Throws Error when the
// store's tables or the list of its atlases cannot be read. Thread-safe.
Salvage SalvageStore(const std::string& path, const std::string& name, const ReadOptions& options);

}  // namespace slamdb::detail
