// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/warnings.h"

#include <algorithm>

#include "slamdb/model/content.h"

namespace slamdb {

void TellWarnings(const MergeReport& report, Notices& notices) {
  for (const MapTwice& twice : report.same_maps)
    if (!twice.left_out)
      notices.Warn(ToString(twice.map) + " of " + report.inputs[twice.input].name +
                   " is in the result twice; SameMap::kKeepFirst leaves the copy out");
  for (const std::string& name : report.other_vocabularies)
    notices.Warn(name + ": its bags of words are of another vocabulary; compute them anew before place recognition");
  for (const std::string& name : report.other_layouts)
    notices.Lose(name + ": the members of its fork are of another layout than those of the result, and were left out");
  if (report.dropped_members > 0 && report.other_layouts.empty())
    notices.Lose("the members that a fork has of the atlas itself are those of the first input");
  for (const std::string& warning : report.warnings) notices.Warn(warning);
  if (!report.join) return;
  for (const std::string& warning : report.join->warnings) notices.Warn(warning);
}

std::vector<std::string> DistinctNames(std::vector<std::string> names) {
  for (std::size_t i = 1; i < names.size(); ++i) {
    const std::string name = names[i];
    for (int copy = 2; std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) !=
                       names.begin() + static_cast<std::ptrdiff_t>(i);
         ++copy)
      names[i] = name + " (" + std::to_string(copy) + ")";
  }
  return names;
}

bool HoldLandmarksAlone(const std::vector<Atlas>& atlases) {
  return std::ranges::all_of(atlases, [](const Atlas& atlas) {
    const Substance substance = SubstanceOf(atlas, /*with_bad=*/true);
    return substance.landmarks && !substance.keyframes;
  });
}

}  // namespace slamdb
