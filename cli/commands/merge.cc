// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/merge.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/report/align_text.h"
#include "cli/report/merge_text.h"
#include "cli/report/optimize_text.h"
#include "slamdb/align/join_aligned.h"
#include "slamdb/align/optimize_joined.h"
#include "slamdb/align/report_json.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/similarity_text.h"
#include "slamdb/edit/merge/anchors.h"
#include "slamdb/model/statistics.h"

namespace slamdb::cli {
namespace {

// What --optimize takes.
enum class Tightening { kUsual, kNone, kPoseGraph, kSeam, kFull };
const std::map<std::string, Tightening> kTightenings = {{"none", Tightening::kNone},
                                                        {"pose-graph", Tightening::kPoseGraph},
                                                        {"seam", Tightening::kSeam},
                                                        {"full", Tightening::kFull}};

struct MergeVerbOptions {
  EditOptions edit;
  std::vector<std::string> inputs;
  MergeOptions merge;
  std::string id_map, vocabulary;
  bool align = false, join = false, scale = false, no_scale = false, fuse = false, no_fuse = false;
  std::string transform, anchors, maps;
  std::optional<double> outlier_distance;
  std::optional<SameMap> same_map;
  FuseOptions fusion;
  Tightening tightening = Tightening::kUsual;
};

const std::map<std::string, SameMap> kConflicts = {
    {"renumber", SameMap::kKeepBoth}, {"error", SameMap::kError}, {"keep-first", SameMap::kKeepFirst}};

void Note(const MergeReport& report, Notices& notices) {
  for (const MapTwice& twice : report.same_maps)
    if (!twice.left_out)
      notices.Warn(ToString(twice.map) + " of " + report.inputs[twice.input].name +
                   " is in the result twice; --on-conflict keep-first leaves the copy out");
  for (const std::string& name : report.other_vocabularies)
    notices.Warn(name + ": its bags of words are of another vocabulary; compute them anew before place recognition");
  for (const std::string& name : report.other_layouts)
    notices.Lose(name + ": the members of its fork are of another layout than those of the result, and were left out");
  if (report.dropped_members > 0 && report.other_layouts.empty())
    notices.Lose("the members that a fork has of the atlas itself are those of the first input");
  for (const std::string& warning : report.warnings) notices.Warn(warning);
  if (!report.join) return;
  for (const std::string& warning : report.join->warnings) notices.Warn(warning);
}

// `0:1`, an end may be left out.
std::string CheckMaps(const std::string& text) {
  const bool digits = text.find_first_not_of("0123456789:") == text.npos;
  return digits && std::ranges::count(text, ':') == 1 && text.size() < 20 && text.size() > 1
             ? std::string()
             : "expected two map ids as FIRST:SECOND, found '" + text + "'";
}

MapId MapOf(std::string_view text) {
  const auto id = detail::ParseNumber<std::uint64_t>(text);
  return id ? MapId(*id) : MapId();
}

JoinOptions JoinOptionsOf(const MergeVerbOptions& options, Notices& notices) {
  JoinOptions join;
  const std::size_t colon = options.maps.find(':');
  if (!options.maps.empty()) {
    join.first = MapOf(options.maps.substr(0, colon));
    join.second = MapOf(options.maps.substr(colon + 1));
  }
  if (!options.transform.empty()) join.first_from_second = ReadSimilarity(options.transform);
  if (!options.anchors.empty()) {
    Anchors anchors = ReadAnchors(options.anchors, &notices);
    join.anchors = std::move(anchors.keyframes);
    join.places = std::move(anchors.places);
  }
  if (options.scale || options.no_scale) join.with_scale = options.scale;
  join.outlier_distance = options.outlier_distance;
  if (options.fuse) join.fuse = options.fusion;
  return join;
}

std::string Provenance(const std::vector<std::string>& inputs) {
  std::string text = "merge";
  for (const std::string& input : inputs) text += " " + input;
  return text;
}

// An input that is named again gets a number, so that tables tell the two apart.
std::vector<std::string> DistinctNames(std::vector<std::string> names) {
  for (std::size_t i = 1; i < names.size(); ++i) {
    const std::string name = names[i];
    for (int copy = 2; std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) !=
                       names.begin() + static_cast<std::ptrdiff_t>(i);
         ++copy)
      names[i] = name + " (" + std::to_string(copy) + ")";
  }
  return names;
}

// Maps of landmarks are fused unless told otherwise, as MRPT's fuseWith does.
bool HoldLandmarksAlone(const std::vector<Atlas>& atlases) {
  return std::ranges::all_of(atlases, [](const Atlas& atlas) {
    const Substance substance = SubstanceOf(atlas, /*with_bad=*/true);
    return substance.landmarks && !substance.keyframes;
  });
}

std::vector<Atlas> ReadInputs(const MergeVerbOptions& options, Console& console, Notices& notices) {
  const std::optional<LoadedVocabulary> vocabulary = LoadGivenVocabulary(options.vocabulary, console);
  std::vector<Atlas> atlases;
  for (const std::string& input : options.inputs) {
    EditOptions each = options.edit;
    each.input = input;
    atlases.push_back(ReadInput(each, console, notices));
    HoldWords(input, vocabulary, console, atlases.back(), notices);
  }
  return atlases;
}

// What to call the maps with keyframes of the result: by the input that they come from.
std::vector<MapName> NamesOf(const std::vector<std::string>& inputs, const MergeResult& result,
                             const std::vector<std::vector<MapId>>& maps) {
  std::vector<MapName> names;
  std::size_t row = 0;
  for (std::size_t input = 0; input < maps.size(); ++input)
    for (const MapId map : maps[input]) {
      const bool left_out = std::ranges::any_of(result.report.same_maps, [&](const MapTwice& twice) {
        return twice.left_out && twice.input == input && twice.map == map;
      });
      if (left_out) continue;
      if (!result.atlas.maps[row++].keyframes.empty()) names.push_back({inputs[input], map});
    }
  return names;
}

// Aligns the maps of the result and joins those that lie in one frame.
JoinAlignedReport Align(MergeResult& result, const MergeVerbOptions& options, const std::vector<MapName>& names,
                        Console& console, Notices& notices) {
  JoinAlignedOptions join{.threads = console.threads(), .progress = console.MakeProgress()};
  join.fuse = options.no_fuse ? std::nullopt : std::optional(options.fusion);
  JoinAlignedReport report = JoinAlignedMaps(result.atlas,
                                             {.own_vocabulary = !result.report.other_vocabularies.empty(),
                                              .threads = console.threads(),
                                              .progress = console.MakeProgress()},
                                             join);
  for (const MapId apart : report.apart) {
    const auto row = std::ranges::find(report.maps, apart) - report.maps.begin();
    notices.Warn(NameText(names[static_cast<std::size_t>(row)]) +
                 " stays a map of its own: it is aligned with no other");
  }
  for (const JoinReport& each : report.joins)
    for (const std::string& warning : each.warnings) notices.Warn(warning);
  return report;
}

// None: the joined maps stay as they lie.
std::optional<OptimizeMethod> MethodOf(Tightening tightening) {
  switch (tightening) {
    case Tightening::kUsual:
      return CanOptimize() ? std::optional(OptimizeMethod::kSeam) : std::nullopt;
    case Tightening::kNone:
      return std::nullopt;
    case Tightening::kPoseGraph:
      return OptimizeMethod::kPoseGraph;
    case Tightening::kSeam:
      return OptimizeMethod::kSeam;
    case Tightening::kFull:
      return OptimizeMethod::kFull;
  }
  return std::nullopt;
}

std::vector<OptimizedJoin> Tighten(Atlas& atlas, const JoinAlignedReport& joined, const MergeVerbOptions& options,
                                   Console& console, Notices& notices) {
  if (joined.joins.empty()) return {};
  const std::optional<OptimizeMethod> method = MethodOf(options.tightening);
  if (!method && options.tightening == Tightening::kUsual)
    notices.Note("the joined map is not optimised: this slamdb was built without Ceres (libceres-dev)");
  if (!method) return {};
  std::vector<OptimizedJoin> rounds = OptimizeJoined(
      atlas, joined, {.method = *method, .threads = console.threads(), .progress = console.MakeProgress()});
  for (const OptimizedJoin& round : rounds) WarnOf(round.optimization, "slamdb optimize goes on", notices);
  return rounds;
}

std::vector<MapPointId> PointsOf(const Atlas& atlas) {
  std::vector<MapPointId> points;
  for (const Map& map : atlas.maps)
    for (const MapPoint& point : map.points) points.push_back(point.id);
  std::ranges::sort(points);
  return points;
}

void FollowIds(const std::vector<MapPointId>& before, const Atlas& atlas, const JoinAlignedReport& joined,
               const std::vector<OptimizedJoin>& tightened, std::vector<IdMap>& id_maps) {
  std::vector<MapPointId> gone;
  std::ranges::set_difference(before, PointsOf(atlas), std::back_inserter(gone));
  for (IdMap& ids : id_maps) {
    for (const JoinReport& join : joined.joins) FollowJoin(join, ids);
    for (const OptimizedJoin& round : tightened) FollowFuse(round.fused, ids);
    FollowRemoval(gone, ids);
  }
}

// Nothing is written when no map could be joined: a wrong merge is worse than none.
ExitCode MergeAligned(MergeResult result, const std::vector<MapName>& names, SideFile& id_map,
                      const MergeVerbOptions& options, Console& console, Notices& notices) {
  std::vector<bool> metric;  // before the maps are joined
  for (const Map& map : result.atlas.maps)
    if (!map.keyframes.empty()) metric.push_back(IsMetric(map));
  if (metric.size() < 2)
    throw Error(ErrorKind::kNotPossible, options.inputs.front(), "",
                "there is only one map with keyframes; name another atlas to align it with");
  const bool follow = !result.report.id_maps.empty();
  const std::vector<MapPointId> points = follow ? PointsOf(result.atlas) : std::vector<MapPointId>();
  const JoinAlignedReport joined = Align(result, options, names, console, notices);
  const std::vector<OptimizedJoin> tightened = Tighten(result.atlas, joined, options, console, notices);
  const bool any = !joined.joins.empty();
  std::string text = (any ? MergeText(result.report) : "") + AlignText(joined.aligned, names, metric);
  for (const JoinReport& join : joined.joins) text += JoinText(join);
  text += OptimizedJoinText(tightened);
  if (any) {
    if (follow) FollowIds(points, result.atlas, joined, tightened, result.report.id_maps);
    if (id_map.wanted()) id_map.Write(IdMapsToText(result.report.id_maps, options.id_map));
    WriteResult(result.atlas, options.edit, Provenance(options.inputs), console, notices, &id_map);
  }
  if (any) Note(result.report, notices);
  const std::string json =
      ToJson(result.report, joined, tightened, names, any ? FilesOf(options.edit).output : std::string());
  if (any) return FinishEdit(text, json, options.edit, console, notices);
  console.Report(notices);
  PrintReport(options.edit.json ? json : text, options.edit.json, /*piped=*/false, console);
  console.Fail("no map could be aligned with another, so nothing was written");
  return ExitCode::kFailed;
}

ExitCode RunMerge(const MergeVerbOptions& options, Console& console) {
  MergeOptions merge = options.merge;
  merge.names = DistinctNames(options.inputs);
  merge.id_maps = !options.id_map.empty();
  merge.same_map = options.same_map.value_or(options.align ? SameMap::kKeepFirst : SameMap::kKeepBoth);
  merge.threads = console.threads();
  merge.progress = console.MakeProgress();
  Notices notices;
  if (options.join) merge.join = JoinOptionsOf(options, notices);
  SideFile id_map(options.id_map, options.edit);
  std::vector<Atlas> atlases = ReadInputs(options, console, notices);
  if (HoldLandmarksAlone(atlases)) {
    if (!merge.join) notices.Note("the maps of landmarks stay apart; --join makes one of two");
    if (merge.join && !options.no_fuse) merge.join->fuse = options.fusion;
  } else if (merge.join && options.transform.empty() && options.anchors.empty()) {
    RefuseUsage("--join needs --transform or --anchors: how the second map lies in the first; --align finds it");
  }
  std::vector<std::vector<MapId>> maps;
  for (const Atlas& atlas : atlases) {
    maps.emplace_back();
    for (const Map& map : atlas.maps) maps.back().push_back(map.id);
  }
  MergeResult result = MergeAtlases(std::move(atlases), merge);
  if (options.align) {
    const std::vector<MapName> names = NamesOf(merge.names, result, maps);
    return MergeAligned(std::move(result), names, id_map, options, console, notices);
  }
  if (id_map.wanted()) id_map.Write(IdMapsToText(result.report.id_maps, options.id_map));
  WriteResult(result.atlas, options.edit, Provenance(options.inputs), console, notices, &id_map);
  Note(result.report, notices);
  return FinishEdit(MergeText(result.report), ToJson(result.report, FilesOf(options.edit).output), options.edit,
                    console, notices);
}

void BindJoin(CLI::App& verb, MergeVerbOptions& options) {
  constexpr const char* kGroup = "Joining maps";
  auto* join =
      verb.add_flag("--join", options.join, "Make one map of two, the second moved into the first")->group(kGroup);
  auto* align =
      verb.add_flag(
              "--align", options.align,
              "Find how the maps lie to each other, as `slamdb align` does, and make one map of those that overlap")
          ->excludes(join)
          ->group(kGroup);
  verb.add_option("--optimize", options.tightening,
                  "What is moved then so that pictures of both fit: none; pose-graph, bends the map to the pairs of "
                  "keyframes that agree; seam, adjusts the bundle about these behind that, the default; full, of all")
      ->transform(OneOf(kTightenings))
      ->needs(align)
      ->group(kGroup);
  const auto needs_join = [&](CLI::Option* option) { return option->needs(join)->group(kGroup); };
  needs_join(verb.add_option("--transform", options.transform,
                             "How the second map lies in the first: \"tx ty tz qx qy qz qw [s]\", or a file of it"))
      ->type_name("T");
  needs_join(verb.add_option("--anchors", options.anchors,
                             "Solve the transform from pairs of keyframes taken at one place, or a CSV table of pairs "
                             "or places; with --transform, link the maps at the first pair"))
      ->type_name("A:B,...|FILE");
  needs_join(verb.add_option("--maps", options.maps,
                             "Which maps: ids in the first and second input; by default the only ones"))
      ->type_name("FIRST:SECOND")
      ->check(CheckMaps);
  auto* scale = needs_join(verb.add_flag("--scale", options.scale,
                                         "Solve the scale from the anchors too; by default only of monocular maps"));
  needs_join(verb.add_flag("--no-scale", options.no_scale, "Take the scale as 1"))->excludes(scale);
  needs_join(verb.add_option("--outliers", options.outlier_distance,
                             "Leave out anchors that lie farther apart than this, in units of the first map"))
      ->type_name("DISTANCE")
      ->check(CheckPositive);
  auto* fuse =
      needs_join(verb.add_flag("--fuse", options.fuse, "Fuse points that both maps have, and their landmarks"));
  needs_join(verb.add_flag("--no-fuse", options.no_fuse,
                           "Keep landmarks apart; by default those of maps without keyframes are fused where they are "
                           "alike"))
      ->excludes(fuse);
  verb.add_option("--fuse-radius", options.fusion.radius, "How far apart fused points may be, in pixels of uncertainty")
      ->type_name("PIXELS")
      ->check(CheckPositive)
      ->capture_default_str()
      ->needs(fuse)
      ->group(kGroup);
  verb.add_option("--fuse-hamming", options.fusion.hamming, "In how many bits their descriptors may differ")
      ->type_name("BITS")
      ->check(CLI::Range(0, 256).description({}))
      ->capture_default_str()
      ->needs(fuse)
      ->group(kGroup);
}

Run AddMerge(CLI::App& verb) {
  const auto options = std::make_shared<MergeVerbOptions>();
  verb.add_option("INPUT", options->inputs, "The atlases: files, STORE.db#NAME, or - for standard input")
      ->type_name("FILE")
      ->required();
  Mark(
      verb.add_option("-o,--output", options->edit.output, "Where to: a file, STORE.db#NAME, or - for standard output"),
      Writes::kAtlas)
      ->type_name("FILE");
  AddFrom(verb, options->edit.from);
  AddEditTarget(verb, options->edit);
  verb.add_option("--on-conflict", options->same_map,
                  "What becomes of a map that comes twice (the same images and points): 'renumber' keeps both, "
                  "'keep-first' leaves the copy out, as --align does unless told otherwise, 'error' refuses")
      ->type_name("WHAT")
      ->transform(OneOf(kConflicts));
  verb.add_flag("--ignore-vocabulary", options->merge.ignore_vocabulary,
                "Merge though the inputs' bags of words are of different vocabularies; the first one's name stays");
  verb.add_flag("--force", options->merge.force,
                "Merge or join all the same what is refused: other vocabularies, an arbitrary scale with a metric one");
  AddVocabulary(verb, options->vocabulary);
  Mark(verb.add_option("--id-map", options->id_map,
                       "Write which id of which input became which, as CSV or (.json) JSON"),
       Writes::kFile)
      ->type_name("FILE");
  BindJoin(verb, *options);
  verb.parse_complete_callback([options] {
    EditOptions& edit = options->edit;
    if (!options->inputs.empty()) edit.output = NamedOutput(options->inputs.front(), edit.output, edit.target.to);
  });
  return [options](Console& console) { return RunMerge(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb merge session_a.osa session_b.osa -o both.osa", "Two sessions in one file, each in its own map."},
    {"slamdb merge session_a.osa session_b.osa -o one.osa --align",
     "Finds where they overlap and makes one map of them, or writes nothing where that is not sure."},
    {"slamdb merge lab.db#monday lab.db#tuesday -o lab.db#week --id-map ids.csv",
     "The same in a store, with a table of which id became which."},
    {"slamdb merge a.osa b.osa -o ab.osa --join --transform b_in_a.txt --fuse",
     "One map of two, where it is known how the second lies in the first."},
    {"slamdb merge two_maps.osa -o one.osa --join --anchors 12:51,30:77,41:90",
     "Joins the two maps of one atlas by keyframes that were taken at the same places."},
};

}  // namespace

const Command kMerge = {
    .name = "merge",
    .summary = "bring several atlases into one",
    .group = Group::kCombine,
    .description =
        R"(Brings the maps of all inputs into one atlas, side by side. The first input keeps its ids; those of each later one are
moved out of the way, kind by kind, where they meet, and every reference moves along. Cameras that are the same become
one. The next ids end up above all. What the result holds is counted and held against the sum of the inputs.

With --align it finds how maps lie to each other that nobody aligned, and makes one map of those that overlap; what is not sure
stays apart, and when nothing is sure, nothing is written. With --join two maps become one: the second is moved by --transform, or by what --anchors solve, its spanning tree is hung
on the first one's and a merge edge recorded, as ORB-SLAM3's own merge does. Keyframes keep their origin map. Join two at
a time. Maps of MRPT landmarks need no transform when they are in one frame, and
are fused where they are alike.

The inputs must have the same vocabulary, as ORB-SLAM3 can load only one, and a map of arbitrary scale is not joined with a
metric one by a transform of scale 1; --force insists. What else does not go together (IMU and its state, stereo and
monocular, cameras) is a warning, whichever input comes first.)",
    .failed = "An input could not be read, the merge was refused, or the output not be written.",
    .lossy = kOutputLossy,
    .examples = kExamples,
    .add = AddMerge,
};

}  // namespace slamdb::cli
