// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/transform.h"

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/report/json.h"
#include "cli/report/layout.h"
#include "cli/report/similarity.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/align_trajectory.h"
#include "slamdb/edit/frame/axes.h"
#include "slamdb/edit/frame/georeference.h"
#include "slamdb/edit/frame/gravity.h"
#include "slamdb/edit/frame/similarity_text.h"
#include "slamdb/formats/formats.h"
#include "slamdb/model/derive.h"

namespace slamdb::cli {
namespace {

using nlohmann::ordered_json;

struct TransformOptions {
  EditOptions edit;
  std::string by, axes, gravity, onto, georeference, origin;
  std::optional<double> scale, max_dt;
  double robust = 0;
  bool body = false, with_scale = false, without_scale = false;
  std::vector<std::uint64_t> maps;
};

// How one map moves, and why so.
struct Motion {
  MapId map;
  Similarity3d target_from_source;
  std::optional<TrajectoryAlignment> alignment;
  std::optional<Upright> upright;
  std::vector<std::string> warnings;
};

// What the options ask for, before any map is read.
struct Plan {
  std::function<Motion(const Map&)> motion;
  bool needs_keyframes = false;  // maps without any stay as they are
  std::optional<LocalFrame> georeference;
};

UpMethod UpMethodOf(const std::string& name) {
  if (name == "inertia") return UpMethod::kInertia;
  if (name == "cameras") return UpMethod::kCameras;
  return name == "path" ? UpMethod::kPath : UpMethod::kAuto;
}

std::string NameOf(UpMethod method) {
  return method == UpMethod::kInertia ? "inertia" : method == UpMethod::kCameras ? "cameras" : "path";
}

std::vector<TimedPosition> ReadReference(const TransformOptions& options, Console& console, Notices& notices) {
  ReadOptions read = MakeReadOptions(console);
  read.features = FeatureColumns::kNone;
  Atlas reference = ReadAtlas(Location::Parse(options.onto), read, notices);
  std::erase_if(reference.maps, [](const Map& map) { return map.keyframes.empty(); });
  if (reference.maps.size() != 1)
    throw Error(options.onto, "", "must hold one trajectory, not " + std::to_string(reference.maps.size()));
  std::vector<TimedPosition> positions;
  for (const KeyFrame& keyframe : reference.maps[0].keyframes) {
    const Eigen::Vector3f center = options.body ? WorldFromBody(keyframe).translation : CameraCenter(keyframe);
    positions.push_back({keyframe.timestamp, center.cast<double>()});
  }
  return positions;
}

Motion AlignedTo(const std::vector<TimedPosition>& reference, const Map& map, const TransformOptions& options,
                 double default_max_dt) {
  TrajectoryAlignmentOptions align;
  align.max_time_difference = options.max_dt.value_or(default_max_dt);
  align.body = options.body;
  align.fit.with_scale = options.with_scale || (!options.without_scale && HasOpenScale(map));
  align.fit.outlier_distance = options.robust;
  const TrajectoryAlignment alignment = AlignToTrajectory(map, reference, align);
  return {.map = map.id, .target_from_source = alignment.reference_from_map, .alignment = alignment};
}

Plan PlanOf(const TransformOptions& options, Console& console, Notices& notices) {
  constexpr double kTrajectoryMaxDt = 0.02, kGpsMaxDt = 1;
  const auto everywhere = [](const Similarity3d& transform) {
    RequireTransform(transform);
    return Plan{.motion = [transform](const Map& map) { return Motion{map.id, transform}; }};
  };
  if (!options.by.empty()) return everywhere(ReadSimilarity(options.by));
  if (options.scale) return everywhere({.scale = *options.scale});
  if (!options.axes.empty()) return everywhere({.rotation = ParseAxes(options.axes)});
  if (!options.gravity.empty())
    return {
        .motion =
            [&options](const Map& map) {
              const Upright upright = FindUp(map, UpMethodOf(options.gravity));
              return Motion{.map = map.id, .target_from_source = {1, upright.target_from_source}, .upright = upright};
            },
        .needs_keyframes = true};
  if (!options.onto.empty())
    return {.motion = [&options, reference = ReadReference(options, console, notices)](
                          const Map& map) { return AlignedTo(reference, map, options, kTrajectoryMaxDt); },
            .needs_keyframes = true};
  const std::vector<GpsFix> fixes = ReadFixes(options.georeference);
  const LocalFrame frame(options.origin.empty() ? fixes.front().place : ParseGeodetic(options.origin));
  return {.motion = [&options, reference = PositionsIn(frame, fixes)](
                        const Map& map) { return AlignedTo(reference, map, options, kGpsMaxDt); },
          .needs_keyframes = true,
          .georeference = frame};
}

std::vector<std::size_t> RowsToMove(const Atlas& atlas, const TransformOptions& options, const Plan& plan) {
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row) {
    const Map& map = atlas.maps[row];
    const bool asked = std::ranges::find(options.maps, map.id.value()) != options.maps.end();
    if (options.maps.empty() ? !plan.needs_keyframes || !map.keyframes.empty() : asked) rows.push_back(row);
  }
  for (const std::uint64_t id : options.maps)
    if (std::ranges::none_of(atlas.maps, [id](const Map& map) { return map.id == MapId(id); }))
      throw Error(options.edit.input, "", "has no map " + std::to_string(id));
  if (rows.empty()) throw Error(options.edit.input, "", "has no map to move");
  return rows;
}

std::string AlignmentText(const TrajectoryAlignment& alignment) {
  const ResidualStatistics& residuals = alignment.residuals;
  return Grouped(alignment.pairs) + " of " + Counted(alignment.keyframes, "keyframe") + " paired, " +
         Counted(alignment.inliers, "inlier") + "; residuals: rmse " + Short(residuals.rmse) + ", median " +
         Short(residuals.median) + ", max " + Short(residuals.max);
}

std::string UprightText(const Upright& upright) {
  switch (upright.method) {
    case UpMethod::kInertia:
      return "up found by inertia: gravity is " + Short(upright.gravity) + " m/s^2";
    case UpMethod::kCameras:
      return "up found by the cameras, taken as level: they roll by " + Short(upright.spread) + " degrees (rms)";
    default:
      return "up found by the path, taken as level: the cameras are " + Short(upright.spread) + " off a plane (rms)";
  }
}

std::string TextOf(const std::vector<Motion>& motions, const Plan& plan) {
  std::string text;
  if (plan.georeference) {
    const Geodetic& origin = plan.georeference->origin();
    text += "east, north, up in metres from " + Short(origin.latitude, 10) + ", " + Short(origin.longitude, 10) + ", " +
            Short(origin.altitude, 7) + " m\n";
  }
  for (const Motion& motion : motions) {
    text += ToString(motion.map) + ": " + SimilarityText(motion.target_from_source) + "\n";
    if (motion.alignment) text += "  " + AlignmentText(*motion.alignment) + "\n";
    if (motion.upright) text += "  " + UprightText(*motion.upright) + "\n";
  }
  return text;
}

ordered_json AlignmentJson(const TrajectoryAlignment& alignment) {
  const ResidualStatistics& residuals = alignment.residuals;
  return {{"keyframes", alignment.keyframes},
          {"pairs", alignment.pairs},
          {"inliers", alignment.inliers},
          {"residuals",
           {{"rmse", residuals.rmse}, {"mean", residuals.mean}, {"median", residuals.median}, {"max", residuals.max}}},
          {"largest_residual_of_all_pairs", alignment.largest_residual}};
}

ordered_json UprightJson(const Upright& upright) {
  ordered_json json = {{"method", NameOf(upright.method)}, {"up", {upright.up.x(), upright.up.y(), upright.up.z()}}};
  if (upright.method == UpMethod::kInertia) json["gravity"] = upright.gravity;
  if (upright.method == UpMethod::kCameras) json["roll_degrees_rms"] = upright.spread;
  if (upright.method == UpMethod::kPath) json["distance_to_plane_rms"] = upright.spread;
  return json;
}

ordered_json GeoreferenceJson(const LocalFrame& frame) {
  const Geodetic& origin = frame.origin();
  return {{"ellipsoid", "WGS84"},
          {"axes", "east, north, up"},
          {"latitude", origin.latitude},
          {"longitude", origin.longitude},
          {"altitude", origin.altitude}};
}

ordered_json JsonOf(const std::vector<Motion>& motions, const Plan& plan, const TransformOptions& options) {
  ordered_json maps = ordered_json::array();
  for (const Motion& motion : motions) {
    ordered_json map = {{"id", motion.map.value()}, {"target_from_source", SimilarityJson(motion.target_from_source)}};
    if (motion.alignment) map["alignment"] = AlignmentJson(*motion.alignment);
    if (motion.upright) map["upright"] = UprightJson(*motion.upright);
    map["warnings"] = motion.warnings;
    maps.push_back(map);
  }
  ordered_json json = {{"input", options.edit.input}, {"output", options.edit.output}, {"maps", maps}};
  if (plan.georeference) json["georeference"] = GeoreferenceJson(*plan.georeference);
  return json;
}

// An .osa file has no place for where on earth its map is, so that stands in a file beside it.
std::unique_ptr<AtomicFile> OpenGeoreferenceFile(const TransformOptions& options, Notices& notices) {
  if (options.edit.dry_run) return nullptr;
  if (options.edit.output == "-") {
    notices.Warn("standard output has no place for the origin; keep the report");
    return nullptr;
  }
  const std::string path = options.edit.output + ".georeference.json";
  notices.Note("the origin is in " + path);
  return std::make_unique<AtomicFile>(
      path, AtomicFileOptions{.overwrite = options.edit.target.overwrite, .sync = !options.edit.target.no_sync});
}

std::vector<std::string> WarningsOf(const Motion& motion, const Map& map) {
  std::vector<std::string> warnings = TransformWarnings(map, motion.target_from_source);
  if (!motion.alignment) return warnings;
  if (auto poor = PoorFitWarning(motion.alignment->residuals.rmse, motion.alignment->spread))
    warnings.push_back(*std::move(poor));
  return warnings;
}

ExitCode RunTransform(const TransformOptions& options, Console& console) {
  Notices notices;
  const Plan plan = PlanOf(options, console, notices);
  Atlas atlas = ReadInput(options.edit, console, notices);
  std::vector<Motion> motions;
  for (const std::size_t row : RowsToMove(atlas, options, plan)) {
    Map& map = atlas.maps[row];
    Motion motion = plan.motion(map);
    motion.warnings = WarningsOf(motion, map);
    for (const std::string& warning : motion.warnings) notices.Warn(ToString(map.id) + ": " + warning);
    TransformMap(map, motion.target_from_source, console.threads());
    motions.push_back(std::move(motion));
  }
  const ordered_json json = JsonOf(motions, plan, options);
  std::unique_ptr<AtomicFile> georeference;
  if (plan.georeference) georeference = OpenGeoreferenceFile(options, notices);
  if (georeference) georeference->Write(JsonText(json));
  WriteResult(atlas, options.edit, "transform " + options.edit.input, console, notices);
  if (georeference) georeference->Commit();
  return FinishEdit(TextOf(motions, plan), JsonText(json), options.edit, console, notices);
}

void BindMotions(CLI::App& verb, TransformOptions& options) {
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
              "ground); auto: by inertia, or else the cameras")
          ->type_name("METHOD")
          ->check(CLI::IsMember({"auto", "inertia", "cameras", "path"})),
      verb.add_option("--onto", options.onto,
                      "Lay the keyframes onto a trajectory (TUM, EuRoC) or another atlas, by time")
          ->type_name("FILE"),
      verb.add_option("--georeference", options.georeference,
                      "Lay the keyframes onto GPS fixes: a CSV file of time, latitude, longitude, altitude (WGS84)")
          ->type_name("FILE"),
  };
  for (CLI::Option* way : ways) {
    way->group(kGroup);
    for (CLI::Option* other : ways)
      if (other != way) way->excludes(other);
  }
}

void BindAlignment(CLI::App& verb, TransformOptions& options) {
  constexpr const char* kGroup = "For --onto and --georeference";
  verb.add_option("--max-dt", options.max_dt,
                  "Seconds that a keyframe and a position may be apart: 0.02 for trajectories, 1 for GPS by default")
      ->type_name("SECONDS")
      ->check(CheckNonNegative)
      ->group(kGroup);
  verb.add_option("--robust", options.robust, "Leave out pairs that end up farther apart than this, in metres")
      ->type_name("DISTANCE")
      ->check(CheckPositive)
      ->group(kGroup);
  CLI::Option* with_scale =
      verb.add_flag("--with-scale", options.with_scale,
                    "Solve for the scale too; by default only where the sensor leaves it open (one camera, no IMU)")
          ->group(kGroup);
  verb.add_flag("--without-scale", options.without_scale, "Keep the scale")->excludes(with_scale)->group(kGroup);
  verb.add_flag("--body", options.body, "The positions are those of the IMU, not of the camera")->group(kGroup);
  verb.add_option("--origin", options.origin, "Origin of the georeferenced frame; by default the first fix")
      ->type_name("LAT,LON[,ALT]")
      ->needs(verb.get_option("--georeference"))
      ->group(kGroup);
}

Run AddTransform(CLI::App& verb) {
  const auto options = std::make_shared<TransformOptions>();
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
    {"slamdb transform mono.osa metric.osa --onto ground_truth.txt",
     "Also finds the scale, which a lone camera leaves open."},
    {"slamdb transform a.osa ros.osa --axes camera:ros", "From z forward to x forward, z up."},
    {"slamdb transform a.osa level.osa --gravity auto --json", "Stands the map upright and tells how that was found."},
    {"slamdb transform lab.db#a lab.db#a_enu --georeference gps.csv --robust 3",
     "East, north, up around the first fix."},
};

}  // namespace

const Command kTransform = {
    .name = "transform",
    .summary = "move, turn, scale, align or georeference maps",
    .description =
        R"(Moves maps into another world frame. Everything that has a length, a direction or a pose moves along, so that every point is
seen at the same pixel as before: poses, points, normals, distance ranges, velocities, and with a change of scale the
baselines and depths. What the IMU measured stays metric.

Each map of an atlas has a frame of its own. --by, --scale and --axes move all of them alike; --gravity, --onto and
--georeference find a transform for each, so that --onto brings all maps into one frame. --map moves only some.

Georeferencing writes the origin to OUTPUT.georeference.json too, since an atlas has no place for it.)",
    .failed = "An input could not be read, the transform is none or could not be found, or the output not be written.",
    .lossy = "Done, but the output does not hold all of the atlas; standard error names what it lacks.",
    .examples = kExamples,
    .add = AddTransform,
};

}  // namespace slamdb::cli
