// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"
#include "slamdb/formats/sqlite/detail/database.h"
#include "slamdb/formats/stella/detail/outgoing.h"
#include "slamdb/formats/stella/detail/stella_map.h"

namespace slamdb::stella {

// What a database of stella_vslam holds, of which columns are told by their names.
//
// Throws Error: kDamaged with table and row.
StoredMap ReadDatabase(sqlite::Database& database, const ReadOptions& options);

void WriteDatabase(const Outgoing& map, const Target& target, const WriteOptions& options);

}  // namespace slamdb::stella
