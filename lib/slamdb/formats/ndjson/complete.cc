// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/import/detail/complete.h"

#include "slamdb/formats/ndjson/detail/read.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {
namespace {

// Whether a field was there.
template <class Entity>
class Has {
 public:
  Has(const MemberTable<Entity>& table, std::string_view name) : node_(table.Find(name)) {}
  bool operator()(const Given& given) const { return given[node_]; }

 private:
  std::size_t node_;
};

void SetCameras(ReadLines& lines) {
  const Has has_type(CameraMembers(), "recorded_type");
  for (std::size_t i = 0; i < lines.cameras.size(); ++i) {
    Camera& camera = lines.atlas.cameras[i];
    if (!has_type(lines.cameras[i])) camera.recorded_type = static_cast<std::uint32_t>(camera.model);
  }
}

// Of its camera, where the line has none.
void SetIntrinsics(const Given& given, const Camera* camera, Intrinsics& intrinsics) {
  static const std::array<Has<KeyFrame>, 4> has{
      Has(KeyFrameMembers(), "intrinsics.fx"), Has(KeyFrameMembers(), "intrinsics.fy"),
      Has(KeyFrameMembers(), "intrinsics.cx"), Has(KeyFrameMembers(), "intrinsics.cy")};
  if (camera == nullptr || camera->model == CameraModel::kEquirectangular || camera->parameters.size() < has.size())
    return;
  const std::array<float*, 4> values{&intrinsics.fx, &intrinsics.fy, &intrinsics.cx, &intrinsics.cy};
  for (std::size_t i = 0; i < has.size(); ++i)
    if (!has[i](given)) *values[i] = camera->parameters[i];
}

void SetKeyFrames(ReadLines& lines) {
  static const Has has_form(KeyFrameMembers(), "features.descriptors_form"),
      has_origin(KeyFrameMembers(), "origin_map");
  const AtlasIndex index(lines.atlas);
  for (std::size_t m = 0; m < lines.maps.size(); ++m) {
    Map& map = lines.atlas.maps[m];
    for (std::size_t row = 0; row < map.keyframes.size(); ++row) {
      const Given& given = lines.maps[m].keyframes[row];
      KeyFrame& keyframe = map.keyframes[row];
      SetIntrinsics(given, index.FindCamera(keyframe.camera), keyframe.intrinsics);
      if (!has_form(given) && keyframe.features.descriptors.empty())
        keyframe.features.descriptors_form = MatrixForm::kEmpty;
      if (!has_origin(given)) keyframe.origin_map = static_cast<std::uint32_t>(map.id.value());
    }
  }
}

void SetPoints(ReadLines& lines) {
  static const Has has_form(PointMembers(), "descriptor_form"), has_descriptor(PointMembers(), "descriptor");
  for (std::size_t m = 0; m < lines.maps.size(); ++m)
    for (std::size_t row = 0; row < lines.maps[m].points.size(); ++row) {
      const Given& given = lines.maps[m].points[row];
      if (!has_form(given) && !has_descriptor(given))
        lines.atlas.maps[m].points[row].descriptor_form = MatrixForm::kEmpty;
    }
}

// CompleteAtlas derives a relation where none of a map's entities has any. Where some of them lack it, it is derived of
// all, and those that had it get theirs back.
template <class Entity, class List>
void ClearUnlessAllHave(const Has<Entity>& has, const std::vector<Given>& given, List& list, const auto& clear) {
  const auto lacks = [&](const Given& each) { return !has(each); };
  if (std::ranges::any_of(given, lacks)) std::ranges::for_each(list, clear);
}

void ClearWhatIsDerived(ReadLines& lines) {
  static const Has has_observations(PointMembers(), "observations");
  static const Has has_connections(KeyFrameMembers(), "connections");
  for (std::size_t m = 0; m < lines.maps.size(); ++m) {
    Map& map = lines.atlas.maps[m];
    ClearUnlessAllHave(has_observations, lines.maps[m].points, map.points,
                       [](MapPoint& point) { point.observations.clear(); });
    ClearUnlessAllHave(has_connections, lines.maps[m].keyframes, map.keyframes,
                       [](KeyFrame& keyframe) { keyframe.connections.clear(); });
  }
}

// Its notes; it also warns of keypoints that it frees, of which all get their points back that had any.
void Derive(Atlas& atlas, int threads, Notices& notices) {
  Notices all;
  CompleteAtlas(atlas, "the file", threads, all);
  for (const Notice& notice : all.items())
    if (notice.kind == Notice::Kind::kNote) notices.Note(notice.text);
}

// Those that are written only where they are recorded.
template <class Entity>
Given OptionalOf(const MemberTable<Entity>& table, std::initializer_list<std::string_view> names) {
  Given optional;
  for (const std::string_view name : names) optional.set(table.Find(name));
  return optional;
}

template <class Entity>
bool HaveAll(const MemberTable<Entity>& table, const std::vector<Given>& given,
             std::initializer_list<std::string_view> but = {"carried"}) {
  const Given optional = OptionalOf(table, but);
  return std::ranges::all_of(given, [&](const Given& each) { return table.HasAllFields(each, optional); });
}

bool HasAll(const ReadLines& lines) {
  return HaveAll(AtlasMembers(), {lines.given}, {"layout", "carried"}) && HaveAll(CameraMembers(), lines.cameras) &&
         std::ranges::all_of(lines.maps, [](const ReadLines::GivenOfMap& map) {
           return HaveAll(MapMembers(), {map.map}) && HaveAll(KeyFrameMembers(), map.keyframes) &&
                  HaveAll(PointMembers(), map.points, {"origin_map", "visible_count", "found_count", "carried"});
         });
}

template <class Entity, class List>
void RestoreEach(const MemberTable<Entity>& table, const std::vector<Given>& given, const List& original, List& list) {
  for (std::size_t row = 0; row < given.size(); ++row) table.Restore(given[row], original[row], list[row]);
}

// What the lines have stays as they have it.
void Restore(const ReadLines& lines, const Atlas& original, Atlas& atlas) {
  AtlasMembers().Restore(lines.given, original, atlas);
  RestoreEach(CameraMembers(), lines.cameras, original.cameras, atlas.cameras);
  for (std::size_t m = 0; m < lines.maps.size(); ++m) {
    MapMembers().Restore(lines.maps[m].map, original.maps[m], atlas.maps[m]);
    RestoreEach(KeyFrameMembers(), lines.maps[m].keyframes, original.maps[m].keyframes, atlas.maps[m].keyframes);
    RestoreEach(PointMembers(), lines.maps[m].points, original.maps[m].points, atlas.maps[m].points);
  }
}

}  // namespace

void CompleteLines(ReadLines& lines, int threads, Notices& notices) {
  if (HasAll(lines)) return;
  SetCameras(lines);
  SetKeyFrames(lines);
  SetPoints(lines);
  const Atlas original = lines.atlas;
  ClearWhatIsDerived(lines);
  Derive(lines.atlas, threads, notices);
  Restore(lines, original, lines.atlas);
}

}  // namespace slamdb::detail
