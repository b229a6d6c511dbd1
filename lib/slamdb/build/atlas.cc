// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "slamdb/build/build.h"
#include "slamdb/build/detail/columns.h"
#include "slamdb/model/counters.h"
#include "slamdb/model/detail/camera_in_world.h"
#include "slamdb/model/detail/irregular_entries.h"
#include "slamdb/model/detail/is_pose.h"

namespace slamdb {
namespace {

using detail::Refuse;

constexpr double kFarthest = 1e18;  // whose square a 32-bit float still holds

std::size_t ParameterCount(CameraModel model) {
  switch (model) {
    case CameraModel::kPinhole:
      return 4;
    case CameraModel::kKannalaBrandt8:
      return 8;
    case CameraModel::kEquirectangular:
      break;
  }
  Refuse("model: nothing is projected with equirectangular cameras; take pinhole or kannala-brandt-8");
}

template <class List>
bool HasId(const List& list, auto id) {
  return std::ranges::find(list, id, [](const auto& entity) { return entity.id; }) != list.end();
}

// The next id, or the given one.
template <class List, class Entity>
Id<Entity> FreeId(const List& list, Id<Entity> id, std::uint64_t next, std::uint64_t end) {
  if (!id && next >= end) Refuse("id: the next ones are used up; `Renumber` frees some");
  if (!id) return Id<Entity>(next);
  if (id.value() >= end) Refuse("id: ", id.value(), " is too large; ids are below ", end);
  if (HasId(list, id)) Refuse("id: the atlas has a ", id, " already; leave it out to get a free one");
  return id;
}

void RequireCenter(const Eigen::Vector3d& center, const std::string& argument) {
  if (!(center.norm() <= kFarthest))
    Refuse(argument, " has a position that is not finite, or too far away for 32-bit floats");
}

}  // namespace

Map& detail::MapOf(Atlas& atlas, MapId id) {
  const auto map = std::ranges::find(atlas.maps, id, &Map::id);
  if (map == atlas.maps.end()) throw Error(ErrorKind::kNotFound, Concat("the atlas has no ", id));
  return *map;
}

CameraId AddCamera(Atlas& atlas, CameraModel model, std::vector<float> parameters, CameraId id) {
  const std::size_t count = ParameterCount(model);
  if (parameters.size() != count)
    Refuse("parameters: there are ", parameters.size(), "; the model has ", count,
           count == 4 ? ": fx, fy, cx, cy" : ": fx, fy, cx, cy, k0, k1, k2, k3");
  for (std::size_t row = 0; row < count; ++row)
    if (!std::isfinite(parameters[row]) || (row < 2 && !(parameters[row] > 0)))
      detail::RefuseRow("parameters", row, "is ", static_cast<double>(parameters[row]),
                        row < 2 ? "; a focal length is above 0" : "; parameters are finite");
  const std::uint64_t next = std::max(LeastCounters(atlas).camera, atlas.next_ids.camera);
  Camera camera{.id = FreeId(atlas.cameras, id, next, 0xffffffff), .model = model};
  camera.recorded_type = static_cast<std::uint32_t>(model);
  camera.parameters = std::move(parameters);
  atlas.cameras.push_back(std::move(camera));
  RaiseCounters(atlas);
  return atlas.cameras.back().id;
}

MapId AddMap(Atlas& atlas, MapId id) {
  Map map;
  map.id = FreeId(atlas.maps, id, std::max(LeastCounters(atlas).map, atlas.next_ids.map), 0xffffffff);
  const auto after = std::ranges::upper_bound(atlas.maps, map.id, {}, &Map::id);
  id = map.id;
  if (after != atlas.maps.end()) detail::DropIrregularEntries(atlas);  // which mean maps by their rows
  atlas.maps.insert(after, std::move(map));
  RaiseCounters(atlas);
  return id;
}

Rigid3f CameraFromWorldOf(const Eigen::Quaterniond& world_from_camera, const Eigen::Vector3d& center,
                          const std::string& argument) {
  if (!detail::IsNearUnit(world_from_camera))
    Refuse(argument, " has a quaternion of length ", world_from_camera.norm(), "; rotations have 1");
  RequireCenter(center, argument);
  return detail::CameraFromWorld(world_from_camera.normalized(), center);
}

Rigid3f CameraFromWorldOf(const Eigen::Matrix4d& world_from_camera, const std::string& argument) {
  constexpr double kTolerance = 1e-3;
  const Eigen::Matrix3d rotation = world_from_camera.topLeftCorner<3, 3>();
  if (!rotation.isUnitary(kTolerance) || !(rotation.determinant() > 0))
    Refuse(argument, " has no rotation in its upper left 3 x 3; scales and reflections are not poses");
  if (!world_from_camera.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), kTolerance))
    Refuse(argument, " does not end with the row 0 0 0 1");
  const Eigen::Vector3d center = world_from_camera.topRightCorner<3, 1>();
  RequireCenter(center, argument);
  return detail::CameraFromWorld(Eigen::Quaterniond(rotation).normalized(), center);
}

}  // namespace slamdb
