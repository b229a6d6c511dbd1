// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/detail/local_origin.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/median.h"

namespace slamdb::detail {
namespace {

using Eigen::Vector3d;

// A float has 24 bits: at this many times the extent, rounding reaches a hundred-thousandth of the extent.
constexpr double kFar = 100;

double ExtentAbout(const Vector3d& middle, const std::vector<Vector3d>& places) {
  std::vector<double> distances(places.size());
  std::ranges::transform(places, distances.begin(), [&](const Vector3d& place) { return (place - middle).norm(); });
  const double extent = MedianOf(std::move(distances));
  return extent > 0 ? extent : 1;
}

std::string WholeText(double value) {
  constexpr double kMost = 0x1p62;
  return std::abs(value) < kMost ? Concat(static_cast<std::int64_t>(value)) : Concat(value);
}

}  // namespace

Vector3d WholeMiddleOf(const std::vector<Vector3d>& places) {
  Vector3d middle;
  std::vector<double> values(places.size());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::ranges::transform(places, values.begin(), [&](const Vector3d& place) { return place[axis]; });
    middle[axis] = std::round(MedianOf(values));
  }
  return middle;
}

Vector3d LocalOriginOf(std::vector<Vector3d> places) {
  std::erase_if(places, [](const Vector3d& place) { return !place.allFinite(); });
  const Vector3d origin = WholeMiddleOf(places);
  return origin.norm() > kFar * ExtentAbout(origin, places) ? origin : Vector3d::Zero();
}

std::string OriginText(const Vector3d& origin) {
  return Concat("(", WholeText(origin.x()), ", ", WholeText(origin.y()), ", ", WholeText(origin.z()), ")");
}

}  // namespace slamdb::detail
