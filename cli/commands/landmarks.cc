// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/landmarks/landmarks.h"

#include <memory>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "slamdb/formats/formats.h"

namespace slamdb::cli {
namespace {

struct FromPointsOptions {
  EditOptions edit;
  double sigma = 1;
};

ExitCode RunFromPoints(const FromPointsOptions& options, Console& console) {
  Notices notices;
  Atlas atlas = ReadInput(options.edit, console, notices);
  const MakeLandmarksReport report = MakeLandmarks(
      atlas, {.pixel_sigma = options.sigma, .threads = console.threads(), .progress = console.MakeProgress()});
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

ExitCode RunToPoints(const EditOptions& options, Console& console) {
  Notices notices;
  Atlas atlas = ReadInput(options, console, notices);
  const MakePointsReport report = MakePoints(atlas);
  if (report.added > 0 && HoldsObservations(options))
    notices.Warn("points without observations are for viewers and exports: ORB-SLAM3 crashes on them");
  WriteResult(atlas, options, "landmarks to-points " + options.input, console, notices);
  std::string text = "moved " + Counted(report.moved, "point") + ", added " + Grouped(report.added) + "\n";
  if (report.plain > 0) text += "  " + Grouped(report.plain) + " of those added have no ORB descriptor\n";
  if (report.fused > 0) text += "  " + Counted(report.fused, "landmark") + " fused with another one of the same id\n";
  if (report.renamed > 0)
    text += "  " + Counted(report.renamed, "landmark") + " got new ids, since another map has theirs\n";
  return FinishEdit(text, ToJson(report, FilesOf(options)), options, console, notices);
}

Run BindFromPoints(CLI::App& verb) {
  const auto options = std::make_shared<FromPointsOptions>();
  AddEdit(verb, options->edit);
  verb.add_option("--sigma", options->sigma, "Standard deviation of a keypoint at full size, in pixels [1]")
      ->type_name("PIXELS")
      ->check(CheckPositive)
      ->check(CLI::Range(1e-3, 1e3).description({}));
  return [options](Console& console) { return RunFromPoints(*options, console); };
}

Run BindToPoints(CLI::App& verb) {
  const auto options = std::make_shared<EditOptions>();
  AddEdit(verb, *options);
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
    {"slamdb landmarks from-points session_a.osa landmarks.mrpt",
     "For a program with MRPT 2; exits 3, since landmarks are not all that the atlas has."},
    {"slamdb landmarks from-points session_a.osa maps.db#a", "Keeps them in a store, beside the points."},
    {"slamdb landmarks to-points landmarks.mrpt points.ply", "To look at landmarks in a viewer of point clouds."},
};

}  // namespace

const Command kLandmarksCommand = {
    .name = "landmarks",
    .summary = "make MRPT landmarks of map points, and map points of landmarks",
    .description =
        R"(MRPT keeps landmarks where ORB-SLAM3 keeps map points: positions with a covariance, a normal, when and how often they were
seen, and features with descriptors. 'from-points' makes them of the points of an atlas. Their covariance is that of the
keypoints, carried to first order through every keyframe that observes a point, poses and scale taken for exact.

'to-points' gives points that are there the position of their landmark, and adds points for other landmarks. Those
have no observations, so they are for looking at and exporting, not for ORB-SLAM3.

Landmarks are kept in stores (.db) and in MRPT's files: .mrpt for MRPT 2, .mrpt3 for MRPT 3, with .gz behind them
compressed, .mrpt.txt as text. An .osa file has no place for them.)",
    .done = "Done, and nothing was lost.",
    .lossy = kOutputLossy,
    .examples = kExamples,
    .add = AddLandmarks,
};

}  // namespace slamdb::cli
