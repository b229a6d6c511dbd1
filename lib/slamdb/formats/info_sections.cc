// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/info_sections.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "slamdb/base/detail/amounts.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/layouts/layout.h"
#include "slamdb/formats/orbslam3/boost_versions.h"
#include "slamdb/model/up.h"

namespace slamdb {
namespace {

// A number in at most so many significant digits; zero has no sign.
std::string Short(double number, int digits = 4) { return detail::Digits(number + 0.0, digits); }

std::string VectorText(const Eigen::Vector3f& vector) {
  return detail::Rounded(vector.x()) + " " + detail::Rounded(vector.y()) + " " + detail::Rounded(vector.z());
}

std::string TextOfSensor(const MapStatistics& map) {
  if (map.keyframes == 0 && map.landmarks > 0) return detail::Counted(map.landmarks, "landmark");
  if (map.keyframes == 0) return map.points > 0 ? "points alone" : "empty";
  return SensorText(map.sensor, map.has_imu);
}

std::string InertialText(const MapStatistics& map) {
  if (!map.imu_initialized) return "not initialised";
  if (map.imu_ba2) return "initialised, both bundle adjustments done";
  return map.imu_ba1 ? "initialised, first bundle adjustment done" : "initialised, no bundle adjustment yet";
}

std::string WithBad(std::uint64_t count, std::uint64_t bad) {
  return detail::Thousands(count) + (bad == 0 ? "" : " (" + detail::Thousands(bad) + " flagged bad)");
}

std::string OriginsText(const MapStatistics& map) {
  std::string text;
  for (const OriginCount& origin : map.origins)
    text += (text.empty() ? "" : ", ") + ("map " + std::to_string(origin.map)) + " (" +
            detail::Counted(origin.count, "keyframe") + ")";
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
  rows.push_back({"trajectory", detail::LengthText(map.trajectory_length, UnitOf(map)) + " in " +
                                    detail::DatedDuration(map.begin_time, map.end_time)});
}

InfoSection SectionOf(const MapStatistics& map) {
  InfoSection section{.heading = {"map " + IdText(map.id), TextOfSensor(map)}, .rows = {}};
  if (map.keyframes == 0 && map.points == 0) return section;
  std::vector<InfoRow>& rows = section.rows;
  rows.push_back({"keyframes", WithBad(map.keyframes, map.bad_keyframes)});
  rows.push_back({"points", WithBad(map.points, map.bad_points)});
  if (map.landmarks > 0) rows.push_back({"landmarks", detail::Thousands(map.landmarks)});
  rows.push_back({"features", detail::Thousands(map.features)});
  rows.push_back({"observations", detail::Thousands(map.observations) + "; a point is seen by " +
                                      Short(map.observers.mean, 3) + " keyframes, median " +
                                      Short(map.observers.median) + ", at most " + Short(map.observers.max, 6)});
  if (map.reprojection_error.count > 0)
    rows.push_back({"reprojection", Short(map.reprojection_error.mean, 3) + " px on average, median " +
                                        Short(map.reprojection_error.median, 3)});
  rows.push_back({"covisibility", detail::Counted(map.covisibility_edges, "edge") + " in " +
                                      detail::Counted(map.components, "component")});
  if (map.loop_edges + map.merge_edges > 0)
    rows.push_back({"closures", detail::Counted(map.loop_edges, "loop edge") + ", " +
                                    detail::Counted(map.merge_edges, "merge edge")});
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

InfoSection HeaderOf(const AtlasInfo& report, const Wording& wording) {
  InfoSection section;
  std::vector<InfoRow>& rows = section.rows;
  if (!report.format_title.empty()) rows.push_back({"format", report.format_title});
  if (report.encoding) rows.push_back({"archive", ArchiveText(*report.encoding)});
  if (!report.layout.empty()) rows.push_back({"layout", LayoutText(report.layout)});
  if (report.bytes) rows.push_back({"size", detail::HumanBytes(*report.bytes)});
  if (!report.vocabulary.name.empty() || !report.vocabulary.checksum.empty())
    rows.push_back({"vocabulary", report.vocabulary.name + "  MD5 " + report.vocabulary.checksum});
  const Counters& next = report.next_ids;
  rows.push_back({"next ids", "map " + std::to_string(next.map) + ", keyframe " + std::to_string(next.keyframe) +
                                  ", map point " + std::to_string(next.map_point) + ", frame " +
                                  std::to_string(next.frame) + ", camera " + std::to_string(next.camera)});
  for (const Camera& camera : report.cameras) rows.push_back({"camera " + IdText(camera.id), CameraText(camera)});
  if (report.repeated_maps > 0)
    rows.push_back({"list of maps", detail::Thousands(report.repeated_maps) +
                                        (report.repeated_maps == 1 ? " entry" : " entries") +
                                        " null or listed twice, which ORB-SLAM3 does not survive; see " +
                                        Worded("`CheckAtlas`", wording)});
  return section;
}

}  // namespace

std::vector<InfoSection> InfoSections(const AtlasInfo& report, const Wording& wording) {
  std::vector<InfoSection> sections = {HeaderOf(report, wording)};
  for (const MapStatistics& map : report.statistics.maps) sections.push_back(SectionOf(map));
  return sections;
}

}  // namespace slamdb
