// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/formats/rows/stored.h"
#include "slamdb/formats/sqlite/detail/database.h"

namespace slamdb::sqlite {

std::vector<HistoryEntry> ReadHistory(Database& database, const std::string& name);
// Of one revision. Throws Error (kDamaged) when the log does not know it.
HistoryEntry ReadHistoryOf(Database& database, std::int64_t atlas, std::int64_t number);
StoreStats ReadStatistics(Database& database);

// Bytes of one atlas' rows by kind of data.
std::vector<PartSize> PartSizesOf(Database& database, std::int64_t atlas);

}  // namespace slamdb::sqlite
