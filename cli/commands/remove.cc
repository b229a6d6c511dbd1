// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "cli/commands/commands.h"
#include "cli/options.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/store/store.h"

namespace slamdb::cli {
namespace {

struct RemoveOptions {
  std::vector<std::string> atlases;
  double wait = kUsualWait;
};

std::string CheckName(const std::string& text) {
  if (!Location::Parse(text).name.empty()) return {};
  return "expected STORE.db#NAME or postgresql://USER@HOST/DATABASE#NAME, found '" + text + "'";
}

ExitCode RunRemove(const RemoveOptions& options, Console& console) {
  for (const std::string& text : options.atlases) {
    const Location location = Location::Parse(text);
    Store::Open(location.path);  // a name that is mistyped must not make a store
    Store::OpenForWriting(location.path, {.lock_timeout = options.wait, .progress = console.MakeProgress(false)})
        .Remove(location.name);
    if (!console.quiet()) console.Print("removed " + location.ToString() + "\n");
  }
  return ExitCode::kDone;
}

Run AddRemove(CLI::App& verb) {
  const auto options = std::make_shared<RemoveOptions>();
  verb.add_option("STORE#NAME", options->atlases, "The atlas to remove")
      ->type_name("FILE")
      ->required()
      ->check(CheckName);
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
