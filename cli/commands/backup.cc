// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <memory>

#include "cli/commands/commands.h"
#include "cli/guard.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/formats/store/store.h"

namespace slamdb::cli {
namespace {

struct BackupOptions {
  StoreVerbOptions store;
  std::string target;
  bool overwrite = false;
};

ExitCode RunBackup(const BackupOptions& options, Console& console) {
  RequireOutput(options.target);
  detail::RefuseOnServer(options.store.path,
                         "pg_dump makes a copy, and 'slamdb sync' one in a file, with all revisions");
  Store::Open(options.store.path, options.store.wait).Backup(options.target, options.overwrite);
  std::error_code ignored;
  if (!console.quiet())
    console.Print("wrote " + options.target + " (" + HumanBytes(std::filesystem::file_size(options.target, ignored)) +
                  ")\n");
  return ExitCode::kDone;
}

Run AddBackup(CLI::App& verb) {
  const auto options = std::make_shared<BackupOptions>();
  AddStore(verb, options->store);
  AddOutputPlace(verb, options->target, Writes::kFile, "The copy to make");
  verb.add_flag("-O,--overwrite", options->overwrite, "Replace the output if it is there");
  return [options](Console& console) { return RunBackup(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb backup lab.db lab-backup.db", "A copy of the whole store as it is now."},
    {"slamdb backup -O lab.db /mnt/disk/lab.db", "Replaces yesterday's."},
    {"slamdb backup -O lab-backup.db lab.db", "Puts it back, also while others use lab.db."},
};

}  // namespace

const Command kBackup = {
    .name = "backup",
    .summary = "copy a store, also while others write to it",
    .group = Group::kStore,
    .description =
        R"(Copies a store as it is at this moment, with SQLite's online backup. Copying the file with cp while a program writes to it
may give a damaged copy. A new copy has the permissions of the store.

With --overwrite the store that is there becomes the copy in one transaction: whatever fails leaves it as it was. When another
program saves to it meanwhile, that save stays and nothing is replaced. What is no store is not replaced.)",
    .failed = "The store could not be read, or the copy not be written.",
    .examples = kExamples,
    .add = AddBackup,
};

}  // namespace slamdb::cli
