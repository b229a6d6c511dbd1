// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/landmarks/detail/points.h"

#include <algorithm>
#include <cmath>

namespace slamdb::detail {
namespace {

constexpr std::uint64_t kOverwhelming = 9;  // to one

template <class Vector>
Eigen::Vector3d UnitOrZero(const Vector& vector) {
  const Eigen::Vector3d wide = vector.template cast<double>();
  const double length = wide.norm();
  return length > 0 && std::isfinite(length) ? Eigen::Vector3d(wide / length) : Eigen::Vector3d::Zero();
}

// ORB-SLAM3's normals point from the cameras to the point. MRPT's makers of landmarks let them point to the sensor.
// This and LandmarkNormalOf are the only places where one becomes the other.
// A landmark without normal says nothing; otherwise the point's keeps its length, which tells how far its views spread.
void SetNormal(const Landmark& landmark, MapPoint& point) {
  const Eigen::Vector3d direction = UnitOrZero(landmark.normal);
  if (direction.isZero(0) || landmark.normal == LandmarkNormalOf(point)) return;
  const double length = static_cast<double>(point.normal.norm());
  const bool has_length = length > 0 && length <= 1;
  point.normal = (has_length ? -length * direction : Eigen::Vector3d(-direction)).cast<float>();
}

}  // namespace

Eigen::Vector3d LandmarkNormalOf(const MapPoint& point) {
  const Eigen::Vector3d direction = UnitOrZero(point.normal);
  return direction.isZero(0) ? direction : Eigen::Vector3d(-direction);
}

void MoveTo(const Landmark& landmark, MapPoint& point) {
  point.position = landmark.mean.cast<float>();
  SetNormal(landmark, point);
}

const FeatureDescriptor* OrbOf(const LandmarkFeature& feature) {
  const FeatureDescriptor* orb = feature.FindDescriptor(DescriptorKind::kOrb);
  return orb != nullptr || feature.type != FeatureType::kOrb ? orb : feature.FindDescriptor(DescriptorKind::kBld);
}

MapPoint PointOf(const Landmark& landmark, MapPointId id) {
  MapPoint point;
  point.id = id;
  point.first_keyframe = -1;
  MoveTo(landmark, point);
  point.descriptor_form = MatrixForm::kEmpty;
  for (const LandmarkFeature& feature : landmark.features) {
    const FeatureDescriptor* orb = OrbOf(feature);
    if (orb == nullptr || orb->bytes.size() != point.descriptor.size()) continue;
    std::copy(orb->bytes.begin(), orb->bytes.end(), point.descriptor.begin());
    point.descriptor_form = MatrixForm::kUsual;
    break;
  }
  return point;
}

Turning TurnNormals(std::vector<Landmark>& landmarks, const std::function<const MapPoint*(const Landmark&)>& point_of) {
  Turning turning;
  std::uint64_t right = 0;
  std::vector<Landmark*> untold;
  for (Landmark& landmark : landmarks) {
    const MapPoint* point = point_of(landmark);
    const double along = point == nullptr ? 0 : landmark.normal.dot(point->normal.cast<double>());
    if (along > 0) {
      landmark.normal = -landmark.normal;
      ++turning.turned;
    } else if (along < 0) {
      ++right;
    } else if (!landmark.normal.isZero(0)) {
      untold.push_back(&landmark);
    }
  }
  if (turning.turned == 0) return turning;
  if (turning.turned < kOverwhelming * right) {
    turning.unturned = untold.size();
    return turning;
  }
  for (Landmark* landmark : untold) landmark->normal = -landmark->normal;
  turning.turned += untold.size();
  return turning;
}

}  // namespace slamdb::detail
