// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/merge.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "cli/choices.h"
#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/libraries.h"
#include "cli/report/align_text.h"
#include "cli/report/merge_text.h"
#include "cli/values.h"
#include "slamdb/align/merge_branches.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/similarity_text.h"
#include "slamdb/edit/merge/anchors.h"
#include "slamdb/edit/merge/warnings.h"
#include "slamdb/formats/formats.h"
#include "slamdb/many/branches.h"
#include "slamdb/many/names.h"
#include "slamdb/optimize/warnings.h"

namespace slamdb::cli {
namespace {

struct MergeVerbOptions {
  EditOptions edit;
  std::vector<std::string> inputs;
  MergeOptions merge;
  std::string id_map, vocabulary;
  bool align = false, join = false, scale = false, no_scale = false, fuse = false, no_fuse = false, no_base = false;
  std::string base;
  BranchGeometry geometry = BranchGeometry::kAlign;
  BranchSide prefer = BranchSide::kOurs;
  std::string transform, anchors, maps;
  std::optional<double> outlier_distance;
  std::optional<SameMap> same_map;
  FuseOptions fusion;
  Tightening tightening = Tightening::kUsual;
};

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

std::string Provenance(const MergeVerbOptions& options) {
  std::string text = "merge";
  if (!options.base.empty()) text += " --base " + options.base;
  for (const std::string& input : options.inputs) text += " " + input;
  return text;
}

std::vector<Atlas> ReadInputs(const MergeVerbOptions& options, Console& console, Notices& notices) {
  const std::optional<LoadedVocabulary> vocabulary = LoadGivenVocabulary(options.vocabulary, console);
  std::vector<std::string> inputs = options.inputs;
  if (!options.base.empty()) inputs.insert(inputs.begin(), options.base);
  std::vector<Atlas> atlases;
  for (const std::string& input : inputs) {
    EditOptions each = options.edit;
    each.input = input;
    atlases.push_back(ReadInput(each, console, notices));
    HoldWords(input, vocabulary, console, atlases.back(), notices);
  }
  return atlases;
}

// One map of those that overlap, or nothing where that is not sure.
ExitCode MergeAndJoin(std::vector<Atlas> atlases, const MergeOptions& merge, SideFile& id_map,
                      const MergeVerbOptions& options, Console& console, Notices& notices) {
  MergeAlignedOptions aligned{.merge = merge, .fuse = options.fusion, .tightening = options.tightening};
  if (options.no_fuse) aligned.fuse.reset();
  const MergeAlignedResult result = MergeAligned(std::move(atlases), aligned, notices);
  const MergeReport& report = result.merged.report;
  std::string text =
      (result.any() ? MergeText(report) : "") + AlignText(result.joined.aligned, result.names, result.metric);
  for (const JoinReport& join : result.joined.joins) text += JoinText(join);
  text += OptimizedJoinText(result.tightened);
  if (!result.any()) {
    console.Report(notices);
    PrintReport(options.edit.json ? ToJson(result) : text, options.edit.json, /*piped=*/false, console);
    console.Fail("no map could be aligned with another, so nothing was written");
    return ExitCode::kFailed;
  }
  if (id_map.wanted()) id_map.Write(IdMapsToText(report.id_maps, options.id_map));
  WriteResult(result.merged.atlas, options.edit, Provenance(options), console, notices, &id_map);
  return FinishEdit(text, ToJson(result, FilesOf(options.edit).output), options.edit, console, notices);
}

// What two robots made of one base.
ExitCode MergeTheBranches(const MergeVerbOptions& options, const std::optional<StoredBranches>& stored,
                          Console& console) {
  if (options.inputs.size() != 2) RefuseUsage("--base is of two inputs, ours and theirs, which were made of it");
  ThreeWayOptions merge{.geometry = options.geometry,
                        .prefer = options.prefer,
                        .fuse = options.fusion,
                        .ignore_vocabulary = options.merge.ignore_vocabulary || options.merge.force,
                        .take_containing = !stored,  // the history knows what was merged
                        .id_maps = !options.id_map.empty(),
                        .threads = console.threads(),
                        .progress = console.MakeProgress()};
  if (options.no_fuse) merge.fuse.reset();
  const std::vector<std::string> names = DistinctNames({options.base, options.inputs[0], options.inputs[1]});
  std::ranges::copy(names, merge.names.begin());
  Notices notices;
  SideFile id_map(options.id_map, options.edit);
  std::vector<Atlas> atlases = ReadInputs(options, console, notices);
  if (stored) RequireBase(*stored, atlases[0], atlases[1], atlases[2], console.threads());
  const MergeBranchesResult result =
      MergeBranches(std::move(atlases[0]), std::move(atlases[1]), std::move(atlases[2]), merge);
  const ThreeWayReport& report = result.merged.report;
  if (id_map.wanted()) id_map.Write(IdMapsToText(report.id_maps, options.id_map));
  WriteResult(result.merged.atlas, options.edit, Provenance(options), console, notices, &id_map);
  TellWarnings(report, notices);
  for (const OptimizedJoin& round : result.tightened)
    TellWarnings(round.optimization, "`OptimizeMaps` goes on", notices);
  return FinishEdit(ThreeWayText(report) + OptimizedJoinText(result.tightened),
                    ToJson(result, FilesOf(options.edit).output), options.edit, console, notices);
}

// Where the result of two atlases of a store goes: to that store, where the second is merged into it; nowhere else, so
// that it is the next revision of the first. What is read are the revisions that they are now.
void GoOnWithRevisions(const StoredBranches& branches, MergeVerbOptions& options) {
  EditOptions& edit = options.edit;
  if (edit.output.empty() && !edit.dry_run) {
    if (!branches.is_newest)
      RefuseUsage(Location(options.inputs[0]).name + " is not the newest revision of " + branches.ours.atlas +
                  ", which the result would take the place of: say with --output where it goes");
    edit.output = branches.store + "#" + branches.ours.atlas;
    edit.target.overwrite = true;
  }
  const Location output(edit.output);
  if (!output.name.empty() && detail::IsSameFile(branches.store, std::nullopt, output.path, std::nullopt))
    edit.merged = branches.theirs;
  if (edit.merged && output.name == branches.ours.atlas) edit.onto = branches.ours;
  const RevisionName* revisions[] = {&branches.ours, &branches.theirs};
  for (std::size_t side = 0; side < 2; ++side) {
    const Location input(options.inputs[side]);
    detail::EnterRevision(input.path, input.name, revisions[side]->ToString());
    options.inputs[side] = branches.LocationOf(*revisions[side]);
  }
}

// Of two atlases of a store: what both come from, if its history knows it and no other base is given.
std::optional<StoredBranches> TakeBase(MergeVerbOptions& options) {
  if (options.inputs.size() != 2 || options.join || options.align || options.no_base) return std::nullopt;
  const Location ours(options.inputs[0]), theirs(options.inputs[1]);
  std::optional<StoredBranches> branches = FindBranches(ours, theirs, options.edit.wait);
  if (!branches) return std::nullopt;
  const bool is_given = !options.base.empty();
  if (!is_given && options.same_map) return std::nullopt;
  if (!is_given && !branches->base) {
    if (options.edit.output.empty() && !options.edit.dry_run)
      RefuseUsage("the history of " + ours.path + " knows nothing that " + ours.name + " and " + theirs.name +
                  " both come from: say it with --base, or with --output where their maps are to go side by side");
    return std::nullopt;
  }
  GoOnWithRevisions(*branches, options);
  if (is_given) return std::nullopt;
  options.base = branches->LocationOf(*branches->base);
  return branches;
}

// Options that mean nothing without others.
void RefuseStray(const CLI::App& verb, const MergeVerbOptions& options) {
  if (!options.base.empty()) return;
  for (const char* option : {"--geometry", "--prefer"})
    if (verb.count(option) > 0)
      RefuseUsage(std::string(option) + " needs --base, or two atlases of a store that knows theirs");
  for (const char* option : {"--fuse", "--no-fuse"})
    if (verb.count(option) > 0 && !options.join) RefuseUsage(std::string(option) + " needs --join or --base");
  for (const char* option : {"--fuse-radius", "--fuse-hamming"})
    if (verb.count(option) > 0 && !options.fuse) RefuseUsage(std::string(option) + " needs --fuse or --base");
}

ExitCode RunMerge(MergeVerbOptions options, const CLI::App& verb, Console& console) {
  const std::vector<std::string> given = options.inputs;
  const std::optional<StoredBranches> stored = TakeBase(options);
  RefuseStray(verb, options);
  if (options.align || (!options.base.empty() && options.geometry == BranchGeometry::kOptimize)) GoOnWithLibraries();
  if (stored)
    console.Note(Location(given[0]).name + " and " + Location(given[1]).name + " both come from " +
                 stored->base->ToString() + ": merged three ways; --no-base keeps their maps side by side");
  if (options.edit.merged && !options.edit.onto)
    console.Note("the history of " + Location(options.edit.output).name + " will tell of " +
                 options.edit.merged->ToString() + " alone: for later merges with " + Location(given[0]).name +
                 " merge into that, or into a branch of it");
  if (!options.base.empty()) return MergeTheBranches(options, stored, console);
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
  if (options.align) return MergeAndJoin(std::move(atlases), merge, id_map, options, console, notices);
  MergeResult result = MergeAtlases(std::move(atlases), merge);
  if (id_map.wanted()) id_map.Write(IdMapsToText(result.report.id_maps, options.id_map));
  WriteResult(result.atlas, options.edit, Provenance(options), console, notices, &id_map);
  TellWarnings(result.report, notices);
  return FinishEdit(MergeText(result.report), ToJson(result.report, FilesOf(options.edit).output), options.edit,
                    console, notices);
}

void BindBranches(CLI::App& verb, MergeVerbOptions& options) {
  constexpr const char* kGroup = "Continuations of one atlas";
  auto* base = verb.add_option("--base", options.base,
                               "What both inputs were made of: their changes are merged, each thing where it changed")
                   ->type_name("FILE")
                   ->group(kGroup);
  verb.add_flag("--no-base", options.no_base,
                "Keep maps side by side, though both inputs are of one store that knows what they come from")
      ->excludes(base)
      ->group(kGroup);
  for (const char* other : {"--join", "--align", "--on-conflict"}) base->excludes(verb.get_option(other));
  verb.add_option("--geometry", options.geometry,
                  "Where that is which both have: align, what both changed, weighed, the default; ours; "
                  "theirs; optimize, align and then the bundle adjusted")
      ->group(kGroup)
      ->type_name("KIND")
      ->transform(OneOf(kBranchGeometries));
  verb.add_option("--prefer", options.prefer,
                  "Whose change stands where both changed the same: ours, the default, or theirs")
      ->group(kGroup)
      ->type_name("KIND")
      ->transform(OneOf(kBranchSides));
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
      ->type_name("KIND")
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
      ->check(Within(kPositive));
  auto* fuse = verb.add_flag("--fuse", options.fuse,
                             "Fuse points that both maps have, and their landmarks; by default with --base")
                   ->group(kGroup);
  verb.add_flag("--no-fuse", options.no_fuse,
                "Keep apart what is fused by default: with --base new points of both, with --join landmarks of maps "
                "without keyframes")
      ->excludes(fuse)
      ->group(kGroup);
  verb.add_option("--fuse-radius", options.fusion.radius, "How far apart fused points may be, in pixels of uncertainty")
      ->type_name("PIXELS")
      ->check(Within(kPositive))
      ->capture_default_str()
      ->group(kGroup);
  verb.add_option("--fuse-hamming", options.fusion.hamming, "In how many bits their descriptors may differ")
      ->type_name("BITS")
      ->check(Within(kBitsOfDescriptor))
      ->capture_default_str()
      ->group(kGroup);
}

Run AddMerge(CLI::App& verb) {
  const auto options = std::make_shared<MergeVerbOptions>();
  verb.add_option("INPUT", options->inputs, AtlasAt("The atlases"))->type_name("FILE")->required();
  Mark(verb.add_option("-o,--output", options->edit.output, OutputAt()), Writes::kAtlas)->type_name("FILE");
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
  BindBranches(verb, *options);
  verb.parse_complete_callback([options] {
    EditOptions& edit = options->edit;
    if (!options->inputs.empty()) edit.output = NamedOutput(options->inputs.front(), edit.output, edit.target.to);
  });
  return [options, &verb](Console& console) { return RunMerge(*options, verb, console); };
}

constexpr Example kExamples[] = {
    {"slamdb merge session_a.osa session_b.osa -o both.osa", "Two sessions in one file, each in its own map."},
    {"slamdb merge session_a.osa session_b.osa -o one.osa --align",
     "Finds where they overlap and makes one map of them, or writes nothing where that is not sure."},
    {"slamdb merge lab.db#monday lab.db#tuesday -o lab.db#week --id-map ids.csv",
     "The same in a store, with a table of which id became which."},
    {"slamdb merge a.osa b.osa -o ab.osa --join --transform b_in_a.txt --fuse",
     "One map of two, where it is known how the second lies in the first."},
    {"slamdb merge --base start.osa monday.osa tuesday.osa -o both.osa",
     "What two robots made of one atlas, each thing where it changed."},
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
stays apart, and when nothing is sure, nothing is written. With --base the inputs are two continuations of one atlas,
ours and theirs, which become one: what one side changed is as it has it, what both changed is a conflict, and listed. Of
two atlases of a store of which one was branched off the other the base is known, and without --output the result is the
next revision of the first.
With --join two maps become one: the second is moved by --transform, or by what --anchors solve, its spanning tree is hung
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
