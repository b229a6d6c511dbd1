// SPDX-License-Identifier: BSD-3-Clause
#include "cli/viewers.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "cli/options.h"
#include "cli/values.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/formats/geographic/options.h"
#include "slamdb/model/statistics.h"

namespace slamdb::cli {
namespace {

constexpr std::pair<const char*, PointColor> kColors[] = {{"map", PointColor::kMap},
                                                          {"error", PointColor::kError},
                                                          {"observations", PointColor::kObservations},
                                                          {"height", PointColor::kHeight},
                                                          {"age", PointColor::kAge}};

PointColor ColorAsked(const ViewerOptions& options) {
  for (const auto& [name, color] : kColors)
    if (options.color == name) return color;
  return PointColor::kMap;
}

// Nothing in the maps tells whether the frame is one on earth.
void WarnOfFrames(const Atlas& atlas, Notices& notices) {
  notices.Warn(
      "the frame of the maps is taken as east, north and up in metres from --origin; `slamdb transform --georeference` "
      "makes it so");
  for (const Map& map : atlas.maps)
    if (!IsMetric(map)) notices.Warn(ToString(map.id) + " has no scale, of one camera: its sizes are not in metres");
}

void WarnOfMapsElsewhere(const Atlas& atlas, const Georeference& where, Notices& notices) {
  for (const Map& map : atlas.maps)
    if (std::ranges::find(where.maps, map.id) == where.maps.end() && !map.keyframes.empty())
      notices.Warn(ToString(map.id) + " was not georeferenced, and is not where it is shown");
}

}  // namespace

void AddViewerOptions(CLI::App& verb, ViewerOptions& options) {
  constexpr const char* kGroup = "Pictures of maps";
  std::vector<std::string> colors{{}};  // empty: it was about the console, see AddConsoleOptions
  std::string words;
  for (const auto& [name, color] : kColors) words += colors.emplace_back(name) + ",";
  verb.add_option(
          "--color", options.color,
          "What the colour of a point tells, in PLY, PCD, glTF and MCAP; by default map. auto, always and never are "
          "about messages, as in other verbs")
      ->type_name("WHAT")
      ->check(CLI::IsMember(colors).description("{" + words + "auto,always,never}"))
      ->group(kGroup);
  verb.add_flag("--cameras", options.cameras, "Write cameras and their path into PLY too, as edges")->group(kGroup);
  verb.add_option("--origin", options.origin,
                  "Where on earth the frame of the maps begins, east, north and up, for KML and GeoJSON; by default as "
                  "`slamdb transform --georeference` keeps it beside the atlas")
      ->type_name("LAT,LON[,ALT]")
      ->check(CheckPlace)
      ->group(kGroup);
  verb.add_option("--most-points", options.most_points,
                  "Map points to write into KML and GeoJSON, evenly out of all: 10000 by default")
      ->type_name("N")
      ->check(CheckNonNegative)
      ->group(kGroup);
}

void RefuseIdleViewerOptions(const Format& output, const ViewerOptions& options) {
  const std::string is = " only; the output is " + std::string(output.title);
  if (!options.color.empty() && !output.has_colors) RefuseUsage("--color is for PLY, PCD, glTF and MCAP" + is);
  if (options.cameras && output.id != "ply")
    RefuseUsage("--cameras is for PLY" + is +
                (output.has_colors && HasAny(output.writes, Content::kPoses) ? ", which always has them" : ""));
  if ((!options.origin.empty() || options.most_points) && !output.is_on_globe)
    RefuseUsage("--origin and --most-points are for KML and GeoJSON" + is);
}

void SetViewerOptions(const ViewerOptions& options, bool ascii, WriteOptions& write) {
  write.of<PointCloudOptions>() = {.binary = !ascii, .color = ColorAsked(options), .cameras = options.cameras};
  if (options.most_points) write.of<GeographicOptions>().most_points = *options.most_points;
}

std::optional<Georeference> WhereOnEarth(const ViewerOptions& options, const std::string& input, const Format& output,
                                         Notices& notices) {
  if (!output.is_on_globe) return std::nullopt;
  if (!options.origin.empty()) {
    const Geodetic origin = ParseGeodetic(options.origin);
    if (std::abs(origin.longitude) > 180)
      notices.Note(
          detail::Concat("the longitude ", origin.longitude, " is written as ", std::remainder(origin.longitude, 360)));
    return Georeference{origin, {}};
  }
  const std::optional<Georeference> found = FindGeoreference(input);
  if (!found)
    RefuseUsage(
        "a " + std::string(output.title) +
        " needs --origin LAT,LON,ALT, where the frame of the maps begins; `slamdb transform --georeference` finds "
        "it, and keeps it in " +
        GeoreferencePath(input));
  notices.Note("the origin is that of " + GeoreferencePath(input));
  return found;
}

void LayOnEarth(const Atlas& atlas, const Georeference& where, WriteOptions& write, Notices& notices) {
  if (where.maps.empty())  // as asked for
    WarnOfFrames(atlas, notices);
  else
    WarnOfMapsElsewhere(atlas, where, notices);
  write.of<GeographicOptions>().origin = where.origin;
}

}  // namespace slamdb::cli
