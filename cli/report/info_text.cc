// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/info_text.h"

#include <algorithm>
#include <functional>
#include <numeric>

#include "cli/report/layout.h"
#include "cli/report/plan.h"
#include "cli/words.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/formats/info_sections.h"

namespace slamdb::cli {
namespace {

using enum Table::Align;

std::string UnitOf(const MapStatistics& map) { return map.metric ? "m" : "units"; }

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

std::string InfoText(const AtlasInfo& report, std::size_t plan_width) {
  constexpr std::size_t kLines = 12, kFewer = 6;  // of one plan, and of each of several
  const std::vector<InfoSection> sections = InfoSections(report, InCommandWords);
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
