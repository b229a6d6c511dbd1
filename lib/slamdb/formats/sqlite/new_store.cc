// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/new_store.h"

#include <algorithm>

#include "slamdb/formats/sqlite/detail/identity.h"
#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/formats/sqlite/detail/writer_lock.h"

namespace slamdb::sqlite {
namespace {

// Measured: 4 to 16 KiB load and save alike; larger pages make the many small rows slower and small stores larger.
constexpr const char* kNewFile = "PRAGMA page_size=8192";

bool HasTables(Database& database) { return database.Integer("SELECT count(*) FROM sqlite_schema") != 0; }

// A log, and nothing in it yet: what a store is before its first transaction is committed.
bool IsBeingMade(Database& database) {
  if (database.is_image() || !IsEmptyDatabase(database)) return false;
  Statement mode(database, "PRAGMA journal_mode");
  return mode.Step() && mode.Text(0) == "wal";
}

void CreateSchema(Database& database) {
  database.Execute(kNewFile);
  database.UseLog();
  WriteTransaction transaction(database);
  if (HasTables(database)) return;  // another program was faster
  MakeTables(database);
  transaction.Commit();
}

}  // namespace

bool IsEmptyDatabase(Database& database) {
  return database.Integer("PRAGMA application_id") == 0 && database.Integer("PRAGMA user_version") == 0 &&
         !HasTables(database);
}

bool IsUnused(Database& database) {
  return !HasTables(database) || database.Integer("SELECT count(*) FROM history") == 0;
}

// Without an index this may be what a power cut left, or the moment before the index is made.
void WaitUntilMade(Database& database, bool had_index) {
  constexpr double kMoment = 0.1;
  Waiting waiting(had_index ? database.lock_timeout() : std::min(kMoment, database.lock_timeout()));
  for (int attempt = 0; IsBeingMade(database) && StillThere(database) && waiting.Pause(attempt);) ++attempt;
}

void PrepareToWrite(Database& database, bool sync) {
  // 64 MiB of cache: the pages that a save touches again and again. Deleted content need not be overwritten. What CHECK
  // asks is a list of words that are ours, of which SQLite would make a table for each row.
  database.Execute(
      "PRAGMA cache_size=-65536; PRAGMA secure_delete=OFF; PRAGMA foreign_keys=OFF; PRAGMA temp_store=MEMORY; "
      "PRAGMA ignore_check_constraints=ON");
  // EXTRA syncs the folder when the journal of a new store's first page goes. One that a power cut brought back would
  // undo that page, and with it all that stands in the log by then.
  database.Execute(sync ? "PRAGMA synchronous=EXTRA" : "PRAGMA synchronous=OFF");
  // As long as somebody saves without a log, the store cannot even be looked at.
  NamingHolder(database, [&] {
    if (IsEmptyDatabase(database)) CreateSchema(database);
    CheckIsStore(database, NewestVersion());
    database.UseLog();
  });
}

}  // namespace slamdb::sqlite
