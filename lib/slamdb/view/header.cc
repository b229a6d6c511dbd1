// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/view/detail/header.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "slamdb/base/detail/amounts.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/formats/info.h"
#include "slamdb/model/detail/json.h"
#include "slamdb/model/up.h"
#include "slamdb/version.h"

namespace slamdb::view {
namespace {

using detail::Json;
using detail::Visible;

constexpr int kVersion = 1;

Json Finite(double number) { return std::isfinite(number) ? Json(number) : Json(); }

Json FactsJson(const ViewInput& input, const AtlasStatistics& statistics) {
  Json list = Json::array();
  if (!input.facts) return list;
  for (const ViewFact& fact : input.facts(statistics))
    list.push_back({{"label", Visible(fact.label)}, {"value", Visible(fact.value)}});
  return list;
}

Json StatisticsJson(const MapStatistics& map) {
  return {{"trajectory_length", Finite(map.trajectory_length)},
          {"duration", Finite(map.end_time - map.begin_time)},
          {"mean_error", map.reprojection_error.count > 0 ? Finite(map.reprojection_error.mean) : Json()},
          {"mean_observers", Finite(map.observers.mean)},
          {"components", map.components}};
}

Json UprightJson(const Up& up) {
  const Eigen::Quaterniond turn = UprightFromMap(up.direction);
  return {turn.x(), turn.y(), turn.z(), turn.w()};
}

// `ups` of its maps.
Json MapsJson(const SceneAtlas& atlas, const AtlasStatistics& statistics, std::span<const Up> ups) {
  Json list = Json::array();
  for (std::uint32_t row = 0; row < atlas.atlas().maps.size(); ++row) {
    const Map& map = atlas.atlas().maps[row];
    list.push_back({{"id", detail::JsonId(map.id)},
                    {"name", ToString(map.id)},
                    {"sensor", NameOf(statistics.maps[row].sensor)},
                    {"metric", statistics.maps[row].metric},
                    {"first_keyframe", atlas.first_keyframe + atlas.numbered.FirstKeyFrame(row)},
                    {"keyframes", map.keyframes.size()},
                    {"first_point", atlas.first_point + atlas.numbered.FirstPoint(row)},
                    {"points", map.points.size()},
                    {"up", detail::JsonOf(ups[row].direction)},
                    {"up_method", NameOf(ups[row].method)},
                    {"upright", UprightJson(ups[row])},
                    {"statistics", StatisticsJson(statistics.maps[row])}});
  }
  return list;
}

// All maps of a comparison stand in one frame.
Json AtlasesJson(const Scene& scene, const std::vector<AtlasStatistics>& statistics, bool is_diff) {
  std::vector<const Map*> maps;
  for (const SceneAtlas& atlas : scene.atlases())
    for (const Map& map : atlas.atlas().maps) maps.push_back(&map);
  const std::vector<Up> ups = UpsOf(maps, is_diff);
  std::size_t first = 0;
  Json list = Json::array();
  for (std::size_t i = 0; i < scene.atlases().size(); ++i) {
    const SceneAtlas& atlas = scene.atlases()[i];
    const auto sensor = std::ranges::find_if(
        statistics[i].maps, [](const MapStatistics& map) { return map.sensor != MapSensor::kUnknown; });
    list.push_back({{"name", Visible(atlas.input.name)},
                    {"format", Visible(atlas.input.format)},
                    {"sensor", NameOf(sensor == statistics[i].maps.end() ? MapSensor::kUnknown : sensor->sensor)},
                    {"info", FactsJson(atlas.input, statistics[i])},
                    {"maps", MapsJson(atlas, statistics[i], std::span(ups).subspan(first))}});
    first += atlas.atlas().maps.size();
  }
  return list;
}

std::string CameraText(const Camera& camera) {
  const std::vector<std::string> names = ParameterNames(camera.model);
  std::string text(NameOf(camera.model));
  for (std::size_t i = 0; i < camera.parameters.size(); ++i) {
    text += "  " + (i < names.size() ? names[i] : "?") + " ";
    detail::AppendNumber(text, camera.parameters[i]);
  }
  return text;
}

// The image of a camera, as the first keyframe that says so has it.
using ImageSizes = std::map<const Camera*, ImageBounds>;
ImageSizes ImagesOf(const SceneAtlas& atlas) {
  ImageSizes images;
  for (const KeyFrame* keyframe : atlas.numbered.keyframes) {
    const ImageBounds& bounds = keyframe->bounds;
    const Camera* camera = atlas.numbered.index().FindCamera(keyframe->camera);
    if (camera != nullptr && bounds.max_x > bounds.min_x && bounds.max_y > bounds.min_y)
      images.try_emplace(camera, bounds);
  }
  return images;
}

// The principal point is told from the corner of the image, as keypoints are.
Json CameraJson(const Camera& camera, const ImageSizes& images) {
  Json json = {{"id", detail::JsonId(camera.id)}, {"model", NameOf(camera.model)}};
  const auto image = images.find(&camera);
  const ImageBounds bounds = image == images.end() ? ImageBounds() : image->second;
  json["width"] = std::int64_t{bounds.max_x} - bounds.min_x;
  json["height"] = std::int64_t{bounds.max_y} - bounds.min_y;
  constexpr const char* kNames[] = {"fx", "fy", "cx", "cy"};
  const double corner[] = {0, 0, double(bounds.min_x), double(bounds.min_y)};
  for (std::size_t i = 0; i < 4; ++i)
    json[kNames[i]] = i < camera.parameters.size() ? Finite(double{camera.parameters[i]} - corner[i]) : Json();
  json["parameters"] = Json::array();
  for (const float parameter : camera.parameters) json["parameters"].push_back(Finite(parameter));
  json["text"] = CameraText(camera);
  return json;
}

Json CamerasJson(const Scene& scene) {
  Json list = Json::array();
  for (const SceneAtlas& atlas : scene.atlases()) {
    const ImageSizes images = ImagesOf(atlas);
    for (const Camera& camera : atlas.atlas().cameras) list.push_back(CameraJson(camera, images));
  }
  return list;
}

// Empty where every keyframe is in the map that it was made in.
Json OriginsJson(const std::vector<AtlasStatistics>& statistics) {
  std::map<std::uint32_t, std::uint64_t> keyframes;
  bool foreign = false;
  for (const AtlasStatistics& atlas : statistics)
    for (const MapStatistics& map : atlas.maps)
      for (const OriginCount& origin : map.origins) {
        keyframes[origin.map] += origin.count;
        foreign = foreign || origin.map != map.id.value();
      }
  Json list = Json::array();
  if (foreign)
    for (const auto& [id, count] : keyframes)
      list.push_back({{"id", id},
                      {"label", statistics.size() > 1  // each of them has its own
                                    ? detail::Concat("map ", id)
                                    : detail::Concat("map ", id, ", ", detail::Counted(count, "keyframe"))}});
  return list;
}

Json RulesJson(const std::vector<BrokenRule>& rules, const Wording& wording) {
  Json list = Json::array();
  for (const BrokenRule& rule : rules)
    list.push_back({{"id", rule.id},
                    {"severity", ToString(rule.severity)},
                    {"title", Visible(Worded(rule.title, wording))},
                    {"consequence", Visible(Worded(rule.consequence, wording))},
                    {"count", rule.count}});
  return list;
}

Json FindingsJson(const PlacedFindings& placed, const Wording& wording) {
  Json list = Json::array();
  for (const PlacedFinding& finding : placed.findings)
    list.push_back({{"rule", placed.rules[finding.rule].id},
                    {"severity", ToString(placed.rules[finding.rule].severity)},
                    {"place", finding.place},
                    {"text", Visible(Worded(finding.text, wording))},
                    {"atlas", finding.atlas},
                    {"map", finding.map},
                    {"kind", finding.kind},
                    {"row", finding.row},
                    {"id", finding.id}});
  return list;
}

Json DiffJson(const SceneDiff::Kind& kind) {
  return {{"added", kind.added}, {"removed", kind.removed}, {"moved", kind.moved}, {"changed", kind.changed}};
}

}  // namespace

std::string HeaderJson(const Scene& scene, const Header& header) {
  Json json = {{"version", kVersion},
               {"generator", "slamdb " + std::string(Version())},
               {"title", Visible(header.title)},
               {"fixed_part", header.fixed_part},
               {"layout", header.options.layout == ViewLayout::kSideBySide ? "side-by-side" : "overlay"},
               {"atlases", AtlasesJson(scene, header.statistics, header.diff.has_value())},
               {"cameras", CamerasJson(scene)},
               {"error_max", Finite(header.error_max)},
               {"merged_from", OriginsJson(header.statistics)},
               {"rules", RulesJson(header.findings.rules, header.options.wording)},
               {"findings", FindingsJson(header.findings, header.options.wording)},
               {"findings_left_out", header.findings.left_out},
               {"diff", nullptr},
               {"origin_of_time", detail::SecondsText(header.origin_of_time)},
               {"left_out", header.left_out}};
  if (header.diff)
    json["diff"] = {{"left", 0},
                    {"right", 1},
                    {"keyframes", DiffJson(header.diff->keyframes)},
                    {"points", DiffJson(header.diff->points)}};
  return detail::Dumped(json);
}

}  // namespace slamdb::view
