// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/split.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>

#include "cli/choices.h"
#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/report/layout.h"
#include "cli/report/part_text.h"
#include "cli/values.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/error.h"
#include "slamdb/base/output_name.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/many/names.h"

namespace slamdb::cli {
namespace {

struct SplitVerbOptions {
  EditOptions edit;
  SplitOptions split;
  Border border = Border::kSmart;
};

// `parts/{}.osa` and `out.osa` become `parts/map-3.osa` and `out-map-3.osa`, `lab.db#a` becomes `lab.db#a-map-3`, and a
// server without a name holds `map-3`.
std::string OutputOf(const std::string& pattern, const std::string& part) {
  if (const std::size_t hole = pattern.find("{}"); hole != std::string::npos)
    return pattern.substr(0, hole) + part + pattern.substr(hole + 2);
  Location location = Location::Parse(pattern);
  if (!location.name.empty()) {
    location.name += "-" + part;
    return location.ToString();
  }
  if (location.is_server()) return Location(location.path, part).ToString();
  const std::size_t suffix = location.path.size() - SuffixOf(location.path).size();
  return location.path.substr(0, suffix) + "-" + part + location.path.substr(suffix);
}

// A folder becomes a pattern of files in it: `parts/` and `parts`, `parts/{}.osa`.
std::string PatternOf(const std::string& output, const std::string& to) {
  if (!NamesFolder(output)) return output;
  const auto suffixes = FormatById(to.empty() ? "orbslam3" : to).suffixes;
  return output + (output.ends_with('/') ? "{}" : "/{}") +
         (suffixes.empty() ? std::string() : std::string(suffixes[0]));
}

// The names in stores, each of which is opened once.
using StoredNames = std::map<std::string, std::vector<std::string>>;

// Whether an atlas is there, in a file or under its name in a store.
bool IsThere(const Location& location, StoredNames& stored) {
  if (!location.is_server() && !std::filesystem::exists(location.path)) return false;
  if (location.name.empty()) return true;
  const auto [store, first] = stored.try_emplace(location.path);
  if (first && !Store::IsYetToBeMade(location.path)) store->second = Store::Open(location.path).Names();
  return std::ranges::find(store->second, location.name) != store->second.end();
}

// Before the first is written.
void RefuseBadOutputs(const SplitVerbOptions& options, const std::vector<Part>& parts) {
  if (options.edit.dry_run) return;
  StoredNames stored;
  for (const Part& part : parts) {
    const Location output = Location::Parse(OutputOf(options.edit.output, part.name));
    if (output.name.empty())
      RefuseBadTarget(output, FormatOfOutput(output, options.edit.target.to), options.edit.target);
    detail::RefuseInput(output.path, output.name.empty() ? std::nullopt : detail::AtlasName(output.name));
    if (!options.edit.target.overwrite && IsThere(output, stored))
      throw Error(ErrorKind::kAlreadyExists, output.ToString(), "", "is there already; -O/--overwrite replaces it");
  }
}

// Of one part: the pattern may have {} in the name of a folder.
void MakeFolderOf(const EditOptions& edit) {
  if (edit.dry_run || Location(edit.output).is_server()) return;
  if (const std::string folder = std::filesystem::path(edit.output).parent_path().string(); !folder.empty())
    MakeFolder(folder);
}

Atlas ReadWhole(const SplitVerbOptions& options, Console& console, Notices& notices) {
  if (options.edit.output == "-") RefuseUsage("several atlases do not fit into standard output; name files");
  RequireOutput(options.edit);
  return ReadAtlas(options.edit.input, MakeReadOptions(console, options.edit.from, options.edit.wait), &notices);
}

ExitCode RunSplit(SplitVerbOptions options, Console& console) {
  options.edit.output = PatternOf(options.edit.output, options.edit.target.to);
  Notices notices;
  const Atlas atlas = ReadWhole(options, console, notices);
  const AtlasIndex index(atlas);
  const std::vector<Part> parts = NamingFile(options.edit.input, [&] { return SplitAtlas(index, options.split); });
  RefuseBadOutputs(options, parts);
  Table table({Table::Align::kLeft, Table::Align::kRight, Table::Align::kRight});
  table.Add({"part", "keyframes", "points"});
  std::vector<TakenPart> taken;
  const Progress progress = console.MakeProgress();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Part& part = parts[i];
    progress("splitting", static_cast<double>(i) / static_cast<double>(parts.size()));
    SubsetReport removed;
    const Atlas own = TakePart(index, part, options.border, removed, console.threads());
    EditOptions edit = options.edit;
    edit.output = OutputOf(options.edit.output, part.name);
    edit.inputs = std::make_shared<InputSubstance>();  // a part may be as empty as its map
    MakeFolderOf(edit);
    WriteResult(own, edit, "split " + options.edit.input, console, notices);
    taken.push_back({.name = part.name, .output = FilesOf(edit).output, .counts = removed.after});
    table.Add({options.edit.dry_run ? part.name : edit.output, Grouped(removed.after.keyframes),
               Grouped(removed.after.points)});
  }
  EditOptions finish = options.edit;
  finish.dry_run = true;  // the table names the outputs
  return FinishEdit(table.ToString(), ToJson(taken, FilesOf(options.edit)), finish, console, notices);
}

Run AddSplit(CLI::App& verb) {
  const auto options = std::make_shared<SplitVerbOptions>();
  AddEdit(verb, options->edit, Writes::kPattern);
  verb.get_option("OUTPUT")->description(
      "Where to: a folder (a name without suffix), a file or STORE.db#NAME; the name of each part goes in place of {}, "
      "or behind the name");
  verb.add_option("--by", options->split.by,
                  "One atlas per map, per session (map that keyframes were made in), or per "
                  "connected part of the covisibility graph")
      ->type_name("PARTS")
      ->transform(OneOf(kSplitWays))
      ->default_str("map");
  verb.add_option("--min-keyframes", options->split.min_keyframes, "Leave out parts with fewer")
      ->type_name("N")
      ->check(Within(kPositive))
      ->capture_default_str();
  verb.add_option("--border", options->border, "Points that several parts observe: see 'slamdb extract --help'")
      ->type_name("BORDER")
      ->transform(OneOf(kBorders))
      ->default_str("smart");
  return [options](Console& console) { return RunSplit(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb split atlas.osa 'parts/{}.osa'", "Writes parts/map-0.osa, parts/map-1.osa, ..."},
    {"slamdb split atlas.osa maps", "The same into the folder maps, which is made."},
    {"slamdb split merged.osa lab.db#merged --by session",
     "Takes apart what was merged: lab.db#merged-session-0 and so on."},
    {"slamdb split atlas.osa big.osa --min-keyframes 20 --dry-run", "Which parts have 20 keyframes or more."},
};

}  // namespace

const Command kSplit = {
    .name = "split",
    .summary = "write each map, session or component as an atlas of its own",
    .group = Group::kChange,
    .description =
        R"(Writes one atlas for each map of an atlas, for each session (the map in which keyframes were made, which they keep
when maps are merged), or for each connected part of the covisibility graph. Every part is closed like those of
'slamdb extract'. Ids stay as they are, and so do the counters: putting the parts together again hands out no id twice.

A folder that is not there yet is made. No output is overwritten without -O, and when one is there, none is written.)",
    .failed = "The input could not be read, no part is left, or an output could not be written.",
    .lossy = kOutputLossy,
    .examples = kExamples,
    .add = AddSplit,
};

}  // namespace slamdb::cli
