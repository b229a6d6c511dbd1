// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/export/detail/frusta.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "slamdb/base/detail/median.h"

namespace slamdb::detail {
namespace {

// At depth 1: left, upper, right, lower.
std::array<float, 4> SidesOf(const KeyFrame& keyframe) {
  constexpr float kMost = 10;  // an angle of view of 169 degrees
  const Intrinsics& camera = keyframe.intrinsics;
  const ImageBounds& image = keyframe.bounds;
  const std::array<float, 4> sides = {(static_cast<float>(image.min_x) - camera.cx) / camera.fx,
                                      (static_cast<float>(image.min_y) - camera.cy) / camera.fy,
                                      (static_cast<float>(image.max_x) - camera.cx) / camera.fx,
                                      (static_cast<float>(image.max_y) - camera.cy) / camera.fy};
  const bool sound = std::ranges::all_of(sides, [](float side) { return std::abs(side) <= kMost; }) &&
                     sides[0] < sides[2] && sides[1] < sides[3];
  return sound ? sides : std::array<float, 4>{-2.F / 3, -0.5F, 2.F / 3, 0.5F};
}

}  // namespace

bool operator<(const Frustum& a, const Frustum& b) {
  const auto less = [](const Eigen::Vector3f& u, const Eigen::Vector3f& v) {
    return std::lexicographical_compare(u.begin(), u.end(), v.begin(), v.end());
  };
  return std::lexicographical_compare(a.vertices.begin(), a.vertices.end(), b.vertices.begin(), b.vertices.end(), less);
}

Frustum FrustumOf(const KeyFrame& keyframe, float depth) {
  const auto [left, upper, right, lower] = SidesOf(keyframe);
  Frustum frustum;
  frustum.vertices = {Eigen::Vector3f::Zero(), Eigen::Vector3f(left, upper, 1), Eigen::Vector3f(right, upper, 1),
                      Eigen::Vector3f(right, lower, 1), Eigen::Vector3f(left, lower, 1)};
  for (Eigen::Vector3f& vertex : frustum.vertices) vertex *= depth;
  return frustum;
}

float FrustumDepth(std::span<const Eigen::Vector3f> centers) {
  std::vector<float> ways;
  for (std::size_t i = 1; i < centers.size(); ++i) {
    const float way = (centers[i] - centers[i - 1]).norm();
    if (way > 0 && std::isfinite(way)) ways.push_back(way);
  }
  if (ways.empty()) return 0.1F;
  constexpr float kDeepest = 1e30F;  // beyond, corners would not be finite
  return std::min(MedianOf(std::move(ways)) / 2, kDeepest);
}

}  // namespace slamdb::detail
