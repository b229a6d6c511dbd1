// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "slamdb/base/detail/amounts.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/markup.h"
#include "slamdb/report/detail/parts.h"

namespace slamdb {
namespace {

using detail::Concat;
using report::Html;
using report::Literal;

// A number with the value that it is sorted by.
void AppendNumber(Html& html, double value, const std::string& shown) {
  html << "<td class=\"number\" data-value=\"" << detail::Digits(value, 17) << "\">" << shown << "</td>";
}

void AppendCount(Html& html, std::uint64_t count) {
  AppendNumber(html, static_cast<double>(count), detail::Thousands(count));
}

// Of unreadable ones behind all numbers.
void AppendEmpty(Html& html) { html << "<td class=\"number\" data-value=\"-1\"></td>"; }

void AppendName(Html& html, const AtlasReport& report) {
  html << "<td class=\"name\">";
  if (report.page.empty())
    html << report.checked.name;
  else
    html << "<a href=\"" << report.page << "\">" << report.checked.name << "</a>";
  if (!report.checked.failure.empty()) html << "<br><span class=\"error\">" << report.checked.failure << "</span>";
  html << "</td>";
}

void AppendNumbers(Html& html, const AtlasReport& report) {
  if (!report.checked.failure.empty()) {
    for (int column = 0; column < 7; ++column) AppendEmpty(html);
    return;
  }
  const AtlasStatistics& all = report.checked.report.statistics;
  double seconds = 0, error = 0, count = 0;
  for (const MapStatistics& map : all.maps) {
    seconds += map.end_time - map.begin_time;
    error += map.reprojection_error.mean * static_cast<double>(map.reprojection_error.count);
    count += static_cast<double>(map.reprojection_error.count);
  }
  AppendCount(html, all.maps.size());
  AppendCount(html, all.keyframes);
  AppendCount(html, all.points);
  AppendNumber(html, all.trajectory_length, report::LengthText(all));
  AppendNumber(html, seconds, detail::DurationText(seconds));
  AppendNumber(html, count > 0 ? error / count : -1, count > 0 ? detail::Digits(error / count, 3) : "");
  if (report.bytes)
    AppendNumber(html, static_cast<double>(*report.bytes), detail::HumanBytes(*report.bytes));
  else
    AppendEmpty(html);
}

void AppendThumbnail(Html& html, Literal theme, const std::string& png) {
  html << "<img alt=\"\" width=\"120\" height=\"75\" class=\"" << theme << "\" src=\"data:image/png;base64,";
  html.Drawn(detail::Base64(std::as_bytes(std::span(png))));
  html << "\">";
}

void AppendRow(Html& html, const AtlasReport& report) {
  html << "<tr data-verdict=\"" << report::VerdictWord(report) << "\"><td>";
  if (!report.thumbnail.empty()) {
    AppendThumbnail(html, "light", report.thumbnail);
    AppendThumbnail(html, "dark", report.dark_thumbnail.empty() ? report.thumbnail : report.dark_thumbnail);
  }
  html << "</td>";
  AppendName(html, report);
  html << "<td>";
  report::AppendVerdict(html, report);
  html << "</td>";
  AppendNumbers(html, report);
  html << "</tr>\n";
}

void AppendHead(Html& html) {
  constexpr Literal kTexts[] = {"name", "verdict"};
  constexpr Literal kNumbers[] = {"maps", "keyframes", "points", "trajectory", "time", "reprojection (px)", "size"};
  html << "<thead><tr><th>plan</th>";
  for (const Literal name : kTexts) html << "<th><button type=\"button\">" << name << "</button></th>";
  for (const Literal name : kNumbers)
    html << "<th class=\"number\"><button type=\"button\">" << name << "</button></th>";
  html << "</tr></thead>\n";
}

}  // namespace

std::string ReportIndex(std::span<const AtlasReport> reports, const std::string& title) {
  Html html;
  const auto sound = static_cast<std::size_t>(
      std::ranges::count_if(reports, [](const AtlasReport& one) { return report::VerdictWord(one) == "sound"; }));
  html << "<header><h1>" << title << "</h1><p>"
       << Concat(sound, " of ", reports.size(), reports.size() == 1 ? " atlas is sound" : " atlases are sound")
       << "</p></header>\n<main>\n";
  html << "<div class=\"filters\"><label>search <input type=\"search\" id=\"search\"></label>\n"
          "<label>verdict <select id=\"verdict\"><option value=\"\">all</option><option>sound</option>"
          "<option>not sound</option><option>not readable</option></select></label>\n"
          "<span class=\"faint\" id=\"shown\" role=\"status\"></span></div>\n"
          "<div class=\"scroll\"><table id=\"atlases\">\n";
  AppendHead(html);
  html << "<tbody>\n";
  for (const AtlasReport& report : reports) AppendRow(html, report);
  html << "</tbody></table></div>\n</main>\n";
  return report::Page(title, std::move(html).Take(), report::kIndexScript);
}

}  // namespace slamdb
