// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

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

}  // namespace

PlacedFindings PlaceFindings(const Scene& scene, const std::vector<CheckReport>& reports, Severity least) {
  PlacedFindings placed;
  for (std::size_t i = 0; i < reports.size(); ++i)
    for (const RuleResult& result : reports[i].results) {
      if (result.severity < least) continue;
      placed.left_out += result.count - result.findings.size();
      for (const Finding& finding : result.findings) {
        placed.findings.push_back({.rule = result.id,
                                   .text = finding.message,
                                   .id = {},
                                   .severity = result.severity,
                                   .kind = {},
                                   .atlas = i});
        Locate(scene.atlases()[i], finding.place, placed.findings.back());
      }
    }
  std::ranges::stable_sort(placed.findings,
                           [](const PlacedFinding& a, const PlacedFinding& b) { return a.severity > b.severity; });
  return placed;
}

}  // namespace slamdb::view
