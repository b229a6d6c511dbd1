// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/formats/sqlite/detail/database.h"

namespace slamdb::sqlite {

// Copies the whole database to a new file with SQLite's online backup, while others may read and write it. The target
// appears whole or not at all. Throws Error: target there and not `overwrite`, disk full, no permission.
void BackupTo(Database& source, const std::string& target, bool overwrite);

}  // namespace slamdb::sqlite
