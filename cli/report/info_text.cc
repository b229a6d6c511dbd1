// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/info_text.h"

#include <algorithm>
#include <functional>
#include <numeric>

#include "cli/boost_versions.h"
#include "cli/report/layout.h"
#include "cli/report/plan.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/formats/layouts/layout.h"

namespace slamdb::cli {
namespace {

using enum Table::Align;

std::string VectorText(const Eigen::Vector3f& vector) {
  return Rounded(vector.x()) + " " + Rounded(vector.y()) + " " + Rounded(vector.z());
}

std::string TextOfSensor(const MapStatistics& map) {
  if (map.keyframes == 0 && map.landmarks > 0) return Counted(map.landmarks, "landmark");
  if (map.keyframes == 0) return map.points > 0 ? "points alone" : "empty";
  return SensorText(map.sensor, map.has_imu);
}

std::string InertialText(const MapStatistics& map) {
  if (!map.imu_initialized) return "not initialised";
  if (map.imu_ba2) return "initialised, both bundle adjustments done";
  return map.imu_ba1 ? "initialised, first bundle adjustment done" : "initialised, no bundle adjustment yet";
}

std::string WithBad(std::uint64_t count, std::uint64_t bad) {
  return Grouped(count) + (bad == 0 ? "" : " (" + Grouped(bad) + " flagged bad)");
}

std::string OriginsText(const MapStatistics& map) {
  std::string text;
  for (const OriginCount& origin : map.origins)
    text += (text.empty() ? "" : ", ") + ("map " + std::to_string(origin.map)) + " (" +
            Counted(origin.count, "keyframe") + ")";
  return text;
}

template <class Entity>
std::string IdText(Id<Entity> id) {
  return id.has_value() ? std::to_string(id.value()) : "none";
}

// Whether any keyframe was made in another map.
bool HasForeignOrigins(const MapStatistics& map) {
  return std::any_of(map.origins.begin(), map.origins.end(),
                     [&](const OriginCount& origin) { return origin.map != map.id.value(); });
}

std::string UnitOf(const MapStatistics& map) { return map.metric ? "m" : "units"; }

void AddShape(const MapStatistics& map, std::vector<InfoRow>& rows) {
  if (!map.bounding_box.isEmpty())
    rows.push_back({"bounding box", VectorText(map.bounding_box.min()) + "  to  " + VectorText(map.bounding_box.max()) +
                                        " " + UnitOf(map) + ", world with " + FrameText(map.up)});
  rows.push_back({"trajectory", LengthText(map.trajectory_length, UnitOf(map)) + " in " +
                                    DatedDuration(map.begin_time, map.end_time)});
}

// On the plan right and up are x and y of the map turned upright: x and z of one with y down.
std::string PlanOf(const MapStatistics& map, const std::vector<Eigen::Vector3f>& path, std::size_t width,
                   std::size_t height) {
  const Eigen::Matrix3d axes = UprightFromMap(map.up.direction).toRotationMatrix();
  std::vector<Eigen::Vector2d> places;
  for (const Eigen::Vector3f& place : path) places.emplace_back((axes * place.cast<double>()).head<2>());
  const auto right = NearAxis(axes.row(0)), up = NearAxis(axes.row(1));
  return PlanText(places, UnitOf(map) + (right && up ? "; right " + *right + ", up " + *up : ""), width, height);
}

// Maps that are drawn: by row, those with most keyframes.
std::vector<bool> DrawnMaps(const AtlasInfo& report) {
  constexpr std::size_t kMost = 6;
  const std::vector<MapStatistics>& maps = report.statistics.maps;
  std::vector<std::size_t> rows(maps.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::ranges::stable_sort(rows, std::greater(), [&](std::size_t row) { return maps[row].keyframes; });
  rows.resize(std::min(rows.size(), kMost));
  std::vector<bool> drawn(maps.size());
  for (const std::size_t row : rows) drawn[row] = true;
  return drawn;
}

InfoSection SectionOf(const MapStatistics& map) {
  InfoSection section{.heading = {"map " + IdText(map.id), TextOfSensor(map)}, .rows = {}};
  if (map.keyframes == 0 && map.points == 0) return section;
  std::vector<InfoRow>& rows = section.rows;
  rows.push_back({"keyframes", WithBad(map.keyframes, map.bad_keyframes)});
  rows.push_back({"points", WithBad(map.points, map.bad_points)});
  if (map.landmarks > 0) rows.push_back({"landmarks", Grouped(map.landmarks)});
  rows.push_back({"features", Grouped(map.features)});
  rows.push_back({"observations", Grouped(map.observations) + "; a point is seen by " + Short(map.observers.mean, 3) +
                                      " keyframes, median " + Short(map.observers.median) + ", at most " +
                                      Short(map.observers.max, 6)});
  if (map.reprojection_error.count > 0)
    rows.push_back({"reprojection", Short(map.reprojection_error.mean, 3) + " px on average, median " +
                                        Short(map.reprojection_error.median, 3)});
  rows.push_back(
      {"covisibility", Counted(map.covisibility_edges, "edge") + " in " + Counted(map.components, "component")});
  if (map.loop_edges + map.merge_edges > 0)
    rows.push_back({"closures", Counted(map.loop_edges, "loop edge") + ", " + Counted(map.merge_edges, "merge edge")});
  AddShape(map, rows);
  if (map.has_imu) rows.push_back({"inertial", InertialText(map)});
  rows.push_back({"keyframe ids", "initial " + IdText(map.initial_keyframe) + ", lowest " +
                                      IdText(map.lowest_keyframe) + ", largest " +
                                      std::to_string(map.largest_keyframe_id)});
  if (HasForeignOrigins(map)) rows.push_back({"made in", OriginsText(map)});
  return section;
}

std::string CameraText(const Camera& camera) {
  const std::vector<std::string> names = ParameterNames(camera.model);
  std::string text(NameOf(camera.model));
  for (std::size_t i = 0; i < camera.parameters.size(); ++i)
    text += "  " + (i < names.size() ? names[i] : "?") + " " + Short(camera.parameters[i], 6);
  return text;
}

// `gnss: calibration of a GNSS antenna in keyframes`.
std::string LayoutText(const std::string& layout) {
  const Layout* known = FindKnownLayout(layout);
  return known == nullptr ? "of a fork, in a file of its own" : known->id + ": " + known->title;
}

std::string ArchiveText(const ArchiveEncoding& encoding) {
  const std::string releases = BoostReleases(encoding.boost_version);
  std::string text = std::string(encoding.text ? "text" : "binary") + ", library version " +
                     std::to_string(encoding.boost_version) + (releases.empty() ? "" : " (" + releases + ")");
  text += ", " + std::to_string(encoding.long_bytes) + "-byte long";
  return text;
}

InfoSection HeaderOf(const AtlasInfo& report) {
  InfoSection section;
  std::vector<InfoRow>& rows = section.rows;
  rows.push_back({"format", report.format_title});
  if (report.encoding) rows.push_back({"archive", ArchiveText(*report.encoding)});
  if (!report.layout.empty()) rows.push_back({"layout", LayoutText(report.layout)});
  if (report.bytes) rows.push_back({"size", HumanBytes(*report.bytes)});
  if (!report.vocabulary.name.empty() || !report.vocabulary.checksum.empty())
    rows.push_back({"vocabulary", report.vocabulary.name + "  MD5 " + report.vocabulary.checksum});
  const Counters& next = report.next_ids;
  rows.push_back({"next ids", "map " + std::to_string(next.map) + ", keyframe " + std::to_string(next.keyframe) +
                                  ", map point " + std::to_string(next.map_point) + ", frame " +
                                  std::to_string(next.frame) + ", camera " + std::to_string(next.camera)});
  for (const Camera& camera : report.cameras) rows.push_back({"camera " + IdText(camera.id), CameraText(camera)});
  if (report.repeated_maps > 0)
    rows.push_back({"list of maps", Counted(report.repeated_maps, "entry", "entries") +
                                        " null or listed twice, which ORB-SLAM3 does not survive; see 'slamdb check'"});
  return section;
}

std::string RowsText(const std::vector<InfoRow>& rows) {
  Table table({kLeft, kLeft}, 2);
  for (const InfoRow& row : rows) table.Add({row.label, row.value});
  return table.ToString();
}

std::string PartsText(const std::vector<PartSize>& parts) {
  std::uint64_t sum = 0;
  for (const PartSize& part : parts) sum += part.bytes;
  if (sum == 0) return {};
  std::vector<PartSize> sorted = parts;
  std::erase_if(sorted, [](const PartSize& part) { return part.bytes == 0; });
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const PartSize& a, const PartSize& b) { return a.bytes > b.bytes; });
  Table table({kLeft, kRight, kRight}, 2);
  for (const PartSize& part : sorted) table.Add({part.part, HumanBytes(part.bytes), Percent(part.bytes, sum)});
  return "\nsize on disk\n" + table.ToString();
}

}  // namespace

std::vector<InfoSection> InfoSections(const AtlasInfo& report) {
  std::vector<InfoSection> sections = {HeaderOf(report)};
  for (const MapStatistics& map : report.statistics.maps) sections.push_back(SectionOf(map));
  return sections;
}

std::string InfoText(const AtlasInfo& report, std::size_t plan_width) {
  constexpr std::size_t kLines = 12, kFewer = 6;  // of one plan, and of each of several
  const std::vector<InfoSection> sections = InfoSections(report);
  std::string text = detail::Visible(report.input) + "\n" + RowsText(sections.front().rows);
  const std::vector<MapStatistics>& maps = report.statistics.maps;
  const std::vector<bool> drawn = DrawnMaps(report);
  for (std::size_t row = 0; row < maps.size(); ++row) {
    const InfoSection& section = sections[row + 1];
    text += "\n" + section.heading.label + "  " + section.heading.value + "\n" + RowsText(section.rows);
    if (plan_width > 0 && drawn[row] && row < report.paths.size())
      text += PlanOf(maps[row], report.paths[row], plan_width, maps.size() > 1 ? kFewer : kLines);
  }
  return text + PartsText(report.parts);
}

}  // namespace slamdb::cli
