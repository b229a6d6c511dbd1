// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/fragments.h"

#include <map>
#include <memory>

#include "cli/choices.h"
#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/report/layout.h"
#include "cli/report/part_text.h"
#include "cli/values.h"

namespace slamdb::cli {
namespace {

struct FragmentVerbOptions {
  EditOptions edit;
  FragmentOptions fragments;
};

std::string TableText(const FragmentReport& report) {
  using enum Table::Align;
  Table table({kRight, kRight, kRight, kRight, kLeft});
  table.Add({"map", "keyframes", "points", "seconds", ""});
  for (const Fragment& map : report.maps)
    table.Add({std::to_string(map.id.value()), Grouped(map.keyframes), Grouped(map.points),
               Short(map.end_time - map.begin_time), map.kept ? "kept" : "dropped"});
  return table.ToString();
}

ExitCode RunFragments(const FragmentVerbOptions& options, Console& console) {
  Notices notices;
  Atlas atlas = ReadInput(options.edit, console, notices);
  FragmentOptions fragments = options.fragments;
  fragments.threads = console.threads();
  fragments.progress = console.MakeProgress();
  const FragmentReport report = DropFragments(atlas, fragments);
  WriteResult(atlas, options.edit, "fragments " + options.edit.input, console, notices);
  return FinishEdit(TableText(report) + PartText(report.removed), ToJson(report, FilesOf(options.edit)), options.edit,
                    console, notices);
}

Run AddFragments(CLI::App& verb) {
  const auto options = std::make_shared<FragmentVerbOptions>();
  options->edit.needs = Content::kObservations | Content::kLandmarks;
  AddEdit(verb, options->edit);
  verb.add_option("--min-keyframes", options->fragments.min_keyframes, "Drop maps with fewer; empty ones always go")
      ->type_name("N")
      ->check(Within(kPositive))
      ->capture_default_str();
  verb.add_option("--largest", options->fragments.largest, "Keep only so many maps, those with most keyframes")
      ->type_name("N")
      ->check(Within(kPositive));
  verb.add_option("--order", options->fragments.order,
                  "Order of the maps in the output: as they are, most keyframes first, earliest first, or by id")
      ->type_name("ORDER")
      ->transform(OneOf(kMapOrders))
      ->default_str("as-is");
  return [options](Console& console) { return RunFragments(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb fragments atlas.osa clean.osa", "Drops empty maps, which ORB-SLAM3 leaves behind on every load."},
    {"slamdb fragments atlas.osa clean.osa --min-keyframes 10", "And those that tracking lost at once."},
    {"slamdb fragments atlas.osa one.osa --largest 1", "The largest map alone."},
};

}  // namespace

const Command kFragments = {
    .name = "fragments",
    .summary = "drop empty and small maps of an atlas, and order the others",
    .group = Group::kChange,
    .description =
        R"(Every time ORB-SLAM3 loses track, and on every load, it opens a new map; those that never met the others again stay in the
atlas as fragments. This verb lists the maps, drops the small ones and writes the rest. Ids stay as they are.

ORB-SLAM3 never goes on in a loaded map by itself: it starts a new, empty one and joins a loaded one only when place
recognition merges the two. It sorts maps by id, so --order matters to other readers alone.)",
    .failed = "The input could not be read, no map would be left, or the output could not be written.",
    .lossy = kOutputLossy,
    .examples = kExamples,
    .add = AddFragments,
};

}  // namespace slamdb::cli
