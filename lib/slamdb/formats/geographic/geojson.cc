// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>

#include "slamdb/base/detail/date_times.h"
#include "slamdb/formats/export/detail/json_appender.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/geographic/detail/geographic.h"
#include "slamdb/formats/geographic/detail/places.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kRowsPerBlock = 512;
constexpr std::string_view kHead = "{\"type\":\"FeatureCollection\",\"generator\":\"slamdb\",\"features\":[";

struct Stop {
  Geodetic place;
  double time;
};
using Path = std::vector<Stop>;

// RFC 7946, 3.1.9: a line that crosses the antimeridian is cut there.
std::vector<Path> CutAtAntimeridian(const Path& path) {
  std::vector<Path> parts(1);
  for (const Stop& stop : path) {
    const double step = parts.back().empty() ? 0 : stop.place.longitude - parts.back().back().place.longitude;
    if (std::abs(step) > 180) {
      const Stop& last = parts.back().back();
      const double edge = step < 0 ? 180 : -180;  // that the last one is near to
      const double share = (edge - last.place.longitude) / (stop.place.longitude + 2 * edge - last.place.longitude);
      const auto between = [share](double from, double to) { return from + share * (to - from); };
      const Stop cut{
          {between(last.place.latitude, stop.place.latitude), edge, between(last.place.altitude, stop.place.altitude)},
          between(last.time, stop.time)};
      parts.back().push_back(cut);
      parts.push_back({cut});
      parts.back().back().place.longitude = -edge;
    }
    parts.back().push_back(stop);
  }
  return parts;
}

Path PathOf(const KeyFrameTrajectory& trajectory, const Places& places) {
  Path path;
  path.reserve(trajectory.poses.size());
  for (const TimedPose& pose : trajectory.poses)
    path.push_back({places.At(pose.world_from_it.translation), pose.timestamp});
  return path;
}

template <class Append>
void AppendList(std::string& out, const Path& path, Append append) {
  char before = '[';
  for (const Stop& stop : path) {
    out += before;
    append(stop);
    before = ',';
  }
  out += ']';
}

// `append(part)` for each part, in brackets of their own where there are several.
template <class Append>
void AppendParts(std::string& out, const std::vector<Path>& parts, Append append) {
  if (parts.size() > 1) out += '[';
  for (const Path& part : parts) {
    if (&part != parts.data()) out += ',';
    append(part);
  }
  if (parts.size() > 1) out += ']';
}

void AppendPosition(std::string& out, const Geodetic& place) {
  out += '[';
  AppendPlace(out, place);
  out += ']';
}

void BeginFeature(std::string& out, std::size_t number) {
  out += number == 0 ? "\n{\"type\":\"Feature\"," : ",\n{\"type\":\"Feature\",";
}

std::string TrajectoryFeature(const KeyFrameTrajectory& trajectory, const Places& places, std::size_t number) {
  std::string out;
  BeginFeature(out, number);
  const std::vector<Path> parts = CutAtAntimeridian(PathOf(trajectory, places));
  out += "\"geometry\":{\"type\":";
  out += parts.size() > 1 ? "\"MultiLineString\"" : "\"LineString\"";
  out += ",\"coordinates\":";
  AppendParts(out, parts, [&](const Path& part) {
    AppendList(out, part, [&](const Stop& stop) { AppendPosition(out, stop.place); });
  });
  out += "},\"properties\":";
  JsonAppender json(out);
  json.BeginObject();
  json.Field("kind", "trajectory");
  json.ExactField("map", trajectory.map->id);
  json.Field("stroke", std::string_view(HexOf(ColorOfMap(trajectory.map->id))));
  if (HasTimes(trajectory)) {
    out += ",\"coordTimes\":";
    AppendParts(out, parts, [&](const Path& part) {
      AppendList(out, part, [&](const Stop& stop) { out += '"' + *DateTimeText(stop.time) + '"'; });
    });
  }
  json.EndObject();
  return out + "}";
}

void AppendPointGeometry(std::string& out, const Geodetic& place) {
  out += "\"geometry\":{\"type\":\"Point\",\"coordinates\":";
  AppendPosition(out, place);
  out += "},\"properties\":";
}

void AppendKeyFrame(std::string& out, const PlacedKeyFrame& keyframe, const Places& places, std::size_t number) {
  const auto& [trajectory, pose] = keyframe;
  BeginFeature(out, number);
  AppendPointGeometry(out, places.At(pose->world_from_it.translation));
  JsonAppender json(out);
  json.BeginObject();
  json.Field("kind", "keyframe");
  json.ExactField("map", trajectory->map->id);
  json.ExactField("id", pose->keyframe->id);
  json.Field("timestamp", pose->timestamp);
  if (const auto time = DateTimeText(pose->timestamp)) json.Field("time", std::string_view(*time));
  json.EndObject();
  out += '}';
}

void AppendPoint(std::string& out, std::size_t row, const Places& places, std::size_t number) {
  const PointRows& points = places.points();
  const MapPoint& point = *points[row].point;
  const float error = points.mean_error(points[row]);
  BeginFeature(out, number);
  AppendPointGeometry(out, places.At(point.position));
  JsonAppender json(out);
  json.BeginObject();
  json.Field("kind", "point");
  json.ExactField("map", points.map_id(points[row]));
  json.ExactField("id", point.id);
  json.Field("observations", point.observations.size());
  if (std::isfinite(error)) json.Field("reprojection_error", error);
  json.EndObject();
  out += '}';
}

// Calls append(out, row, number of the feature) for rows [0, count), of which `before` stand before.
template <class Append>
void WriteFeatures(AtomicFile& file, std::size_t count, std::size_t before, const WriteOptions& options,
                   Append append) {
  WriteRows(file, count, kRowsPerBlock, options, [&](std::size_t begin, std::size_t end, std::string& out) {
    for (std::size_t row = begin; row < end; ++row) append(out, row, before + row);
  });
}

void WriteGeojson(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  AtomicFile file(target, FileOptions(options));
  const Places places(atlas, target, options, notices);
  WarnOfSeveralFrames(places.points().maps(), "the property `map` tells them apart", notices);
  file.Write(kHead);
  std::size_t features = 0;
  for (const KeyFrameTrajectory& trajectory : places.trajectories())
    if (trajectory.poses.size() > 1) file.Write(TrajectoryFeature(trajectory, places, features++));
  const auto& keyframes = places.keyframes();
  WriteFeatures(file, keyframes.size(), features, options, [&](std::string& out, std::size_t row, std::size_t number) {
    AppendKeyFrame(out, keyframes[row], places, number);
  });
  const auto& chosen = places.chosen_points();
  WriteFeatures(
      file, chosen.size(), features + keyframes.size(), options,
      [&](std::string& out, std::size_t row, std::size_t number) { AppendPoint(out, chosen[row], places, number); });
  file.Write("\n]}\n");
  file.Commit();
  notices.Tell(places.Summary(), places.Counts());
}

bool SniffGeojson(const Probe& probe) { return probe.head.starts_with(kHead); }

constexpr std::array<std::string_view, 1> kSuffixes = {".geojson"};

}  // namespace

const Format kGeojsonFormat = {.id = "geojson",
                               .title = "GeoJSON map",
                               .suffixes = kSuffixes,
                               .chooses_maps = true,
                               .is_on_globe = true,
                               .is_export = true,
                               .writes = Content::kPoints | Content::kPoses | Content::kMaps,
                               .sniff = SniffGeojson,
                               .write = WriteGeojson};

}  // namespace slamdb::detail
