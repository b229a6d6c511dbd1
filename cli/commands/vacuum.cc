// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "cli/commands/commands.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/formats/store/store.h"

namespace slamdb::cli {
namespace {

ExitCode RunVacuum(const StoreVerbOptions& options, Console& console) {
  detail::RefuseOnServer(options.path, "the server gives space back by itself, or when told to, as VACUUM does in SQL");
  const std::uint64_t before = Store::Open(options.path, options.wait).Stats().file_bytes;
  Store store =
      Store::OpenForWriting(options.path, {.lock_timeout = options.wait, .progress = console.MakeProgress(false)});
  store.Vacuum();
  if (!console.quiet())
    console.Print(options.path + ": " + HumanBytes(before) + " before, " + HumanBytes(store.Stats().file_bytes) +
                  " now\n");
  return ExitCode::kDone;
}

Run AddVacuum(CLI::App& verb) {
  const auto options = std::make_shared<StoreVerbOptions>();
  AddStore(verb, *options);
  return [options](Console& console) { return RunVacuum(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb vacuum lab.db", "After atlases were removed."},
    {"slamdb vacuum lab.db --wait 60", "With a minute's patience for another program that writes."},
};

}  // namespace

const Command kVacuum = {
    .name = "vacuum",
    .summary = "give free space of a store back to the disk",
    .group = Group::kStore,
    .description =
        "Rewrites a store without its free pages. While it runs it needs as much free disk space as the store takes, "
        "once "
        "beside it and once in the folder of temporary files (SQLITE_TMPDIR, else TMPDIR, /var/tmp or /tmp).",
    .failed = "The store could not be written, or another program uses it.",
    .examples = kExamples,
    .add = AddVacuum,
};

}  // namespace slamdb::cli
