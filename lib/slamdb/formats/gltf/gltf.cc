// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/gltf/detail/gltf.h"

#include <array>
#include <cmath>
#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/point_colors.h"
#include "slamdb/formats/export/detail/points.h"
#include "slamdb/formats/export/detail/raw.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/gltf/detail/document.h"
#include "slamdb/formats/trajectory/detail/poses.h"
#include "slamdb/model/up.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kRowsPerBlock = 8192;

GltfCloud CloudOf(const PointRows& points, std::size_t map) {
  GltfCloud cloud;
  for (std::size_t row = points.begins()[map]; row < points.begins()[map + 1]; ++row) {
    cloud.box.extend(points[row].point->position);
    ++cloud.count;
  }
  return cloud;
}

std::string DocumentOf(const PointRows& points, const Trajectories& trajectories, const std::vector<Up>& ups,
                       GltfDocument& document) {
  static const KeyFrameTrajectory kNoPoses{};
  for (std::size_t row = 0; row < points.maps().size(); ++row) {
    const Map& map = *points.maps()[row];
    const KeyFrameTrajectory* trajectory = trajectories.Find(map);
    document.AddMap(map.id, ups[row].direction, CloudOf(points, row), trajectory == nullptr ? kNoPoses : *trajectory);
  }
  return document.Finish();
}

// What colours of 8 bits are in 16 bits that are linear in light.
std::array<std::uint16_t, 256> LinearTable() {
  std::array<std::uint16_t, 256> table{};
  for (std::size_t value = 0; value < table.size(); ++value)
    table[value] = static_cast<std::uint16_t>(std::lround(65535 * LinearOf(static_cast<std::uint8_t>(value))));
  return table;
}

// Of unit length, to where the point was seen from; ORB-SLAM3's points the other way.
Eigen::Vector3f NormalOf(const MapPoint& point, const Eigen::Vector3d& otherwise) {
  const Eigen::Vector3d normal = -point.normal.cast<double>();
  const double length = normal.norm();
  return (length > 0 && std::isfinite(length) ? Eigen::Vector3d(normal / length) : otherwise).cast<float>();
}

// The file's length must fit into 32 bits.
std::uint32_t LengthOf(std::size_t json, std::size_t binary, const Target& target) {
  const std::uint64_t length = 12 + 8 + json + (binary > 0 ? 8 + binary : 0);
  if (length > std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorKind::kNotPossible, target.path, "",
                Concat("a .glb file has at most 4 GiB, and this one would have ", Thousands(length),
                       " bytes; write one map alone (ExportOptions::map), or fewer points"));
  return static_cast<std::uint32_t>(length);
}

// The header, and what stands in front of the points.
std::string HeadOf(std::string json, std::size_t binary, const Target& target) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string head = "glTF";
  AppendRaw(head, std::uint32_t{2});
  AppendRaw(head, LengthOf(json.size(), binary, target));
  AppendRaw(head, static_cast<std::uint32_t>(json.size()));
  head += "JSON" + json;
  if (binary > 0) {
    AppendRaw(head, static_cast<std::uint32_t>(binary));
    head += std::string_view("BIN\0", 4);
  }
  return head;
}

void WritePoints(AtomicFile& file, const PointRows& points, const PointColors& colors, const std::vector<Up>& ups,
                 const WriteOptions& options) {
  static const std::array<std::uint16_t, 256> kLinear = LinearTable();
  WriteRows(file, points.size(), kRowsPerBlock, options, [&](std::size_t begin, std::size_t end, std::string& out) {
    for (std::size_t row = begin; row < end; ++row) {
      const MapPoint& point = *points[row].point;
      const float error = points.mean_error(points[row]);
      for (const float value : point.position) AppendRaw(out, value);
      for (const float value : NormalOf(point, ups[points[row].map].direction)) AppendRaw(out, value);
      for (const std::uint8_t value : colors[row]) AppendRaw(out, kLinear[value]);
      AppendRaw(out, std::numeric_limits<std::uint16_t>::max());
      AppendRaw(out, point.id.value());
      AppendRaw(out, static_cast<float>(point.observations.size()));
      AppendRaw(out, std::isfinite(error) ? error : -1.F);
    }
  });
}

void WriteGltf(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  AtomicFile file(target, FileOptions(options));
  const PointRows points(atlas, target, options, Positions::kFinite);
  const PointColors colors(points, options);
  const Trajectories trajectories = CollectTrajectories(atlas, target, options, notices, Rounded::kIsTaken);
  WarnOfSeveralFrames(points.maps(), "a node for each tells them apart", notices);
  points.WarnOfNotFinite(notices);
  const std::vector<Up> ups = UpsOf(points.maps());
  GltfDocument document(points.size());
  std::string json = DocumentOf(points, trajectories, ups, document);
  file.Write(HeadOf(std::move(json), document.points_size() + document.tail().size(), target));
  WritePoints(file, points, colors, ups, options);
  file.Write(document.tail());
  file.Commit();
  colors.Tell(notices);
  notices.Tell(points.Summary() + "; " + trajectories.Summary(),
               WrittenCounts{.keyframes = trajectories.Count().poses, .points = points.size()});
}

// Others are pictures of other things.
bool SniffGltf(const Probe& probe) {
  return probe.head.starts_with("glTF") && probe.head.find("\"generator\":\"slamdb\"") != std::string::npos;
}

constexpr std::array<std::string_view, 1> kSuffixes = {".glb"};

}  // namespace

const Format kGltfFormat = {.id = "gltf",
                            .title = "glTF scene",
                            .suffixes = kSuffixes,
                            .kind = FileKind::kBinary,
                            .chooses_maps = true,
                            .has_colors = true,
                            .is_export = true,
                            .writes = Content::kPoints | Content::kNormals | Content::kPoses | Content::kMaps,
                            .sniff = SniffGltf,
                            .write = WriteGltf};

}  // namespace slamdb::detail
