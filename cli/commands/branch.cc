// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "cli/commands/commands.h"
#include "cli/options.h"
#include "cli/revisions.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/store/report.h"

namespace slamdb::cli {
namespace {

struct BranchOptions {
  RevisionOptions from;
  std::string name;
  bool json = false;
};

// Also of STORE.db#NAME, where the store is the same.
std::string NameOfBranch(const std::string& text, const std::string& store) {
  const Location branch = Location::Parse(text);
  if (branch.name.empty() || branch.path == store) return branch.name.empty() ? text : branch.name;
  if (HoldsNamedAtlases(branch.path))
    RefuseUsage("NAME: a branch is in the store that it is made in, " + store + "; write '" + branch.name + "'");
  return text;
}

ExitCode RunBranch(BranchOptions options, Console& console) {
  const Location location = Location::Parse(options.from.atlas);
  options.name = NameOfBranch(options.name, location.path);
  Store store = OpenToChange(location.path, options.from.wait, console);
  const RevisionName from = store.FindRevision(location.name);
  store.Branch(location.name, options.name, {.threads = console.threads(), .progress = console.MakeProgress(false)});
  const std::string branch = location.path + "#" + options.name;
  if (options.json)
    console.PrintData(BranchAsJson(from, options.from.atlas, branch));
  else if (!console.quiet())
    console.Print(branch + " begins as " + from.ToString() + "\n");
  return ExitCode::kDone;
}

Run AddBranch(CLI::App& verb) {
  const auto options = std::make_shared<BranchOptions>();
  AddRevision(verb, options->from, "The atlas to begin as, or a revision of it");
  verb.add_option("NAME", options->name, "What the branch is called in the store")->type_name("NAME")->required();
  AddJson(verb, options->json);
  return [options](Console& console) { return RunBranch(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb branch lab.db#session_a robot7", "What robot 7 brings home is saved as lab.db#robot7."},
    {"slamdb branch lab.db#session_a@1 again", "Goes on from an earlier revision."},
};

}  // namespace

const Command kBranch = {
    .name = "branch",
    .summary = "begin another atlas of a store as a revision of one",
    .group = Group::kStore,
    .description =
        R"(Makes a new atlas that begins as another one, or as a revision of it, and remembers that: 'slamdb merge' of the two finds what
both come from. Keypoints and descriptors, most of the bytes, are stored once for both.)",
    .failed = "There is no such atlas or revision, the name is taken, or the store could not be written.",
    .examples = kExamples,
    .add = AddBranch,
};

}  // namespace slamdb::cli
