// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/diff/diff.h"

#include <memory>

#include "cli/commands/commands.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "cli/report/similarity.h"
#include "cli/values.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/layouts/layout.h"

namespace slamdb::cli {
namespace {

using Verdict = AtlasDiff::Verdict;

struct DiffVerbOptions {
  std::string before, after;
  InputFormat from;
  double tolerance = 0;
  bool ignore_ids = false, summary = false, json = false;
  std::optional<std::size_t> max_listed;
  double wait = kUsualWait;
};

std::string Joined(const std::vector<std::string>& parts, std::string_view separator = ", ") {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : std::string(separator)) + part;
  return text;
}

// `6 removed, 2 added`, without what is zero.
std::string Counts(const std::vector<std::pair<std::uint64_t, std::string_view>>& counts) {
  std::vector<std::string> parts;
  for (const auto& [count, what] : counts)
    if (count > 0) parts.push_back(Grouped(count) + " " + std::string(what));
  return Joined(parts);
}

std::string Line(std::string_view what, std::uint64_t before, std::uint64_t after, const std::string& counts) {
  return std::string(what) + ": " + Grouped(before) + " -> " + Grouped(after) + (counts.empty() ? "" : "; " + counts) +
         "\n";
}

std::string Listed(std::string_view what, const std::vector<EntityName>& names, bool with_map, std::size_t most) {
  if (names.empty() || most == 0) return {};
  std::string text = "  " + std::string(what) + ":";
  for (std::size_t i = 0; i < std::min(names.size(), most); ++i)
    text += " " + (with_map ? std::to_string(names[i].map) + "/" : std::string()) + std::to_string(names[i].id);
  return text + (names.size() > most ? " ..." : "") + "\n";
}

// Ids stand behind their map's where there are several maps.
std::string EntityText(std::string_view what, const EntityDiff& diff, bool with_map, std::size_t most) {
  const std::string counts = Counts({{diff.removed.size(), "removed"},
                                     {diff.added.size(), "added"},
                                     {diff.changed, "changed"},
                                     {diff.changed_map, "in another map"},
                                     {diff.renumbered, "renumbered"}});
  std::string text = Line(what, diff.before, diff.after, counts);
  if (!diff.changes.empty()) {
    std::vector<std::string> aspects;
    for (const AspectCount& change : diff.changes)
      aspects.push_back(std::string(change.aspect) + " " + Grouped(change.count));
    text += "  changed: " + Joined(aspects) + "\n";
  }
  return text + Listed("removed", diff.removed, with_map, most) + Listed("added", diff.added, with_map, most);
}

std::string DistancesText(const Distribution& distances, std::string_view unit) {
  return "median " + Short(distances.median) + ", max " + Short(distances.max) + std::string(unit);
}

std::string MotionText(const MapMotion& motion) {
  std::string text = ToString(motion.before) + " moved:\n";
  if (motion.keyframes > 0)
    text += "  " + Counted(motion.keyframes, "keyframe") + " by " + DistancesText(motion.keyframe_distance, "") +
            "; turned by " + DistancesText(motion.keyframe_degrees, " degrees") + "\n";
  if (motion.points > 0)
    text += "  " + Counted(motion.points, "point") + " by " + DistancesText(motion.point_distance, "") + "\n";
  if (motion.after_from_before)
    text += "  as a whole: " + SimilarityText(*motion.after_from_before) +
            "; what is left: " + DistancesText(motion.rest, "") + "\n";
  return text;
}

// An atlas may hold all of a layout, which is long.
std::string LayoutName(const std::string& layout) {
  if (layout.empty()) return KnownLayouts().front().id;
  try {
    const std::string id = LayoutOf(layout).id;
    return id.empty() ? "a layout of its own" : id;
  } catch (const Error&) {
    return "a layout that is none";
  }
}

std::string FieldText(const FieldDiff& field) {
  if (field.field != "layout") return field.before + " -> " + field.after;
  const std::string before = LayoutName(field.before), after = LayoutName(field.after);
  return before + " -> " + (before == after ? "another, called the same" : after);
}

std::string FieldsText(const std::vector<FieldDiff>& fields, std::string_view prefix = {}) {
  std::string text;
  for (const FieldDiff& field : fields) text += std::string(prefix) + field.field + ": " + FieldText(field) + "\n";
  return text;
}

std::string TextOf(const AtlasDiff& diff, const DiffVerbOptions& options) {
  constexpr std::size_t kListed = 10;
  const std::size_t most = options.max_listed.value_or(kListed);
  const bool with_map = diff.maps.before > 1 || diff.maps.after > 1;
  std::string text = diff.verdict() == Verdict::kSame         ? "the same\n"
                     : diff.verdict() == Verdict::kRenumbered ? "renumbered only\n"
                                                              : "different\n";
  text += EntityText("maps", diff.maps, false, most) + EntityText("cameras", diff.cameras, false, most) +
          EntityText("keyframes", diff.keyframes, with_map, most) + EntityText("points", diff.points, with_map, most);
  for (const LinkDiff& link : diff.links)
    if (!link.same())
      text += Line(link.kind, link.before, link.after,
                   Counts({{link.removed, "removed"}, {link.added, "added"}, {link.changed, "changed"}}));
  for (const MapMotion& motion : diff.motions)
    if (motion.moved()) text += MotionText(motion);
  text += FieldsText(diff.fields) + FieldsText(diff.numbering);
  if (diff.other_ids > 0) text += "ids of frames or culled keyframes: differ in " + Grouped(diff.other_ids) + "\n";
  return text + FieldsText(diff.encoding, "encoding, which does not count: ");
}

std::string SummaryOf(const AtlasDiff& diff) {
  std::string line(NameOf(diff.verdict()));
  const auto add = [&line](std::string_view name, std::uint64_t removed, std::uint64_t added, std::uint64_t changed) {
    line += " " + std::string(name) + "=-" + std::to_string(removed) + "+" + std::to_string(added) + "~" +
            std::to_string(changed);
  };
  const auto add_entities = [&](std::string_view name, const EntityDiff& entities) {
    add(name, entities.removed.size(), entities.added.size(), entities.changed);
  };
  add_entities("maps", diff.maps);
  add_entities("cameras", diff.cameras);
  add_entities("keyframes", diff.keyframes);
  add_entities("points", diff.points);
  LinkDiff links;
  for (const LinkDiff& link : diff.links) {
    links.removed += link.removed;
    links.added += link.added;
    links.changed += link.changed;
  }
  add("links", links.removed, links.added, links.changed);
  line += " fields=" + std::to_string(diff.fields.size());
  line += " renumbered=" + std::to_string(diff.maps.renumbered + diff.cameras.renumbered + diff.keyframes.renumbered +
                                          diff.points.renumbered);
  return line + "\n";
}

std::string JsonOf(const AtlasDiff& diff, const DiffVerbOptions& options) {
  DiffReportOptions report{.before = options.before, .after = options.after};
  report.max_listed = options.max_listed.value_or(report.max_listed);
  return ToJson(diff, report);
}

ExitCode RunDiff(const DiffVerbOptions& options, Console& console) {
  const ReadOptions read = MakeReadOptions(console, options.from, options.wait);
  Notices notices;
  Atlas before = ReadAtlas(options.before, read, &notices);
  Atlas after = ReadAtlas(options.after, read, &notices);
  if (KeepWhatCloudsHold(before, after)) notices.Note("compares points alone, as one of the inputs holds no more");
  const AtlasDiff diff =
      DiffAtlases(before, after,
                  {.tolerance = options.tolerance, .threads = console.threads(), .progress = console.MakeProgress()});
  console.Report(notices);
  if (options.json)
    console.PrintData(JsonOf(diff, options));
  else if (options.summary)
    console.Print(SummaryOf(diff));
  else if (!console.quiet())
    console.Print(TextOf(diff, options));
  const bool equal = diff.verdict() == Verdict::kSame || (options.ignore_ids && diff.verdict() == Verdict::kRenumbered);
  return equal ? ExitCode::kDone : ExitCode::kFailed;
}

Run AddDiff(CLI::App& verb) {
  const auto options = std::make_shared<DiffVerbOptions>();
  verb.add_option("BEFORE", options->before, AtlasAt("An atlas"))->type_name("FILE")->required();
  verb.add_option("AFTER", options->after, "The atlas to compare it with")->type_name("FILE")->required();
  AddFrom(verb, options->from);
  AddWait(verb, options->wait);
  verb.add_option(
          "--tolerance", options->tolerance,
          "Numbers are the same when they differ by at most this times the larger of 1 and their size; 1e-5 lets "
          "pass what single precision rounds")
      ->type_name("FRACTION")
      ->check(Within(kNonNegative))
      ->capture_default_str();
  verb.add_flag("--ignore-ids", options->ignore_ids, "Atlases that are only renumbered count as the same");
  CLI::Option* json = verb.add_flag("--json", options->json, "Print JSON, for programs");
  verb.add_flag("--summary", options->summary, "Print one line, for scripts: verdict and -removed+added~changed")
      ->excludes(json);
  verb.add_option("--max-listed", options->max_listed,
                  "Ids to list of what was removed and added; by default 10 as text, 1000 as JSON")
      ->type_name("N");
  return [options](Console& console) { return RunDiff(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb diff before.osa after.osa", "What changed."},
    {"slamdb diff a.osa lab.db#a --quiet", "Only the exit code, across formats."},
    {"slamdb diff a.osa renumbered.osa --ignore-ids --summary",
     "One line, beginning with same, renumbered or different."},
    {"slamdb diff a.osa there_and_back.osa --tolerance 1e-5", "Lets float noise pass."},
};

}  // namespace

const Command kDiff = {
    .name = "diff",
    .summary = "compare two atlases by what they mean",
    .group = Group::kLook,
    .description =
        R"(Tells what was removed, added, moved, changed or renumbered from one atlas to the other. Entities are recognised by content,
whatever their ids: keyframes by descriptors and time, points by descriptor and by who sees them where, maps by their
keyframes. Of a point cloud (PLY, PCD, XYZ) and an atlas points alone are compared, by position, then id. References are the same when they lead to the same entity. The order of lists does not count, and neither does
how the files are encoded.

An error prints nothing on standard output; a comparison always prints there, unless --quiet.)",
    .done = "The atlases are the same, or with --ignore-ids only renumbered.",
    .failed = "The atlases differ.",
    .examples = kExamples,
    .add = AddDiff,
    .trouble = "Trouble: the command line was wrong, or an input could not be read.",
};

}  // namespace slamdb::cli
