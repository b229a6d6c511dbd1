// SPDX-License-Identifier: BSD-3-Clause
#include "cli/edit.h"

#include <memory>

#include "cli/commands/commands.h"
#include "cli/help/usage.h"
#include "cli/report/layout.h"
#include "slamdb/base/detail/open_end.h"
#include "slamdb/edit/tables/tables.h"

namespace slamdb::cli {
namespace {

struct EditVerbOptions {
  EditOptions edit;
  std::string points, keyframes, journal;
  bool delete_missing = false;
};

std::optional<Source> TableAt(const std::string& path) {
  return path.empty() ? std::nullopt : std::optional<Source>(path);
}

std::string Line(const TableEditChanges& changes, std::string_view noun) {
  std::string line = "  " + Counted(changes.rows, "row") + " of " + std::string(noun) + "s: " + Grouped(changes.moved) +
                     " moved, " + Grouped(changes.changed) + " changed otherwise";
  if (changes.deleted > 0) line += ", " + Grouped(changes.deleted) + " deleted";
  return line + "\n";
}

std::string TextOf(const TableEditReport& report, const TableEditOptions& tables, bool dry_run) {
  std::string text = dry_run ? "would edit\n" : "edited\n";
  if (tables.points) text += Line(report.points, "point");
  if (tables.keyframes) text += Line(report.keyframes, "keyframe");
  if (report.refreshed > 0) text += "  normals and distance ranges anew: " + Counted(report.refreshed, "point") + "\n";
  const SubsetReport& removed = report.removed;
  if (removed.keyframes + removed.points > 0)
    text += "  removed in all " + Counted(removed.keyframes, "keyframe") + ", " + Counted(removed.points, "point") +
            ", " + Counted(removed.observations, "observation") + "\n";
  return text;
}

ExitCode RunEdit(const EditVerbOptions& options, Console& console) {
  if (options.points.empty() && options.keyframes.empty())
    RefuseUsage("a table is missing; --points or --keyframes names one");
  SideFile journal(options.journal, options.edit);
  Notices notices;
  Atlas atlas = ReadInput(options.edit, console, notices);
  const TableEditOptions tables = {.points = TableAt(options.points),
                                   .keyframes = TableAt(options.keyframes),
                                   .delete_missing = options.delete_missing,
                                   .journal = journal.wanted() || options.edit.json,  // which counts its edits
                                   .threads = console.threads()};
  const TableEditReport report = EditByTables(atlas, tables);
  TellWarnings(report, tables, notices);
  if (journal.wanted()) journal.Write(ToJson(report.journal));
  WriteResult(atlas, options.edit, "edit " + options.edit.input, console, notices, &journal);
  return FinishEdit(TextOf(report, tables, options.edit.dry_run), ToJson(report, FilesOf(options.edit)), options.edit,
                    console, notices);
}

Run AddEditVerb(CLI::App& verb) {
  const auto options = std::make_shared<EditVerbOptions>();
  options->edit.needs = Content::kPoses | Content::kPoints;
  AddEdit(verb, options->edit);
  verb.add_option("--points", options->points, "A table of points as 'convert --to csv' writes it")->type_name("FILE");
  verb.add_option("--keyframes", options->keyframes, "A table of keyframes as 'convert --to csv-keyframes' writes it")
      ->type_name("FILE");
  verb.add_flag("--delete-missing", options->delete_missing,
                "Delete what has no row: the tables are whole, but for what is flagged bad, and for maps without rows");
  Mark(verb.add_option("--journal", options->journal, "Write every edit here, for 'slamdb repair --undo'"),
       Writes::kFile)
      ->type_name("FILE");
  return [options](Console& console) { return RunEdit(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb edit lab.osa moved.osa --points points.csv",
     "Points that were moved in the table, which 'slamdb convert lab.osa points.csv' wrote, move in the map."},
    {"slamdb edit lab.osa moved.osa --points points.csv --delete-missing --dry-run",
     "Says how many points without a row would go."},
    {"slamdb edit lab.db#map lab.db#edited --keyframes poses.keyframes.csv",
     "Poses of a table, from one atlas of a store to another."},
    {"slamdb edit lab.osa moved.osa --points points.csv --journal edit.json",
     "Keeps a journal, of which 'slamdb repair --undo edit.json' makes the map again, byte for byte."},
};

}  // namespace

const Command kEdit = {
    .name = "edit",
    .summary = "apply tables of points and keyframes",
    .group = Group::kChange,
    .description =
        R"(Gives the points and keyframes of an atlas what the rows of CSV tables say: write the tables with 'slamdb convert', change
them with anything, apply them. Values that are as they were change nothing, not a bit; empty cells and columns that
are not there neither. Rows without an entity are errors with their line; entities without a row stay, unless
--delete-missing says that the tables are whole. What deleting leaves open is closed as 'slamdb extract' does. The input
is never changed.)",
    .done = "Done.",
    .failed = "A table does not fit the atlas, or a file cannot be read or written; nothing was written.",
    .lossy = kOutputLossy,
    .examples = kExamples,
    .add = AddEditVerb};

}  // namespace slamdb::cli
