// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <charconv>
#include <cmath>

#include "cli/report/info_report.h"

namespace slamdb::cli {
namespace {

using nlohmann::ordered_json;

// -1, as ORB-SLAM3 has it, for no id at all would not be an id: null.
template <class Entity>
ordered_json IdJson(Id<Entity> id) {
  return id.has_value() ? ordered_json(id.value()) : ordered_json();
}

// The shortest decimal number that is this float again: 458.654, not the 458.65399169921875 that a double would show.
ordered_json FloatJson(float number) {
  if (!std::isfinite(number)) return nullptr;
  std::array<char, 32> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), number);
  double value = 0;
  std::from_chars(text.data(), written.ptr, value);
  return value;
}

ordered_json VectorJson(const Eigen::Vector3f& vector) {
  return {FloatJson(vector.x()), FloatJson(vector.y()), FloatJson(vector.z())};
}

ordered_json DistributionJson(const Distribution& numbers) {
  return {{"count", numbers.count}, {"mean", numbers.mean}, {"median", numbers.median}, {"max", numbers.max}};
}

ordered_json CameraJson(const Camera& camera) {
  ordered_json parameters = ordered_json::object();
  const std::vector<std::string> names = ParameterNames(camera.model);
  for (std::size_t i = 0; i < camera.parameters.size(); ++i)
    parameters[i < names.size() ? names[i] : "parameter_" + std::to_string(i)] = FloatJson(camera.parameters[i]);
  return {{"id", IdJson(camera.id)}, {"model", CameraModelName(camera.model)}, {"parameters", parameters}};
}

ordered_json OriginsJson(const std::vector<OriginCount>& origins) {
  ordered_json list = ordered_json::array();
  for (const OriginCount& origin : origins) list.push_back({{"map", origin.map}, {"keyframes", origin.count}});
  return list;
}

ordered_json BoxJson(const Eigen::AlignedBox3f& box) {
  if (box.isEmpty()) return nullptr;
  return {{"min", VectorJson(box.min())}, {"max", VectorJson(box.max())}};
}

ordered_json MapJson(const MapStatistics& map) {
  return {{"id", IdJson(map.id)},
          {"sensor", SensorName(map.sensor)},
          {"imu", map.has_imu},
          {"keyframes", map.keyframes},
          {"bad_keyframes", map.bad_keyframes},
          {"points", map.points},
          {"bad_points", map.bad_points},
          {"landmarks", map.landmarks},
          {"features", map.features},
          {"observations", map.observations},
          {"observers_per_point", DistributionJson(map.observers)},
          {"points_by_observers", map.observer_histogram},
          {"reprojection_error_px", DistributionJson(map.reprojection_error)},
          {"unprojectable_observations", map.unprojectable},
          {"covisibility_edges", map.covisibility_edges},
          {"loop_edges", map.loop_edges},
          {"merge_edges", map.merge_edges},
          {"components", map.components},
          {"largest_component", map.largest_component},
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
          {"initial_keyframe", IdJson(map.initial_keyframe)},
          {"lowest_keyframe", IdJson(map.lowest_keyframe)},
          {"max_keyframe_id", map.max_keyframe_id},
          {"largest_keyframe_id", map.largest_keyframe_id},
          {"largest_point_id", map.largest_point_id}};
}

ordered_json TotalsJson(const AtlasStatistics& totals) {
  return {{"maps", totals.maps.size()},
          {"keyframes", totals.keyframes},
          {"points", totals.points},
          {"bad_keyframes", totals.bad_keyframes},
          {"bad_points", totals.bad_points},
          {"features", totals.features},
          {"observations", totals.observations},
          {"covisibility_edges", totals.covisibility_edges},
          {"loop_edges", totals.loop_edges},
          {"merge_edges", totals.merge_edges},
          {"trajectory_length", totals.trajectory_length}};
}

}  // namespace

std::string SensorName(MapSensor sensor) {
  constexpr std::array<const char*, 4> kNames = {"unknown", "monocular", "stereo-or-rgbd", "fisheye-stereo"};
  return kNames.at(static_cast<std::size_t>(sensor));
}

std::string CameraModelName(CameraModel model) {
  return model == CameraModel::kKannalaBrandt8 ? "kannala-brandt-8" : "pinhole";
}

std::vector<std::string> ParameterNames(CameraModel model) {
  if (model == CameraModel::kPinhole) return {"fx", "fy", "cx", "cy"};
  return {"fx", "fy", "cx", "cy", "k0", "k1", "k2", "k3"};
}

ordered_json InfoJson(const InfoReport& report) {
  ordered_json json = {{"file", report.file}, {"format", report.format_id}};
  json["size_bytes"] = report.size_bytes ? ordered_json(*report.size_bytes) : ordered_json();
  if (report.has_encoding)
    json["archive"] = {{"text", report.encoding.text},
                       {"boost_version", report.encoding.boost_version},
                       {"long_bytes", report.encoding.long_bytes},
                       {"size_bytes", report.encoding.size_bytes}};
  json["vocabulary"] = {{"name", report.vocabulary.name}, {"checksum", report.vocabulary.checksum}};
  json["next_ids"] = {{"map", report.next_ids.map},           {"frame", report.next_ids.frame},
                      {"keyframe", report.next_ids.keyframe}, {"map_point", report.next_ids.map_point},
                      {"camera", report.next_ids.camera},     {"initial_keyframe", report.next_ids.initial_keyframe}};
  json["cameras"] = ordered_json::array();
  for (const Camera& camera : report.cameras) json["cameras"].push_back(CameraJson(camera));
  json["repeated_maps"] = report.repeated_maps;
  json["maps"] = ordered_json::array();
  for (const MapStatistics& map : report.statistics.maps) json["maps"].push_back(MapJson(map));
  json["totals"] = TotalsJson(report.statistics);
  json["parts"] = ordered_json::array();
  for (const PartSize& part : report.parts) json["parts"].push_back({{"part", part.part}, {"bytes", part.bytes}});
  return json;
}

}  // namespace slamdb::cli
