// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/convert.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/libraries.h"
#include "cli/options.h"
#include "cli/reconstructions.h"
#include "cli/report/layout.h"
#include "cli/selection.h"
#include "cli/times.h"
#include "cli/viewers.h"
#include "cli/words.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/convert_report.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/g2o/options.h"
#include "slamdb/formats/mrpt/options.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/trajectories.h"
#include "slamdb/formats/trajectory/options.h"
#include "slamdb/many/names.h"

namespace slamdb::cli {
namespace {

struct ConvertVerbOptions {
  std::string input, output, onto;
  InputFormat from;
  TimesOptions times;
  TargetOptions target;
  SelectionOptions selection;
  ViewerOptions viewers;
  ReconstructionOptions reconstructions;
  bool sanitize = false, text = false, ascii = false, body = false, strict = false, sim3 = false;
  bool mrpt_own_slots = false, json = false, dry_run = false;
  std::optional<int> long_bytes;
  double wait = kUsualWait;
};

std::string Summary(const ConvertReport& report) {
  if (!report.maps) return {};
  return "from " + Counted(*report.maps, "map") + ", " + Counted(report.keyframes, "keyframe") + ", " +
         Counted(report.points, "point") + (report.landmarks == 0 ? "" : ", " + Counted(report.landmarks, "landmark")) +
         (report.bytes ? "; " + HumanBytes(*report.bytes) : "");
}

// Empty: as the output's suffix has it.
std::string FormatAsked(const ConvertVerbOptions& options) {
  return options.text ? "orbslam3-text" : options.target.to;
}

WriteOptions WriteOptionsOf(const ConvertVerbOptions& options, const Selection& selection, Console& console) {
  WriteOptions write = MakeWriteOptions(console, options.target, "convert " + options.input, options.wait);
  write.format = FormatAsked(options);
  write.strict = options.strict;
  write.of<Orbslam3WriteOptions>().long_bytes = options.long_bytes;
  write.of<ExportOptions>().map = selection.map;
  SetViewerOptions(options.viewers, options.ascii, write);
  SetReconstructionOptions(options.reconstructions, write);
  write.of<TrajectoryOptions>().pose_frame = options.body ? PoseFrame::kBody : PoseFrame::kCamera;
  write.of<MrptWriteOptions>().own_slots = options.mrpt_own_slots;
  write.of<G2oWriteOptions>().similarities = options.sim3;
  return write;
}

ExitCode Finish(const ConvertReport& report, const Location& output, const ConvertVerbOptions& options,
                Console& console, const Notices& notices) {
  const std::string details = " (" + report.format + ") " + Summary(report);
  if (!options.json && !options.dry_run) return FinishWriting(output, details, console, notices);
  console.Report(notices);
  const ReportFiles files{.input = options.input, .output = options.dry_run ? std::string() : output.ToString()};
  const bool piped = !options.dry_run && IsStandardOutput(output.path);
  if (options.json)
    PrintReport(ToJson(report, files), /*json=*/true, piped, console);
  else
    console.Print("would write " + output.ToString() +
                  (notices.written().empty() ? details : ": " + notices.written()) + "\n");
  return notices.lossy() ? ExitCode::kLossy : ExitCode::kDone;
}

// Options that would be without effect.
void RefuseIdleOptions(const Format& output, const ConvertVerbOptions& options) {
  const std::string is = " only; the output is " + std::string(output.title);
  if (options.body && options.onto.empty() && !IsTrajectory(output)) RefuseUsage("--body is for trajectories" + is);
  if (options.sim3 && output.id != "g2o") RefuseUsage("--sim3 is for g2o" + is);
  RefuseIdleViewerOptions(output, options.viewers);
  RefuseIdleReconstructionOptions(output, options.reconstructions);
  if (options.long_bytes && !output.id.starts_with("orbslam3"))
    RefuseUsage("--long-bytes is for archives of ORB-SLAM3" + is);
}

ExitCode RunConvert(const ConvertVerbOptions& options, Console& console) {
  if (!options.reconstructions.images.empty()) GoOnWithLibraries();
  RequireOutput(options.output);
  const Location input(options.input), output(NamedOutput(options.input, options.output, FormatAsked(options)));
  const Format& format = FormatOfOutput(output, FormatAsked(options));
  RefuseIdleOptions(format, options);
  RefuseBadTarget(output, format, options.target);
  if (!options.dry_run) RefuseBinaryOnTerminal(output, format, options.ascii);
  Notices notices;
  ConvertOptions convert{
      .read = MakeReadOptions(console, options.from, options.wait),
      .onto = options.onto,
      .read_onto = MakeReadOptions(console, {.format = {}, .layout = options.from.layout}, options.wait),
      .body = options.body,
      .sanitize = options.sanitize,
      .where = WhereOnEarth(options.viewers, options.input, format, notices),
      .dry_run = options.dry_run};
  ReadOptions& read = convert.read;
  read.of<TrajectoryReadOptions>() = options.times.ForReading();
  SetReconstructionOptions(options.reconstructions, read);
  const HeldSource held = HoldInput(input, read);
  if (options.times.any()) RefuseIdleTimes(FormatOfInput(held, options.from), options.times);
  if (!options.reconstructions.database.empty())
    RefuseIdleDatabase(FormatOfInput(held, options.from), options.reconstructions);
  read.selection = ParseSelection(options.selection, held, read);
  convert.write = WriteOptionsOf(options, read.selection, console);
  if (const std::string why = WhyNotOnto(held, convert); !why.empty()) RefuseUsage(InCommandWords(why));
  const Converted converted = Convert(held, options.input, output, convert, notices);
  const ExitCode finished = Finish(converted.report, output, options, console, notices);
  return converted.sound ? finished : ExitCode::kFailed;
}

void BindFormatOptions(CLI::App& verb, ConvertVerbOptions& options) {
  verb.add_flag("--strict", options.strict,
                "Refuse to write what does not hold all of the atlas, exports of points and poses too");
  verb.add_flag("--text", options.text, "Write a text archive: short for --to orbslam3-text")
      ->excludes(verb.get_option("--to"))
      ->group(kArchiveGroup);
  verb.add_flag("--sanitize", options.sanitize,
                "Repair what ORB-SLAM3 refuses or crashes on, as `slamdb repair` does, and zero uninitialised fields")
      ->group(kArchiveGroup);
  verb.add_option("--long-bytes", options.long_bytes,
                  "Bytes of a long where the file is to be read; 4 is for Windows and 32-bit ARM")
      ->type_name("N")
      ->check(CLI::IsMember({4, 8}))
      ->group(kArchiveGroup);
  constexpr const char* kExport = "Points and trajectories";
  verb.add_flag("--ascii", options.ascii, "Write PLY and PCD as text")->group(kExport);
  verb.add_flag(
          "--body", options.body,
          "Trajectories are of the body (IMU) frame instead of the camera's: that is written, or read with --onto")
      ->group(kExport);
  verb.add_flag("--sim3", options.sim3, "Write g2o with a scale for each keyframe: VERTEX_SIM3:EXPMAP")->group(kExport);
  AddTimes(verb, options.times, "a trajectory", kExport);
  verb.add_flag("--mrpt-own-slots", options.mrpt_own_slots,
                "Write ORB descriptors where MRPT 2 itself writes them, though it then reads them as BLD")
      ->group("MRPT landmarks");
}

Run AddConvert(CLI::App& verb) {
  const auto options = std::make_shared<ConvertVerbOptions>();
  verb.add_option("INPUT", options->input, AtlasAt("The atlas"))->type_name("FILE")->required();
  AddOutputPlace(verb, options->output, Writes::kAtlas, OutputAt());
  AddFrom(verb, options->from);
  verb.add_option(
          "--onto", options->onto,
          "Write this atlas with the poses and points of INPUT: a graph or a reconstruction that was optimised, by "
          "id, or a trajectory, by time; other points follow their reference keyframe")
      ->type_name("FILE");
  AddTarget(verb, options->target);
  AddWait(verb, options->wait);
  AddJson(verb, options->json);
  verb.add_flag("--dry-run", options->dry_run, "Say what would be written and lost, and write nothing");
  BindFormatOptions(verb, *options);
  AddViewerOptions(verb, options->viewers);
  AddReconstructionOptions(verb, options->reconstructions);
  AddSelection(verb, options->selection);
  return [options](Console& console) { return RunConvert(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb convert session_a.osa lab.db#session_a",
     "Keeps an atlas in a store; saving it again writes what changed."},
    {"slamdb convert crashed.osa safe.osa --sanitize --boost-version ubuntu18.04",
     "Makes a file that ORB-SLAM3 on an older system loads of one that makes it crash."},
    {"slamdb convert session_a.osa model --to colmap --with-database",
     "A model and a database for COLMAP: point_triangulator, bundle_adjuster and mapper run on it."},
    {"slamdb convert lab.txt moved.osa --onto lab.osa",
     "Puts poses that were optimised elsewhere into the atlas: a trajectory, a g2o graph, a COLMAP model."},
    {"slamdb convert session_a.osa trajectory.txt --to tum --body", "Writes the keyframe poses, and says how many."},
};

}  // namespace

const Command kConvert = {
    .name = "convert",
    .summary = "write an atlas in another format, or as part",
    .group = Group::kConvert,
    .description =
        R"(Reads an atlas and writes it in the format of the output. The input's format is told by its content, then by its suffix;
the output's by its suffix; --from and --to override. 'slamdb version' lists the formats.

An .osa file that is read and written again keeps every byte, also by way of a store. Exports of points and trajectories
say in one line what was written. What any other target cannot hold is named on standard error, and the exit code is
then 3. The input is never changed. The output is written beside its place and renamed when it is whole.)",
    .done = "Done: an atlas was written whole, or the points or poses that were asked for.",
    .failed = "The input could not be read, the output not be written, or --strict refused a loss.",
    .lossy = kOutputLossy,
    .examples = kExamples,
    .add = AddConvert,
};

}  // namespace slamdb::cli
