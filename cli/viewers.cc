// SPDX-License-Identifier: BSD-3-Clause
#include "cli/viewers.h"

#include <utility>
#include <vector>

#include "cli/choices.h"
#include "cli/options.h"
#include "cli/values.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/formats/geographic/options.h"
#include "slamdb/many/convert.h"

namespace slamdb::cli {
namespace {

PointColor ColorAsked(const ViewerOptions& options) {
  const auto asked = kColors.find(options.color);
  return asked == kColors.end() ? PointColor::kMap : asked->second;
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
      ->check(Within(kNonNegative))
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
  const std::optional<Georeference> found = slamdb::WhereOnEarth(options.origin, input, output, notices);
  if (output.is_on_globe && !found)
    RefuseUsage(
        "a " + std::string(output.title) +
        " needs --origin LAT,LON,ALT, where the frame of the maps begins; `slamdb transform --georeference` finds "
        "it, and keeps it in " +
        GeoreferencePath(input));
  return found;
}

}  // namespace slamdb::cli
