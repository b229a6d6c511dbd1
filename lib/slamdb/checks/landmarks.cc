// SPDX-License-Identifier: BSD-3-Clause
// Landmarks: ids, numbers and descriptors as MRPT has them.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <unordered_map>

#include "slamdb/checks/detail/catalogue.h"
#include "slamdb/checks/detail/visit.h"

namespace slamdb::detail {
namespace {

// A covariance that files hold in floats may miss zero by their rounding.
constexpr double kRoundingTolerance = 1e-6;

Place PlaceOf(const Map& map, const Landmark& landmark) { return {.map = map.id, .landmark = landmark.id}; }

template <class Visit>
void ForEachLandmark(const Atlas& atlas, const Visit& visit) {
  for (const Map& map : atlas.maps)
    for (const Landmark& landmark : map.landmarks) visit(map, landmark);
}

bool HasNegativeVariance(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  const Eigen::Vector3d& values = solver.eigenvalues();  // ascending
  return !(values[0] >= -kRoundingTolerance * values[2]);
}

// Known kinds, each once, in the order of MRPT.
bool AreInOrder(const std::vector<FeatureDescriptor>& descriptors) {
  return std::ranges::adjacent_find(descriptors, std::ranges::greater_equal(), &FeatureDescriptor::kind) ==
             descriptors.end() &&
         (descriptors.empty() || descriptors.back().kind <= DescriptorKind::kLatch);
}

// MRPT's normals point to the sensors, those of points away from the cameras.
bool FacesAsItsPoint(const Landmark& landmark, const IdTable& points, const Map& map) {
  const std::uint32_t row = landmark.is_numbered() ? points.Find(landmark.id.value()) : kNoRow;
  return row != kNoRow && landmark.normal.dot(map.points[row].normal.cast<double>()) > 0;
}

}  // namespace

void CheckLandmarkIdUnique(const Subject& subject, Findings& findings) {
  for (const Map& map : subject.atlas.maps) {
    std::unordered_map<LandmarkId, std::size_t> first;
    for (std::size_t row = 0; row < map.landmarks.size(); ++row) {
      const LandmarkId id = map.landmarks[row].id;
      if (!id) continue;
      if (const auto [found, is_new] = first.emplace(id, row); !is_new)
        findings.Add(PlaceOf(map, map.landmarks[row]), "entries ", found->second, " and ", row,
                     " of the map's list have this id");
    }
  }
}

void CheckLandmarkFinite(const Subject& subject, Findings& findings) {
  ForEachLandmark(subject.atlas, [&](const Map& map, const Landmark& landmark) {
    if (!landmark.mean.allFinite()) findings.Add(PlaceOf(map, landmark), "its mean holds NaN or infinity");
    if (!landmark.normal.allFinite()) findings.Add(PlaceOf(map, landmark), "its normal holds NaN or infinity");
  });
}

void CheckLandmarkNormal(const Subject& subject, Findings& findings) {
  for (const Map& map : subject.atlas.maps) {
    if (map.landmarks.empty()) continue;
    const IdTable points = PointTable(map);
    for (const Landmark& landmark : map.landmarks)
      if (FacesAsItsPoint(landmark, points, map))
        findings.Add(PlaceOf(map, landmark), "its normal points away from the cameras, as that of its point");
  }
}

std::size_t TurnLandmarkNormals(Atlas& atlas) {
  std::size_t turned = 0;
  for (Map& map : atlas.maps) {
    if (map.landmarks.empty()) continue;
    const IdTable points = PointTable(map);
    for (Landmark& landmark : map.landmarks)
      if (FacesAsItsPoint(landmark, points, map)) {
        landmark.normal = -landmark.normal;
        ++turned;
      }
  }
  return turned;
}

void CheckLandmarkCovariance(const Subject& subject, Findings& findings) {
  ForEachLandmark(subject.atlas, [&](const Map& map, const Landmark& landmark) {
    const Eigen::Matrix3d covariance = landmark.pose().covariance;
    if (!covariance.allFinite())
      findings.Add(PlaceOf(map, landmark), "its covariance holds NaN or infinity");
    else if (HasNegativeVariance(covariance))
      findings.Add(PlaceOf(map, landmark), "its covariance has a negative variance in some direction");
  });
}

void CheckLandmarkDescriptors(const Subject& subject, Findings& findings) {
  ForEachLandmark(subject.atlas, [&](const Map& map, const Landmark& landmark) {
    for (std::size_t row = 0; row < landmark.features.size(); ++row)
      if (!AreInOrder(landmark.features[row].descriptors))
        findings.Add(PlaceOf(map, landmark), "the kinds of the descriptors of feature ", row,
                     " are unknown, repeated or out of order");
  });
}

}  // namespace slamdb::detail
