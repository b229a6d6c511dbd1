// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/migrations.h"

#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/sqlite/detail/backup.h"
#include "slamdb/formats/sqlite/detail/identity.h"
#include "slamdb/formats/sqlite/detail/list_order.h"
#include "slamdb/formats/sqlite/detail/pictures.h"
#include "slamdb/formats/sqlite/detail/place_words.h"
#include "slamdb/formats/sqlite/detail/summary.h"
#include "slamdb/formats/sqlite/detail/writer_lock.h"

namespace slamdb::sqlite {
namespace {

// Copies the store to `<path>.v<version>.bak`, or with a number behind it when that is taken. Nobody writes meanwhile:
// the caller has the lock, on a connection that for that reason cannot be copied from.
std::string BackUp(const std::string& path, int version, double lock_timeout) {
  Database source(path, Access::kRead, lock_timeout);
  const std::string name = detail::Concat(path, ".v", version, ".bak");
  for (int i = 1;; ++i) {
    const std::string target = i == 1 ? name : detail::Concat(name, ".", i);
    try {
      BackupTo(source, target, false);
      return target;
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kAlreadyExists) throw;
    }
  }
}

void RecordMigration(Database& database, const MigrateReport& report) {
  Statement insert(database, "INSERT INTO history (at, tool, action, provenance) VALUES (?1, ?2, 'migrate', ?3)",
                   "table history");
  const std::string now = TimeOfDay(), tool = ToolName();
  const std::string what = "version " + std::to_string(report.from) + " to " + std::to_string(report.to);
  insert.BindText(1, now).BindText(2, tool).BindText(3, what).Run();
}

void Stamp(Database& database, int version) {
  database.Execute("PRAGMA application_id=" + std::to_string(kApplicationId));
  database.Execute("PRAGMA user_version=" + std::to_string(version));
}

void RunStepBack(Database& database, const Migration& migration) {
  if (migration.number == kFirstVersionWithRevisions) {
    MakeListsAscend(database);
    JoinAllFeatures(database);
  }
  database.Execute(std::string(migration.back));
  database.Execute("PRAGMA user_version=" + std::to_string(migration.number - 1));
}

// Takes the step and takes it back again, so that a refusal comes before anything is written.
void TryStepBack(const std::string& path, const MigrateOptions& options, const Migration& migration) {
  Database database(path, Access::kWrite, options.lock_timeout);
  const WriteTransaction rolled_back(database);
  RunStepBack(database, migration);
}

// Which steps lead from `from` to where the options want to go.
void PlanSteps(const MigrateOptions& options, std::span<const Migration> migrations, MigrateReport& report) {
  const Migration& last = migrations.back();
  report.to = options.back ? std::min(report.from, last.number - 1) : last.number;
  if (report.to < report.from) report.steps.emplace_back(std::string(last.name) + ".back");
  for (const Migration& migration : migrations) {
    if (migration.number > report.from && !options.back) report.steps.emplace_back(migration.name);
  }
}

}  // namespace

int NewestVersion() { return Migrations().back().number; }

int VersionOf(Database& database) { return static_cast<int>(database.Integer("PRAGMA user_version")); }

void MakeTables(Database& database) {
  for (const char* statement : NewestSchema()) database.Execute(statement);
  Stamp(database, NewestVersion());
}

void RunMigrations(Database& database, std::span<const Migration> migrations) {
  const int version = VersionOf(database);
  for (const Migration& migration : migrations) {
    if (migration.number > version) database.Execute(std::string(migration.sql));
  }
  Stamp(database, migrations.back().number);
}

MigrateReport Migrate(const std::string& path, const MigrateOptions& options, std::span<const Migration> migrations) {
  MigrateReport report;
  {
    Database database(path, Access::kRead, options.lock_timeout);
    CheckIsStore(database, migrations.back().number, Older::kAccept);
    report.from = VersionOf(database);
  }
  PlanSteps(options, migrations, report);
  if (options.back && report.steps.empty())
    throw Error(
        ErrorKind::kNotPossible, path, "",
        detail::Concat("is of version ", report.from, " and cannot go further back: this slamdb goes back from ",
                       "its own version, ", migrations.back().number, ", alone"));
  if (!report.steps.empty() && options.back && migrations.back().back.empty())
    throw Error(ErrorKind::kNotPossible, path, "", "there is no way back from version " + std::to_string(report.from));
  if (!report.steps.empty() && options.back) TryStepBack(path, options, migrations.back());
  if (report.steps.empty() || options.dry_run) return report;

  Database database(path, Access::kWrite, options.lock_timeout);
  WriteTransaction transaction(database);
  if (VersionOf(database) != report.from)
    throw Error(ErrorKind::kLocked, path, "", "migrated by another program meanwhile");
  if (options.backup) report.backup = BackUp(path, report.from, options.lock_timeout);
  if (options.back)
    RunStepBack(database, migrations.back());
  else
    RunMigrations(database, migrations);
  if (report.from < kFirstVersionWithRevisions && report.to >= kFirstVersionWithRevisions) SplitAllFeatures(database);
  if (report.to >= kFirstVersionWithSummaries) SaveMissingSummaries(database);
  if (report.from < kFirstVersionWithPlaces && report.to >= kFirstVersionWithPlaces) RebuildPlaceWords(database);
  RecordMigration(database, report);
  transaction.Commit();
  return report;
}

}  // namespace slamdb::sqlite
