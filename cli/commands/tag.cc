// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <optional>

#include "cli/commands/commands.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "cli/revisions.h"
#include "slamdb/formats/store/report.h"

namespace slamdb::cli {
namespace {

struct TagOptions {
  RevisionOptions revision;
  std::optional<std::string> tag;
  bool remove = false, json = false;
};

ExitCode ListTags(const TagOptions& options, Console& console) {
  const Location location = Location::Parse(options.revision.atlas);
  Store store = Store::Open(location.path, options.revision.wait);
  const std::vector<HistoryEntry> entries = store.Log(store.FindRevision(location.name).atlas);
  if (options.json) {
    console.PrintData(TagsAsJson(entries, options.revision.atlas));
    return ExitCode::kDone;
  }
  using enum Table::Align;
  Table table({kLeft, kLeft, kLeft});
  for (const HistoryEntry& entry : entries)
    for (const std::string& tag : entry.tags)
      table.Add({tag, entry.atlas + "@" + std::to_string(entry.revision), entry.at});
  console.Print(table.empty() ? "no tags\n" : table.ToString());
  return ExitCode::kDone;
}

ExitCode RunTag(const TagOptions& options, Console& console) {
  if (!options.tag) {
    if (options.remove) RefuseUsage("--remove needs the tag to remove");
    return ListTags(options, console);
  }
  const Location location = Location::Parse(options.revision.atlas);
  Store store = OpenToChange(location.path, options.revision.wait, console);
  const RevisionName revision = store.FindRevision(location.name);
  if (options.remove)
    store.Untag(location.name, *options.tag);
  else
    store.Tag(location.name, *options.tag);
  if (options.json) return ListTags(options, console);
  if (!console.quiet())
    console.Print(options.remove ? "removed the tag " + *options.tag + " of " + revision.atlas + "\n"
                                 : location.path + "#" + revision.atlas + "@" + *options.tag + " is " +
                                       revision.ToString() + "\n");
  return ExitCode::kDone;
}

Run AddTag(CLI::App& verb) {
  const auto options = std::make_shared<TagOptions>();
  AddRevision(verb, options->revision, "The atlas, whose newest revision is meant, or a revision of it");
  verb.add_option("TAG", options->tag, "The name to give it; without one, the tags of the atlas are listed")
      ->type_name("TAG");
  verb.add_flag("--remove", options->remove, "Take the tag from the atlas instead");
  AddJson(verb, options->json);
  return [options](Console& console) { return RunTag(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb tag lab.db#session_a release", "The newest revision is lab.db#session_a@release from now on."},
    {"slamdb tag lab.db#session_a", "The tags of an atlas."},
};

}  // namespace

const Command kTag = {
    .name = "tag",
    .summary = "give a revision of an atlas a name",
    .group = Group::kStore,
    .description =
        "Names a revision: STORE.db#NAME@TAG reads it, and 'slamdb gc' leaves it. A tag stays where it is; to move "
        "one, remove "
        "it first.",
    .failed =
        "There is no such atlas, revision or tag, another revision has the tag, or the store could not be written.",
    .examples = kExamples,
    .add = AddTag,
};

}  // namespace slamdb::cli
