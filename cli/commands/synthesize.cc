// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/synthetic/synthesize.h"

#include <map>
#include <memory>

#include "cli/byte_size.h"
#include "cli/choices.h"
#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/guard.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "cli/values.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/similarity_text.h"
#include "slamdb/edit/words/words.h"
#include "slamdb/formats/formats.h"

namespace slamdb::cli {
namespace {

struct SynthesizeOptions {
  std::string output, sensor = "monocular", vocabulary, truth;
  SessionOptions sessions;
  TargetOptions target;
  SyntheticOptions atlas;
  std::uint64_t size = 0;  // bytes wanted; 0: as --keyframes and --points say
  bool overlapping = false;

  bool are_sessions() const { return overlapping || sessions.look_alike; }
};

// One transform a line: from the frame of each map to its room's.
std::string TruthOf(const SyntheticSessions& made) {
  std::string text;
  for (const Similarity3d& room_from_map : made.room_from_map) text += ToText(room_from_map) + "\n";
  return text;
}

ExitCode RunSynthesize(const SynthesizeOptions& options, Console& console) {
  RequireOutput(options.output);
  const Location output = Location::Parse(options.output);
  const Format& format = FormatOfOutput(output, options.target.to);
  RefuseBadTarget(output, format, options.target);
  RefuseBinaryOnTerminal(output, format);
  SyntheticOptions wanted = options.atlas;
  wanted.sensor = kSensors.at(options.sensor);
  wanted.threads = console.threads();
  wanted.progress = console.MakeProgress();
  if (options.size > 0) ScaleTo(options.size, wanted);
  if (options.are_sessions()) wanted.sessions = options.sessions;
  std::optional<AtomicFile> truth;
  if (!options.truth.empty()) truth.emplace(options.truth, AtomicFileOptions{.overwrite = options.target.overwrite});
  const std::optional<LoadedVocabulary> vocabulary = LoadGivenVocabulary(options.vocabulary, console);
  SyntheticSessions made = SynthesizeSessions(wanted);
  Atlas& atlas = made.atlas;
  if (vocabulary) RecomputeWords(atlas, vocabulary->tree, vocabulary->identity, {.threads = console.threads()});
  Notices notices;
  if (!vocabulary) notices.Note("its words are of no vocabulary: --vocabulary makes them of one");
  WriteAtlas(atlas, output,
             MakeWriteOptions(console, options.target, "synthesize --seed " + std::to_string(wanted.seed)), &notices);
  if (truth) {
    truth->Write(TruthOf(made));
    truth->Commit();
  }
  return FinishWriting(output,
                       ": " + Counted(atlas.maps.size(), "map") + " of " + Counted(wanted.keyframes, "keyframe") +
                           " and " + Counted(wanted.points, "point"),
                       console, notices);
}

CLI::Option* AddShare(CLI::App& verb, const char* name, double& value, const char* description, const char* group) {
  return verb.add_option(name, value, description)
      ->type_name("SHARE")
      ->check(Within(kShare))
      ->capture_default_str()
      ->group(group);
}

void AddSessions(CLI::App& verb, const std::shared_ptr<SynthesizeOptions>& options) {
  constexpr const char* kSessions = "Maps as sessions";
  CLI::Option* overlap =
      AddShare(verb, "--overlap", options->sessions.overlap,
               "The maps are sessions in one room, of which two neighbours share so much of their arc", kSessions);
  overlap->default_str({});  // not given, the maps are no sessions
  overlap->each([options](const std::string&) { options->overlapping = true; });
  AddShare(verb, "--common", options->sessions.common, "Of the points there, how many both sessions have", kSessions)
      ->needs(overlap);
  verb.add_flag("--look-alike", options->sessions.look_alike,
                "The maps are of different rooms; strips of the first one's wall are in all")
      ->excludes(overlap)
      ->group(kSessions);
  Mark(verb.add_option(
           "--truth", options->truth,
           "Write how the frame of each map lies in its room, as a line of 8 numbers that transform and merge take"),
       Writes::kFile)
      ->type_name("FILE")
      ->group(kSessions);
}

Run AddSynthesize(CLI::App& verb) {
  const auto options = std::make_shared<SynthesizeOptions>();
  SyntheticOptions& atlas = options->atlas;
  std::vector<std::string> sensors;
  for (const auto& [name, sensor] : kSensors) sensors.push_back(name);
  AddOutputPlace(verb, options->output, Writes::kAtlas, OutputAt());
  AddTarget(verb, options->target);
  constexpr const char* kGroup = "The atlas";
  verb.add_option("--sensor", options->sensor, "What sees the world")
      ->type_name("KIND")
      ->check(CLI::IsMember(sensors))
      ->capture_default_str()
      ->group(kGroup);
  verb.add_flag("--inertial", atlas.inertial, "With an IMU")->group(kGroup);
  const auto number = [&](const char* name, auto& value, const char* description) {
    return verb.add_option(name, value, description)->type_name("N")->capture_default_str()->group(kGroup);
  };
  number("--maps", atlas.maps, "How many maps")->check(Within(kMapsMade));
  CLI::Option* keyframes = number("--keyframes", atlas.keyframes, "Keyframes in each map");
  CLI::Option* points = number("--points", atlas.points, "Points in each map");
  number("--features", atlas.features, "Keypoints in each keyframe, at most");
  verb.add_option("--noise", atlas.pixel_noise, "Standard deviation of keypoints, in pixels")
      ->type_name("PIXELS")
      ->check(Within(kNonNegative))
      ->capture_default_str()
      ->group(kGroup);
  AddShare(verb, "--outliers", atlas.outliers, "Of the keypoints of points, how many show something else", kGroup);
  number("--flipped-bits", atlas.flipped_bits, "Bits at most in which a look at a point differs from its descriptor")
      ->check(Within(kBitsOfDescriptor));
  number("--seed", atlas.seed, "Another number, another atlas");
  verb.add_option("--vocabulary", options->vocabulary,
                  "Make the words of this vocabulary file, so that a SLAM system that has it can load the atlas; by "
                  "default they are made up")
      ->type_name("FILE")
      ->group(kGroup);
  AddSessions(verb, options);
  AddByteSize(
      verb, "--size", kAtlasMade, [options](std::uint64_t bytes) { options->size = bytes; },
      "Keyframes and points for a binary .osa of about this size, such as 200MB")
      ->excludes(keyframes)
      ->excludes(points)
      ->group(kGroup);
  return [options](Console& console) { return RunSynthesize(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb synthesize small.osa", "A small monocular atlas to try things on."},
    {"slamdb synthesize big.osa --size 200MB --sensor rgbd", "One for measuring."},
    {"slamdb synthesize small.osa --vocabulary ORBvoc.txt", "One that ORB-SLAM3 finds its places in."},
    {"slamdb synthesize two.osa --maps 2 --overlap 0.3 --truth truth.txt", "Two sessions in one room, to align."},
    {"slamdb synthesize lab.db#vi --sensor stereo --inertial --maps 3", "Three stereo-inertial maps, into a store."},
};

}  // namespace

const Command kSynthesize = {
    .name = "synthesize",
    .summary = "make a sound atlas of any size and sensor",
    .group = Group::kConvert,
    .description =
        R"(Makes an atlas as ORB-SLAM3 would have saved it, of a camera that goes round a room: poses, points, keypoints, descriptors,
graph and counters are geometrically consistent, and 'slamdb check' finds nothing in it. Equal options give equal bytes.
The words are made up, of a vocabulary that is none: --vocabulary, or 'slamdb vocabulary recompute' later, makes them of one.
With --overlap its maps are sessions in one room, each with its own origin and, monocular, its own scale, as 'slamdb align'
brings together; with --look-alike they are of rooms that look alike, which it must refuse.
For trying, testing and benchmarking without data.)",
    .failed = "The options contradict each other, or the output could not be written.",
    .lossy = "Done, but the output, of a format for atlases, does not hold everything that an atlas has.",
    .examples = kExamples,
    .add = AddSynthesize,
};

}  // namespace slamdb::cli
