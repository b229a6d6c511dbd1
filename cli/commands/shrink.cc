// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <map>
#include <memory>

#include "cli/choices.h"
#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/report/layout.h"
#include "cli/report/part_text.h"
#include "cli/values.h"
#include "slamdb/align/shrink_for_locating.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/part/warnings.h"

namespace slamdb::cli {
namespace {

constexpr double kMegabyte = 1e6;

struct ShrinkVerbOptions {
  EditOptions edit;
  std::optional<double> target_megabytes;
  ShrinkOptions shrink;
  std::string purpose, vocabulary;
};

std::string FoundText(const ShrinkReport& report) {
  if (!report.found) return {};
  const auto& [places, before, after] = *report.found;
  return "finds " + Grouped(after) + " of " + Counted(places, "place") + " (" + Percent(after, places) + "); " +
         Grouped(before) + " before (" + Percent(before, places) + ")\n";
}

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
  if (!options.purpose.empty()) shrink.*kPurposes.at(options.purpose) = true;
  if (!shrink.target_bytes && !shrink.target_keyframes && !shrink.for_localization && !shrink.largest_map)
    RefuseUsage("say how small: --target-mb, --target-keyframes, --for localization, or --largest-map");
  shrink.threads = console.threads();
  shrink.progress = console.MakeProgress();
  Notices notices;
  Atlas atlas = ReadInput(options.edit, console, notices);
  HoldWords(options.edit.input, LoadGivenVocabulary(options.vocabulary, console), console, atlas, notices);
  const ShrinkReport report = NamingFile(options.edit.input, [&] { return ShrinkForLocating(atlas, shrink); });
  WriteResult(atlas, options.edit, "shrink " + options.edit.input, console, notices);
  WarnOfPoorCoverage(report.coverage, notices);
  return FinishEdit(PartText(report.removed) + SizesText(report) + CoverageText(report.coverage) + FoundText(report),
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
      ->check(Within(kPositive))
      ->group(kGroup);
  verb.add_option("--target-keyframes", options->shrink.target_keyframes, "At most so many keyframes")
      ->type_name("N")
      ->check(Within(kPositive))
      ->group(kGroup);
  verb.add_option("--for", options->purpose,
                  "localization: without features that see no point and IMU measurements; mapping: with them, however "
                  "few megabytes are asked for")
      ->type_name("PURPOSE")
      ->check(CLI::IsMember(kPurposes))
      ->group(kGroup);
  verb.add_flag("--largest-map", options->shrink.largest_map, "Only the map with most keyframes; the others go")
      ->group(kGroup);
  verb.add_option("--min-points", options->shrink.min_points,
                  "With how many points of a keyframe a camera is found, and a place covered")
      ->type_name("N")
      ->check(Within(kPositive))
      ->capture_default_str()
      ->group(kGroup);
  return [options](Console& console) { return RunShrink(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb shrink session.osa small.osa --target-mb 10",
     "Fits a map into 10 MB, keeping what a camera is found by, and says how much that is."},
    {"slamdb shrink session.osa small.osa --target-keyframes 60", "The 60 keyframes that find most."},
    {"slamdb shrink session.osa small.osa --target-mb 10 --for mapping", "The same for a map that is to be extended."},
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
        R"(Keeps the keyframes by which a camera is found from most places, as many as the target allows, and the points that they
observe; the rest is closed as 'slamdb extract' does. Each keyframe of the input stands for a place: it is left out, and what
its picture shows of each other keyframe is counted, as ORB-SLAM3 relocalises by one keyframe's points, and tries only
keyframes that have most words in common with the picture. Keyframes that stand in the way of others go, too. Points that need
two keyframes stay only where two that see them are kept.

--for localization drops what ORB-SLAM3 does not need to load a map and localise in it. Such a map is not for being extended:
mapping wants the features that see no point yet. --target-mb drops that first, before any keyframe; with --for mapping
keyframes alone go.

What was found before and after is measured by 'slamdb locate' of at most a hundred keyframes, each as if the map had never
had it. A place is covered when enough of the points that it sees are kept; a warning tells when less than 80% of the places
that were covered still are.)",
    .failed = "The input could not be read, the target is too small, or the output could not be written.",
    .lossy = kOutputLossy,
    .examples = kExamples,
    .add = AddShrink,
};

}  // namespace slamdb::cli
