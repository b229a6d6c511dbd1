// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <utility>

#include "slamdb/align/detail/map_views.h"
#include "slamdb/model/similarity.h"

namespace slamdb::detail {

// Where a point should be seen.
struct Expected {
  Eigen::Vector2d pixel;
  double depth = 0;         // along the optical axis, units of the view's map
  std::int32_t octave = 0;  // of the view's pyramid
};

// Whether no point of a group can be in the picture. True only where that is certain.
bool IsOutOfSight(const View& view, const PointGroup& group, const Similarity3d& map_from_point);

// Where a view should see a point of another map, or of its own.
// nullopt when it is out of the picture, behind the camera, farther away or nearer than what descriptors stand, or seen
// from a side from which it never was.
// `map_from_point`: from the point's map to the view's.
std::optional<Expected> Expect(const View& view, const ViewedPoint& point, const Similarity3d& map_from_point,
                               double least_cosine);

// The keypoint near where a point is expected, at about its octave, whose descriptor is most alike.
struct Found {
  std::uint32_t keypoint;
  int bits;  // in which the descriptors differ
};
std::optional<Found> FindNear(const View& view, const Expected& expected, const Descriptor& descriptor, double radius,
                              int most_bits);

}  // namespace slamdb::detail
