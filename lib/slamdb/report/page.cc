// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "slamdb/base/detail/amounts.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/plot/plot.h"
#include "slamdb/report/detail/parts.h"

namespace slamdb {
namespace {

using detail::Concat;
using detail::Thousands;
using report::Html;
using report::Literal;

void AppendNumber(Html& html, Literal name, const std::string& value) {
  html << "<div><dt>" << name << "</dt><dd>" << value << "</dd></div>\n";
}

double DurationOf(const AtlasStatistics& statistics) {
  double seconds = 0;
  for (const MapStatistics& map : statistics.maps) seconds += map.end_time - map.begin_time;
  return seconds;
}

void AppendNumbers(Html& html, const AtlasReport& report) {
  const AtlasStatistics& all = report.checked.report.statistics;
  html << "<dl class=\"numbers\">\n";
  AppendNumber(html, "maps", Thousands(all.maps.size()));
  AppendNumber(html, "keyframes", Thousands(all.keyframes));
  AppendNumber(html, "points", Thousands(all.points));
  AppendNumber(html, "observations", Thousands(all.observations));
  AppendNumber(html, "trajectory", report::LengthText(all));
  AppendNumber(html, "time", detail::DurationText(DurationOf(all)));
  AppendNumber(html, "loop and merge edges", Thousands(all.loop_edges + all.merge_edges));
  if (report.bytes) AppendNumber(html, "size", detail::HumanBytes(*report.bytes));
  html << "</dl>\n";
}

void AppendCell(Html& html, const std::string& value) { html << "<td class=\"number\">" << value << "</td>"; }

void AppendMaps(Html& html, const AtlasStatistics& statistics) {
  html << "<h2>Maps</h2>\n<div class=\"scroll\"><table>\n<tr><th>map</th><th>sensor</th><th "
          "class=\"number\">keyframes</th>"
          "<th class=\"number\">points</th><th class=\"number\">observers of a point</th>"
          "<th class=\"number\">reprojection (px)</th><th class=\"number\">components</th>"
          "<th class=\"number\">trajectory</th><th class=\"number\">time</th></tr>\n";
  for (const MapStatistics& map : statistics.maps) {
    html << "<tr><td>" << ToString(map.id) << "</td><td>" << SensorText(map.sensor, map.has_imu) << "</td>";
    AppendCell(html, Thousands(map.keyframes));
    AppendCell(html, Thousands(map.points));
    AppendCell(html, detail::Digits(map.observers.mean, 3));
    AppendCell(html, map.reprojection_error.count == 0 ? "" : detail::Digits(map.reprojection_error.mean, 3));
    AppendCell(html, Thousands(map.components));
    AppendCell(html, detail::LengthText(map.trajectory_length, map.metric ? "m" : "units"));
    AppendCell(html, detail::DurationText(map.end_time - map.begin_time));
    html << "</tr>\n";
  }
  html << "</table></div>\n";
}

// Without the line that only a file of its own begins with.
std::string_view ElementOf(const std::string& svg) { return std::string_view(svg).substr(svg.find("<svg")); }

void AppendPlots(Html& html, const Atlas& atlas, int threads) {
  if (!CanPlot()) {
    html << "<p class=\"faint\">Built without Cairo, which draws plots.</p>\n";
    return;
  }
  std::vector<PlotOptions> pictures;
  for (const PlotKind kind : PlotKinds()) {
    if (kind == PlotKind::kOverview || kind == PlotKind::kTrajectory) continue;
    for (const bool dark : {false, true})
      pictures.push_back({.kind = kind, .width = 620, .dark = dark, .threads = threads});
  }
  const std::vector<Plot> plots = DrawPlots(atlas, pictures);
  html << "<h2>Plots</h2>\n<div class=\"plots\">\n";
  for (std::size_t i = 0; i < plots.size(); ++i) {  // the style shows the one of two that suits the page
    html << (pictures[i].dark ? Literal("<div class=\"dark\">") : Literal("<figure><div class=\"light\">"));
    html.Drawn(ElementOf(plots[i].bytes));
    html << (pictures[i].dark ? Literal("</div></figure>") : Literal("</div>"));
  }
  html << "</div>\n";
}

void AppendDetails(Html& html, const Atlas& atlas) {
  html << "<h2>Details</h2>\n<p>Vocabulary <code>" << atlas.vocabulary.name << "</code>, MD5 <code>"
       << atlas.vocabulary.checksum << "</code></p>\n<p>Next ids: "
       << Concat("map ", atlas.next_ids.map, ", keyframe ", atlas.next_ids.keyframe, ", map point ",
                 atlas.next_ids.map_point, ", frame ", atlas.next_ids.frame, ", camera ", atlas.next_ids.camera)
       << "</p>\n";
  for (const Camera& camera : atlas.cameras) {
    std::string parameters;
    for (const float value : camera.parameters) parameters += Concat(" ", static_cast<double>(value));
    html << "<p>" << ToString(camera.id)
         << (camera.model == CameraModel::kPinhole          ? Literal(", pinhole:")
             : camera.model == CameraModel::kKannalaBrandt8 ? Literal(", Kannala-Brandt:")
                                                            : Literal(", equirectangular:"))
         << parameters << "</p>\n";
  }
}

}  // namespace

AtlasReport ReportOn(const Atlas& atlas, const std::string& name, const CheckOptions& options) {
  AtlasReport report;
  report.checked.name = name;
  report.checked.report = CheckAtlas(atlas, options);
  report.gates = options.gates;
  if (CanPlot()) {
    report.thumbnail = DrawThumbnail(atlas, 240, 150).bytes;
    report.dark_thumbnail = DrawThumbnail(atlas, 240, 150, /*dark=*/true).bytes;
  }
  return report;
}

std::string ReportPage(const Atlas& atlas, const AtlasReport& report, const ReportPageOptions& options) {
  Html html;
  html << "<header>";
  if (!report.page.empty()) html << "<p><a href=\"index.html\">all atlases</a></p>";
  html << "<h1>" << report.checked.name << "</h1>";
  report::AppendVerdict(html, report);
  html << "</header>\n<main>\n";
  AppendNumbers(html, report);
  AppendPlots(html, atlas, options.threads);
  report::AppendFindings(html, report.checked.report, options.wording);
  report::AppendGates(html, report);
  AppendMaps(html, report.checked.report.statistics);
  AppendDetails(html, atlas);
  html << "</main>\n";
  return report::Page(report.checked.name, std::move(html).Take(), {});
}

}  // namespace slamdb
