// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "slamdb/formats/rows/atlas_query.h"
#include "slamdb/formats/rows/stored.h"
#include "slamdb/formats/sqlite/detail/database.h"
#include "slamdb/model/map_query.h"
#include "slamdb/model/summary.h"

// What a list tells of atlases, without reading them.
namespace slamdb::sqlite {

// Writes what of the summary is no column of the first version, and how many bytes the rows of the atlas take.
void SaveSummary(Database& database, std::int64_t atlas, const AtlasSummary& summary);

// The same for atlases that an earlier version saved; damaged ones stay without. In the caller's transaction, whose
// changes it sees.
void SaveMissingSummaries(Database& database);

// Every atlas by name; of those without a summary the counts alone.
std::vector<StoredAtlas> ListAtlases(Database& database);

// The names of the atlases that match, ascending.
std::vector<std::string> FindAtlases(Database& database, const MapQuery& query);
std::vector<std::string> FindAtlases(Database& database, const AtlasQuery& query);

}  // namespace slamdb::sqlite
