// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/locate.h"

#include <algorithm>
#include <memory>
#include <optional>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/guard.h"
#include "cli/options.h"
#include "cli/report/locate_text.h"
#include "cli/whole_store.h"
#include "slamdb/align/locate_report.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/evaluate/evaluate.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/sqlite/store.h"
#include "slamdb/formats/trajectories.h"
#include "slamdb/many/locate_in_store.h"
#include "slamdb/model/statistics.h"
#include "slamdb/pictures/picture_list.h"
#include "slamdb/pictures/pictures.h"

namespace slamdb::cli {
namespace {

using detail::Concat;

struct LocateVerbOptions {
  std::string input, camera, vocabulary, against, output;
  InputFormat from;
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

std::optional<CameraSettings> GivenCamera(const LocateVerbOptions& options) {
  return options.camera.empty() ? std::nullopt : std::optional(ReadCameraSettings(options.camera));
}

// By picture, those that could not be read.
using Unreadable = std::vector<std::optional<Error>>;

// Calls work(row) for every picture, in parallel. Throws what it throws where no picture can be read.
template <class Work>
Unreadable ForEachPicture(const std::vector<PictureFile>& files, std::string_view doing, Console& console,
                          const Work& work) {
  const Progress progress = console.MakeProgress();
  constexpr std::size_t kBatch = 16;  // between two tellings
  Unreadable unreadable(files.size());
  const auto work_on = [&](std::size_t i) {
    try {
      NamingFile(files[i].path, [&] { work(i); });
    } catch (const Error& error) {
      unreadable[i] = error;
    }
  };
  for (std::size_t done = 0; done < files.size(); done += kBatch) {
    if (progress) progress(doing, static_cast<double>(done) / static_cast<double>(files.size()));
    detail::ParallelFor(std::min(kBatch, files.size() - done), 1, console.threads(),
                        [&](std::size_t begin, std::size_t end) {
                          for (std::size_t i = done + begin; i < done + end; ++i) work_on(i);
                        });
  }
  if (std::ranges::all_of(unreadable, [](const auto& error) { return error.has_value(); })) throw *unreadable.front();
  return unreadable;
}

LocateReport ReportOf(const std::vector<PictureFile>& files) {
  LocateReport report;
  for (const PictureFile& file : files) {
    LocatedPicture& picture = report.pictures.emplace_back();
    picture.name = file.path;
    picture.timestamp = file.timestamp;
  }
  return report;
}

void TellUnreadable(const Unreadable& unreadable, LocateReport& report, Notices& notices) {
  for (std::size_t i = 0; i < unreadable.size(); ++i) {
    if (!unreadable[i]) continue;
    report.pictures[i].localization = {.verdict = LocateVerdict::kUnreadable, .reason = unreadable[i]->problem()};
    notices.Warn(unreadable[i]->what());
  }
}

LocateReport LocatePictures(const LocateVerbOptions& options, const Atlas& atlas, const Locator& locator,
                            Console& console, Notices& notices) {
  const std::optional<CameraSettings> given = GivenCamera(options);
  const std::vector<PictureFile> files = FindPictures(options.pictures);
  LocateReport report = ReportOf(files);
  const Unreadable unreadable = ForEachPicture(files, "locating", console, [&](std::size_t i) {
    const GrayPicture picture = ReadPicture(files[i].path);
    const CameraSettings camera = CameraFor(atlas, given, picture);
    report.pictures[i].localization = locator.Locate(ExtractFeatures(picture, camera, options.features));
  });
  TellUnreadable(unreadable, report, notices);
  if (!options.against.empty() && std::ranges::none_of(files, &PictureFile::has_time))
    notices.Warn("the pictures have no times: they are paired with " + options.against +
                 " by their order, 1 for the first");
  return report;
}

// Pictures before it is known whose camera took them: as ORB-SLAM3 finds features unless it is told otherwise.
CameraSettings AnyCamera(const GrayPicture& picture) {
  CameraSettings settings{.camera = {}, .distortion = {}};
  settings.camera.parameters = {1, 1, 0, 0};
  settings.width = settings.file_width = picture.width;
  settings.height = settings.file_height = picture.height;
  return settings;
}

// A picture that all atlases of a store are asked for.
struct AskedPicture {
  CameraSettings found_with;
  PictureFeatures features;
};

// As the camera of an atlas sees it.
std::optional<PictureFeatures> SeenBy(const Atlas& atlas, const AskedPicture& picture, const std::string& file,
                                      std::int32_t features) {
  const std::optional<CameraSettings> own = SettingsOfMap(atlas, picture.found_with.width, picture.found_with.height);
  if (!own) return std::nullopt;
  std::optional<PictureFeatures> seen = WithCamera(picture.features, picture.found_with, *own);
  return seen ? seen : ExtractFeatures(ReadPicture(file), *own, features);
}

LocateReport LocateInWholeStore(const LocateVerbOptions& options, Store& store, Console& console, Notices& notices) {
  const std::optional<CameraSettings> given = GivenCamera(options);
  const std::vector<PictureFile> files = FindPictures(options.pictures);
  std::vector<CameraSettings> found_with(files.size());
  std::vector<PictureFeatures> looks(files.size());
  const Unreadable unreadable = ForEachPicture(files, "looking at pictures", console, [&](std::size_t i) {
    const GrayPicture picture = ReadPicture(files[i].path);
    found_with[i] = given ? *given : AnyCamera(picture);
    looks[i] = ExtractFeatures(picture, found_with[i], options.features);
  });
  const auto features_for = [&](std::size_t i, const Atlas& atlas) -> std::optional<PictureFeatures> {
    if (given) return looks[i];
    return SeenBy(atlas, {found_with[i], looks[i]}, files[i].path, options.features);
  };
  const LocatedInStore located =
      LocateInStore(store, looks, features_for,
                    {.lock_timeout = options.wait, .threads = console.threads(), .progress = console.MakeProgress()});
  for (const std::string& atlas : located.not_asked) notices.Warn("not asked: " + atlas);
  LocateReport report = ReportOf(files);
  for (std::size_t i = 0; i < files.size(); ++i) {
    LocatedPicture& picture = report.pictures[i];
    const std::vector<AtlasLocalization>& answers = located.pictures[i];
    picture.localization.reason = "no place of the store looks like it";
    picture.localization.evidence.features = looks[i].descriptors.size();
    if (answers.empty()) continue;
    picture.atlas = answers.front().atlas;
    picture.localization = answers.front().localization;
    picture.others.assign(answers.begin() + 1, answers.end());
  }
  TellUnreadable(unreadable, report, notices);
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
          if (picture.localization.verdict == LocateVerdict::kFound && picture.localization.map == map.id &&
              picture.timestamp == pose.timestamp)
            picture.error = {pose.translation_error, pose.rotation_error_degrees};
    } catch (const Error& error) {
      notices.Warn(Concat(map.id, ": not held against ", truth, ": ", error.problem()));
    }
  }
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

void RefuseContradictions(const LocateVerbOptions& options) {
  if (options.benchmark == !options.pictures.empty())
    RefuseUsage(options.benchmark ? "--benchmark leaves keyframes out, and takes no pictures"
                                  : "name pictures, or ask for --benchmark");
  if (options.benchmark && !(options.against.empty() && options.camera.empty()))
    RefuseUsage("--benchmark uses what keyframes have recorded, and takes neither --against nor --camera");
}

ExitCode Finish(const LocateReport& report, const LocateVerbOptions& options, Console& console,
                const Notices& notices) {
  console.Report(notices);
  PrintReport(options.json ? ToJson(report, options.input) : LocateText(report, options.benchmark, console.verbose()),
              options.json, !options.output.empty() && IsStandardOutput(options.output), console);
  const bool all = options.benchmark || report.found() == report.pictures.size();
  return all ? ExitCode::kDone : ExitCode::kFailed;
}

ExitCode RunInWholeStore(const LocateVerbOptions& options, Store& store, Console& console) {
  if (options.benchmark || !(options.against.empty() && options.output.empty() && options.vocabulary.empty()))
    RefuseUsage("--benchmark, --against, --output and --vocabulary are for one atlas: name it, as " + store.path() +
                "#NAME");
  Notices notices;
  const LocateReport report = LocateInWholeStore(options, store, console, notices);
  return Finish(report, options, console, notices);
}

ExitCode RunInAtlas(const LocateVerbOptions& options, Console& console) {
  Notices notices;
  const ReadOptions read = MakeReadOptions(console, options.from, options.wait);
  Atlas atlas = ReadAtlas(Location(options.input), read, &notices);
  const std::optional<LoadedVocabulary> vocabulary = LoadGivenVocabulary(options.vocabulary, console);
  HoldWords(options.input, vocabulary, console, atlas, notices);
  LocateReport report = NamingFile(options.input, [&] {
    const Locator locator(atlas, {.vocabulary = vocabulary ? &vocabulary->tree : nullptr,
                                  .threads = console.threads(),
                                  .progress = console.MakeProgress()});
    if (!options.benchmark) return LocatePictures(options, atlas, locator, console, notices);
    LocateBenchmarkOptions left_out = options.left_out;
    left_out.threads = console.threads();
    left_out.progress = console.MakeProgress();
    return BenchmarkLocating(locator, atlas, left_out);
  });
  if (!options.against.empty()) HoldAgainst(options.against, atlas, MakeReadOptions(console), report, notices);
  if (!options.output.empty()) WritePoses(report, atlas, options, console);
  return Finish(report, options, console, notices);
}

ExitCode RunLocate(const LocateVerbOptions& options, Console& console) {
  RefuseContradictions(options);
  std::optional<Store> store = OpenWholeStore(options.input, options.from, options.wait);
  return store ? RunInWholeStore(options, *store, console) : RunInAtlas(options, console);
}

Run AddLocate(CLI::App& verb) {
  const auto options = std::make_shared<LocateVerbOptions>();
  verb.add_option("INPUT", options->input, "The atlas: a file or STORE.db#NAME; a store without #NAME: all its atlases")
      ->type_name("FILE")
      ->required();
  verb.add_option("PICTURE", options->pictures,
                  "Pictures, folders of them, or lists (.txt, .csv: a picture a line, behind its time or alone)")
      ->type_name("FILE");
  AddFrom(verb, options->from);
  verb.add_option("--camera", options->camera,
                  "Settings of the camera that took them, as ORB-SLAM3 reads them (YAML); by default the map's own")
      ->type_name("FILE");
  AddVocabulary(verb, options->vocabulary);
  verb.add_option("--features", options->features, "How many features are looked for in a picture: 100 to 100,000")
      ->type_name("N")
      ->check(CLI::Range(100, 100'000).description(""))
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
    {"slamdb locate lab.db frame.png", "Which of the atlases in a store know this place?"},
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

Of a store without #NAME all atlases are asked: the store tells which keyframes look like the picture, and their maps alone are
loaded.

--benchmark leaves each keyframe out in turn, with the points that need it, and locates it by its own recorded features: the
share found and the errors tell how good the map is for localisation.)",
    .done = "Every picture was found; or the benchmark is done.",
    .failed = "A picture was not found for sure, an input could not be read, or the output not be written.",
    .examples = kExamples,
    .add = AddLocate,
};

}  // namespace slamdb::cli
