// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <functional>

#include "slamdb/view/detail/header.h"

namespace slamdb::view {
namespace {

// In which map of the atlas a place is; kNoRow when it does not say.
std::uint32_t MapOf(const AtlasIndex& index, const Place& place) {
  if (place.map) return index.MapRow(place.map);
  if (place.point) return index.LocatePoint(place.point).map;
  if (place.keyframe) return index.LocateKeyFrame(place.keyframe).map;
  return kNoRow;
}

void Locate(const SceneAtlas& atlas, const Place& place, PlacedFinding& finding) {
  const std::uint32_t map = MapOf(atlas.numbered.index(), place);
  if (map != kNoRow) finding.map = std::int64_t{atlas.first_map} + map;
  if (place.point) {
    finding.kind = "point";
    finding.id = std::to_string(place.point.value());
    if (map != kNoRow) finding.row = atlas.PointRow(map, place.point);
  } else if (place.keyframe) {
    finding.kind = "keyframe";
    finding.id = std::to_string(place.keyframe.value());
    if (map != kNoRow) finding.row = atlas.KeyFrameRow(map, place.keyframe);
  } else if (place.camera) {
    finding.kind = "camera";
    finding.id = std::to_string(place.camera.value());
    const std::uint32_t row = atlas.numbered.index().CameraRow(place.camera);
    if (row != kNoRow) finding.row = std::int64_t{atlas.first_camera} + row;
  } else {
    finding.kind = place.map ? "map" : "atlas";
    finding.id = place.map ? std::to_string(place.map.value()) : "";
  }
}

// Rules that found something in any atlas, errors first, else as the catalogue has them.
std::vector<BrokenRule> RulesOf(const std::vector<CheckReport>& reports, Severity least) {
  std::vector<BrokenRule> rules;
  for (const CheckReport& report : reports)
    for (const RuleResult& result : report.results) {
      if (result.severity < least) continue;
      auto rule = std::ranges::find(rules, result.id, &BrokenRule::id);
      if (rule == rules.end())
        rule = rules.insert(
            rules.end(),
            {.id = result.id, .title = result.title, .consequence = result.consequence, .severity = result.severity});
      rule->count += result.count;
    }
  std::ranges::stable_sort(rules, std::ranges::greater(), &BrokenRule::severity);
  return rules;
}

}  // namespace

PlacedFindings PlaceFindings(const Scene& scene, const std::vector<CheckReport>& reports, Severity least) {
  PlacedFindings placed{.rules = RulesOf(reports, least)};
  for (std::size_t i = 0; i < reports.size(); ++i)
    for (const RuleResult& result : reports[i].results) {
      const auto rule = std::ranges::find(placed.rules, result.id, &BrokenRule::id);
      if (rule == placed.rules.end()) continue;
      placed.left_out += result.count - result.findings.size();
      for (const Finding& finding : result.findings) {
        placed.findings.push_back({.rule = std::size_t(rule - placed.rules.begin()),
                                   .place = ToString(finding.place),
                                   .text = finding.message,
                                   .id = {},
                                   .kind = {},
                                   .atlas = i});
        Locate(scene.atlases()[i], finding.place, placed.findings.back());
      }
    }
  std::ranges::stable_sort(placed.findings, std::ranges::less(), &PlacedFinding::rule);
  return placed;
}

}  // namespace slamdb::view
