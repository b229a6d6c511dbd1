// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/colmap/detail/local_origin.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/colmap/detail/poses.h"

namespace slamdb::colmap {
namespace {

using Eigen::Vector3d;

// A float has 24 bits: at this many times the extent, rounding reaches a hundred-thousandth of the extent.
constexpr double kFar = 100;

double MedianOf(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Where cameras and points are, as far as they are somewhere.
std::vector<Vector3d> PlacesIn(std::span<const NamedModel> models) {
  std::vector<Vector3d> places;
  const auto add = [&](const Vector3d& place) {
    if (place.allFinite()) places.push_back(place);
  };
  for (const NamedModel& named : models) {
    for (const Image& image : named.model.images) add(TranslationOf(Inverse(image.camera_from_world)));
    for (const Point& point : named.model.points)
      add(Vector3d(point.position[0], point.position[1], point.position[2]));
  }
  return places;
}

// All digits of a whole number.
std::string WholeText(double value) {
  constexpr double kMost = 0x1p62;
  return std::abs(value) < kMost ? detail::Concat(static_cast<std::int64_t>(value)) : detail::Concat(value);
}

// Medians, which points far off do not move.
Vector3d MiddleOf(const std::vector<Vector3d>& places) {
  Vector3d middle;
  std::vector<double> values(places.size());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::ranges::transform(places, values.begin(), [&](const Vector3d& place) { return place[axis]; });
    middle[axis] = std::round(MedianOf(values));  // whole, so that it is easily added again
  }
  return middle;
}

double ExtentAbout(const Vector3d& middle, const std::vector<Vector3d>& places) {
  std::vector<double> distances(places.size());
  std::ranges::transform(places, distances.begin(), [&](const Vector3d& place) { return (place - middle).norm(); });
  const double extent = MedianOf(distances);
  return extent > 0 ? extent : 1;
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
  const std::vector<Vector3d> places = PlacesIn(models);
  if (places.empty()) return Vector3d::Zero();
  const Vector3d origin = MiddleOf(places);
  if (!(origin.norm() > kFar * ExtentAbout(origin, places))) return Vector3d::Zero();
  for (NamedModel& named : models) Move(origin, named.model);
  return origin;
}

void WarnOfLocalOrigin(const Vector3d& origin, Notices& notices) {
  if (origin.isZero(0)) return;
  notices.Warn(detail::Concat("coordinates are far from their origin for the 32-bit floats of an atlas: (",
                              WholeText(origin.x()), ", ", WholeText(origin.y()), ", ", WholeText(origin.z()),
                              ") was taken off all positions"));
}

}  // namespace slamdb::colmap
