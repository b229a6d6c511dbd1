// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "cli/commands/commands.h"
#include "cli/options.h"
#include "slamdb/formats/store/report.h"

namespace slamdb::cli {
namespace {

struct MigrateVerbOptions {
  StoreVerbOptions store;
  bool back = false, dry_run = false, no_backup = false, json = false;
};

ExitCode RunMigrate(const MigrateVerbOptions& options, Console& console) {
  const bool is_server = Location(options.store.path).is_server();  // of which pg_dump makes a copy
  const MigrateReport report = MigrateStore(options.store.path, {.back = options.back,
                                                                 .dry_run = options.dry_run,
                                                                 .backup = !options.no_backup && !is_server,
                                                                 .lock_timeout = options.store.wait});
  if (options.json) {
    const bool is_done = report.from != report.to && !options.dry_run;
    console.PrintData(ToJson(report, options.store.path, is_done ? options.store.path : ""));
    return ExitCode::kDone;
  }
  if (console.quiet()) return ExitCode::kDone;
  std::string text = options.store.path + ": ";
  if (report.from == report.to) {
    text += "is of version " + std::to_string(report.to) + " already\n";
  } else {
    text += std::string(options.dry_run ? "would go" : "went") + " from version " + std::to_string(report.from) +
            " to " + std::to_string(report.to) + "\n";
  }
  for (const std::string& step : report.steps) text += "  " + step + "\n";
  if (!report.backup.empty()) text += "  the store as it was is in " + report.backup + "\n";
  console.Print(text);
  return ExitCode::kDone;
}

Run AddMigrate(CLI::App& verb) {
  const auto options = std::make_shared<MigrateVerbOptions>();
  AddStore(verb, options->store);
  verb.add_flag("-n,--dry-run", options->dry_run, "Only tell what would be done");
  verb.add_flag("--back", options->back, "Go one version back, for an earlier slamdb");
  verb.add_flag("--no-backup", options->no_backup, "Do not keep the store as it was");
  AddJson(verb, options->json);
  return [options](Console& console) { return RunMigrate(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb migrate lab.db --dry-run", "Which steps a store of an earlier slamdb needs."},
    {"slamdb migrate lab.db", "Takes them, and keeps the store as it was in lab.db.v1.bak."},
    {"slamdb migrate lab.db --back", "Makes a store that the slamdb before this one reads, if nothing in it is newer."},
};

}  // namespace

const Command kMigrate = {
    .name = "migrate",
    .summary = "bring a store of an earlier slamdb up to date",
    .group = Group::kStore,
    .description =
        R"(Brings the schema of a store to the version of this slamdb, in one transaction. Other verbs refuse a store of another
version and say so. A store that is up to date is left alone, and one of a newer slamdb is refused. With --back the store
goes one version back, which is refused where it holds what that version cannot.)",
    .failed = "The store could not be read or written, or it is of a newer slamdb.",
    .examples = kExamples,
    .add = AddMigrate,
};

}  // namespace slamdb::cli
