// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/locate.h"

#include <memory>
#include <optional>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/guard.h"
#include "cli/libraries.h"
#include "cli/options.h"
#include "cli/report/locate_text.h"
#include "cli/values.h"
#include "cli/whole_store.h"
#include "slamdb/align/locate_report.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/many/locate_pictures.h"

namespace slamdb::cli {
namespace {

struct LocateVerbOptions {
  std::string input, camera, vocabulary, against, output;
  InputFormat from;
  std::vector<std::string> pictures;
  std::int32_t features = 2000;
  bool benchmark = false, json = false, overwrite = false;
  LocateBenchmarkOptions left_out;
  double wait = kUsualWait;
};

LocatePicturesOptions PicturesOf(const LocateVerbOptions& options, Console& console) {
  LocatePicturesOptions pictures{.pictures = options.pictures,
                                 .features = options.features,
                                 .against = options.against,
                                 .lock_timeout = options.wait,
                                 .threads = console.threads(),
                                 .progress = console.MakeProgress()};
  if (!options.camera.empty()) pictures.camera = ReadCameraSettings(options.camera);
  return pictures;
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
  const LocateReport report = LocatePictures(store, PicturesOf(options, console), notices);
  return Finish(report, options, console, notices);
}

ExitCode RunInAtlas(const LocateVerbOptions& options, Console& console) {
  Notices notices;
  const ReadOptions read = MakeReadOptions(console, options.from, options.wait);
  Atlas atlas = ReadAtlas(Location(options.input), read, &notices);
  const std::optional<LoadedVocabulary> vocabulary = LoadGivenVocabulary(options.vocabulary, console);
  HoldWords(options.input, vocabulary, console, atlas, notices);
  const LocateReport report = NamingFile(options.input, [&] {
    const Locator locator(atlas, {.vocabulary = vocabulary ? &vocabulary->tree : nullptr,
                                  .threads = console.threads(),
                                  .progress = console.MakeProgress()});
    if (!options.benchmark) return LocatePictures(atlas, locator, PicturesOf(options, console), notices);
    LocateBenchmarkOptions left_out = options.left_out;
    left_out.threads = console.threads();
    left_out.progress = console.MakeProgress();
    return BenchmarkLocating(locator, atlas, left_out);
  });
  if (!options.output.empty())
    WriteOutput({.path = options.output, .overwrite = options.overwrite}, PosesFound(report, atlas), console);
  return Finish(report, options, console, notices);
}

ExitCode RunLocate(const LocateVerbOptions& options, Console& console) {
  if (!options.pictures.empty()) GoOnWithLibraries();
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
      ->check(Within(kLocateFeatures))
      ->capture_default_str();
  verb.add_option("--against", options->against,
                  "A trajectory of true poses, paired by time: the found poses are laid onto it, and the errors told")
      ->type_name("FILE");
  verb.add_flag("--benchmark", options->benchmark,
                "Leave each keyframe out in turn and locate it by its own features: no pictures are needed");
  verb.add_option("--most", options->left_out.most_keyframes,
                  "With --benchmark: at most so many keyframes, at equal steps")
      ->type_name("N")
      ->check(Within(kPositive))
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
