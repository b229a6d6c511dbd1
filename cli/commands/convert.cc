// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/guard.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "cli/times.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/georeference.h"
#include "slamdb/edit/repair/repair.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/geographic/options.h"
#include "slamdb/formats/mrpt/options.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/trajectories.h"
#include "slamdb/formats/trajectory/options.h"

namespace slamdb::cli {
namespace {

struct ConvertOptions {
  std::string input, output, from;
  TimesOptions times;
  TargetOptions target;
  SelectionOptions selection;
  bool sanitize = false, text = false, ascii = false, body = false, strict = false;
  bool mrpt_own_slots = false;
  std::string color, origin;
  bool cameras = false;
  std::optional<std::size_t> most_points;
  std::optional<std::uint32_t> boost_version;
  std::optional<int> long_bytes;
  double wait = kUsualWait;
};

void RefuseEmptySelection(const Atlas& atlas, const Selection& selection, const ConvertOptions& options) {
  if (options.selection.map && atlas.maps.empty())
    throw Error(ErrorKind::kNotFound, options.input, "", "has no map " + std::to_string(*options.selection.map));
  const Substance selected = SubstanceOf(atlas, /*with_bad=*/true);
  if (selected.landmarks) return;
  if ((selection.has_keyframe_range() && !selected.keyframes) || (selection.box && !selected.points))
    throw Error(ErrorKind::kNotFound, options.input, "",
                selected.keyframes ? "has no points in the box" : "has no keyframes in the range");
}

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

std::string Summary(const Atlas& atlas, const Location& output) {
  std::uint64_t keyframes = 0, points = 0, landmarks = 0;
  for (const Map& map : atlas.maps) {
    keyframes += map.keyframes.size();
    points += map.points.size();
    landmarks += map.landmarks.size();
  }
  std::error_code ignored;
  const std::uint64_t size = std::filesystem::file_size(output.path, ignored);
  return "from " + Counted(atlas.maps.size(), "map") + ", " + Counted(keyframes, "keyframe") + ", " +
         Counted(points, "point") + (landmarks == 0 ? "" : ", " + Counted(landmarks, "landmark")) +
         (ignored ? "" : "; " + HumanBytes(size));
}

constexpr std::pair<const char*, PointColor> kColors[] = {{"map", PointColor::kMap},
                                                          {"error", PointColor::kError},
                                                          {"observations", PointColor::kObservations},
                                                          {"height", PointColor::kHeight},
                                                          {"age", PointColor::kAge}};

PointColor ColorAsked(const ConvertOptions& options) {
  for (const auto& [name, color] : kColors)
    if (options.color == name) return color;
  return PointColor::kMap;
}

bool IsOnGlobe(const Format& format) { return format.id == "kml" || format.id == "geojson"; }

// Where on earth the maps are: as asked for, or as `transform` has kept it beside the input. Throws
// CLI::ValidationError where nothing tells it.
std::optional<Georeference> WhereOnEarth(const ConvertOptions& options, const Format& output, Notices& notices) {
  if (!IsOnGlobe(output)) return std::nullopt;
  if (!options.origin.empty()) return Georeference{ParseGeodetic(options.origin), {}};
  const std::optional<Georeference> found = FindGeoreference(options.input);
  if (!found)
    RefuseUsage(
        "a " + std::string(output.title) +
        " needs --origin LAT,LON,ALT, where the frame of the maps begins; `slamdb transform --georeference` finds "
        "it, and keeps it in " +
        GeoreferencePath(options.input));
  notices.Note("the origin is that of " + GeoreferencePath(options.input));
  return found;
}

void WarnOfMapsElsewhere(const Atlas& atlas, const Georeference& where, Notices& notices) {
  if (where.maps.empty()) return;  // as asked for
  for (const Map& map : atlas.maps)
    if (std::ranges::find(where.maps, map.id) == where.maps.end() && !map.keyframes.empty())
      notices.Warn(ToString(map.id) + " was not georeferenced, and is not where it is shown");
}

// Empty: as the output's suffix has it.
std::string FormatAsked(const ConvertOptions& options) { return options.text ? "orbslam3-text" : options.target.to; }

WriteOptions WriteOptionsOf(const ConvertOptions& options, const Selection& selection, Console& console) {
  WriteOptions write = MakeWriteOptions(console, options.target, "convert " + options.input, options.wait);
  write.format = FormatAsked(options);
  write.strict = options.strict;
  write.of<Orbslam3WriteOptions>() = {.boost_version = options.boost_version, .long_bytes = options.long_bytes};
  write.of<ExportOptions>().map = selection.map;
  write.of<PointCloudOptions>() = {.binary = !options.ascii, .color = ColorAsked(options), .cameras = options.cameras};
  if (options.most_points) write.of<GeographicOptions>().most_points = *options.most_points;
  write.of<TrajectoryOptions>().pose_frame = options.body ? PoseFrame::kBody : PoseFrame::kCamera;
  write.of<MrptWriteOptions>().own_slots = options.mrpt_own_slots;
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

ExitCode Finish(const std::string& wrote, const Location& output, const Format& format, Console& console,
                const Notices& notices) {
  return FinishWriting(output, " (" + std::string(format.id) + ") " + wrote, console, notices);
}

// Null where nothing tells it.
const Format* FindFormat(const HeldSource& input, const ConvertOptions& options) {
  return options.from.empty() ? FindFormatOfInput(input) : &FormatById(options.from);
}

// A trajectory becomes a trajectory without an atlas between, in whose single precision digits would be lost. The body
// is known to atlases alone.
bool IsOfTrajectories(const HeldSource& input, const Format& output, const ConvertOptions& options) {
  if (!IsTrajectory(output) || options.body) return false;
  const Format* format = FindFormat(input, options);
  return format != nullptr && IsTrajectory(*format);
}

ExitCode ConvertPoses(const HeldSource& input, const Location& output, const Format& format, const ReadOptions& read,
                      const WriteOptions& write, Console& console) {
  Notices notices;
  ConvertTrajectory(input, output, read, write, &notices);
  return Finish({}, output, format, console, notices);
}

bool HasColors(const Format& format) {
  return format.id == "ply" || format.id == "pcd" || format.id == "gltf" || format.id == "mcap";
}

// Options that would be without effect.
void RefuseIdleOptions(const Format& output, const ConvertOptions& options) {
  const std::string is = " only; the output is " + std::string(output.title);
  if (options.body && !IsTrajectory(output)) RefuseUsage("--body is for trajectories" + is);
  if (!options.color.empty() && !HasColors(output)) RefuseUsage("--color is for PLY, PCD, glTF and MCAP" + is);
  if (options.cameras && output.id != "ply")
    RefuseUsage("--cameras is for PLY" + is +
                (HasColors(output) && output.id != "pcd" ? ", which always has them" : ""));
  if ((!options.origin.empty() || options.most_points) && !IsOnGlobe(output))
    RefuseUsage("--origin and --most-points are for KML and GeoJSON" + is);
  if ((options.boost_version || options.long_bytes) && !output.id.starts_with("orbslam3"))
    RefuseUsage("--boost-version and --long-bytes are for archives of ORB-SLAM3" + is);
}

ExitCode RunConvert(const ConvertOptions& options, Console& console) {
  const Location input(options.input), output(NamedOutput(options.input, options.output, FormatAsked(options)));
  const Format& format = FormatOfOutput(output, FormatAsked(options));
  RefuseIdleOptions(format, options);
  RefuseBinaryOnTerminal(output, format, options.ascii);

  Notices notices;
  const std::optional<Georeference> where = WhereOnEarth(options, format, notices);

  ReadOptions read = MakeReadOptions(console, options.from, options.wait);
  read.selection = ParseSelection(options.selection);
  read.of<TrajectoryReadOptions>() = options.times.ForReading();
  const HeldSource held = HoldInput(input, read);
  if (options.times.any()) RefuseIdleTimes(FindFormat(held, options), options.times);
  if (IsOfTrajectories(held, format, options))
    return ConvertPoses(held, output, format, read, WriteOptionsOf(options, read.selection, console), console);
  Atlas atlas = ReadAtlas(held, read, &notices);
  Inputs inputs;
  inputs.Add(atlas);
  const bool sound = !options.sanitize || RepairForOrbslam3(atlas, console, notices);
  RefuseEmptySelection(atlas, read.selection, options);
  RefuseEmptyResult(atlas, inputs, output.ToString(), format, /*dry_run=*/false, notices);
  if (options.strict) RefuseLosses(notices);
  if (CutsThroughMaps(read.selection) && HasAny(format.writes, Content::kObservations))
    notices.Warn("only the selected part is written: what refers to the rest leads nowhere");
  if (read.selection.has_keyframe_range() && SubstanceOf(atlas).landmarks)
    notices.Warn("landmarks belong to no keyframe: the ranges of keyframes and times leave out none of them");
  if (where) WarnOfMapsElsewhere(atlas, *where, notices);
  WriteOptions write = WriteOptionsOf(options, read.selection, console);
  if (where) write.of<GeographicOptions>().origin = where->origin;
  WriteAtlas(atlas, output, write, &notices);

  const ExitCode finished = Finish(Summary(atlas, output), output, format, console, notices);
  return sound ? finished : ExitCode::kFailed;
}

void BindViewerOptions(CLI::App& verb, ConvertOptions& options) {
  constexpr const char* kGroup = "Pictures of maps";
  std::vector<std::string> colors;
  for (const auto& [name, color] : kColors) colors.emplace_back(name);
  verb.add_option(
          "--color", options.color,
          "What the colour of a point tells, in PLY, PCD, glTF and MCAP: map (by default), error, observations, "
          "height or age")
      ->type_name("WHAT")
      ->check(CLI::IsMember(colors).description({}))
      ->group(kGroup);
  verb.add_flag("--cameras", options.cameras, "Write cameras and their path into PLY too, as edges")->group(kGroup);
  verb.add_option("--origin", options.origin,
                  "Where on earth the frame of the maps begins, east, north and up, for KML and GeoJSON; by default as "
                  "`slamdb transform --georeference` keeps it beside the atlas")
      ->type_name("LAT,LON[,ALT]")
      ->group(kGroup);
  verb.add_option("--most-points", options.most_points,
                  "Map points to write into KML and GeoJSON, evenly out of all: 10000 by default")
      ->type_name("N")
      ->group(kGroup);
}

void BindFormatOptions(CLI::App& verb, ConvertOptions& options) {
  verb.add_flag("--strict", options.strict,
                "Refuse to write what does not hold all of the atlas, exports of points and poses too");
  constexpr const char* kArchive = "ORB-SLAM3 files";
  verb.add_flag("--text", options.text, "Write a text archive: short for --to orbslam3-text")
      ->excludes(verb.get_option("--to"))
      ->group(kArchive);
  verb.add_flag("--sanitize", options.sanitize,
                "Repair what ORB-SLAM3 refuses or crashes on, as `slamdb repair` does, and zero uninitialised fields")
      ->group(kArchive);
  verb.add_option(
          "--boost-version", options.boost_version,
          "Version of the archive library to write for: 12 loads in Boost 1.58 and later, 18 in 1.73 and later; by "
          "default as it was read")
      ->type_name("N")
      ->check(CLI::Range(10, 255).description({}))
      ->group(kArchive);
  verb.add_option("--long-bytes", options.long_bytes,
                  "Bytes of a long where the file is to be read; 4 is for Windows and 32-bit ARM")
      ->type_name("N")
      ->check(CLI::IsMember({4, 8}))
      ->group(kArchive);
  constexpr const char* kExport = "Points and trajectories";
  verb.add_flag("--ascii", options.ascii, "Write PLY and PCD as text")->group(kExport);
  verb.add_flag("--body", options.body, "Write trajectories of the body (IMU) frame instead of the camera's")
      ->group(kExport);
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
  Mark(verb.add_option("OUTPUT", options->output, "Where to: a file, STORE.db#NAME, or - for standard output"),
       Writes::kAtlas)
      ->type_name("FILE")
      ->required();
  AddFrom(verb, options->from);
  AddTarget(verb, options->target);
  AddWait(verb, options->wait);
  BindFormatOptions(verb, *options);
  BindViewerOptions(verb, *options);
  AddSelection(verb, options->selection);
  return [options](Console& console) { return RunConvert(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb convert session_a.osa lab.db#session_a",
     "Keeps an atlas in a store; saving it again writes what changed."},
    {"slamdb convert lab.db#session_a a.osa --boost-version 15", "And back, for ORB-SLAM3 on Ubuntu 18.04."},
    {"slamdb convert crashed.osa safe.osa --sanitize", "Makes a file that ORB-SLAM3 loads of one that makes it crash."},
    {"slamdb convert session_a.osa a.glb --color error",
     "A scene for Blender and browsers, points coloured by reprojection error; .mcap is for Foxglove."},
    {"slamdb convert session_a.osa trajectory.txt --to tum --body", "Writes the keyframe poses, and says how many."},
};

}  // namespace

const Command kConvert = {
    .name = "convert",
    .summary = "write an atlas in another format, or as part",
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
