// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/cull.h"

#include <memory>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/report/layout.h"
#include "cli/report/part_text.h"
#include "slamdb/edit/part/warnings.h"

namespace slamdb::cli {
namespace {

struct CullVerbOptions {
  EditOptions edit;
  CullOptions rules;
  std::optional<double> redundancy;
  std::optional<int> min_observations;
};

std::string ReportText(const CullReport& report) {
  Table table({Table::Align::kLeft, Table::Align::kRight});
  const auto add = [&](const char* rule, std::uint64_t count) {
    if (count > 0) table.Add({rule, Grouped(count)});
  };
  add("bad points", report.bad_points);
  add("points with few observations", report.few_observations);
  add("points with large reprojection error", report.large_errors);
  add("points with small parallax", report.small_parallax);
  add("points not seen since", report.unseen);
  add("redundant keyframes", report.redundant_keyframes);
  add("points that culled keyframes held", report.unheld);
  return table.empty() ? "nothing to cull\n" : "culled\n" + table.ToString();
}

// 0 on the command line: ORB-SLAM3's number for the sensor.
template <class Number>
std::optional<OrOfSensor<Number>> AskedOf(const std::optional<Number>& asked) {
  if (!asked) return std::nullopt;
  if (*asked == Number{0}) return OfSensor();
  return *asked;
}

CullOptions RulesOf(const CullVerbOptions& options, Console& console) {
  CullOptions rules = options.rules;
  rules.redundancy = AskedOf(options.redundancy);
  rules.min_observations = AskedOf(options.min_observations);
  rules.UseOrbslam3UnlessAsked();
  rules.threads = console.threads();
  rules.progress = console.MakeProgress();
  return rules;
}

ExitCode RunCull(const CullVerbOptions& options, Console& console) {
  Notices notices;
  Atlas atlas = ReadInput(options.edit, console, notices);
  const CullReport report = Cull(atlas, RulesOf(options, console));
  WriteResult(atlas, options.edit, "cull " + options.edit.input, console, notices);
  WarnOfPoorCoverage(report.coverage, notices);
  return FinishEdit(ReportText(report) + PartText(report.removed) + CoverageText(report.coverage),
                    ToJson(report, FilesOf(options.edit)), options.edit, console, notices);
}

Run AddCull(CLI::App& verb) {
  const auto options = std::make_shared<CullVerbOptions>();
  options->edit.needs = Content::kObservations;
  AddEdit(verb, options->edit);
  constexpr const char* kGroup = "Rules";
  CullOptions& rules = options->rules;
  verb.add_option("--redundant", options->redundancy,
                  "Keyframes of whose points more than this share is seen by others at the same scale or finer; 0: "
                  "ORB-SLAM3's share for the sensor, 0.9 or, for depth with IMU, 0.5")
      ->type_name("SHARE")
      ->group(kGroup);
  verb.add_option("--observers", rules.redundant_observers, "How many others; ORB-SLAM3 says 3 and takes 4")
      ->type_name("N")
      ->capture_default_str()
      ->group(kGroup);
  verb.add_option("--min-observations", options->min_observations,
                  "Points with fewer observations, those with depth counting twice; 0: ORB-SLAM3's number for the "
                  "sensor, 3 for monocular maps and 4 for others")
      ->type_name("N")
      ->group(kGroup);
  verb.add_option("--max-error", rules.max_error,
                  "Points with a larger root mean square reprojection error, in pixels of the keypoints' octaves")
      ->type_name("PIXELS")
      ->group(kGroup);
  verb.add_option("--min-parallax", rules.min_parallax,
                  "Points without depth that no two keyframes see from directions so far apart")
      ->type_name("DEGREES")
      ->group(kGroup);
  verb.add_option("--unseen-since", rules.unseen_since, "Points that no keyframe observes at or after this time")
      ->type_name("SECONDS")
      ->group(kGroup);
  return [options](Console& console) { return RunCull(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb cull session.osa lean.osa", "ORB-SLAM3's rules, once over the whole map."},
    {"slamdb cull session.osa lean.osa --redundant 0.8", "Redundant keyframes alone, and more of them."},
    {"slamdb cull session.osa clean.osa --max-error 2.5 --min-parallax 1", "Points that are measured badly."},
    {"slamdb cull lab.db#map fresh.osa --unseen-since 1403636700", "Forgets what has not been seen lately."},
};

}  // namespace

const Command kCull = {
    .name = "cull",
    .summary = "remove redundant keyframes and poor points",
    .group = Group::kChange,
    .description =
        R"(Removes points and keyframes by rules, and closes the rest as 'slamdb extract' does. Without rules it takes those that
ORB-SLAM3's local mapping follows, for redundant keyframes and points with few observations; with rules, only those. The
first keyframe of a map and keyframes with loop or merge edges stay. Bad points always go.

ORB-SLAM3 also culls points that were found in fewer than a quarter of the frames that should have seen them; its files
do not hold those counts. The report says from how many places the map can still be localised in; docs/cull.md defines it.)",
    .failed = "The input could not be read, a rule makes no sense, or the output could not be written.",
    .lossy = kOutputLossy,
    .examples = kExamples,
    .add = AddCull,
};

}  // namespace slamdb::cli
