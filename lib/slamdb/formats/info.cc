// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/info.h"

#include <array>
#include <charconv>
#include <cmath>

#include "slamdb/base/detail/file_size.h"
#include "slamdb/formats/detail/choose.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/json.h"
#include "slamdb/model/detail/path.h"

namespace slamdb {
namespace {

using detail::Json;

// The shortest decimal number that is this float again: 458.654, not the 458.65399169921875 that a double would show.
Json FloatJson(float number) {
  if (!std::isfinite(number)) return nullptr;
  std::array<char, 32> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), number);
  double value = 0;
  std::from_chars(text.data(), written.ptr, value);
  return value;
}

Json VectorJson(const Eigen::Vector3f& vector) {
  return {FloatJson(vector.x()), FloatJson(vector.y()), FloatJson(vector.z())};
}

Json CameraJson(const Camera& camera) {
  Json parameters = Json::object();
  const std::vector<std::string> names = ParameterNames(camera.model);
  for (std::size_t i = 0; i < camera.parameters.size(); ++i)
    parameters[i < names.size() ? names[i] : "parameter_" + std::to_string(i)] = FloatJson(camera.parameters[i]);
  return {{"id", detail::JsonId(camera.id)}, {"model", NameOf(camera.model)}, {"parameters", parameters}};
}

Json OriginsJson(const std::vector<OriginCount>& origins) {
  Json list = Json::array();
  for (const OriginCount& origin : origins) list.push_back({{"map", origin.map}, {"keyframes", origin.count}});
  return list;
}

Json BoxJson(const Eigen::AlignedBox3f& box) {
  if (box.isEmpty()) return nullptr;
  return {{"min", VectorJson(box.min())}, {"max", VectorJson(box.max())}};
}

Json MapJson(const MapStatistics& map) {
  return {{"id", detail::JsonId(map.id)},
          {"sensor", NameOf(map.sensor)},
          {"imu", map.has_imu},
          {"keyframes", map.keyframes},
          {"bad_keyframes", map.bad_keyframes},
          {"points", map.points},
          {"bad_points", map.bad_points},
          {"landmarks", map.landmarks},
          {"features", map.features},
          {"observations", map.observations},
          {"observers_per_point", detail::JsonOf(map.observers)},
          {"points_by_observers", map.observer_histogram},
          {"reprojection_error_px", detail::JsonOf(map.reprojection_error)},
          {"unprojectable_observations", map.unprojectable},
          {"covisibility_edges", map.covisibility_edges},
          {"loop_edges", map.loop_edges},
          {"merge_edges", map.merge_edges},
          {"components", map.components},
          {"largest_component", map.largest_component},
          {"up", VectorJson(map.up.direction.cast<float>())},
          {"up_method", NameOf(map.up.method)},
          {"bounding_box", BoxJson(map.bounding_box)},
          {"trajectory_length", map.trajectory_length},
          {"begin_time", map.begin_time},
          {"end_time", map.end_time},
          {"inertial",
           {{"inertial", map.inertial},
            {"imu_initialized", map.imu_initialized},
            {"imu_ba1", map.imu_ba1},
            {"imu_ba2", map.imu_ba2}}},
          {"origins", OriginsJson(map.origins)},
          {"initial_keyframe", detail::JsonId(map.initial_keyframe)},
          {"lowest_keyframe", detail::JsonId(map.lowest_keyframe)},
          {"max_keyframe_id", detail::JsonNumber(map.max_keyframe_id)},
          {"largest_keyframe_id", detail::JsonNumber(map.largest_keyframe_id)},
          {"largest_point_id", detail::JsonNumber(map.largest_point_id)}};
}

Json TotalsJson(const AtlasStatistics& totals) {
  std::uint64_t landmarks = 0;
  for (const MapStatistics& map : totals.maps) landmarks += map.landmarks;
  return {{"maps", totals.maps.size()},
          {"keyframes", totals.keyframes},
          {"points", totals.points},
          {"landmarks", landmarks},
          {"bad_keyframes", totals.bad_keyframes},
          {"bad_points", totals.bad_points},
          {"features", totals.features},
          {"observations", totals.observations},
          {"covisibility_edges", totals.covisibility_edges},
          {"loop_edges", totals.loop_edges},
          {"merge_edges", totals.merge_edges},
          {"trajectory_length", totals.trajectory_length}};
}

std::vector<Eigen::Vector3f> PathOf(const Map& map) {
  std::vector<Eigen::Vector3f> path;
  for (const KeyFrame* keyframe : detail::GoodByTime(map)) path.push_back(CameraCenter(*keyframe));
  return path;
}

}  // namespace

AtlasInfo InfoOf(const Atlas& atlas, const Format& format, const std::string& input) {
  AtlasInfo info{.input = input, .format_id = std::string(format.id), .format_title = std::string(format.title)};
  if (format.keeps_encoding) info.encoding = atlas.encoding;
  info.layout = atlas.layout;
  info.vocabulary = atlas.vocabulary;
  info.next_ids = atlas.next_ids;
  info.cameras = atlas.cameras;
  info.repeated_maps = atlas.repeated_maps.size();
  return info;
}

AtlasInfo ReadInfo(const Location& location, ReadOptions options, Notices* notices, bool header_only) {
  const HeldSource held = detail::Hold({location.path, location.name}, options);
  const Format& found = detail::FormatToRead(held.source(), options);
  std::vector<PartSize> parts;
  options.features = header_only ? FeatureColumns::kNone : FeatureColumns::kGeometry;
  options.part_sizes = &parts;
  Notices unheard;
  const Atlas atlas = detail::ReadInMemory(
      held.source(), [&] { return found.read(held.source(), options, notices == nullptr ? unheard : *notices); });
  AtlasInfo info = InfoOf(atlas, found, location.ToString());
  info.parts = std::move(parts);
  const std::optional<Bytes>& memory = held.source().memory;
  info.bytes = memory ? memory->size() : detail::FileSize(location.path);
  if (header_only) return info;
  info.statistics = ComputeStatistics(atlas, options.threads);
  for (const Map& map : atlas.maps) info.paths.push_back(PathOf(map));
  return info;
}

std::string ToJson(const AtlasInfo& info, int indent) {
  Json json = detail::ReportHead("info", info.input);
  json["format"] = info.format_id;
  json["bytes"] = detail::NumberOrNull(info.bytes);
  if (info.encoding) json["encoding"] = detail::JsonOf(*info.encoding);
  if (!info.layout.empty()) json["layout"] = info.layout;
  json["vocabulary"] = detail::JsonOf(info.vocabulary);
  json["next_ids"] = detail::JsonOf(info.next_ids);
  json["cameras"] = Json::array();
  for (const Camera& camera : info.cameras) json["cameras"].push_back(CameraJson(camera));
  json["repeated_maps"] = info.repeated_maps;
  json["maps"] = Json::array();
  for (const MapStatistics& map : info.statistics.maps) json["maps"].push_back(MapJson(map));
  json["totals"] = TotalsJson(info.statistics);
  json["parts"] = Json::array();
  for (const PartSize& part : info.parts) json["parts"].push_back({{"part", part.part}, {"bytes", part.bytes}});
  return detail::JsonText(json, indent);
}

std::string_view NameOf(MapSensor sensor) {
  constexpr std::array<std::string_view, 4> kNames = {"unknown", "monocular", "stereo-or-rgbd", "fisheye-stereo"};
  return kNames.at(static_cast<std::size_t>(sensor));
}

std::string_view NameOf(CameraModel model) {
  constexpr std::array<std::string_view, 3> kNames = {"pinhole", "kannala-brandt-8", "equirectangular"};
  return kNames.at(static_cast<std::size_t>(model));
}

std::vector<std::string> ParameterNames(CameraModel model) {
  if (model == CameraModel::kEquirectangular) return {"columns", "rows"};
  if (model == CameraModel::kPinhole) return {"fx", "fy", "cx", "cy"};
  return {"fx", "fy", "cx", "cy", "k0", "k1", "k2", "k3"};
}

}  // namespace slamdb
