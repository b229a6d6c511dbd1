// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <memory>

#include "cli/commands/commands.h"
#include "cli/console.h"
#include "cli/help/help.h"
#include "cli/help/manual.h"
#include "cli/help/tree.h"
#include "cli/options.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/base/error.h"

namespace slamdb::cli {
namespace {

struct ManOptions {
  std::string verb;
  std::string folder;
};

void WritePage(const CLI::App& app, const std::string& folder) {
  AtomicFile file(folder + "/" + ManualPageName(app), {.overwrite = true, .sync = false});
  file.Write(ManualPage(app));
  file.Commit();
}

ExitCode RunMan(const CLI::App& program, const ManOptions& options, Console& console) {
  if (!options.folder.empty()) {
    std::filesystem::create_directories(options.folder);
    WritePage(program, options.folder);
    for (const CLI::App* verb : VerbsOf(program)) WritePage(*verb, options.folder);
    return ExitCode::kDone;
  }
  if (options.verb.empty()) {
    console.PrintData(ManualPage(program));
    return ExitCode::kDone;
  }
  for (const CLI::App* verb : VerbsOf(program)) {
    if (verb->get_name() != options.verb) continue;
    console.PrintData(ManualPage(*verb));
    return ExitCode::kDone;
  }
  RefuseUsage("unknown verb '" + options.verb + "'");
}

Run AddMan(CLI::App& verb) {
  const auto options = std::make_shared<ManOptions>();
  verb.add_option("VERB", options->verb, "The verb; without it the page of slamdb itself");
  verb.add_option("--folder", options->folder, "Write every page into this folder")->type_name("FOLDER");
  const CLI::App* program = verb.get_parent();
  return [options, program](Console& console) { return RunMan(*program, *options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb man check | man -l -", "Reads the manual page of a verb where it is not installed."},
    {"slamdb man --folder build/man", "What the build installs."},
};

}  // namespace

const Command kMan = {
    .name = "man",
    .summary = "print a manual page in roff",
    .description = "Prints the manual page of slamdb or of one of its verbs, made from the options as they are parsed.",
    .failed = "No such verb, or the page could not be written.",
    .examples = kExamples,
    .add = AddMan,
    .hidden = true,
    .tells_of_all = true,
};

}  // namespace slamdb::cli
