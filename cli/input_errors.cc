// SPDX-License-Identifier: BSD-3-Clause
#include "cli/input_errors.h"

#include <algorithm>

#include "cli/report/layout.h"
#include "slamdb/checks/check.h"

namespace slamdb::cli {
namespace {

// A trajectory breaks rules of what it does not hold, and has no repair.
bool HoldsAtlas(const Atlas& atlas) {
  return std::ranges::any_of(atlas.maps, [](const Map& map) {
    return std::ranges::any_of(map.points, &MapPoint::has_descriptor) || !map.landmarks.empty() ||
           std::ranges::any_of(map.keyframes,
                               [](const KeyFrame& keyframe) { return !keyframe.features.keypoints.empty(); });
  });
}

}  // namespace

void TellErrors(const std::string& input, const Atlas& atlas, const Console& console, Notices& notices) {
  if (console.quiet() || !HoldsAtlas(atlas)) return;
  CheckOptions errors{.max_findings = 1, .threads = console.threads()};
  for (const Rule& rule : ReadRules())
    if (rule.severity != Severity::kError) errors.ignore.emplace_back(rule.id);
  const CheckReport check = CheckAtlas(atlas, errors);
  if (check.ok()) return;
  notices.Warn(input + " has " + Counted(check.Count(Severity::kError), "error") + ", the first of " +
               check.results.front().id + "; `slamdb repair` it first, or the result may have them too");
}

}  // namespace slamdb::cli
