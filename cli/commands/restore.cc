// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "cli/commands/commands.h"
#include "cli/options.h"
#include "cli/revisions.h"
#include "slamdb/formats/store/report.h"

namespace slamdb::cli {
namespace {

struct RestoreOptions {
  RevisionOptions revision;
  bool json = false;
};

ExitCode RunRestore(const RestoreOptions& options, Console& console) {
  const Location location = Location::Parse(options.revision.atlas);
  Store store = OpenToChange(location.path, options.revision.wait, console);
  const RevisionName restored = store.FindRevision(location.name);
  const SaveReport report =
      store.Restore(location.name, {.threads = console.threads(), .progress = console.MakeProgress(false)});
  if (options.json)
    console.PrintData(RestoreAsJson(report, restored, options.revision.atlas));
  else if (!console.quiet())
    console.Print(location.path + "#" + restored.atlas + "@" + std::to_string(report.revision) + " is " +
                  restored.ToString() + (report.unchanged ? " already\n" : " again\n"));
  return ExitCode::kDone;
}

Run AddRestore(CLI::App& verb) {
  const auto options = std::make_shared<RestoreOptions>();
  AddRevision(verb, options->revision, "The revision to go back to: NAME@3, NAME@-1, NAME@{2026-11-20}, NAME@TAG");
  AddJson(verb, options->json);
  return [options](Console& console) { return RunRestore(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb restore fleet.db#robot7@1", "Makes the first revision the newest again."},
    {"slamdb restore fleet.db#robot7@-1", "Takes the last save back."},
};

}  // namespace

const Command kRestore = {
    .name = "restore",
    .summary = "make an earlier revision of an atlas the newest again",
    .group = Group::kStore,
    .description =
        "Saves a revision of an atlas anew, as its newest. Those between stay: 'slamdb log' shows them, and restoring "
        "can be "
        "taken back the same way. To look at a revision, read it: every verb takes STORE.db#NAME@3.",
    .failed = "There is no such revision, it is damaged, or the store could not be written.",
    .examples = kExamples,
    .add = AddRestore,
};

}  // namespace slamdb::cli
