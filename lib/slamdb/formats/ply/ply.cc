// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/ply/detail/ply.h"

#include <algorithm>
#include <array>

#include "slamdb/base/detail/text.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/point_colors.h"
#include "slamdb/formats/export/detail/points.h"
#include "slamdb/formats/export/detail/raw.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/formats/ply/detail/cameras.h"
#include "slamdb/formats/ply/detail/read.h"
#include "slamdb/formats/trajectory/detail/poses.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kRowsPerBlock = 8192;

struct Layout {
  IdColumn map, id;
  bool binary, cameras;
};

std::string_view TypeName(IdColumn column) { return column == IdColumn::kUnsigned32 ? "uint" : "double"; }

std::string Header(std::size_t vertices, const PlyCameras& cameras, const std::string& legend, Layout layout) {
  std::string text = "ply\nformat ";
  text += layout.binary ? "binary_little_endian" : "ascii";
  text += " 1.0\ncomment written by slamdb: map points\n";
  if (!legend.empty()) text += "comment colours: " + legend + "\n";
  text += "element vertex ";
  AppendNumber(text, vertices);
  text +=
      "\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property float min_distance\nproperty float max_distance\n"
      "property uint observations\nproperty float reprojection_error\n";
  text.append("property ").append(TypeName(layout.map)).append(" map\n");
  text.append("property ").append(TypeName(layout.id)).append(" id\n");
  if (layout.cameras) {
    text += "property uchar camera\nelement edge ";
    AppendNumber(text, cameras.edges().size());
    text +=
        "\nproperty int vertex1\nproperty int vertex2\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  }
  return text + "end_header\n";
}

PlyVertex VertexOf(const PointRows& points, const PointColors& colors, std::size_t row) {
  const MapPoint& point = *points[row].point;
  return {.position = point.position,
          .normal = point.normal,
          .color = colors[row],
          .min_distance = point.min_distance,
          .max_distance = point.max_distance,
          .observations = static_cast<std::uint32_t>(point.observations.size()),
          .error = points.mean_error(points[row]),
          .map = points.map_id(points[row]).value(),
          .id = point.id.value()};
}

void AppendBinary(std::string& out, const PlyVertex& vertex, Layout layout) {
  for (const float value : vertex.position) AppendRaw(out, value);
  for (const float value : vertex.normal) AppendRaw(out, value);
  for (const std::uint8_t value : vertex.color) AppendRaw(out, value);
  AppendRaw(out, vertex.min_distance);
  AppendRaw(out, vertex.max_distance);
  AppendRaw(out, vertex.observations);
  AppendRaw(out, vertex.error);
  AppendRawId(out, vertex.map, layout.map);
  AppendRawId(out, vertex.id, layout.id);
  if (layout.cameras) AppendRaw(out, vertex.camera);
}

void AppendAscii(std::string& out, const PlyVertex& vertex, Layout layout) {
  const auto add = [&out](auto value) {
    AppendNumber(out, value);
    out += ' ';
  };
  for (const float value : vertex.position) add(value);
  for (const float value : vertex.normal) add(value);
  for (const std::uint8_t value : vertex.color) add(value);
  add(vertex.min_distance);
  add(vertex.max_distance);
  add(vertex.observations);
  add(vertex.error);
  add(vertex.map);
  AppendNumber(out, vertex.id);
  if (layout.cameras) {
    out += ' ';
    AppendNumber(out, vertex.camera);
  }
  out += '\n';
}

void AppendVertex(std::string& out, const PlyVertex& vertex, Layout layout) {
  if (layout.binary)
    AppendBinary(out, vertex, layout);
  else
    AppendAscii(out, vertex, layout);
}

void AppendEdge(std::string& out, const PlyCameras::Edge& edge, const Color& color, bool binary) {
  if (binary) {
    for (const std::uint32_t vertex : edge) AppendRaw(out, vertex);
    for (const std::uint8_t value : color) AppendRaw(out, value);
    return;
  }
  for (const std::uint32_t vertex : edge) AppendNumber(out, vertex), out += ' ';
  for (const std::uint8_t value : color) AppendNumber(out, value), out += ' ';
  out.back() = '\n';
}

void WriteCameras(AtomicFile& file, const PlyCameras& cameras, Layout layout, const WriteOptions& options) {
  WriteRows(file, cameras.size(), kRowsPerBlock, options, [&](std::size_t begin, std::size_t end, std::string& out) {
    for (std::size_t camera = begin; camera < end; ++camera)
      for (const PlyVertex& vertex : cameras[camera]) AppendVertex(out, vertex, layout);
  });
  const std::vector<PlyCameras::Edge>& edges = cameras.edges();
  WriteRows(file, edges.size(), kRowsPerBlock, options, [&](std::size_t begin, std::size_t end, std::string& out) {
    for (std::size_t edge = begin; edge < end; ++edge)
      AppendEdge(out, edges[edge], cameras.ColorOf(edges[edge]), layout.binary);
  });
}

void WritePly(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  const PointCloudOptions& cloud = options.of<PointCloudOptions>();
  AtomicFile file(target, FileOptions(options));
  const PointRows points(atlas, target, options);
  const PointColors colors(points, options);
  WarnOfSeveralFrames(points.maps(), "the property `map` and the colour tell them apart", notices);
  Trajectories trajectories;
  if (cloud.cameras) trajectories = CollectTrajectories(atlas, target, options, notices, Rounded::kIsTaken);
  const PlyCameras cameras(trajectories, points.size());
  const Layout layout{.map = ColumnForMapIds(points),
                      .id = std::max(ColumnForPointIds(points), cameras.ColumnForIds()),
                      .binary = cloud.binary,
                      .cameras = cloud.cameras};
  const std::string legend = cloud.color == PointColor::kMap ? "" : colors.Legend();
  file.Write(Header(points.size() + PlyCameras::kVertices * cameras.size(), cameras, legend, layout));
  WriteRows(file, points.size(), kRowsPerBlock, options, [&](std::size_t begin, std::size_t end, std::string& out) {
    for (std::size_t row = begin; row < end; ++row) AppendVertex(out, VertexOf(points, colors, row), layout);
  });
  WriteCameras(file, cameras, layout, options);
  file.Commit();
  colors.Tell(notices);
  notices.Tell(points.Summary() + (cloud.cameras ? "; " + trajectories.Summary() : ""),
               WrittenCounts{.keyframes = cloud.cameras ? trajectories.Count().poses : 0, .points = points.size()});
}

bool SniffPly(const Probe& probe) { return probe.head.starts_with("ply\n") || probe.head.starts_with("ply\r\n"); }

constexpr std::array<std::string_view, 1> kSuffixes = {".ply"};

}  // namespace

const Format kPlyFormat = {.id = "ply",
                           .title = "PLY point cloud",
                           .suffixes = kSuffixes,
                           .kind = FileKind::kBinaryOrText,
                           .chooses_maps = true,
                           .has_colors = true,
                           .is_export = true,
                           .reads = Content::kPoints | Content::kNormals | Content::kMaps,
                           .writes = Content::kPoints | Content::kNormals | Content::kMaps,
                           .sniff = SniffPly,
                           .read = ReadPly,
                           .write = WritePly};

}  // namespace slamdb::detail
