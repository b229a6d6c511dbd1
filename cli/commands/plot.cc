// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/plot/plot.h"

#include <filesystem>
#include <memory>

#include "cli/choices.h"
#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/exports.h"
#include "cli/libraries.h"
#include "cli/options.h"
#include "cli/reference.h"
#include "cli/report/evaluate_text.h"
#include "cli/selection.h"
#include "cli/values.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/formats.h"
#include "slamdb/many/names.h"

namespace slamdb::cli {
namespace {

struct PlotVerbOptions {
  std::string input, output, with, format, kind;
  InputFormat from;
  bool overwrite = false, body = false;
  SelectionOptions selection;
  TimesOptions times;
  EvaluationOptions evaluation;
  PlotOptions plot;
  double wait = kUsualWait;
};

std::string OutputOf(const PlotVerbOptions& options) {
  if (!options.output.empty()) return options.output;
  if (options.input == "-") RefuseUsage("name the picture of standard input with -o/--output");
  std::string picture = NameOf(Location(options.input)) + "." + (options.format.empty() ? "svg" : options.format);
  GuardDefaultName(picture);
  return picture;
}

PlotFormat FormatOf(const PlotVerbOptions& options, const std::string& output) {
  if (options.format.empty()) return PictureFormatOf(output);
  return kPlotFormats.at(options.format);
}

// The figures of `slamdb evaluate`, of what is drawn.
PlotReference HoldAgainstReference(const Atlas& atlas, const Format* format, const PlotVerbOptions& options,
                                   Console& console, Notices& notices) {
  Estimates estimate = EstimatesOf(atlas, options.input, format, options.body, notices);
  const TrajectoriesOptions read{.times = options.times,
                                 .body = options.body,
                                 .only_positions = options.evaluation.alignment != AlignmentKind::kOrigin,
                                 .wait = options.wait};
  Estimates truth = ReadTrajectoriesOf(options.with, read, console, notices);
  RefuseIdleBody(estimate, truth, options.body);
  TellWhosePoses(estimate, truth, options.body, notices);
  Estimate reference = TakeOnly(std::move(truth));
  EvaluationOptions evaluation = options.evaluation;
  evaluation.deltas.clear();  // errors of motions are not drawn
  evaluation.threads = console.threads();
  EvaluationReport report = EvaluateEstimates(std::move(estimate), reference, evaluation);
  TellWarnings(report, notices);
  TellUnevaluated(report, notices);
  return {std::move(reference.poses), std::move(report), reference.open_scale ? "map units" : "m"};
}

ExitCode RunPlot(const PlotVerbOptions& options, Console& console) {
  GoOnWithLibraries();
  if (!options.with.empty() && !options.kind.empty() && options.kind != NameOf(PlotKind::kTrajectory))
    RefuseUsage("--with is for --kind trajectory, not for " + options.kind);
  const std::string output = OutputOf(options);
  PlotOptions plot = options.plot;
  plot.format = FormatOf(options, output);
  if (plot.format == PlotFormat::kPng)
    RefuseBinaryOnTerminal(Location(output, {}), {.title = "PNG", .kind = FileKind::kBinary});
  AtomicFile file(output, {.overwrite = options.overwrite});  // what would fail at the end fails now
  Notices notices;
  if (!options.kind.empty()) plot.kind = *PlotKindByName(options.kind);
  if (!options.with.empty()) plot.kind = PlotKind::kTrajectory;
  plot.threads = console.threads();
  plot.title = options.input == "-" ? "" : NameOf(Location(options.input));
  ReadOptions read = MakeReadOptions(console, options.from, options.wait);
  read.needs = Content::kPoses | Content::kPoints;
  read.features = FeatureColumns::kGeometry;
  const HeldSource held = HoldInput(options.input, read);
  read.selection = ParseSelection(options.selection, held, read);
  const Atlas atlas = ReadPartToShow(options.input, held, read, notices);
  if (!options.with.empty())
    plot.reference = HoldAgainstReference(atlas, FindFormatOfInput(held), options, console, notices);
  const Plot picture = NamingFile(options.input, [&] { return DrawPlot(atlas, plot); });
  file.Write(picture.bytes);
  file.Commit();
  notices.Tell(detail::Concat(NameOf(plot.kind), " of ", picture.text));
  console.PrintWritten(output, notices);
  console.Report(notices);
  return ExitCode::kDone;
}

void BindLook(CLI::App& verb, PlotVerbOptions& options) {
  constexpr const char* kGroup = "The picture";
  std::vector<std::string> kinds;
  for (const PlotKind kind : PlotKinds()) kinds.emplace_back(NameOf(kind));
  verb.add_option("--kind", options.kind, "What to draw; by default overview, and trajectory with --with")
      ->type_name("KIND")
      ->check(CLI::IsMember(kinds))
      ->group(kGroup);
  verb.add_option("--format", options.format, "By default as the suffix of the output says")
      ->type_name("FORMAT")
      ->check(CLI::IsMember(kPlotFormats))
      ->group(kGroup);
  verb.add_option("--width", options.plot.width, "Pixels; the height follows")
      ->type_name("PIXELS")
      ->check(Within(kPlotWidth))
      ->capture_default_str()
      ->group(kGroup);
  verb.add_option("--scale", options.plot.scale, "Of a PNG: so many pixels for one of the width")
      ->type_name("FACTOR")
      ->check(Within(kPlotScale))
      ->capture_default_str()
      ->group(kGroup);
  verb.add_flag("--dark", options.plot.dark, "Light ink on a dark page")->group(kGroup);
  verb.add_flag("--together", options.plot.together,
                "Draw all maps in one frame, for maps that something aligned; by default each has a place of its own")
      ->group(kGroup);
}

void BindReference(CLI::App& verb, PlotVerbOptions& options) {
  constexpr const char* kGroup = "For a trajectory beside a reference";
  CLI::Option* with =
      verb.add_option("--with", options.with,
                      "Lay the trajectory onto this one (TUM, EuRoC, KITTI, another atlas) as `slamdb evaluate` does, "
                      "and colour it by its error")
          ->type_name("FILE")
          ->group(kGroup);
  AddPairing(verb, options.evaluation, options.times, kGroup);
  AddAlignment(verb, options.evaluation, kGroup);
  verb.add_flag("--joint", options.evaluation.joint, "All maps are in one frame, and aligned as one")->group(kGroup);
  verb.add_flag("--body", options.body, "Poses of atlases are those of the IMU, not of the camera")->group(kGroup);
  const auto depends = [&](const CLI::Option* option) { return option->get_group() == kGroup && option != with; };
  for (CLI::Option* option : verb.get_options(depends)) option->needs(with);
}

Run AddPlot(CLI::App& verb) {
  const auto options = std::make_shared<PlotVerbOptions>();
  verb.add_option("FILE", options->input, AtlasAt("The atlas"))->type_name("FILE")->required();
  AddFrom(verb, options->from);
  Mark(verb.add_option("-o,--output", options->output,
                       "Write to this file, an .svg or a .png; by default NAME.svg in this folder"),
       Writes::kFile)
      ->type_name("FILE");
  verb.add_flag("-O,--overwrite", options->overwrite, "Replace the output file if it is there");
  BindLook(verb, *options);
  AddSelection(verb, options->selection);
  BindReference(verb, *options);
  AddWait(verb, options->wait);
  return [options](Console& console) { return RunPlot(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb plot lab.osa",
     "An overview, lab.svg: plan, side, track lengths, errors, covisibility, keyframes over time."},
    {"slamdb plot lab.osa --kind plan --width 600 --dark -o lab_plan.png", "For a dark page, in pixels."},
    {"slamdb plot lab.osa --with ground_truth.txt -o error.svg",
     "How far the trajectory is from the truth, and where."},
    {"slamdb plot lab.db#monday --kind covisibility -o -", "Of an atlas in a store, to standard output."},
};

}  // namespace

const Command kPlot = {
    .name = "plot",
    .summary = "draw a map as a picture",
    .group = Group::kLook,
    .description =
        R"(Draws an atlas for a paper, a page or a log, as SVG or PNG: from above and from the side, with points, trajectory, loop and
merge edges on a metric grid; the covisibility of keyframes as a matrix; how many keyframes observe a point, and how many
points a keyframe; the reprojection error over the image; keyframes over time with their gaps; the trajectory beside a
reference, coloured by its error.

Plans are level: which way is up is told by the IMU, or else by how the cameras were held, and the plan says so. The same
input gives the same bytes. Colours are told apart by those who see red and green alike.)",
    .failed = "An input could not be read, no map fits onto the reference, or the output not be written.",
    .examples = kExamples,
    .add = AddPlot,
};

}  // namespace slamdb::cli
