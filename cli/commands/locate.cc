// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/locate.h"

#include <algorithm>
#include <memory>
#include <optional>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/guard.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "slamdb/align/locate_report.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/evaluate/evaluate.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/trajectories.h"
#include "slamdb/model/statistics.h"
#include "slamdb/pictures/picture_list.h"
#include "slamdb/pictures/pictures.h"

namespace slamdb::cli {
namespace {

using detail::Concat;
using detail::Digits;

struct LocateVerbOptions {
  std::string input, from, camera, vocabulary, against, output;
  std::vector<std::string> pictures;
  std::int32_t features = 2000;
  bool benchmark = false, json = false, overwrite = false;
  LocateBenchmarkOptions left_out;
  double wait = kUsualWait;
};

CameraSettings CameraFor(const Atlas& atlas, const std::optional<CameraSettings>& given, const GrayPicture& picture) {
  if (given) return *given;
  std::optional<CameraSettings> own = SettingsOfMap(atlas, picture.width, picture.height);
  if (!own)
    throw Error(ErrorKind::kNotPossible, Concat("no keyframe has pictures of ", picture.width, " x ", picture.height,
                                                "; --camera tells the camera of this one"));
  return *std::move(own);
}

LocateReport LocatePictures(const LocateVerbOptions& options, const Atlas& atlas, const Locator& locator,
                            Console& console) {
  std::optional<CameraSettings> given;
  if (!options.camera.empty()) given = ReadCameraSettings(options.camera);
  const std::vector<PictureFile> files = FindPictures(options.pictures);
  LocateReport report;
  report.pictures.resize(files.size());
  const Progress progress = console.MakeProgress();
  constexpr std::size_t kBatch = 16;  // between two tellings
  for (std::size_t done = 0; done < files.size(); done += kBatch) {
    if (progress) progress("locating", static_cast<double>(done) / static_cast<double>(files.size()));
    detail::ParallelFor(
        std::min(kBatch, files.size() - done), 1, console.threads(), [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = done + begin; i < done + end; ++i)
            report.pictures[i] = NamingFile(files[i].path, [&] {
              const GrayPicture picture = ReadPicture(files[i].path);
              const CameraSettings camera = CameraFor(atlas, given, picture);
              return LocatedPicture{.name = files[i].path,
                                    .timestamp = files[i].timestamp,
                                    .localization = locator.Locate(ExtractFeatures(picture, camera, options.features)),
                                    .error = {}};
            });
        });
  }
  return report;
}

std::vector<TrajectoryPose> FoundIn(const LocateReport& report, std::optional<MapId> map) {
  std::vector<TrajectoryPose> poses;
  for (const LocatedPicture& picture : report.pictures) {
    const Localization& found = picture.localization;
    if (found.verdict == LocateVerdict::kFound && (!map || found.map == *map))
      poses.push_back({picture.timestamp, found.position, found.rotation});
  }
  return poses;
}

// The errors of what was found, map by map, each laid onto the truth.
void HoldAgainst(const std::string& truth, const Atlas& atlas, const ReadOptions& read, LocateReport& report,
                 Notices& notices) {
  const std::vector<TrajectoryPose> reference = ReadTrajectory(Location(truth), read, &notices);
  for (const Map& map : atlas.maps) {
    const Estimate estimate{.map = map.id, .poses = FoundIn(report, map.id), .open_scale = !IsMetric(map)};
    if (estimate.poses.empty()) continue;
    try {
      const TrajectoryEvaluation evaluation = EvaluateTrajectory(estimate, reference, {.deltas = {}});
      for (const PairedPose& pose : evaluation.poses)
        for (LocatedPicture& picture : report.pictures)
          if (picture.localization.map == map.id && picture.timestamp == pose.timestamp)
            picture.error = {pose.translation_error, pose.rotation_error_degrees};
    } catch (const Error& error) {
      notices.Warn(Concat(map.id, ": not held against ", truth, ": ", error.problem()));
    }
  }
}

std::string LineOf(const LocatedPicture& picture) {
  const Localization& found = picture.localization;
  std::string line = Concat(picture.name, ": ", NameOf(found.verdict));
  if (found.verdict == LocateVerdict::kFound)
    line += Concat(" in ", found.map, " at ", Digits(found.position.x(), 5), " ", Digits(found.position.y(), 5), " ",
                   Digits(found.position.z(), 5), ", like ", found.resembles, ", ", found.evidence.inliers, " points");
  if (found.verdict != LocateVerdict::kFound) line += ": " + found.reason;
  if (picture.error)
    line += Concat("; error ", Digits(picture.error->position, 3), ", ", Digits(picture.error->rotation_degrees, 3),
                   " degrees");
  return line + "\n";
}

std::string ReportText(const LocateReport& report, const LocateVerbOptions& options, bool verbose) {
  std::string text;
  for (const LocatedPicture& picture : report.pictures)
    if (!options.benchmark || verbose || picture.localization.verdict != LocateVerdict::kFound) text += LineOf(picture);
  const auto share = 100.0 * static_cast<double>(report.found()) / static_cast<double>(report.pictures.size());
  text += Concat("found ", report.found(), " of ",
                 Counted(report.pictures.size(), options.benchmark ? "keyframe" : "picture"), " (",
                 detail::Fixed(share, 0), "%)\n");
  if (const auto median = report.MedianError(), largest = report.LargestError(); median && largest)
    text += Concat("error: median ", Digits(median->position, 3), ", ", Digits(median->rotation_degrees, 3),
                   " degrees; largest ", Digits(largest->position, 3), ", ", Digits(largest->rotation_degrees, 3),
                   " degrees\n");
  return text;
}

std::string TumOf(const std::vector<TrajectoryPose>& poses) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  for (const TrajectoryPose& pose : poses) {
    detail::AppendSeconds(text, pose.timestamp);
    const Eigen::Vector4d& q = pose.rotation.coeffs();
    for (const double number : {pose.position.x(), pose.position.y(), pose.position.z(), q.x(), q.y(), q.z(), q.w()}) {
      text += ' ';
      detail::AppendNumber(text, number);
    }
    text += '\n';
  }
  return text;
}

// Of one map: poses of several are in different frames.
void WritePoses(const LocateReport& report, const Atlas& atlas, const LocateVerbOptions& options, Console& console) {
  std::vector<MapId> maps;
  for (const Map& map : atlas.maps)
    if (!FoundIn(report, map.id).empty()) maps.push_back(map.id);
  std::string text;
  for (const MapId map : maps)
    text += (maps.size() > 1 ? Concat("# map ", map.value(), "\n") : std::string()) + TumOf(FoundIn(report, map));
  if (maps.empty()) text = TumOf({});
  WriteOutput({.path = options.output, .overwrite = options.overwrite}, text, console);
}

ExitCode RunLocate(const LocateVerbOptions& options, Console& console) {
  if (options.benchmark == !options.pictures.empty())
    RefuseUsage(options.benchmark ? "--benchmark leaves keyframes out, and takes no pictures"
                                  : "name pictures, or ask for --benchmark");
  if (options.benchmark && !(options.against.empty() && options.camera.empty()))
    RefuseUsage("--benchmark uses what keyframes have recorded, and takes neither --against nor --camera");
  Notices notices;
  const ReadOptions read = MakeReadOptions(console, options.from, options.wait);
  Atlas atlas = ReadAtlas(Location(options.input), read, &notices);
  const std::optional<LoadedVocabulary> vocabulary = LoadGivenVocabulary(options.vocabulary, console);
  HoldWords(options.input, vocabulary, console, atlas, notices);
  LocateReport report = NamingFile(options.input, [&] {
    const Locator locator(atlas, {.vocabulary = vocabulary ? &vocabulary->tree : nullptr,
                                  .threads = console.threads(),
                                  .progress = console.MakeProgress()});
    if (!options.benchmark) return LocatePictures(options, atlas, locator, console);
    LocateBenchmarkOptions left_out = options.left_out;
    left_out.threads = console.threads();
    left_out.progress = console.MakeProgress();
    return BenchmarkLocating(locator, atlas, left_out);
  });
  if (!options.against.empty()) HoldAgainst(options.against, atlas, MakeReadOptions(console), report, notices);
  if (!options.output.empty()) WritePoses(report, atlas, options, console);
  console.Report(notices);
  PrintReport(options.json ? ToJson(report, options.input) : ReportText(report, options, console.verbose()),
              options.json, !options.output.empty() && IsStandardOutput(options.output), console);
  const bool all = options.benchmark || report.found() == report.pictures.size();
  return all ? ExitCode::kDone : ExitCode::kFailed;
}

Run AddLocate(CLI::App& verb) {
  const auto options = std::make_shared<LocateVerbOptions>();
  verb.add_option("INPUT", options->input, "The atlas: a file or STORE.db#NAME")->type_name("FILE")->required();
  verb.add_option("PICTURE", options->pictures,
                  "Pictures, folders of them, or lists (.txt, .csv: a picture a line, behind its time or alone)")
      ->type_name("FILE");
  AddFrom(verb, options->from);
  verb.add_option("--camera", options->camera,
                  "Settings of the camera that took them, as ORB-SLAM3 reads them (YAML); by default the map's own")
      ->type_name("FILE");
  AddVocabulary(verb, options->vocabulary);
  verb.add_option("--features", options->features, "How many features are looked for in a picture")
      ->type_name("N")
      ->check(CLI::Range(100, 100'000))
      ->capture_default_str();
  verb.add_option("--against", options->against,
                  "A trajectory of true poses, paired by time: the found poses are laid onto it, and the errors told")
      ->type_name("FILE");
  verb.add_flag("--benchmark", options->benchmark,
                "Leave each keyframe out in turn and locate it by its own features: no pictures are needed");
  verb.add_option("--most", options->left_out.most_keyframes,
                  "With --benchmark: at most so many keyframes, at equal steps")
      ->type_name("N")
      ->check(CheckPositive)
      ->capture_default_str();
  Mark(verb.add_option("-o,--output", options->output, "Write the poses of what was found to this file (TUM)"),
       Writes::kFile)
      ->type_name("FILE");
  verb.add_flag("-O,--overwrite", options->overwrite, "Replace the output file if it is there");
  AddJson(verb, options->json);
  AddWait(verb, options->wait);
  return [options](Console& console) { return RunLocate(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb locate lab.osa frame.png", "Is this place in my map? Exit status 0 says yes, 1 no."},
    {"slamdb locate lab.osa frames --camera camera.yaml -o poses.tum", "All pictures of a folder, by another camera."},
    {"slamdb locate lab.osa --benchmark", "How good the map is for finding oneself in it."},
};

}  // namespace

const Command kLocate = {
    .name = "locate",
    .summary = "find pictures in a map, or tell how good a map is for that",
    .group = Group::kLook,
    .description =
        R"(Finds where pictures were taken, by what they show: ORB features, the places of the map that look alike, the pose by what
both have in common, and then the picture is held against the map. What the picture must show and does not speaks against the
pose, however many points speak for it: a room that looks alike is refused or called doubtful.

--benchmark leaves each keyframe out in turn, with the points that need it, and locates it by its own recorded features: the
share found and the errors tell how good the map is for localisation.)",
    .done = "Every picture was found; or the benchmark is done.",
    .failed = "A picture was not found for sure, an input could not be read, or the output not be written.",
    .examples = kExamples,
    .add = AddLocate,
};

}  // namespace slamdb::cli
