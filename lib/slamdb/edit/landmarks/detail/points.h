// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "slamdb/model/atlas.h"

// What a point has of a landmark, and the other way round.
namespace slamdb::detail {

// The opposite of the point's normal, of unit length; zero when it has none.
Eigen::Vector3d LandmarkNormalOf(const MapPoint& point);

// Gives a point the position and the normal of its landmark.
void MoveTo(const Landmark& landmark, MapPoint& point);

// A point without observations where the landmark is, with its ORB descriptor if it has one.
MapPoint PointOf(const Landmark& landmark, MapPointId id);

// The ORB descriptor of a feature; null: it has none.
// MRPT 2 makes BLD of ORB when it reads a file and writes it again; the type of the feature stays.
const FeatureDescriptor* OrbOf(const LandmarkFeature& feature);

// Which way landmarks face, by the points that they are of: earlier versions of slamdb gave them the normals of points.
class Facing {
 public:
  void Add(const Landmark& landmark, const MapPoint& point);
  bool as_points() const { return away_ > towards_; }

 private:
  std::uint64_t away_ = 0, towards_ = 0;  // from the cameras, and to them
};

// Turns the normals round; returns how many there are.
std::uint64_t TurnNormals(std::vector<Landmark>& landmarks);

}  // namespace slamdb::detail
