// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/colmap/detail/local_origin.h"

#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/colmap/detail/poses.h"
#include "slamdb/model/detail/local_origin.h"

namespace slamdb::colmap {
namespace {

using Eigen::Vector3d;

// Where cameras and points are.
std::vector<Vector3d> PlacesIn(std::span<const NamedModel> models) {
  std::vector<Vector3d> places;
  for (const NamedModel& named : models) {
    for (const Image& image : named.model.images) places.push_back(TranslationOf(Inverse(image.camera_from_world)));
    for (const Point& point : named.model.points)
      places.emplace_back(point.position[0], point.position[1], point.position[2]);
  }
  return places;
}

void Move(const Vector3d& origin, Pose& target_from_world) {
  const Vector3d moved = TranslationOf(target_from_world) + RotationOf(target_from_world).normalized() * origin;
  Vector3d::Map(target_from_world.translation.data()) = moved;
}

void Move(const Vector3d& origin, Model& model) {
  for (Image& image : model.images) Move(origin, image.camera_from_world);
  for (Frame& frame : model.frames) Move(origin, frame.rig_from_world);
  for (Point& point : model.points) Vector3d::Map(point.position.data()) -= origin;
}

}  // namespace

Vector3d MoveToLocalOrigin(std::span<NamedModel> models) {
  const Vector3d origin = detail::LocalOriginOf(PlacesIn(models));
  if (origin.isZero(0)) return origin;
  for (NamedModel& named : models) Move(origin, named.model);
  return origin;
}

void WarnOfLocalOrigin(const Vector3d& origin, Notices& notices) {
  if (origin.isZero(0)) return;
  notices.Warn(detail::Concat("coordinates are far from their origin for the 32-bit floats of an atlas: ",
                              detail::OriginText(origin), " was taken off all positions"));
}

}  // namespace slamdb::colmap
