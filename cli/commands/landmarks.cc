// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/landmarks/landmarks.h"

#include <algorithm>
#include <memory>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "cli/values.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/landmarks/warnings.h"
#include "slamdb/formats/formats.h"

namespace slamdb::cli {
namespace {

struct FromPointsOptions {
  EditOptions edit;
  double sigma = 1;
};

// Of a format that holds nothing else, landmarks are what was asked for: the rest is left behind, and no loss.
void KeepWhatWasAskedFor(const EditOptions& options, Atlas& atlas, Notices& notices) {
  if (options.dry_run ||
      HasAny(FormatOfOutput(options.output, options.target.to).writes, Content::kPoses | Content::kPoints))
    return;
  Atlas landmarks;
  std::uint64_t count = 0;
  for (Map& map : atlas.maps) {
    count += map.landmarks.size();
    landmarks.maps.emplace_back().id = map.id;
    landmarks.maps.back().landmarks = std::move(map.landmarks);
  }
  notices.Tell(Counted(count, "landmark"));
  atlas = std::move(landmarks);
}

ExitCode RunFromPoints(const FromPointsOptions& options, Console& console) {
  Notices notices;
  Atlas atlas = ReadInput(options.edit, console, notices);
  const MakeLandmarksReport report = MakeLandmarks(
      atlas, {.pixel_sigma = options.sigma, .threads = console.threads(), .progress = console.MakeProgress()});
  NamingFile(options.edit.input, [&] { RequireMade(report); });
  KeepWhatWasAskedFor(options.edit, atlas, notices);
  WriteResult(atlas, options.edit, "landmarks from-points " + options.edit.input, console, notices);
  std::string text = "made " + Counted(report.landmarks, "landmark") + " of points\n";
  if (report.undetermined > 0)
    text += "  " + Grouped(report.undetermined) + " without covariance: their observations do not determine one\n";
  if (report.bad > 0) text += "  " + Counted(report.bad, "point") + " flagged bad left out\n";
  return FinishEdit(text, ToJson(report, FilesOf(options.edit)), options.edit, console, notices);
}

// Whether the output is for more than looking at.
bool HoldsObservations(const EditOptions& options) {
  return !options.dry_run && HasAny(FormatOfOutput(options.output, options.target.to).writes, Content::kObservations);
}

struct ToPointsOptions {
  EditOptions edit;
  std::string into;
  bool add = false;
};

void WarnOfAdded(std::uint64_t added, const EditOptions& options, Notices& notices) {
  if (HoldsObservations(options)) WarnOfUnobserved(added, notices);
}

ExitCode MakeThem(const EditOptions& options, Console& console) {
  Notices notices;
  Atlas atlas = ReadInput(options, console, notices);
  NamingFile(options.input, [&] { RequireLandmarks(atlas); });
  const MakePointsReport report = MakePoints(atlas);
  WarnOfAdded(report.added, options, notices);
  TellWarnings(report, notices);
  WriteResult(atlas, options, "landmarks to-points " + options.input, console, notices);
  std::string text = "moved " + Counted(report.moved, "point") + ", added " + Grouped(report.added) + "\n";
  if (report.plain > 0) text += "  " + Grouped(report.plain) + " of those added have no ORB descriptor\n";
  if (report.fused > 0) text += "  " + Counted(report.fused, "landmark") + " fused with another one of the same id\n";
  if (report.renamed > 0)
    text += "  " + Counted(report.renamed, "landmark") + " got new ids, since another map has theirs\n";
  return FinishEdit(text, ToJson(report, FilesOf(options)), options, console, notices);
}

// What the format of the output has no place for goes before it is written, and is a loss only where it says more than
// the atlas does.
void DropUnwritable(const LayLandmarksReport& report, const EditOptions& options, Atlas& atlas, Notices& notices) {
  if (options.dry_run) return;
  const Format& format = FormatOfOutput(options.output, options.target.to);
  if (HasAny(format.writes, Content::kLandmarks)) return;
  for (Map& map : atlas.maps) map.landmarks.clear();
  if (report.counts > 0)
    notices.Lose(std::string(format.id) + " cannot hold times and counts of landmarks (" + Grouped(report.counts) +
                 "); a store can");
}

std::string LayText(const LayLandmarksReport& report) {
  std::string text = "moved " + Counted(report.moved, "point") + " to their landmarks";
  if (report.same > 0) text += ", of which " + Grouped(report.same) + " were there already";
  text += "\n";
  if (report.added > 0) text += "  " + Counted(report.added, "point") + " made of landmarks that were not there\n";
  if (report.without > 0) text += "  " + Counted(report.without, "point") + " without landmark left as they were\n";
  return text;
}

ExitCode LayThem(const ToPointsOptions& options, Console& console) {
  const EditOptions& edit = options.edit;
  Notices notices;
  const Atlas landmarks = ReadInput(edit, console, notices);
  NamingFile(edit.input, [&] { RequireLandmarks(landmarks); });
  Atlas atlas = ReadAtlas(options.into, MakeReadOptions(console, {}, edit.wait), &notices);
  const LayLandmarksReport report = LayLandmarks(atlas, landmarks, {.add = options.add});
  TellWarnings(report, options.into, notices);
  WarnOfAdded(report.added, edit, notices);
  DropUnwritable(report, edit, atlas, notices);
  WriteResult(atlas, edit, "landmarks to-points " + edit.input + " --into " + options.into, console, notices);
  return FinishEdit(LayText(report),
                    ToJson(report, {.input = options.into, .output = FilesOf(edit).output}, edit.input), edit, console,
                    notices);
}

ExitCode RunToPoints(const ToPointsOptions& options, Console& console) {
  if (!options.into.empty()) return LayThem(options, console);
  return MakeThem(options.edit, console);
}

Run BindFromPoints(CLI::App& verb) {
  const auto options = std::make_shared<FromPointsOptions>();
  options->edit.needs = Content::kObservations;
  AddEdit(verb, options->edit);
  verb.add_option("--sigma", options->sigma, "Standard deviation of a keypoint at full size, in pixels [1]")
      ->type_name("PIXELS")
      ->check(Within(kPixelSigma));
  return [options](Console& console) { return RunFromPoints(*options, console); };
}

Run BindToPoints(CLI::App& verb) {
  const auto options = std::make_shared<ToPointsOptions>();
  AddEdit(verb, options->edit);
  auto* into =
      verb.add_option("--into", options->into,
                      "Lay the landmarks onto this atlas, of whose points they were made: by id, the output is "
                      "that atlas with its points moved")
          ->type_name("FILE");
  verb.add_flag("--add", options->add, "With --into: make points of landmarks that the atlas does not have")
      ->needs(into);
  return [options](Console& console) { return RunToPoints(*options, console); };
}

Run AddLandmarks(CLI::App& verb) {
  verb.require_subcommand(1);
  CLI::App* from = verb.add_subcommand("from-points", "Make a landmark of every map point, with its covariance");
  CLI::App* to = verb.add_subcommand("to-points", "Make map points of landmarks, or move those they were made of");
  return [from, run_from = BindFromPoints(*from), run_to = BindToPoints(*to)](Console& console) {
    return from->parsed() ? run_from(console) : run_to(console);
  };
}

constexpr Example kExamples[] = {
    {"slamdb landmarks from-points session_a.osa landmarks.mrpt", "For a program with MRPT 2."},
    {"slamdb landmarks from-points session_a.osa maps.db#a", "Keeps them in a store, beside the points."},
    {"slamdb landmarks to-points landmarks.mrpt points.ply", "To look at landmarks in a viewer of point clouds."},
    {"slamdb landmarks to-points landmarks.mrpt --into session_a.osa moved.osa",
     "Takes what another program did to the landmarks back to the atlas that they were made of."},
};

}  // namespace

const Command kLandmarksCommand = {
    .name = "landmarks",
    .summary = "make MRPT landmarks of map points, and map points of landmarks",
    .group = Group::kConvert,
    .description =
        R"(MRPT keeps landmarks where ORB-SLAM3 keeps map points: positions with a covariance, a normal, when and how often they were
seen, and features with descriptors. 'from-points' makes them of the points of an atlas. Their covariance is that of the
keypoints, carried to first order through every keyframe that observes a point, poses and scale taken for exact.

'to-points' gives points that are there the position of their landmark, and adds points for other landmarks. Those
have no observations, so they are for looking at and exporting, not for ORB-SLAM3. With --into the landmarks of a file move
the points of the atlas that they came from, which keeps everything else.

Normals of landmarks point to the cameras, those of points away from them; both verbs turn them.

Landmarks are kept in stores (.db) and in MRPT's files: .mrpt for MRPT 2, .mrpt3 for MRPT 3, with .gz behind them
compressed, .mrpt.txt as text. An .osa file has no place for them.)",
    .done = "Done, and nothing was lost.",
    .lossy = kOutputLossy,
    .examples = kExamples,
    .add = AddLandmarks,
};

}  // namespace slamdb::cli
