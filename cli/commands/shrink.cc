// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/shrink.h"

#include <cmath>
#include <memory>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/report/layout.h"
#include "cli/report/part_text.h"
#include "slamdb/base/error.h"

namespace slamdb::cli {
namespace {

constexpr double kMegabyte = 1e6;

struct ShrinkVerbOptions {
  EditOptions edit;
  std::optional<double> target_megabytes;
  ShrinkOptions shrink;
  std::string purpose, vocabulary;
};

std::string SizesText(const ShrinkReport& report) {
  std::string text;
  if (report.features_dropped > 0)
    text += "dropped " + Counted(report.features_dropped, "feature") + " without point\n";
  if (report.measurements_dropped > 0)
    text += "dropped " + Counted(report.measurements_dropped, "IMU measurement") + "\n";
  return text + "takes " + HumanBytes(report.bytes_after) + " as .osa, " + HumanBytes(report.bytes_before) +
         " before\n";
}

ExitCode RunShrink(const ShrinkVerbOptions& options, Console& console) {
  ShrinkOptions shrink = options.shrink;
  if (options.target_megabytes)
    shrink.target_bytes = static_cast<std::uint64_t>(std::floor(*options.target_megabytes * kMegabyte));
  shrink.for_localization = options.purpose == "localization";
  if (!shrink.target_bytes && !shrink.target_keyframes && !shrink.for_localization && !shrink.largest_map)
    RefuseUsage("say how small: --target-mb, --target-keyframes, --for localization, or --largest-map");
  shrink.threads = console.threads();
  shrink.progress = console.MakeProgress();
  Notices notices;
  Atlas atlas = ReadInput(options.edit, console, notices);
  HoldWords(options.edit.input, LoadGivenVocabulary(options.vocabulary, console), console, atlas, notices);
  const ShrinkReport report = Shrink(atlas, shrink);
  WriteResult(atlas, options.edit, "shrink " + options.edit.input, console, notices);
  WarnOfPoorCoverage(report.coverage, notices);
  return FinishEdit(PartText(report.removed) + SizesText(report) + CoverageText(report.coverage),
                    ToJson(report, FilesOf(options.edit)), options.edit, console, notices);
}

Run AddShrink(CLI::App& verb) {
  const auto options = std::make_shared<ShrinkVerbOptions>();
  options->edit.needs = Content::kObservations;
  AddEdit(verb, options->edit);
  AddVocabulary(verb, options->vocabulary);
  constexpr const char* kGroup = "How small";
  verb.add_option("--target-mb", options->target_megabytes, "At most so many megabytes (1,000,000 bytes) as .osa file")
      ->type_name("MB")
      ->check(CheckPositive)
      ->group(kGroup);
  verb.add_option("--target-keyframes", options->shrink.target_keyframes, "At most so many keyframes")
      ->type_name("N")
      ->check(CheckPositive)
      ->group(kGroup);
  verb.add_option("--for", options->purpose, "localization: without features that see no point and IMU measurements")
      ->type_name("PURPOSE")
      ->check(CLI::IsMember({"localization"}))
      ->group(kGroup);
  verb.add_flag("--largest-map", options->shrink.largest_map, "Only the map with most keyframes; the others go")
      ->group(kGroup);
  verb.add_option("--min-points", options->shrink.min_points, "With how many points a place counts as covered")
      ->type_name("N")
      ->check(CheckPositive)
      ->capture_default_str()
      ->group(kGroup);
  return [options](Console& console) { return RunShrink(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb shrink session.osa small.osa --target-mb 10", "Fits a map into 10 MB, keeping what most places need."},
    {"slamdb shrink session.osa small.osa --target-keyframes 60", "The 60 keyframes that cover most."},
    {"slamdb shrink atlas.osa robot.osa --for localization",
     "What a robot needs that only localises: about a third smaller, and no place less."},
    {"slamdb shrink atlas.osa robot.osa --for localization --largest-map", "The same of the largest map alone."},
};

}  // namespace

const Command kShrink = {
    .name = "shrink",
    .summary = "make an atlas small and keep the places it covers",
    .group = Group::kChange,
    .description =
        R"(Keeps the keyframes that cover most places, as many as the target allows, and the points that they observe; the rest is
closed as 'slamdb extract' does. Each keyframe of the input stands for its place; a place is covered when enough of the
points that it sees are kept. Points that need two keyframes stay only where two that see them are kept, and no choice
covers less than as many consecutive or evenly spaced keyframes would. A warning tells when less than 80% of the places
that were covered still are.

--for localization also drops what ORB-SLAM3 does not need to load a map and localise in it. Such a map is not for being
extended: mapping wants the features that see no point yet.)",
    .failed = "The input could not be read, the target is too small, or the output could not be written.",
    .lossy = kOutputLossy,
    .examples = kExamples,
    .add = AddShrink,
};

}  // namespace slamdb::cli
