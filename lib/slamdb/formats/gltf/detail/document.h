// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "slamdb/formats/export/detail/frusta.h"
#include "slamdb/formats/export/detail/json_appender.h"
#include "slamdb/formats/trajectory/detail/poses.h"
#include "slamdb/model/colors.h"

namespace slamdb::detail {

// The points of a map.
struct GltfCloud {
  std::size_t count = 0;
  Eigen::AlignedBox3f box;
};

// A glTF document that is being made: its JSON, and the binary part of everything but the points.
class GltfDocument {
 public:
  // Bytes of a point: position, normal, colour, id, observations, error.
  static constexpr std::size_t kPointStride = 48;

  // So many points in all maps together. They stand first in the binary part, map after map.
  explicit GltfDocument(std::size_t points) : points_size_(kPointStride * points) {}

  // Adds a map: points where there are some, the path and the cameras of the trajectory.
  void AddMap(MapId id, const Eigen::Vector3d& up, const GltfCloud& cloud, const KeyFrameTrajectory& trajectory);

  // Ends the document: the whole JSON.
  std::string Finish();

  // The binary part: so many bytes of points, then these.
  std::size_t points_size() const { return points_size_; }
  const std::string& tail() const { return tail_; }

 private:
  // An array of the document: its elements as text, and how many there are.
  struct List {
    std::string text;
    JsonAppender json{text};
    std::size_t count = 0;
    JsonAppender& Add() {
      ++count;
      return json;
    }
    std::size_t last() const { return count - 1; }
  };
  using Index = std::size_t;

  Index AddPoints(const std::string& name, const GltfCloud& cloud);
  Index AddPath(const std::string& name, Index material, const KeyFrameTrajectory& trajectory);
  Index AddKeyFrames(const std::string& name, Index material, const KeyFrameTrajectory& trajectory);
  Index MeshOf(const Frustum& frustum, Index material);
  Index MaterialOf(MapId id);
  Index PointMaterial();
  Index AddMaterial(const std::string& name, const std::array<double, 3>& linear);
  Index AddTail(std::string_view bytes, bool indices);
  Index AddView(std::size_t offset, std::size_t bytes, std::size_t stride, bool indices);
  Index AddPositions(Index view, std::size_t count, const Eigen::AlignedBox3f& box);
  // `accessor`: of the first attribute; those of the others follow it.
  Index AddMesh(const std::string& name, std::span<const std::string_view> attributes, Index accessor,
                std::optional<Index> edges, int mode, Index material);
  Index AddLines(const std::string& name, Index positions, std::optional<Index> edges, int mode, Index material);
  Index AddNode(const std::string& name, Index mesh);

  std::size_t points_size_, points_begun_ = 0;
  std::string tail_;
  List nodes_, meshes_, accessors_, views_, materials_;
  std::vector<Index> map_nodes_;
  std::map<std::pair<Index, Frustum>, Index> frusta_;  // by material
  std::map<MapId, Index> map_materials_;
  std::optional<Index> point_material_, frustum_edges_;
};

// A part of a colour as glTF has it, linear in light, from 0 to 1.
double LinearOf(std::uint8_t srgb);

}  // namespace slamdb::detail
