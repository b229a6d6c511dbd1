// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/fragments.h"

#include <memory>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/report/json.h"
#include "cli/report/layout.h"
#include "cli/report/part_report.h"

namespace slamdb::cli {
namespace {

struct FragmentVerbOptions {
  EditOptions edit;
  FragmentOptions fragments;
  std::string order = "as-is";
};

MapOrder OrderOf(const std::string& name) {
  return name == "size"   ? MapOrder::kSize
         : name == "time" ? MapOrder::kTime
         : name == "id"   ? MapOrder::kId
                          : MapOrder::kAsIs;
}

std::string TableText(const FragmentReport& report) {
  using enum Table::Align;
  Table table({kRight, kRight, kRight, kRight, kLeft});
  table.Add({"map", "keyframes", "points", "seconds", ""});
  for (const Fragment& map : report.maps)
    table.Add({std::to_string(map.id.value()), Grouped(map.keyframes), Grouped(map.points),
               Short(map.end_time - map.begin_time), map.kept ? "kept" : "dropped"});
  return table.ToString();
}

nlohmann::ordered_json MapsJson(const FragmentReport& report) {
  nlohmann::ordered_json maps = nlohmann::ordered_json::array();
  for (const Fragment& map : report.maps)
    maps.push_back({{"id", map.id.value()},
                    {"keyframes", map.keyframes},
                    {"points", map.points},
                    {"begin_time", map.begin_time},
                    {"end_time", map.end_time},
                    {"kept", map.kept}});
  return maps;
}

ExitCode RunFragments(const FragmentVerbOptions& options, Console& console) {
  Notices notices;
  Atlas atlas = ReadInput(options.edit, console, notices);
  const Totals before = Totals::Of(atlas);
  FragmentOptions fragments = options.fragments;
  fragments.order = OrderOf(options.order);
  const FragmentReport report = DropFragments(atlas, fragments, console.threads());
  WriteResult(atlas, options.edit, "fragments " + options.edit.input, console, notices);
  const Totals after = Totals::Of(atlas);
  nlohmann::ordered_json json = {{"maps", MapsJson(report)}};
  json.update(PartJson(before, after, report.removed));
  nlohmann::ordered_json order = nlohmann::ordered_json::array();
  for (const Map& map : atlas.maps) order.push_back(map.id.value());
  json["order"] = order;
  return FinishEdit(TableText(report) + PartText(before, after, report.removed), JsonText(json), options.edit, console,
                    notices);
}

Run AddFragments(CLI::App& verb) {
  const auto options = std::make_shared<FragmentVerbOptions>();
  AddEdit(verb, options->edit);
  verb.add_option("--min-keyframes", options->fragments.min_keyframes, "Drop maps with fewer; empty ones always go")
      ->type_name("N")
      ->check(CheckPositive)
      ->capture_default_str();
  verb.add_option("--largest", options->fragments.largest, "Keep only so many maps, those with most keyframes")
      ->type_name("N")
      ->check(CheckPositive);
  verb.add_option("--order", options->order,
                  "Order of the maps in the output: as they are, most keyframes first, earliest first, or by id")
      ->check(CLI::IsMember({"as-is", "size", "time", "id"}))
      ->capture_default_str();
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
    .description =
        R"(Every time ORB-SLAM3 loses track, and on every load, it opens a new map; those that never met the others again stay in the
atlas as fragments. This verb lists the maps, drops the small ones and writes the rest. Ids stay as they are.

ORB-SLAM3 never goes on in a loaded map by itself: it starts a new, empty one and joins a loaded one only when place
recognition merges the two. It sorts maps by id, so --order matters to other readers alone.)",
    .failed = "The input could not be read, no map would be left, or the output could not be written.",
    .lossy = "Done, but the output's format does not hold all of the atlas; standard error names what it lacks.",
    .examples = kExamples,
    .add = AddFragments,
};

}  // namespace slamdb::cli
