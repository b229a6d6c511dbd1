// SPDX-License-Identifier: BSD-3-Clause
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands/commands.h"
#include "cli/options.h"
#include "cli/revisions.h"
#include "slamdb/formats/store/report.h"

namespace slamdb::cli {
namespace {

struct RemoveOptions {
  std::vector<std::string> atlases;
  double wait = kUsualWait;
  bool json = false;
};

void Remove(const std::string& atlas, const RemoveOptions& options, Console& console) {
  const Location location = Location::Parse(atlas);
  OpenToChange(location.path, options.wait, console).Remove(location.name);
  if (!console.quiet() && !options.json) console.Print("removed " + location.ToString() + "\n");
}

// Ends at the first that cannot be removed, and tells of those before it.
ExitCode RunRemove(const RemoveOptions& options, Console& console) {
  std::vector<std::string> removed;
  std::exception_ptr failure;
  try {
    for (const std::string& atlas : options.atlases) {
      Remove(atlas, options, console);
      removed.push_back(atlas);
    }
  } catch (...) {
    failure = std::current_exception();
  }
  if (options.json) console.PrintData(RemovedAsJson(removed));
  if (failure) std::rethrow_exception(failure);
  return ExitCode::kDone;
}

Run AddRemove(CLI::App& verb) {
  const auto options = std::make_shared<RemoveOptions>();
  verb.add_option("STORE#NAME", options->atlases, "The atlas to remove")
      ->type_name("FILE")
      ->required()
      ->check(WhyNoAtlasInAStore);
  AddJson(verb, options->json);
  AddWait(verb, options->wait);
  return [options](Console& console) { return RunRemove(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb remove lab.db#old", "Removes one atlas; its history stays."},
    {"slamdb remove lab.db#a lab.db#b && slamdb vacuum lab.db", "Removes two and makes the file smaller."},
};

}  // namespace

const Command kRemove = {
    .name = "remove",
    .summary = "remove an atlas from a store",
    .group = Group::kStore,
    .description =
        "Removes atlases from a store. That cannot be undone; 'slamdb backup' copies a store. The file keeps its "
        "size until 'slamdb vacuum'.",
    .failed = "There is no such atlas, or the store could not be written.",
    .examples = kExamples,
    .add = AddRemove,
};

}  // namespace slamdb::cli
