// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/options.h"
#include "cli/reconstructions.h"
#include "cli/report/layout.h"
#include "cli/selected.h"
#include "cli/times.h"
#include "cli/viewers.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/put_poses.h"
#include "slamdb/edit/repair/repair.h"
#include "slamdb/formats/convert_report.h"
#include "slamdb/formats/dry_run.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/g2o/options.h"
#include "slamdb/formats/keyframe_poses.h"
#include "slamdb/formats/mrpt/options.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/trajectories.h"
#include "slamdb/formats/trajectory/options.h"

namespace slamdb::cli {
namespace {

struct ConvertOptions {
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

// What the reader had to leave out; WriteAtlas refuses what the target cannot hold.
void RefuseLosses(const Notices& notices) {
  for (const Notice& notice : notices.items())
    if (notice.kind == Notice::Kind::kLoss)
      throw Error(ErrorKind::kNotPossible, notice.text + "; --strict refuses that");
}

// Whether references lead from what is selected to what is not. None lead from one map to another.
bool CutsThroughMaps(Selection selection) {
  selection.map.reset();
  return !selection.everything();
}

std::optional<std::uint64_t> SizeOf(const std::string& path) {
  std::error_code unknown;
  const std::uint64_t size = std::filesystem::file_size(path, unknown);
  return unknown ? std::nullopt : std::optional(size);
}

std::string Summary(const ConvertReport& report) {
  if (!report.maps) return {};
  return "from " + Counted(*report.maps, "map") + ", " + Counted(report.keyframes, "keyframe") + ", " +
         Counted(report.points, "point") + (report.landmarks == 0 ? "" : ", " + Counted(report.landmarks, "landmark")) +
         (report.bytes ? "; " + HumanBytes(*report.bytes) : "");
}

// Empty: as the output's suffix has it.
std::string FormatAsked(const ConvertOptions& options) { return options.text ? "orbslam3-text" : options.target.to; }

WriteOptions WriteOptionsOf(const ConvertOptions& options, const Selection& selection, Console& console) {
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

// Returns whether no error is left.
bool RepairForOrbslam3(Atlas& atlas, Console& console, Notices& notices) {
  const RepairReport report = RepairAtlas(atlas, {.journal = false, .threads = console.threads()});
  for (const AppliedFix& fix : report.applied)
    notices.Warn("repaired: " + fix.title + " (" + Counted(fix.changes, "change") + ")");
  for (const std::string& error : ErrorsOf(report.left)) notices.Warn(error);
  return report.sound();
}

ExitCode Finish(ConvertReport report, const Location& output, const ConvertOptions& options, Console& console,
                const Notices& notices, std::uint64_t would_have) {  // bytes, in a dry run
  const Format& format = FormatById(report.format);                  // of the output
  const bool is_one_file = !format.needs_path && !format.is_folder;
  if (is_one_file && !options.dry_run) report.bytes = SizeOf(output.path);
  if (is_one_file && options.dry_run && !format.named && !IsStandardOutput(output.path) && !IsSpecialFile(output.path))
    report.bytes = would_have;
  report.Add(notices);
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

bool IsOfTrajectory(const HeldSource& input, const ConvertOptions& options) {
  const Format* format = FormatOfInput(input, options.from);
  return format != nullptr && IsTrajectory(*format);
}

// A trajectory becomes a trajectory without an atlas between, in whose single precision digits would be lost. The body
// is known to atlases alone.
bool IsOfTrajectories(const HeldSource& input, const Format& output, const ConvertOptions& options) {
  if (!IsTrajectory(output) || options.body || !options.onto.empty()) return false;
  return IsOfTrajectory(input, options);
}

ExitCode ConvertPoses(const HeldSource& input, const Location& output, const Format& format, const ReadOptions& read,
                      const WriteOptions& write, const ConvertOptions& options, Console& console,
                      const std::uint64_t& would_have) {  // set while it writes
  Notices notices;
  ConvertReport report;
  report.format = format.id;
  report.keyframes = ConvertTrajectory(input, output, read, write, &notices);
  return Finish(std::move(report), output, options, console, notices, would_have);
}

// Options that would be without effect.
void RefuseIdleOptions(const Format& output, const ConvertOptions& options) {
  const std::string is = " only; the output is " + std::string(output.title);
  if (options.body && options.onto.empty() && !IsTrajectory(output)) RefuseUsage("--body is for trajectories" + is);
  if (options.sim3 && output.id != "g2o") RefuseUsage("--sim3 is for g2o" + is);
  RefuseIdleViewerOptions(output, options.viewers);
  RefuseIdleReconstructionOptions(output, options.reconstructions);
  if (options.long_bytes && !output.id.starts_with("orbslam3"))
    RefuseUsage("--long-bytes is for archives of ORB-SLAM3" + is);
}

// Graphs and trajectories are what comes onto a map.
void RequireMapOnto(const Atlas& atlas, const ConvertOptions& options, const Location& output) {
  const auto is_map = [](const Map& map) {
    return !map.points.empty() || std::ranges::any_of(map.keyframes, [](const KeyFrame& keyframe) {
      return !keyframe.features.map_points.empty();
    });
  };
  if (std::ranges::any_of(atlas.maps, is_map)) return;
  throw Error(
      ErrorKind::kNotPossible, options.onto, "",
      "holds neither points nor keypoints: --onto names the map, and INPUT the poses that go into it. The other "
      "way round it is `slamdb convert " +
          options.onto + " " + output.ToString() + " --onto " + options.input + "`");
}

// What there is to say of the poses' source is about what is not put: nothing of the output is lost by it.
void AddOfPoses(const Notices& of_poses, const std::string& source, Notices& notices) {
  for (const Notice& notice : of_poses.items()) {
    if (notice.kind == Notice::Kind::kWarning) notices.Warn(notice.text);
    if (notice.kind == Notice::Kind::kLoss) notices.Note(source + ": " + notice.text);
  }
}

// The atlas of --onto with the poses of the input.
Atlas PutOnto(const HeldSource& poses, const ReadOptions& read, const Location& output, const ConvertOptions& options,
              Console& console, std::optional<PutInto>& into, Notices& notices) {
  if (options.body && !IsOfTrajectory(poses, options))
    RefuseUsage("--body with --onto is for trajectories only; the poses of other inputs are of cameras");
  if (!read.selection.everything()) RefuseUsage("--onto takes all poses of the input: it goes with no selection");
  const InputFormat onto{.format = {}, .layout = options.from.layout};
  Atlas atlas = ReadAtlas(Location(options.onto), MakeReadOptions(console, onto, options.wait), &notices);
  RequireMapOnto(atlas, options, output);
  PutPosesOptions places{.of_body = options.body, .threads = console.threads()};
  Notices of_poses;
  const std::vector<KeyFramePose> found = ReadKeyFramePoses(poses, read, &of_poses, &places.points, &places.origin);
  AddOfPoses(of_poses, options.input, notices);
  const PutPosesReport put = PutPoses(atlas, found, places);
  into = {.keyframes = put.keyframes, .points = put.points, .largest_shift = put.largest_shift};
  notices.Note("put " + Counted(put.keyframes, "pose") + " and " + Counted(put.points, "point") + " into " +
               options.onto + "; the largest shift of a camera is " + detail::Digits(put.largest_shift, 3));
  for (const std::string& warning : put.warnings) notices.Warn(warning);
  for (const std::string& loss : put.losses) notices.Lose(loss);
  return atlas;
}

// The atlas as it is to be written, or an Error: the selection, the repairs that --sanitize asks for, what is refused.
Atlas Prepare(const HeldSource& held, const ReadOptions& read, const Location& output, const Format& format,
              const ConvertOptions& options, Console& console, std::optional<PutInto>& into, Notices& notices,
              bool& sound) {
  Atlas atlas = options.onto.empty() ? ReadAtlas(held, read, &notices)
                                     : PutOnto(held, read, output, options, console, into, notices);
  Inputs inputs;
  inputs.Add(atlas, options.onto.empty() ? FormatOfInput(held, options.from) : FindFormatOfInput(options.onto));
  LoseUseToOrbslam3(atlas, inputs, format, options.target, notices);
  sound = !options.sanitize || RepairForOrbslam3(atlas, console, notices);
  RefuseEmptySelection(atlas, options.input, held, read);
  RefuseEmptyResult(atlas, inputs, output.ToString(), format, /*dry_run=*/false, notices);
  if (options.strict) RefuseLosses(notices);
  if (CutsThroughMaps(read.selection) && HasAny(format.writes, Content::kObservations))
    notices.Warn("only the selected part is written: what refers to the rest leads nowhere");
  if (read.selection.has_keyframe_range() && SubstanceOf(atlas).landmarks)
    notices.Warn("landmarks belong to no keyframe: the ranges of keyframes and times leave out none of them");
  return atlas;
}

ExitCode RunConvert(const ConvertOptions& options, Console& console) {
  RequireOutput(options.output);
  const Location input(options.input), output(NamedOutput(options.input, options.output, FormatAsked(options)));
  const Format& format = FormatOfOutput(output, FormatAsked(options));
  RefuseIdleOptions(format, options);
  RefuseBadTarget(output, format, options.target);
  if (!options.dry_run) RefuseBinaryOnTerminal(output, format, options.ascii);
  Notices notices;
  const std::optional<Georeference> where = WhereOnEarth(options.viewers, options.input, format, notices);

  ReadOptions read = MakeReadOptions(console, options.from, options.wait);
  read.of<TrajectoryReadOptions>() = options.times.ForReading();
  SetReconstructionOptions(options.reconstructions, read);
  const HeldSource held = HoldInput(input, read);
  if (options.times.any()) RefuseIdleTimes(FormatOfInput(held, options.from), options.times);
  if (!options.reconstructions.database.empty())
    RefuseIdleDatabase(FormatOfInput(held, options.from), options.reconstructions);
  read.selection = ParseSelection(options.selection, held, read);
  WriteOptions write = WriteOptionsOf(options, read.selection, console);
  std::uint64_t would_have = 0;
  if (options.dry_run) write.of<DryRunOptions>().bytes = &would_have;
  if (IsOfTrajectories(held, format, options))
    return ConvertPoses(held, output, format, read, write, options, console, would_have);
  bool sound = true;
  std::optional<PutInto> put;
  const Atlas atlas = Prepare(held, read, output, format, options, console, put, notices, sound);
  if (where) LayOnEarth(atlas, *where, write, notices);
  ConvertReport report = ConvertReportOf(atlas, format);
  report.put = put;
  WriteAtlas(atlas, output, write, &notices);
  const ExitCode finished = Finish(std::move(report), output, options, console, notices, would_have);
  return sound ? finished : ExitCode::kFailed;
}

void BindFormatOptions(CLI::App& verb, ConvertOptions& options) {
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
  const auto options = std::make_shared<ConvertOptions>();
  verb.add_option("INPUT", options->input, "The atlas: a file, STORE.db#NAME, or - for standard input")
      ->type_name("FILE")
      ->required();
  AddOutputPlace(verb, options->output, Writes::kAtlas, kWhereTo);
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
