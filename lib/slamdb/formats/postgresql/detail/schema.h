// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/formats/postgresql/detail/connection.h"
#include "slamdb/formats/postgresql/detail/encode.h"
#include "slamdb/formats/rows/stored.h"

// The schema of the store in PostgreSQL: schema/postgresql/*.sql.
namespace slamdb::postgresql {

// Rows that the newest revision has: `until`.
inline constexpr std::int64_t kNewest = 2147483647;

// Which rows of the atlas a revision has, as SQL: `atlas = 7 AND since <= 3 AND until > 3`.
std::string InRevision(std::int64_t atlas, std::int64_t revision);
// Those of the newest, by the indexes of these: where all is of one server, so that nothing is left unfinished.
std::string InNewest(std::int64_t atlas);

// `1, 5`: for COPY (SELECT ...), which takes no parameters.
std::string ListOf(const std::set<std::int64_t>& numbers);

// A table that COPY fills.
struct Table {
  const char* target;  // `name (columns)`
  std::vector<Type> types;
};
const Table& KeyframeTable();
const Table& FeaturesTable();
const Table& PictureTable();
const Table& WordsTable();
const Table& PlaceTable();
const Table& PointTable();
const Table& LandmarkTable();

// Tables of which rows belong to revisions, and the column by which their rows are known within an atlas.
struct Versioned {
  std::string_view table, key;
};
std::span<const Versioned> VersionedTables();

// All tables that are partitioned.
std::vector<std::string_view> PartitionedTables();
// Deletes all rows of an atlas in them, or counts them.
std::int64_t DeleteRows(Connection& connection, std::int64_t atlas);
std::int64_t CountRows(Connection& connection, std::int64_t atlas);

// The version of store that this library reads and writes.
int NewestVersion();
// Of a database; 0: it has no store.
int VersionOf(Connection& connection);
// Throws Error unless the database has a store of this library's version.
void CheckIsStore(Connection& connection);
// Makes the store where the database has none. Others who do the same are waited for.
void MakeStore(Connection& connection, int partitions = 1);

// The tables, types and views, in a transaction that is to be the caller's.
void MakeTables(Connection& connection);
// The partition `number` of a table, on this server. `constraint` is its own: `PRIMARY KEY (...)`, where the table has
// none.
void MakePartition(Connection& connection, std::string_view table, std::int64_t number, std::int64_t partitions,
                   std::string_view constraint = {});
// Held while a store is made or made another: a transaction's lock.
void LockMaking(Connection& connection);

// MigrateStore (formats/store/store.h).
MigrateReport Migrate(const std::string& uri, const MigrateOptions& options);

}  // namespace slamdb::postgresql
