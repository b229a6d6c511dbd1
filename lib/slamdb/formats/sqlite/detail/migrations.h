// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "slamdb/formats/rows/stored.h"
#include "slamdb/formats/sqlite/detail/database.h"

namespace slamdb::sqlite {

// One step of the schema: schema/<name>.sql brings a store from version number - 1 to `number`, and
// schema/<name>.back.sql, where there is one, back again; it fails where something would be lost.
struct Migration {
  int number;
  std::string_view name;
  std::string_view sql;
  std::string_view back = {};
};

// All of them, ascending from 1. Their SQL is compiled into the library.
std::span<const Migration> Migrations();

// The statements that make what all of them make of an empty database, at once.
std::span<const char* const> NewestSchema();

// `SLDB`: PRAGMA application_id of every store.
constexpr std::int64_t kApplicationId = 0x534C4442;

// The version of store that this library reads and writes.
int NewestVersion();

// PRAGMA user_version.
int VersionOf(Database& database);

// The versions that brought tables and columns which older stores lack.
inline constexpr int kFirstVersionWithLandmarks = 2, kFirstVersionWithTracking = 3, kFirstVersionWithSummaries = 4,
                     kFirstVersionWithPlaces = 5, kFirstVersionWithCarried = 6, kFirstVersionWithRevisions = 7;

// Makes the tables of this program's version in an empty database, inside the caller's transaction, and stamps it.
void MakeTables(Database& database);

// Runs the steps that `database` lacks, inside the caller's transaction, and stamps it with the last one's number.
void RunMigrations(Database& database, std::span<const Migration> migrations);

// MigrateStore of store.h, with any list of migrations up to this program's version.
MigrateReport Migrate(const std::string& path, const MigrateOptions& options, std::span<const Migration> migrations);

}  // namespace slamdb::sqlite
