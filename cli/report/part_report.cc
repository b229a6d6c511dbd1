// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/part_report.h"

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

Totals Totals::Of(const Atlas& atlas) {
  Totals totals{.maps = atlas.maps.size()};
  for (const Map& map : atlas.maps) {
    totals.keyframes += map.keyframes.size();
    totals.points += map.points.size();
    totals.landmarks += map.landmarks.size();
  }
  return totals;
}

std::string PartText(const Totals& before, const Totals& after, const SubsetReport& removed) {
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

void WarnIfNothingIsLeft(const Totals& before, const Totals& after, Notices& notices) {
  if (before.keyframes > 0 && after.keyframes == 0) notices.Warn("no keyframe is left; milder rules keep some");
  if (before.points > 0 && after.points == 0) notices.Warn("no map point is left; milder rules keep some");
}

std::string CoverageText(const Coverage& coverage) {
  return "covers " + Share(coverage.covered, coverage.places, "place") + " (" +
         Percent(coverage.covered, coverage.places) + ") with " + std::to_string(coverage.min_points) +
         " points or more; " + Grouped(coverage.covered_before) + " before\n";
}

nlohmann::ordered_json PartJson(const Totals& before, const Totals& after, const SubsetReport& removed) {
  const auto json = [](const Totals& totals) {
    return nlohmann::ordered_json{{"maps", totals.maps},
                                  {"keyframes", totals.keyframes},
                                  {"points", totals.points},
                                  {"landmarks", totals.landmarks}};
  };
  return {{"before", json(before)},
          {"after", json(after)},
          {"cut",
           {{"observations", removed.observations},
            {"slots", removed.slots},
            {"edges", removed.edges},
            {"cameras", removed.cameras}}},
          {"chosen",
           {{"references", removed.new_references},
            {"parents", removed.new_parents},
            {"joined_preintegrations", removed.joined}}}};
}

nlohmann::ordered_json CoverageJson(const Coverage& coverage) {
  return {{"min_points", coverage.min_points},
          {"places", coverage.places},
          {"covered_before", coverage.covered_before},
          {"covered", coverage.covered}};
}

Border BorderOf(const std::string& name) {
  return name == "strict" ? Border::kStrict : name == "smart" ? Border::kSmart : Border::kCompletePoints;
}

}  // namespace slamdb::cli
