// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/gltf/detail/document.h"

#include <cmath>

#include "slamdb/formats/export/detail/raw.h"
#include "slamdb/model/up.h"

namespace slamdb::detail {
namespace {

// Numbers of the standard.
constexpr int kUnsignedShort = 5123, kFloat = 5126;
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr int kPoints = 0, kLines = 1, kLineStrip = 3;

// In double, so that every reader gets the very float.
void AppendVector(JsonAppender& json, std::string_view name, const Eigen::Vector3f& vector) {
  json.Field(name, vector.cast<double>().eval());
}

std::string PositionBytes(std::span<const Eigen::Vector3f> positions) {
  std::string bytes;
  for (const Eigen::Vector3f& position : positions)
    for (const float value : position) AppendRaw(bytes, value);
  return bytes;
}

Eigen::AlignedBox3f BoxOf(std::span<const Eigen::Vector3f> positions) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& position : positions) box.extend(position);
  return box;
}

void AppendAccessor(JsonAppender& json, std::size_t view, std::size_t offset, int component, std::size_t count,
                    std::string_view type, bool normalized = false) {
  json.BeginObject();
  json.Field("bufferView", view);
  json.Field("byteOffset", offset);
  json.Field("componentType", component);
  if (normalized) json.Field("normalized", true);
  json.Field("count", count);
  json.Field("type", type);
  json.EndObject();
}

}  // namespace

double LinearOf(std::uint8_t srgb) {
  const double value = srgb / 255.0;
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

GltfDocument::Index GltfDocument::AddView(std::size_t offset, std::size_t bytes, std::size_t stride, bool indices) {
  JsonAppender& json = views_.Add();
  json.BeginObject();
  json.Field("buffer", 0);
  json.Field("byteOffset", offset);
  json.Field("byteLength", bytes);
  if (stride > 0) json.Field("byteStride", stride);
  json.Field("target", indices ? kElementArrayBuffer : kArrayBuffer);
  json.EndObject();
  return views_.last();
}

GltfDocument::Index GltfDocument::AddTail(std::string_view bytes, bool indices) {
  tail_ += bytes;
  return AddView(points_size_ + tail_.size() - bytes.size(), bytes.size(), 0, indices);
}

GltfDocument::Index GltfDocument::AddPositions(Index view, std::size_t count, const Eigen::AlignedBox3f& box) {
  JsonAppender& json = accessors_.Add();
  json.BeginObject();
  json.Field("bufferView", view);
  json.Field("byteOffset", 0);
  json.Field("componentType", kFloat);
  json.Field("count", count);
  json.Field("type", "VEC3");
  AppendVector(json, "min", box.min());
  AppendVector(json, "max", box.max());
  json.EndObject();
  return accessors_.last();
}

GltfDocument::Index GltfDocument::AddMaterial(const std::string& name, const std::array<double, 3>& linear) {
  JsonAppender& json = materials_.Add();
  json.BeginObject();
  json.Field("name", std::string_view(name));
  json.BeginObject("pbrMetallicRoughness");
  json.Field("baseColorFactor", Eigen::Vector4d(linear[0], linear[1], linear[2], 1));
  json.Field("metallicFactor", 0);
  json.EndObject();
  json.BeginObject("extensions");
  json.BeginObject("KHR_materials_unlit");
  json.EndObject();
  json.EndObject();
  json.EndObject();
  return materials_.last();
}

GltfDocument::Index GltfDocument::PointMaterial() {
  if (!point_material_) point_material_ = AddMaterial("points", {1, 1, 1});
  return *point_material_;
}

GltfDocument::Index GltfDocument::MaterialOf(MapId id) {
  const auto found = map_materials_.find(id);
  if (found != map_materials_.end()) return found->second;
  const auto [red, green, blue] = ColorOfMap(id);
  return map_materials_[id] = AddMaterial(ToString(id), {LinearOf(red), LinearOf(green), LinearOf(blue)});
}

GltfDocument::Index GltfDocument::AddNode(const std::string& name, Index mesh) {
  JsonAppender& json = nodes_.Add();
  json.BeginObject();
  json.Field("name", std::string_view(name));
  json.Field("mesh", mesh);
  json.EndObject();
  return nodes_.last();
}

GltfDocument::Index GltfDocument::AddPoints(const std::string& name, const GltfCloud& cloud) {
  const std::size_t bytes = kPointStride * cloud.count;
  const Index view = AddView(points_begun_, bytes, kPointStride, false);
  points_begun_ += bytes;
  const Index first = AddPositions(view, cloud.count, cloud.box);
  AppendAccessor(accessors_.Add(), view, 12, kFloat, cloud.count, "VEC3");
  AppendAccessor(accessors_.Add(), view, 24, kUnsignedShort, cloud.count, "VEC4", true);
  AppendAccessor(accessors_.Add(), view, 32, kUnsignedShort, cloud.count, "VEC4");
  AppendAccessor(accessors_.Add(), view, 40, kFloat, cloud.count, "SCALAR");
  AppendAccessor(accessors_.Add(), view, 44, kFloat, cloud.count, "SCALAR");
  constexpr std::string_view kAttributes[] = {"POSITION", "NORMAL",        "COLOR_0",
                                              "_ID",      "_OBSERVATIONS", "_REPROJECTION_ERROR"};
  return AddNode(name, AddMesh(name, kAttributes, first, std::nullopt, kPoints, PointMaterial()));
}

GltfDocument::Index GltfDocument::AddLines(const std::string& name, Index positions, std::optional<Index> edges,
                                           int mode, Index material) {
  constexpr std::string_view kAttributes[] = {"POSITION"};
  return AddMesh(name, kAttributes, positions, edges, mode, material);
}

GltfDocument::Index GltfDocument::AddMesh(const std::string& name, std::span<const std::string_view> attributes,
                                          Index accessor, std::optional<Index> edges, int mode, Index material) {
  JsonAppender& json = meshes_.Add();
  json.BeginObject();
  json.Field("name", std::string_view(name));
  json.BeginArray("primitives");
  json.BeginObject();
  json.BeginObject("attributes");
  for (const std::string_view attribute : attributes) json.Field(attribute, accessor++);
  json.EndObject();
  if (edges) json.Field("indices", *edges);
  json.Field("mode", mode);
  json.Field("material", material);
  json.EndObject();
  json.EndArray();
  json.EndObject();
  return meshes_.last();
}

GltfDocument::Index GltfDocument::AddPath(const std::string& name, Index material,
                                          const KeyFrameTrajectory& trajectory) {
  const std::vector<Eigen::Vector3f> centers = CentersOf(trajectory);
  const Index positions = AddPositions(AddTail(PositionBytes(centers), false), centers.size(), BoxOf(centers));
  return AddNode(name, AddLines(name, positions, std::nullopt, kLineStrip, material));
}

GltfDocument::Index GltfDocument::MeshOf(const Frustum& frustum, Index material) {
  const auto [found, is_new] = frusta_.try_emplace({material, frustum}, 0);
  if (!is_new) return found->second;
  if (!frustum_edges_) {
    std::string bytes;
    for (const auto& [from, to] : Frustum::kEdges) AppendRaw(bytes, from), AppendRaw(bytes, to);
    const Index view = AddTail(bytes, true);
    AppendAccessor(accessors_.Add(), view, 0, kUnsignedShort, 2 * Frustum::kEdges.size(), "SCALAR");
    frustum_edges_ = accessors_.last();
  }
  const Index view = AddTail(PositionBytes(frustum.vertices), false);
  const Index positions = AddPositions(view, frustum.vertices.size(), BoxOf(frustum.vertices));
  return found->second = AddLines("camera", positions, frustum_edges_, kLines, material);
}

GltfDocument::Index GltfDocument::AddKeyFrames(const std::string& name, Index material,
                                               const KeyFrameTrajectory& trajectory) {
  const float depth = FrustumDepth(CentersOf(trajectory));
  const Index first = nodes_.count;
  for (const TimedPose& pose : trajectory.poses) {
    const Index mesh = MeshOf(FrustumOf(*pose.keyframe, depth), material);
    JsonAppender& json = nodes_.Add();
    json.BeginObject();
    json.Field("name", std::string_view(ToString(pose.keyframe->id)));
    json.Field("mesh", mesh);
    json.Field("rotation", pose.world_from_it.rotation.coeffs());
    AppendVector(json, "translation", pose.world_from_it.translation);
    json.BeginObject("extras");
    json.ExactField("keyframe", pose.keyframe->id);
    json.Field("timestamp", pose.timestamp);
    json.EndObject();
    json.EndObject();
  }
  JsonAppender& json = nodes_.Add();
  json.BeginObject();
  json.Field("name", std::string_view(name));
  json.BeginArray("children");
  for (Index child = first; child < first + trajectory.poses.size(); ++child) json.Value(child);
  json.EndArray();
  json.EndObject();
  return nodes_.last();
}

void GltfDocument::AddMap(MapId id, const Eigen::Vector3d& up, const GltfCloud& cloud,
                          const KeyFrameTrajectory& trajectory) {
  static const Eigen::Quaterniond kYFromZ(std::sqrt(0.5), -std::sqrt(0.5), 0, 0);
  const std::string name = ToString(id);
  std::vector<Index> children;
  if (cloud.count > 0) children.push_back(AddPoints(name + " points", cloud));
  if (trajectory.poses.size() > 1) children.push_back(AddPath(name + " trajectory", MaterialOf(id), trajectory));
  if (!trajectory.poses.empty()) children.push_back(AddKeyFrames(name + " keyframes", MaterialOf(id), trajectory));
  JsonAppender& json = nodes_.Add();
  json.BeginObject();
  json.Field("name", std::string_view(name));
  json.Field("rotation", Quaternionf((kYFromZ * UprightFromMap(up)).cast<float>()).coeffs());
  if (!children.empty()) json.Array("children", children);
  json.BeginObject("extras");
  json.ExactField("map", id);
  json.EndObject();
  json.EndObject();
  map_nodes_.push_back(nodes_.last());
}

std::string GltfDocument::Finish() {
  std::string text;
  JsonAppender json(text);
  const auto add = [&](std::string_view name, const List& list) {
    if (list.count > 0) text.append(",\"").append(name).append("\":[").append(list.text).append("]");
  };
  json.BeginObject();
  json.BeginObject("asset");
  json.Field("version", "2.0");
  json.Field("generator", "slamdb");
  json.EndObject();
  if (materials_.count > 0) json.Array("extensionsUsed", std::array{"KHR_materials_unlit"});
  json.Field("scene", 0);
  json.BeginArray("scenes");
  json.BeginObject();
  json.Field("name", "atlas");
  if (!map_nodes_.empty()) json.Array("nodes", map_nodes_);
  json.EndObject();
  json.EndArray();
  add("nodes", nodes_);
  add("meshes", meshes_);
  add("materials", materials_);
  add("accessors", accessors_);
  add("bufferViews", views_);
  if (points_size_ + tail_.size() > 0) {
    json.BeginArray("buffers");
    json.BeginObject();
    json.Field("byteLength", points_size_ + tail_.size());
    json.EndObject();
    json.EndArray();
  }
  json.EndObject();
  return text;
}

}  // namespace slamdb::detail
