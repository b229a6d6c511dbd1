// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "slamdb/formats/postgresql/detail/connection.h"
#include "slamdb/formats/postgresql/detail/names.h"
#include "slamdb/formats/postgresql/detail/partition.h"
#include "slamdb/formats/rows/atlas_query.h"
#include "slamdb/formats/rows/stored.h"
#include "slamdb/model/map_query.h"

// What a store tells of its atlases, without reading them.
namespace slamdb::postgresql {

std::vector<StoredAtlas> ListAtlases(Connection& connection);  // by name
// The names of the atlases that match, ascending; of a partition on another server, of its atlases alone.
std::vector<std::string> FindAtlases(Connection& connection, const MapQuery& query, const Partition& partition = {});
// Those of which the store itself tells what is asked for.
std::vector<std::string> FindAtlases(Connection& connection, const AtlasQuery& query);
// Oldest first; empty name: everything.
std::vector<HistoryEntry> ReadHistory(Connection& connection, const std::string& name);
// Of one revision. Throws Error (kDamaged) when the log does not know it.
HistoryEntry ReadHistoryOf(Connection& connection, std::int64_t atlas, std::int64_t number);
std::vector<RevisionChain> ReadChains(Connection& connection, const ChainQuery& query);
StoreStats ReadStatistics(Connection& connection);
// How many bytes each kind of data of the newest revision takes.
std::vector<PartSize> PartSizesOf(Connection& connection, std::int64_t atlas, const Partition& partition);
// Their sum into its row.
void WriteBytes(Connection& connection, std::int64_t atlas, const Partition& partition);

// Whether the rows of the newest revision are those that saves have written: by the transactions that did, without a
// look at what they hold. False also where that cannot be told: after a restore from a dump, and on another server.
bool IsAsSaved(Connection& connection, const Named& named);

}  // namespace slamdb::postgresql
