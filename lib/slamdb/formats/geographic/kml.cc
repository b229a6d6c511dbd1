// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/date_times.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/geographic/detail/geographic.h"
#include "slamdb/formats/geographic/detail/places.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kRowsPerBlock = 512;
constexpr std::string_view kHead =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<!-- written by slamdb -->\n"
    "<kml xmlns=\"http://www.opengis.net/kml/2.2\" xmlns:gx=\"http://www.google.com/kml/ext/2.2\">\n"
    "<Document>\n"
    "<name>map</name>\n";

std::string IdText(MapId id) { return id ? std::to_string(id.value()) : "none"; }
std::string StyleOf(MapId id) { return "map-" + std::to_string(id.value() % 10); }

// KML's colours are aabbggrr.
std::string StyleElement(std::uint64_t number) {
  const std::string hex = HexOf(ColorOfMap(MapId(number)));
  const std::string color = "<color>ff" + hex.substr(5, 2) + hex.substr(3, 2) + hex.substr(1, 2) + "</color>";
  return Concat(
      "<Style id=\"map-", number, "\"><IconStyle>", color,
      "<scale>0.5</scale><Icon><href>http://maps.google.com/mapfiles/kml/shapes/placemark_circle.png</href></Icon>"
      "</IconStyle><LabelStyle><scale>0</scale></LabelStyle><LineStyle>",
      color, "<width>3</width></LineStyle></Style>\n");
}

// Longitude, latitude, altitude of all poses in front of which stands `begin`.
void AppendPath(std::string& out, const KeyFrameTrajectory& trajectory, const Places& places, std::string_view begin,
                std::string_view end) {
  for (const TimedPose& pose : trajectory.poses) {
    out += begin;
    AppendPlace(out, places.At(pose.world_from_it.translation));
    out += end;
  }
}

// gx:Track has blanks between its numbers.
void AppendTrack(std::string& out, const KeyFrameTrajectory& trajectory, const Places& places) {
  out += "<gx:Track>\n<altitudeMode>absolute</altitudeMode>\n";
  for (const TimedPose& pose : trajectory.poses) out += "<when>" + *DateTimeText(pose.timestamp) + "</when>\n";
  std::string path;
  AppendPath(path, trajectory, places, "<gx:coord>", "</gx:coord>\n");
  for (char& letter : path)
    if (letter == ',') letter = ' ';
  out += path + "</gx:Track>\n";
}

std::string TrajectoryText(const KeyFrameTrajectory& trajectory, const Places& places) {
  std::string out = Concat("<Placemark>\n<name>", trajectory.map->id, " trajectory</name>\n<styleUrl>#",
                           StyleOf(trajectory.map->id), "</styleUrl>\n");
  if (HasTimes(trajectory)) {
    AppendTrack(out, trajectory, places);
  } else {
    out += "<LineString>\n<altitudeMode>absolute</altitudeMode>\n<coordinates>\n";
    AppendPath(out, trajectory, places, "", "\n");
    out += "</coordinates>\n</LineString>\n";
  }
  return out + "</Placemark>\n";
}

void AppendPointElement(std::string& out, const Geodetic& place) {
  out += "<Point><altitudeMode>absolute</altitudeMode><coordinates>";
  AppendPlace(out, place);
  out += "</coordinates></Point>";
}

void AppendKeyFrame(std::string& out, const PlacedKeyFrame& keyframe, const Places& places) {
  const auto& [trajectory, pose] = keyframe;
  out += Concat("<Placemark><name>", pose->keyframe->id, "</name>");
  if (const auto time = DateTimeText(pose->timestamp)) out += "<TimeStamp><when>" + *time + "</when></TimeStamp>";
  out += "<styleUrl>#" + StyleOf(trajectory->map->id) + "</styleUrl><ExtendedData><Data name=\"map\"><value>" +
         IdText(trajectory->map->id) + "</value></Data><Data name=\"timestamp\"><value>";
  AppendSeconds(out, pose->timestamp);
  out += "</value></Data></ExtendedData>";
  AppendPointElement(out, places.At(pose->world_from_it.translation));
  out += "</Placemark>\n";
}

void WriteKeyFrames(AtomicFile& file, const Places& places, const WriteOptions& options) {
  const auto& keyframes = places.keyframes();
  if (keyframes.empty()) return;
  file.Write("<Folder>\n<name>keyframes</name>\n");
  WriteRows(file, keyframes.size(), kRowsPerBlock, options, [&](std::size_t begin, std::size_t end, std::string& out) {
    for (std::size_t row = begin; row < end; ++row) AppendKeyFrame(out, keyframes[row], places);
  });
  file.Write("</Folder>\n");
}

// A placemark for each map: places of points are many, and have no names.
void WritePoints(AtomicFile& file, const Places& places, const WriteOptions& options) {
  const PointRows& points = places.points();
  const auto& chosen = places.chosen_points();
  const auto map_of = [&](std::size_t i) { return points[chosen[i]].map; };
  if (chosen.empty()) return;
  file.Write("<Folder>\n<name>points</name>\n");
  WriteRows(file, chosen.size(), kRowsPerBlock, options, [&](std::size_t begin, std::size_t end, std::string& out) {
    for (std::size_t i = begin; i < end; ++i) {
      const MapId map = points.map_id(points[chosen[i]]);
      if (i == 0 || map_of(i) != map_of(i - 1))
        out += Concat("<Placemark>\n<name>", map, " points</name>\n<styleUrl>#", StyleOf(map),
                      "</styleUrl>\n<MultiGeometry>\n");
      AppendPointElement(out, places.At(points[chosen[i]].point->position));
      out += '\n';
      if (i + 1 == chosen.size() || map_of(i) != map_of(i + 1)) out += "</MultiGeometry>\n</Placemark>\n";
    }
  });
  file.Write("</Folder>\n");
}

void WriteKml(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  AtomicFile file(target, FileOptions(options));
  const Places places(atlas, target, options, notices);
  WarnOfSeveralFrames(places.points().maps(), "names and colours tell them apart", notices);
  std::string head(kHead);
  for (std::uint64_t number = 0; number < 10; ++number) head += StyleElement(number);
  for (const KeyFrameTrajectory& trajectory : places.trajectories())
    if (trajectory.poses.size() > 1) head += TrajectoryText(trajectory, places);
  file.Write(head);
  WriteKeyFrames(file, places, options);
  WritePoints(file, places, options);
  file.Write("</Document>\n</kml>\n");
  file.Commit();
  notices.Tell(places.Summary(), places.Counts());
}

// Others are tracks.
bool SniffKml(const Probe& probe) { return probe.head.starts_with(kHead.substr(0, kHead.find("<kml"))); }

constexpr std::array<std::string_view, 1> kSuffixes = {".kml"};

}  // namespace

const Format kKmlFormat = {.id = "kml",
                           .title = "KML map",
                           .suffixes = kSuffixes,
                           .chooses_maps = true,
                           .is_on_globe = true,
                           .is_export = true,
                           .writes = Content::kPoints | Content::kPoses | Content::kMaps,
                           .sniff = SniffKml,
                           .write = WriteKml};

}  // namespace slamdb::detail
