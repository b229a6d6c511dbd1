// SPDX-License-Identifier: BSD-3-Clause
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "cli/choices.h"
#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/reference.h"
#include "cli/report/layout.h"
#include "cli/report/similarity.h"
#include "cli/times.h"
#include "cli/values.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/axes.h"
#include "slamdb/edit/frame/georeference.h"
#include "slamdb/edit/frame/similarity_text.h"
#include "slamdb/edit/frame/transform_atlas.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/rtabmap/fixes.h"

namespace slamdb::cli {
namespace {

struct TransformVerbOptions {
  EditOptions edit;
  std::string by, axes, gravity, onto, georeference, origin;
  TimesOptions times;
  std::optional<double> scale, max_dt, time_offset;
  std::optional<double> robust;
  bool body = false, with_scale = false, without_scale = false, estimate_time_offset = false;
  std::vector<std::uint64_t> maps;
};

// Options that would be without effect.
void RefuseIdleOptions(const TransformVerbOptions& options) {
  if (!options.onto.empty() || !options.georeference.empty()) return;
  const std::pair<const char*, bool> given[] = {
      {"--max-dt", options.max_dt.has_value()},           {"--robust", options.robust.has_value()},
      {"--time-offset", options.time_offset.has_value()}, {"--estimate-time-offset", options.estimate_time_offset},
      {"--time-unit", !options.times.unit.empty()},       {"--with-scale", options.with_scale},
      {"--without-scale", options.without_scale},         {"--body", options.body}};
  for (const auto& [option, is_given] : given)
    if (is_given) RefuseUsage(std::string(option) + " is for --onto and --georeference only");
}

FitOptions FitOf(const TransformVerbOptions& options) {
  FitOptions fit{.max_time_difference = options.max_dt,
                 .body = options.body,
                 .outlier_distance = options.robust,
                 .time_offset = options.time_offset.value_or(0),
                 .estimate_time_offset = options.estimate_time_offset};
  if (options.with_scale || options.without_scale) fit.with_scale = options.with_scale;
  return fit;
}

Destination DestinationOf(const TransformVerbOptions& options, Console& console, Notices& notices) {
  if (!options.by.empty()) return ReadSimilarity(options.by);
  if (options.scale) return Similarity3d{.scale = *options.scale};
  if (!options.axes.empty()) return Similarity3d{.rotation = ParseAxes(options.axes)};
  if (!options.gravity.empty()) return TurnUpright{kUpMethods.at(options.gravity)};
  if (!options.onto.empty())
    return OntoTrajectory{
        PositionsOf(ReadTrajectoriesOf(
            options.onto,
            {.times = options.times, .body = options.body, .only_positions = true, .wait = options.edit.wait}, console,
            notices)),
        FitOf(options)};
  OntoEarth earth{
      .fixes = ReadRecordedFixes(options.georeference, {.time_unit = options.times.ForReading().time_unit}, &notices),
      .fit = FitOf(options)};
  if (!options.origin.empty()) earth.origin = ParseGeodetic(options.origin);
  return earth;
}

std::string AlignmentText(const TrajectoryAlignment& alignment) {
  const ResidualStatistics& residuals = alignment.residuals;
  return Grouped(alignment.pairs) + " of " + Counted(alignment.keyframes, "keyframe") + " paired, " +
         Counted(alignment.inliers, "inlier") + "; residuals: rmse " + Short(residuals.rmse) + ", median " +
         Short(residuals.median) + ", max " + Short(residuals.max) +
         (alignment.time_offset == 0
              ? ""
              : "\n  the reference's clock is ahead by " + detail::Fixed(alignment.time_offset, 4) + " s");
}

std::string UpText(const Up& up) {
  switch (up.method) {
    case UpMethod::kInertia:
      return "up found by inertia: gravity is " + Short(up.gravity) + " m/s^2";
    case UpMethod::kCameras:
      return "up found by the cameras, taken as level: they roll by " + Short(up.spread) + " degrees (rms)";
    default:
      return "up found by the path, taken as level: the cameras are " + Short(up.off_path) + " off a plane (rms)";
  }
}

std::string TextOf(const TransformReport& report) {
  std::string text;
  if (report.origin)
    text += "east, north, up in metres from " + Short(report.origin->latitude, 10) + ", " +
            Short(report.origin->longitude, 10) + ", " + Short(report.origin->altitude, 7) + " m\n";
  for (const MovedMap& moved : report.maps) {
    text += ToString(moved.map) + ": " + SimilarityText(moved.target_from_source) + "\n";
    if (moved.alignment) text += "  " + AlignmentText(*moved.alignment) + "\n";
    if (moved.up) text += "  " + UpText(*moved.up) + "\n";
  }
  return text;
}

// An .osa file has no place for where on earth its map is, so that stands in a file beside it.
std::string PathOfOrigin(const TransformVerbOptions& options, Notices& notices) {
  if (options.georeference.empty() || options.edit.dry_run) return {};
  if (options.edit.output == "-" || IsSpecialFile(options.edit.output)) {
    notices.Warn("standard output has no place for the origin; keep the report");
    return {};
  }
  if (Location(options.edit.output).is_server()) {
    notices.Warn("a server has no place for the origin; keep the report");
    return {};
  }
  std::string path = GeoreferencePath(options.edit.output);
  notices.Note("the origin is in " + path);
  return path;
}

ExitCode RunTransform(const TransformVerbOptions& options, Console& console) {
  RefuseIdleOptions(options);
  RefuseBadOutput(options.edit);
  Notices notices;
  TransformOptions transform{
      .to = DestinationOf(options, console, notices), .threads = console.threads(), .progress = console.MakeProgress()};
  for (const std::uint64_t id : options.maps) transform.maps.emplace_back(id);
  Atlas atlas = ReadInput(options.edit, console, notices);
  SideFile georeference(PathOfOrigin(options, notices), options.edit);
  const TransformReport report = NamingFile(options.edit.input, [&] { return TransformAtlas(atlas, transform); });
  TellWarnings(report, notices);
  const std::string json = ToJson(report, FilesOf(options.edit));
  georeference.Write(json);
  WriteResult(atlas, options.edit, "transform " + options.edit.input, console, notices, &georeference);
  return FinishEdit(TextOf(report), json, options.edit, console, notices);
}

void BindMotions(CLI::App& verb, TransformVerbOptions& options) {
  constexpr const char* kGroup = "Where to; one of these";
  const std::vector<CLI::Option*> ways = {
      verb.add_option(
              "--by", options.by,
              "A transform or a file that holds one: 'tx ty tz qx qy qz qw [scale]', or the 12 or 16 numbers of a "
              "matrix; x' = scale R x + t")
          ->type_name("TRANSFORM"),
      verb.add_option("--scale", options.scale, "Multiply all lengths")->type_name("FACTOR"),
      verb.add_option("--axes", options.axes,
                      "Change the axes: FROM:TO of camera, ros, enu, ned and opengl, or a list as x,-z,y")
          ->type_name("AXES"),
      verb.add_option(
              "--gravity", options.gravity,
              "Turn up to +z; which way is up is told by inertia, the cameras (held level) or their path (level "
              "ground); auto: by inertia, or else the cameras, or else their path")
          ->type_name("METHOD")
          ->check(CLI::IsMember({"auto", "inertia", "cameras", "path"})),
      verb.add_option(
              "--onto", options.onto,
              "Lay the keyframes onto a trajectory (TUM, EuRoC, KITTI, tables of ROS) or another atlas, by time")
          ->type_name("FILE"),
      verb.add_option(
              "--georeference", options.georeference,
              "Lay the keyframes onto GPS fixes: a table of time, latitude, longitude, altitude (WGS84), or NMEA")
          ->type_name("FILE"),
  };
  for (CLI::Option* way : ways) {
    way->group(kGroup);
    for (CLI::Option* other : ways)
      if (other != way) way->excludes(other);
  }
}

void BindAlignment(CLI::App& verb, TransformVerbOptions& options) {
  constexpr const char* kGroup = "For --onto and --georeference";
  verb.add_option("--max-dt", options.max_dt,
                  "Seconds that a keyframe and a position may be apart: 0.02 for trajectories, 1 for GPS by default")
      ->type_name("SECONDS")
      ->check(Within(kNonNegative))
      ->group(kGroup);
  verb.add_option("--robust", options.robust,
                  "Leave out pairs that end up farther apart than this, in metres; by default only gross outliers are, "
                  "and inf keeps all")
      ->type_name("DISTANCE")
      ->check(Within(kPositive))
      ->group(kGroup);
  CLI::Option* offset = verb.add_option("--time-offset", options.time_offset,
                                        "Seconds that the clock of the reference is ahead of the map's")
                            ->type_name("SECONDS")
                            ->check(Within(kFinite))
                            ->group(kGroup);
  verb.add_flag("--estimate-time-offset", options.estimate_time_offset,
                "Find the time offset under which speeds and paths agree best")
      ->excludes(offset)
      ->group(kGroup);
  AddTimes(verb, options.times, "the reference", kGroup);
  verb.get_option("--times")->needs(verb.get_option("--onto"));
  CLI::Option* with_scale =
      verb.add_flag("--with-scale", options.with_scale,
                    "Solve for the scale too; by default only where the sensor leaves it open (one camera, no IMU)")
          ->group(kGroup);
  verb.add_flag("--without-scale", options.without_scale, "Keep the scale")->excludes(with_scale)->group(kGroup);
  verb.add_flag("--body", options.body, "The positions are those of the IMU, not of the camera")->group(kGroup);
  verb.add_option("--origin", options.origin,
                  "Origin of the georeferenced frame; by default the first fix near the others")
      ->type_name("LAT,LON[,ALT]")
      ->check(CheckPlace)
      ->needs(verb.get_option("--georeference"))
      ->group(kGroup);
}

Run AddTransform(CLI::App& verb) {
  const auto options = std::make_shared<TransformVerbOptions>();
  AddEdit(verb, options->edit);
  BindMotions(verb, *options);
  BindAlignment(verb, *options);
  verb.add_option("--map", options->maps, "Move only the map of this id; may be given several times")
      ->type_name("ID")
      ->allow_extra_args(false);
  return [options](Console& console) {
    const bool chosen =
        options->scale ||
        !(options->by + options->axes + options->gravity + options->onto + options->georeference).empty();
    if (!chosen) throw CLI::RequiredError("One of --by, --scale, --axes, --gravity, --onto and --georeference");
    return RunTransform(*options, console);
  };
}

constexpr Example kExamples[] = {
    {"slamdb transform a.osa moved.osa --by '1 0 0 0 0 0.7071068 0.7071068'",
     "A quarter turn about z, then 1 m along x."},
    {"slamdb transform mono.osa metric.osa --onto ground_truth.txt --estimate-time-offset",
     "Also finds the scale, which a lone camera leaves open, and by how much the clocks differ."},
    {"slamdb transform a.osa ros.osa --axes camera:ros", "From z forward to x forward, z up."},
    {"slamdb transform a.osa level.osa --gravity auto --json", "Stands the map upright and tells how that was found."},
    {"slamdb transform lab.db#a lab.db#a_enu --georeference gps.csv --robust 3",
     "East, north, up around the first fix."},
};

}  // namespace

const Command kTransform = {
    .name = "transform",
    .summary = "move, turn, scale, align or georeference maps",
    .group = Group::kChange,
    .description =
        R"(Moves maps into another world frame. Everything that has a length, a direction or a pose moves along, so that every point is
seen at the same pixel as before: poses, points, normals, distance ranges, velocities, and with a change of scale the
baselines and depths. What the IMU measured stays metric.

Each map of an atlas has a frame of its own. --by, --scale and --axes move all of them alike; --gravity, --onto and
--georeference find a transform for each, so that --onto brings all maps into one frame. --map moves only some.

`slamdb evaluate` says how good a map is there: errors of positions and rotations, absolute and relative, and coverage.

Georeferencing writes the origin to OUTPUT.georeference.json too, since an atlas has no place for it.)",
    .failed = "An input could not be read, the transform is none or could not be found, or the output not be written.",
    .lossy = kOutputLossy,
    .examples = kExamples,
    .add = AddTransform,
};

}  // namespace slamdb::cli
