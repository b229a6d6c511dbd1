// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/extract.h"

#include <algorithm>
#include <map>
#include <memory>

#include "cli/choices.h"
#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/report/part_text.h"
#include "cli/values.h"
#include "slamdb/base/detail/text.h"

namespace slamdb::cli {
namespace {

struct ExtractVerbOptions {
  EditOptions edit;
  SelectionOptions selection;
  std::vector<std::uint64_t> keyframes;
  std::string polygon, plane = "auto", region = "both";
  Border border = Border::kSmart;
  std::optional<std::uint32_t> session;
  std::optional<std::size_t> component;
  std::size_t every = 1;
  bool except = false;

  bool SelectsSomething() const {
    return selection.map || !selection.keyframes.empty() || !selection.time.empty() || !selection.box.empty() ||
           !keyframes.empty() || !polygon.empty() || session || component || every > 1;
  }
};

// `X,Y X,Y ...`, corners apart by spaces or semicolons. Empty when it is not that.
std::vector<Eigen::Vector2f> ParsePolygon(std::string_view text) {
  std::vector<Eigen::Vector2f> corners;
  constexpr std::string_view kSeparators = " ;";
  for (auto corner = detail::TakeWord(text, kSeparators); !corner.empty();
       corner = detail::TakeWord(text, kSeparators)) {
    const auto place = detail::Split(corner, ',');
    const auto x = detail::ParseNumber<float>(place.front()), y = detail::ParseNumber<float>(place.back());
    if (place.size() != 2 || !x || !y) return {};
    corners.emplace_back(*x, *y);
  }
  return corners;
}

std::string CheckPolygon(const std::string& text) {
  return ParsePolygon(text).empty() ? "expected corners as 'X,Y X,Y X,Y ...', found '" + text + "'" : std::string();
}

SelectOptions SelectOptionsOf(const ExtractVerbOptions& options, const Selection& selection) {
  SelectOptions select{.map = selection.map,
                       .first_keyframe = selection.first_keyframe,
                       .last_keyframe = selection.last_keyframe,
                       .begin_time = selection.begin_time,
                       .end_time = selection.end_time,
                       .session = options.session,
                       .component = options.component,
                       .every = options.every,
                       .box = selection.box,
                       .polygon = ParsePolygon(options.polygon),
                       .except = options.except};
  for (const std::uint64_t id : options.keyframes) select.keyframes.emplace_back(id);
  select.plane = kPlanes.at(options.plane);
  select.region = kRegions.at(options.region);
  return select;
}

void RefuseContradictions(const ExtractVerbOptions& options) {
  if (!options.SelectsSomething())
    RefuseUsage("say which part: --map, --keyframes, --time, --box, ... ('slamdb convert' writes the whole)");
  if (options.except && options.border == Border::kCompletePoints)
    RefuseUsage("--border complete-points would bring back what --except takes out; use smart or strict");
}

bool HasKeyframeIn(const Atlas& atlas, const Selection& selection) {
  Selection times;
  times.begin_time = selection.begin_time;
  times.end_time = selection.end_time;
  return std::ranges::any_of(atlas.maps, [&](const Map& map) {
    return (!selection.map || map.id == *selection.map) &&
           std::ranges::any_of(map.keyframes, [&](const KeyFrame& keyframe) { return times.Has(keyframe); });
  });
}

// The time that was asked for, in that of the keyframes. Throws Error when none is in it.
Selection SelectionIn(const Atlas& atlas, const ExtractVerbOptions& options) {
  const std::optional<TimeSpan> span = SpanOf(atlas, options.selection.map);
  const Selection selection = ParseSelection(options.selection, span);
  if (options.selection.time.empty() || options.except || HasKeyframeIn(atlas, selection)) return selection;
  throw Error(ErrorKind::kNotFound, options.edit.input, "", NoKeyframeIn(selection, span));
}

ExitCode RunExtract(const ExtractVerbOptions& options, Console& console) {
  RefuseContradictions(options);
  Notices notices;
  Atlas atlas = ReadInput(options.edit, console, notices);
  const ExtractOptions extract{.part = SelectOptionsOf(options, SelectionIn(atlas, options)),
                               .border = options.border,
                               .threads = console.threads(),
                               .progress = console.MakeProgress()};
  const ExtractReport report = NamingFile(options.edit.input, [&] { return Extract(atlas, extract); });
  WriteResult(atlas, options.edit, "extract " + options.edit.input, console, notices);
  return FinishEdit(PartText(report.removed) + CoverageText(report.coverage), ToJson(report, FilesOf(options.edit)),
                    options.edit, console, notices);
}

void AddParts(CLI::App& verb, ExtractVerbOptions& options) {
  constexpr const char* kGroup = "Selection";
  AddSelection(verb, options.selection);
  verb.get_option("--box")->description("Only what is inside the box with these corners, in map coordinates");
  verb.add_option("--keyframe", options.keyframes, "Only these keyframes, ids with commas between")
      ->type_name("ID,...")
      ->delimiter(',')
      ->group(kGroup);
  verb.add_option("--polygon", options.polygon, "Only what is inside this outline on the plan, three corners or more")
      ->type_name("'X,Y X,Y ...'")
      ->check(CheckPolygon)
      ->group(kGroup);
  verb.add_option("--plane", options.plane,
                  "The plane of the plan; auto: of the two axes of the map that are nearest to level")
      ->check(CLI::IsMember({"auto", "xy", "xz", "yz"}))
      ->capture_default_str()
      ->group(kGroup);
  verb.add_option("--region", options.region,
                  "What box and polygon cut: cameras and points, only cameras (with all that they see), or only points "
                  "(with the keyframes that see them)")
      ->check(CLI::IsMember({"both", "cameras", "points"}))
      ->capture_default_str()
      ->group(kGroup);
  verb.add_option("--session", options.session, "Only keyframes that were made in the map of this id, before merges")
      ->type_name("ID")
      ->group(kGroup);
  verb.add_option("--component", options.component,
                  "Only this connected part of the covisibility graph; 1 is the largest")
      ->type_name("N")
      ->check(Within(kPositive))
      ->group(kGroup);
  verb.add_option("--every", options.every, "Of what is selected, every Nth keyframe in order of time")
      ->type_name("N")
      ->check(Within(kPositive))
      ->group(kGroup);
  verb.add_flag("--except", options.except, "Everything but the part")->group(kGroup);
}

Run AddExtract(CLI::App& verb) {
  const auto options = std::make_shared<ExtractVerbOptions>();
  AddEdit(verb, options->edit);
  AddParts(verb, *options);
  verb.add_option("--border", options->border,
                  "Points at the border: strict keeps all that something still measures, smart those that ORB-SLAM3 "
                  "would not cull, complete-points adds all keyframes that observe them")
      ->type_name("BORDER")
      ->transform(OneOf(kBorders))
      ->default_str("smart");
  return [options](Console& console) { return RunExtract(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb extract atlas.osa one.osa --map 1", "One map of several; other maps and their cameras go."},
    {"slamdb extract session.osa start.osa --time +0:+10",
     "The first ten seconds; -10: are the last ten, and 1403636580:1403636640 is a minute of the clock."},
    {"slamdb extract session.osa lab.osa --polygon '-6,-6 6,-6 6,6 -6,6' --region cameras",
     "What was seen from inside a room, given as outline on the plan."},
    {"slamdb extract session.osa rest.osa --box -1,-2,0:1,0,3 --region points --except",
     "Cuts the points in a box out, such as those on a parked car."},
    {"slamdb extract session.osa thin.osa --every 3 --dry-run", "What every third keyframe would leave."},
};

}  // namespace

const Command kExtract = {
    .name = "extract",
    .summary = "write a part of an atlas as an atlas of its own",
    .group = Group::kChange,
    .description =
        R"(Takes the keyframes that meet all that is asked for, and the points that they observe, out of an atlas. What leads
out of the part is closed so that 'slamdb check' finds it as sound as the whole, and ORB-SLAM3 loads it: observations,
covisibility, spanning tree, loop edges, neighbours in time with their preintegrated motion, initial keyframe. Ids stay as
they are. --border decides about points that lose observers. MRPT landmarks stay when they are inside box and polygon, or
else with their map. The rules are in docs/extract.md.)",
    .failed = "The input could not be read, nothing is selected, or the output could not be written.",
    .lossy = kOutputLossy,
    .examples = kExamples,
    .add = AddExtract,
};

}  // namespace slamdb::cli
