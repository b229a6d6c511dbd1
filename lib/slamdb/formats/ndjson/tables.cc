// SPDX-License-Identifier: BSD-3-Clause
#include <numeric>

#include "slamdb/base/error.h"
#include "slamdb/formats/ndjson/detail/read.h"
#include "slamdb/model/detail/matrix_types.h"

namespace slamdb::detail {
namespace {

template <class Sizes>
std::uint64_t Sum(const Sizes& sizes) {
  return std::accumulate(sizes.begin(), sizes.end(), std::uint64_t{0});
}

void RequireGrid(JsonScanner& json, std::string_view name, const FeatureGrid& grid) {
  if (Sum(grid.column_sizes) != grid.cell_sizes.size() || Sum(grid.cell_sizes) != grid.keypoints.size())
    json.Refuse(Concat(name, ": column_sizes add up to ", Sum(grid.column_sizes), " cells, and cell_sizes to ",
                       Sum(grid.cell_sizes), " keypoints, but there are ", grid.cell_sizes.size(), " cells and ",
                       grid.keypoints.size(), " keypoints"));
}

// What is left out of a matrix of numbers is that of a column of floats.
void FinishMatrix(JsonScanner& json, Given& given, Matrix& matrix) {
  static const std::size_t kValues = KeyFrameMembers().Find(kMatrixValues),
                           kBytes = KeyFrameMembers().Find(kMatrixBytes);
  const auto lacks = [&](std::string_view name) { return !given[KeyFrameMembers().Find(name)]; };
  if (given[kValues] && given[kBytes]) json.Refuse("distortion: either values or bytes, not both");
  if (given[kValues]) {
    if (lacks("distortion.type")) matrix.type = kCv32F;
    if (lacks("distortion.columns")) matrix.columns = 1;
    if (lacks("distortion.rows") && matrix.columns == 1)
      matrix.rows = static_cast<std::int32_t>(matrix.data.size() / sizeof(float));
    if (lacks("distortion.continuous")) matrix.continuous = true;
    if (matrix.type != kCv32F) json.Refuse("distortion: matrices of other types than 5 have bytes, not values");
  }
  if (given[kBytes]) given.set(kValues);
  RequireSound(json, "distortion: ", matrix);
}

void RequireEntries(const std::vector<RepeatedEntry>& entries, std::string_view name, const auto& size_of) {
  std::uint64_t next = 0;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const RepeatedEntry& entry = entries[i];
    const bool null = entry.owner_map == RepeatedEntry::kNull;
    if (entry.position < next || (!null && entry.row >= size_of(entry.owner_map)))
      throw Error(ErrorKind::kDamaged, "", Concat(name, "[", i, "]"),
                  "is no entry of the list: positions ascend, and what stands there once more is there");
    next = entry.position + 1;
  }
}

template <class Entity>
MemberTable<Entity> Made(std::initializer_list<std::string_view> more, std::initializer_list<std::string_view> needed) {
  MemberTable<Entity> table;
  for (const std::string_view name : more) table.Add(name);
  table.Require(needed);
  return table;
}

}  // namespace

const MemberTable<Atlas>& AtlasMembers() {
  static const MemberTable<Atlas> table = [] {
    MemberTable<Atlas> atlas = Made<Atlas>({"type", "maps", "cameras"}, {});
    fields::ForEachEncodingField([&](std::string_view name, auto... path) {
      atlas.Add(name, [path...](JsonScanner& json, Atlas& read) { ReadMember(json, Member(read, path...)); });
    });
    return atlas;
  }();
  return table;
}

const MemberTable<Camera>& CameraMembers() {
  static const auto table = Made<Camera>({"type"}, {"id", "model", "parameters"});
  return table;
}

const MemberTable<Map>& MapMembers() {
  static const auto table = Made<Map>({"type", "keyframe_count", "point_count"}, {"id"});
  return table;
}

const MemberTable<KeyFrame>& KeyFrameMembers() {
  static const MemberTable<KeyFrame> table = [] {
    auto keyframe = Made<KeyFrame>({"type", "map"}, {"id", "timestamp", "camera_from_world"});
    keyframe.Add(kMatrixBytes, [](JsonScanner& json, KeyFrame& read) { ReadMatrixBytes(json, read.distortion.data); });
    return keyframe;
  }();
  return table;
}

const MemberTable<MapPoint>& PointMembers() {
  static const auto table = Made<MapPoint>({"type", "map"}, {"id", "position"});
  return table;
}

const MemberTable<Landmark>& LandmarkMembers() {
  static const auto table = Made<Landmark>({"type", "map"}, {"mean"});
  return table;
}

void RequireSound(JsonScanner& json, Given& given, KeyFrame& keyframe) {
  const Features& features = keyframe.features;
  FinishMatrix(json, given, keyframe.distortion);
  RequireGrid(json, "features.grid", features.grid);
  RequireGrid(json, "features.right_grid", features.right_grid);
  if (features.bag_of_words.words.size() != features.bag_of_words.weights.size())
    json.Refuse(Concat("features.bag_of_words: ", features.bag_of_words.words.size(), " words have ",
                       features.bag_of_words.weights.size(), " weights"));
  const FeatureVector& vector = features.feature_vector;
  if (vector.nodes.size() != vector.sizes.size() || Sum(vector.sizes) != vector.features.size())
    json.Refuse(Concat("features.feature_vector: sizes do not add up, of ", vector.nodes.size(), " nodes with ",
                       vector.features.size(), " features"));
  const bool is_empty =
      features.descriptors_form == MatrixForm::kEmpty || features.descriptors_form == MatrixForm::kEmptyContinuous;
  if (is_empty && !features.descriptors.empty())
    json.Refuse("features.descriptors_form: is empty, but there are descriptors");
}

void RequireSound(JsonScanner& json, const ArchiveEncoding& encoding) {
  const auto known = [](std::uint8_t bytes) { return bytes == 4 || bytes == 8; };
  if (!known(encoding.long_bytes) || !known(encoding.size_bytes) || encoding.boost_version > 0xffff)
    json.Refuse("encoding: long_bytes and size_bytes are 4 or 8, and boost_version has 16 bits");
}

void RequireSoundEntries(const Atlas& atlas) {
  RequireEntries(atlas.repeated_maps, "repeated_maps", [&](std::uint32_t) { return atlas.maps.size(); });
  RequireEntries(atlas.repeated_cameras, "repeated_cameras", [&](std::uint32_t) { return atlas.cameras.size(); });
  for (const Map& map : atlas.maps) {
    const std::string place = ToString(map.id) + ": ";
    RequireEntries(map.repeated_keyframes, place + "repeated_keyframes", [&](std::uint32_t owner) {
      return owner < atlas.maps.size() ? atlas.maps[owner].keyframes.size() : 0;
    });
    RequireEntries(map.repeated_points, place + "repeated_points", [&](std::uint32_t owner) {
      return owner < atlas.maps.size() ? atlas.maps[owner].points.size() : 0;
    });
  }
}

}  // namespace slamdb::detail
