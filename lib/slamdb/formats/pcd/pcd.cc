// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/pcd/detail/pcd.h"

#include <array>
#include <bit>

#include "slamdb/base/detail/text.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/point_colors.h"
#include "slamdb/formats/export/detail/points.h"
#include "slamdb/formats/export/detail/raw.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/formats/pcd/detail/read.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kRowsPerBlock = 8192;

struct Columns {
  IdColumn map, point;
};

std::string Header(std::size_t points, Columns columns, bool binary) {
  const auto wide = [](IdColumn column) { return column == IdColumn::kDouble; };
  std::string text =
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
      "FIELDS x y z normal_x normal_y normal_z rgb min_distance max_distance observations reprojection_error map id\n";
  text.append("SIZE 4 4 4 4 4 4 4 4 4 4 4 ").append(wide(columns.map) ? "8" : "4");
  text.append(wide(columns.point) ? " 8\n" : " 4\n");
  text.append("TYPE F F F F F F F F F U F ").append(wide(columns.map) ? "F" : "U");
  text.append(wide(columns.point) ? " F\n" : " U\n");
  text += "COUNT 1 1 1 1 1 1 1 1 1 1 1 1 1\nWIDTH ";
  AppendNumber(text, points);
  text += "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS ";
  AppendNumber(text, points);
  return text + (binary ? "\nDATA binary\n" : "\nDATA ascii\n");
}

// PCL keeps a colour as the float whose bits are 0x00RRGGBB, and takes a field `rgb` only of that type.
float PackedColor(const Color& color) {
  const auto [red, green, blue] = color;
  const auto bits = static_cast<std::uint32_t>(red << 16 | green << 8 | blue);
  return std::bit_cast<float>(bits);
}

void AppendBinaryRow(std::string& out, const PointRows& points, const PointColors& colors, std::size_t row,
                     Columns columns) {
  const MapPoint& point = *points[row].point;
  for (const float value : point.position) AppendRaw(out, value);
  for (const float value : point.normal) AppendRaw(out, value);
  AppendRaw(out, PackedColor(colors[row]));
  AppendRaw(out, point.min_distance);
  AppendRaw(out, point.max_distance);
  AppendRaw(out, static_cast<std::uint32_t>(point.observations.size()));
  AppendRaw(out, points.mean_error(points[row]));
  AppendRawId(out, points.map_id(points[row]).value(), columns.map);
  AppendRawId(out, point.id.value(), columns.point);
}

void AppendAsciiRow(std::string& out, const PointRows& points, const PointColors& colors, std::size_t row) {
  const MapPoint& point = *points[row].point;
  const auto add = [&out](auto value) {
    AppendNumber(out, value);
    out += ' ';
  };
  for (const float value : point.position) add(value);
  for (const float value : point.normal) add(value);
  add(PackedColor(colors[row]));
  add(point.min_distance);
  add(point.max_distance);
  add(point.observations.size());
  add(points.mean_error(points[row]));
  add(points.map_id(points[row]).value());
  AppendNumber(out, point.id.value());
  out += '\n';
}

void WritePcd(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  const bool binary = options.of<PointCloudOptions>().binary;
  AtomicFile file(target, FileOptions(options));
  const PointRows points(atlas, target, options);
  const PointColors colors(points, options);
  WarnOfSeveralFrames(points.maps(), "the field `map` and the colour tell them apart", notices);
  const Columns columns{.map = ColumnForMapIds(points), .point = ColumnForPointIds(points)};
  file.Write(Header(points.size(), columns, binary));
  WriteRows(file, points.size(), kRowsPerBlock, options, [&](std::size_t begin, std::size_t end, std::string& out) {
    for (std::size_t row = begin; row < end; ++row) {
      if (binary)
        AppendBinaryRow(out, points, colors, row, columns);
      else
        AppendAsciiRow(out, points, colors, row);
    }
  });
  file.Commit();
  colors.Tell(notices);
  notices.Tell(points.Summary(), WrittenCounts{.points = points.size()});
}

// A line of its header behind comments.
bool SniffPcd(const Probe& probe) {
  if (probe.head.starts_with("# .PCD v")) return true;
  std::string_view text = probe.head;
  while (text.starts_with('#')) TakeLine(text);
  return text.starts_with("VERSION ") && text.find("\nFIELDS ") != text.npos;
}

constexpr std::array<std::string_view, 1> kSuffixes = {".pcd"};

}  // namespace

const Format kPcdFormat = {.id = "pcd",
                           .title = "PCD point cloud",
                           .suffixes = kSuffixes,
                           .kind = FileKind::kBinaryOrText,
                           .chooses_maps = true,
                           .has_colors = true,
                           .is_export = true,
                           .reads = Content::kPoints | Content::kNormals | Content::kMaps,
                           .writes = Content::kPoints | Content::kNormals | Content::kMaps,
                           .sniff = SniffPcd,
                           .read = ReadPcd,
                           .write = WritePcd};

}  // namespace slamdb::detail
