// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/ply/detail/ply.h"

#include <array>

#include "slamdb/base/detail/text.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/points.h"
#include "slamdb/formats/export/detail/raw.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/export/options.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kRowsPerBlock = 8192;

struct Columns {
  IdColumn map, point;
};

std::string_view TypeName(IdColumn column) { return column == IdColumn::kUnsigned32 ? "uint" : "double"; }

std::string Header(std::size_t points, Columns columns, bool binary) {
  std::string text = "ply\nformat ";
  text += binary ? "binary_little_endian" : "ascii";
  text += " 1.0\ncomment written by slamdb: map points\nelement vertex ";
  AppendNumber(text, points);
  text +=
      "\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property float min_distance\nproperty float max_distance\n"
      "property uint observations\nproperty float reprojection_error\n";
  text.append("property ").append(TypeName(columns.map)).append(" map\n");
  text.append("property ").append(TypeName(columns.point)).append(" id\nend_header\n");
  return text;
}

void AppendBinaryRow(std::string& out, const PointRows& points, std::size_t row, Columns columns) {
  const MapPoint& point = *points[row].point;
  for (const float value : point.position) AppendRaw(out, value);
  for (const float value : point.normal) AppendRaw(out, value);
  for (const std::uint8_t value : ColorOfMap(points.map_id(points[row]))) AppendRaw(out, value);
  AppendRaw(out, point.min_distance);
  AppendRaw(out, point.max_distance);
  AppendRaw(out, static_cast<std::uint32_t>(point.observations.size()));
  AppendRaw(out, points.mean_error(points[row]));
  AppendRawId(out, points.map_id(points[row]).value(), columns.map);
  AppendRawId(out, point.id.value(), columns.point);
}

void AppendAsciiRow(std::string& out, const PointRows& points, std::size_t row) {
  const MapPoint& point = *points[row].point;
  const auto add = [&out](auto value) {
    AppendNumber(out, value);
    out += ' ';
  };
  for (const float value : point.position) add(value);
  for (const float value : point.normal) add(value);
  for (const std::uint8_t value : ColorOfMap(points.map_id(points[row]))) add(value);
  add(point.min_distance);
  add(point.max_distance);
  add(point.observations.size());
  add(points.mean_error(points[row]));
  add(points.map_id(points[row]).value());
  AppendNumber(out, point.id.value());
  out += '\n';
}

void WritePly(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  const bool binary = options.of<PointCloudOptions>().binary;
  AtomicFile file(target, FileOptions(options));
  const PointRows points(atlas, target, options);
  WarnOfSeveralFrames(points.maps(), "the property `map` and the colour tell them apart", notices);
  const Columns columns{.map = ColumnForMapIds(points), .point = ColumnForPointIds(points)};
  file.Write(Header(points.size(), columns, binary));
  WriteRows(file, points.size(), kRowsPerBlock, options, [&](std::size_t begin, std::size_t end, std::string& out) {
    for (std::size_t row = begin; row < end; ++row) {
      if (binary)
        AppendBinaryRow(out, points, row, columns);
      else
        AppendAsciiRow(out, points, row);
    }
  });
  file.Commit();
  notices.Tell(points.Summary());
}

bool SniffPly(const Probe& probe) { return probe.head.starts_with("ply\n") || probe.head.starts_with("ply\r\n"); }

constexpr std::array<std::string_view, 1> kSuffixes = {".ply"};

}  // namespace

const Format kPlyFormat = {.id = "ply",
                           .title = "PLY point cloud",
                           .suffixes = kSuffixes,
                           .kind = FileKind::kBinaryOrText,
                           .chooses_maps = true,
                           .is_export = true,
                           .writes = Content::kPoints | Content::kNormals | Content::kMaps,
                           .sniff = SniffPly,
                           .write = WritePly};

}  // namespace slamdb::detail
