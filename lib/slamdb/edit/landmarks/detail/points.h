// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
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

struct Turning {
  std::uint64_t turned = 0;    // landmarks whose normals were those of points
  std::uint64_t unturned = 0;  // of which no point tells, left as they were though others were turned
};

// Turns normals that point away from the cameras: earlier versions of slamdb gave landmarks those of their points. Each
// is held against its point, which `point_of` finds or not; those without are turned when nine tenths or more of the
// others are.
Turning TurnNormals(std::vector<Landmark>& landmarks, const std::function<const MapPoint*(const Landmark&)>& point_of);

}  // namespace slamdb::detail
