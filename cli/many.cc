// SPDX-License-Identifier: BSD-3-Clause
#include "cli/many.h"

#include <algorithm>

#include "cli/report/layout.h"

namespace slamdb::cli {
namespace {

// `12 other files, 1 hidden, 2 folders (-r looks into them)`; empty: nothing was left out.
std::string LeftOut(const SkippedFiles& skipped) {
  std::string text;
  const auto add = [&](std::uint64_t count, const std::string& what) {
    if (count > 0) text += (text.empty() ? "" : ", ") + what;
  };
  add(skipped.others, Counted(skipped.others, "other file"));
  add(skipped.hidden, Grouped(skipped.hidden) + " hidden");
  add(skipped.special, Grouped(skipped.special) + " that are no files");
  add(skipped.folders, Counted(skipped.folders, "folder") + " (-r looks into them)");
  return text;
}

}  // namespace

CLI::Option* AddMany(CLI::App& verb, ManyOptions& options) {
  CLI::Option* files =
      AddInputs(verb, options.inputs,
                "Atlases: files, folders, stores (also postgresql://USER@HOST/DATABASE), STORE.db#NAME, also "
                "with * and ? in the name, or - for standard input");
  verb.add_flag("-r,--recursive", options.recursive, "Look into folders of folders too");
  return files;
}

AtlasInputs FindInputs(const ManyOptions& options, Console& console, double wait) {
  AtlasInputs found = FindAtlases(options.inputs.paths, {.recursive = options.recursive,
                                                         .revisions = options.revisions,
                                                         .lock_timeout = wait,
                                                         .progress = console.MakeProgress(/*show=*/false)});
  const auto is_atlas = [](const AtlasInput& input) { return input.failure.empty(); };
  const std::string left_out = LeftOut(found.skipped);
  // Where nothing was found, the failures say so.
  if (!left_out.empty() && std::ranges::any_of(found.atlases, is_atlas)) console.Note("left out " + left_out);
  for (const std::string& store : found.empty_stores) console.Note(store + ": the store holds no atlas");
  return found;
}

}  // namespace slamdb::cli
