// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/report/layout.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/ids/origin.h"

namespace slamdb::cli {
namespace {

struct ReassignOptions {
  EditOptions edit;
  OriginOptions origin;
  std::vector<std::string> replace;
};

// `3=0`.
std::optional<std::pair<std::uint32_t, std::uint32_t>> ParseReplacement(std::string_view text) {
  const auto ids = detail::Split(text, '=');
  const auto from = detail::ParseNumber<std::uint32_t>(ids.front()),
             to = detail::ParseNumber<std::uint32_t>(ids.back());
  return ids.size() == 2 && from && to ? std::optional(std::pair(*from, *to)) : std::nullopt;
}

std::string CheckReplacement(const std::string& text) {
  return ParseReplacement(text) ? std::string() : "expected two map ids as FROM=TO, found '" + text + "'";
}

std::string Text(const OriginReport& report) {
  using enum Table::Align;
  Table table({kRight, kRight, kRight});
  table.Add({"origin map", "keyframes before", "after"});
  std::map<std::uint32_t, std::pair<std::uint64_t, std::uint64_t>> rows;
  for (const auto& [origin, count] : report.before) rows[origin].first = count;
  for (const auto& [origin, count] : report.after) rows[origin].second = count;
  for (const auto& [origin, counts] : rows)
    table.Add({std::to_string(origin), Grouped(counts.first), Grouped(counts.second)});
  std::string text = table.ToString() + Counted(report.changed, "keyframe") + " changed";
  if (!report.points_before.empty()) text += ", and " + Counted(report.points_changed, "point");
  if (report.next_map_after != report.next_map_before)
    text += "; the next map id is " + std::to_string(report.next_map_after) + " now, above every origin";
  return text + "\n";
}

ExitCode RunReassign(const ReassignOptions& options, Console& console) {
  OriginOptions origin = options.origin;
  for (const std::string& text : options.replace) origin.replace.push_back(*ParseReplacement(text));
  if (!origin.from_map && !origin.set && origin.replace.empty() && origin.shift == 0 && !origin.compact)
    RefuseUsage("nothing to do: give --from-map, --set, --map, --shift or --compact");
  Notices notices;
  Atlas atlas = ReadInput(options.edit, console, notices);
  const OriginReport report = ReassignOrigins(atlas, origin);
  WriteResult(atlas, options.edit, "reassign-origin " + options.edit.input, console, notices);
  return FinishEdit(Text(report), ToJson(report, FilesOf(options.edit)), options.edit, console, notices);
}

Run AddReassign(CLI::App& verb) {
  const auto options = std::make_shared<ReassignOptions>();
  options->edit.needs = Content::kObservations;
  AddEdit(verb, options->edit);
  auto* from_map = verb.add_flag("--from-map", options->origin.from_map,
                                 "Every keyframe and point was made in the map that it is in now");
  verb.add_option("--set", options->origin.set,
                  "Every keyframe, and point that records an origin, was made in this map")
      ->type_name("ID")
      ->excludes(from_map);
  verb.add_option("--map", options->replace, "What was made in map FROM was made in map TO; several at once")
      ->type_name("FROM=TO,...")
      ->delimiter(',')
      ->check(CheckReplacement);
  verb.add_option("--shift", options->origin.shift, "Add this to every origin; may be negative")->type_name("[-]N");
  verb.add_flag("--compact", options->origin.compact, "Number the origins 0, 1, 2, ... in their order");
  return [options](Console& console) { return RunReassign(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb reassign-origin merged.osa out.osa --map 3=0", "What map 3 made counts as made by map 0."},
    {"slamdb reassign-origin merged.osa out.osa --from-map", "Forgets merges: origins are the maps as they are now."},
    {"slamdb reassign-origin merged.osa --compact --dry-run", "Shows what --compact would do."},
};

}  // namespace

const Command kReassignOrigin = {
    .name = "reassign-origin",
    .summary = "change in which map keyframes were made",
    .group = Group::kChange,
    .description =
        R"(ORB-SLAM3 keeps with each keyframe the id of the map in which it was made, which stays when maps are merged: it tells
sessions apart. This verb sets, replaces, shifts or renumbers these ids, in the order --from-map, --set, --map, --shift,
--compact, and shows how many keyframes each origin has before and after. Nothing else changes, but for the next map id,
which stays above every origin. ORB-SLAM3's files hold no origins of map points.)",
    .failed = "The input could not be read, an origin does not exist, or the output not be written.",
    .lossy = kOutputLossy,
    .examples = kExamples,
    .add = AddReassign,
};

}  // namespace slamdb::cli
