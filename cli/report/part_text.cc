// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/part_text.h"

#include "cli/report/layout.h"

namespace slamdb::cli {
namespace {

std::string Share(std::uint64_t after, std::uint64_t before, const char* what) {
  return Grouped(after) + " of " + Counted(before, what);
}

// "a, b and c" of those that are not zero.
class Sentence {
 public:
  void Add(std::uint64_t count, const char* one, const char* many = "") {
    if (count > 0) parts_.push_back(*many == '\0' ? Counted(count, one) : Counted(count, one, many));
  }
  std::string ToString(const std::string& verb) const {
    std::string text;
    for (std::size_t i = 0; i < parts_.size(); ++i)
      text += (i == 0 ? verb : i + 1 == parts_.size() ? " and " : ", ") + parts_[i];
    return text.empty() ? text : text + "\n";
  }

 private:
  std::vector<std::string> parts_;
};

}  // namespace

std::string PartText(const SubsetReport& removed) {
  const EntityCounts &before = removed.before, &after = removed.after;
  std::string text = "kept " + Share(after.maps, before.maps, "map") + ", " +
                     Share(after.keyframes, before.keyframes, "keyframe") + ", " +
                     Share(after.points, before.points, "point");
  if (before.landmarks > 0) text += ", " + Share(after.landmarks, before.landmarks, "landmark");
  text += "\n";
  Sentence cut, chosen;
  cut.Add(removed.observations, "observation");
  cut.Add(removed.slots, "slot");
  cut.Add(removed.edges, "edge");
  cut.Add(removed.cameras, "camera");
  chosen.Add(removed.new_references, "reference keyframe");
  chosen.Add(removed.new_parents, "parent");
  chosen.Add(removed.joined, "joined preintegration");
  return text + cut.ToString("cut ") + chosen.ToString("chose ");
}

std::string CoverageText(const Coverage& coverage) {
  return "covers " + Share(coverage.covered, coverage.places, "place") + " (" +
         Percent(coverage.covered, coverage.places) + ") with " + std::to_string(coverage.min_points) +
         " points or more; " + Grouped(coverage.covered_before) + " before\n";
}

}  // namespace slamdb::cli
