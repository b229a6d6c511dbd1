// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/ids/renumber.h"

#include <map>
#include <memory>

#include "cli/choices.h"
#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/report/layout.h"
#include "cli/values.h"
#include "slamdb/base/detail/open_end.h"
#include "slamdb/base/error.h"

namespace slamdb::cli {
namespace {

struct RenumberVerbOptions {
  EditOptions edit;
  RenumberOptions renumber;
  std::vector<std::string> kinds;
  std::string id_map, apply, undo, of;
};

// The ids that --apply or --undo brings.
IdMap GivenIds(const RenumberVerbOptions& options, Notices& notices) {
  const bool undoes = options.apply.empty();
  try {
    IdMap ids = ReadIdMap(undoes ? options.undo : options.apply, options.of, &notices);
    return undoes ? Inverse(ids) : ids;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kUsage && error.kind() != ErrorKind::kNotFound) throw;
    throw Error(error.kind(), error.path(), error.place(), error.problem() + " (--of names one)");
  }
}

IdMap Change(const RenumberVerbOptions& options, Atlas& atlas, Console& console, Notices& notices) {
  if (options.apply.empty() && options.undo.empty()) {
    RenumberOptions renumber = options.renumber;
    renumber.threads = console.threads();
    renumber.progress = console.MakeProgress();
    if (!options.kinds.empty()) renumber.kinds = IdKindsByName(options.kinds);
    IdMap ids = Renumber(atlas, renumber);
    ids.input = options.edit.input;
    return ids;
  }
  IdMap ids = GivenIds(options, notices);
  if (!ids.counters_before)
    notices.Warn(
        (options.apply.empty() ? options.undo : options.apply) +
        ": has no counters (next_map, next_keyframe, ...), with which id maps of `renumber` end: it may be cut "
        "there; those of the atlas rise above the new ids, and stay otherwise");
  ApplyIdMap(atlas, ids, console.threads());
  return ids;
}

std::string Text(const RenumberReport& report) {
  using enum Table::Align;
  Table table({kLeft, kRight, kRight, kRight});
  table.Add({"kind", "ids", "changed", "new ids"});
  for (const KindRenumbered& kind : report.kinds)
    table.Add({std::string(NameOf(kind.kind)), Grouped(kind.ids), Grouped(kind.changed),
               std::to_string(kind.first) + " to " + std::to_string(kind.last)});
  return table.ToString();
}

ExitCode Finish(const IdMap& ids, const RenumberVerbOptions& options, Console& console, const Notices& notices) {
  const RenumberReport report = SummaryOf(ids);
  return FinishEdit(Text(report), ToJson(report, FilesOf(options.edit)), options.edit, console, notices);
}

// A table instead of an atlas: only its ids change.
ExitCode RunOnTable(const RenumberVerbOptions& options, Console& console) {
  Notices notices;
  const IdMap ids = GivenIds(options, notices);
  RequireOutput(options.edit);
  const WholeFile file(options.edit.input);
  detail::WarnOfOpenEnd(file.text(), options.edit.input, notices);
  const std::string table = ApplyIdMapToCsv(file.text(), ids);
  if (!options.edit.dry_run) WriteOutput({options.edit.output, options.edit.target.overwrite}, table, console);
  return Finish(ids, options, console, notices);
}

ExitCode RunRenumber(const RenumberVerbOptions& options, Console& console) {
  const bool by_table = !options.apply.empty() || !options.undo.empty();
  if (!options.of.empty() && !by_table) RefuseUsage("--of names an input of the table that --apply or --undo gives");
  if (by_table && options.edit.input.ends_with(".csv")) return RunOnTable(options, console);
  SideFile id_map(options.id_map, options.edit);
  Notices notices;
  Atlas atlas = ReadInput(options.edit, console, notices);
  const IdMap ids = Change(options, atlas, console, notices);
  if (id_map.wanted()) id_map.Write(IdMapsToText({&ids, 1}, options.id_map));
  WriteResult(atlas, options.edit, "renumber " + options.edit.input, console, notices, &id_map);
  return Finish(ids, options, console, notices);
}

Run AddRenumber(CLI::App& verb) {
  const auto options = std::make_shared<RenumberVerbOptions>();
  AddEdit(verb, options->edit);
  verb.add_option(
          "--kinds", options->kinds,
          "What gets new ids, with commas between; by default all but frames, whose ids are those of the recording's "
          "images")
      ->type_name("KIND,...")
      ->delimiter(',')
      ->check(CLI::IsMember({"map", "keyframe", "point", "frame", "camera", "all"}));
  auto* start = verb.add_option("--start", options->renumber.start, "The first of the dense ids")
                    ->check(Within(kNonNegative))
                    ->type_name("ID")
                    ->capture_default_str();
  auto* offset = verb.add_option("--offset", options->renumber.offset, "Add this to every id instead; may be negative")
                     ->type_name("[-]N")
                     ->excludes(start);
  auto* order = verb.add_option("--order", options->renumber.order,
                                "Order of dense ids: 'id' keeps that of the old ids, 'time' takes that of the images, "
                                "'as-is' that of the file's lists")
                    ->type_name("ORDER")
                    ->transform(OneOf(kIdOrders))
                    ->excludes(offset);
  Mark(verb.add_option("--id-map", options->id_map, "Write which id became which, as CSV or (.json) JSON"),
       Writes::kFile)
      ->type_name("FILE");
  auto* apply = verb.add_option("--apply", options->apply,
                                "Change ids as this id map says; INPUT may then also be a CSV table with ids")
                    ->type_name("FILE");
  auto* undo = verb.add_option("--undo", options->undo, "Change ids back as they were before this id map")
                   ->type_name("FILE")
                   ->excludes(apply);
  for (auto* by_table : {apply, undo}) by_table->excludes(start)->excludes(offset)->excludes(order);
  verb.add_option("--of", options->of, "Of an id map with several inputs, take the ids of this one")
      ->type_name("INPUT");
  return [options](Console& console) { return RunRenumber(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb renumber session_a.osa dense.osa --id-map ids.csv",
     "Ids without gaps, and a table of which became which."},
    {"slamdb renumber dense.osa again.osa --undo ids.csv", "And back: again.osa has the bytes of session_a.osa."},
    {"slamdb renumber keyframes.csv dense.csv --apply ids.csv", "The same for a table of keyframes made from it."},
    {"slamdb renumber b.osa b1000.osa --offset 1000 --kinds keyframe",
     "Leaves room below for another robot's keyframes."},
};

}  // namespace

const Command kRenumber = {
    .name = "renumber",
    .summary = "give maps, keyframes, points, frames and cameras new ids",
    .group = Group::kChange,
    .description =
        R"(Gives entities dense ids (0, 1, 2, ... or from --start), or adds an offset to them, and moves every reference along.
Ids of entities long gone that are still named somewhere, such as the keyframe that made a point, get ids behind those
that are there, so that nothing is mixed up and --undo gives the original bytes back.

With --id-map the new ids are written as a table, which --apply applies to another atlas, or to a CSV table that
'slamdb convert' made, and --undo undoes.)",
    .failed = "An input could not be read, an id map does not fit, or the output not be written.",
    .lossy = kOutputLossy,
    .examples = kExamples,
    .add = AddRenumber,
};

}  // namespace slamdb::cli
