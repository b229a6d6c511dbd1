// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/visibility.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "slamdb/model/derive.h"

namespace slamdb::detail {

bool IsOutOfSight(const View& view, const PointGroup& group, const Similarity3d& map_from_point) {
  const Eigen::Vector3d center = view.CameraFromWorld(map_from_point * group.center);
  const double distance = center.norm(), radius = map_from_point.scale * group.radius;
  if (!(distance > radius)) return false;
  return std::acos(std::clamp(center.z() / distance, -1.0, 1.0)) - std::asin(radius / distance) > view.half_angle;
}

std::optional<Expected> Expect(const View& view, const ViewedPoint& point, const Similarity3d& map_from_point,
                               double least_cosine) {
  const Eigen::Vector3d position = map_from_point * point.position;
  const Eigen::Vector3d in_camera = view.CameraFromWorld(position);
  Expected expected{.depth = in_camera.z()};
  if (!(in_camera.z() > 0) || !view.lens.Project(in_camera, expected.pixel) || !view.frame.contains(expected.pixel))
    return std::nullopt;
  const Eigen::Vector3d ray = position - view.center;
  const double distance = ray.norm(), unit = map_from_point.scale * view.lens.fx;
  const double far = point.far * unit;
  if (!(distance >= static_cast<double>(kNearMargin) * point.near * unit &&
        distance <= static_cast<double>(kFarMargin) * far))
    return std::nullopt;
  if (!point.normal.isZero() && (map_from_point.rotation * point.normal).dot(ray) < least_cosine * distance)
    return std::nullopt;
  const double octave = view.log_factor > 0 ? std::ceil(std::log(far / distance) / view.log_factor) : 0;
  expected.octave = static_cast<std::int32_t>(std::clamp(octave, 0.0, static_cast<double>(view.scales.size() - 1)));
  return expected;
}

std::optional<Found> FindNear(const View& view, const Expected& expected, const Descriptor& descriptor, double radius,
                              int most_bits) {
  std::optional<Found> best;
  view.cells.VisitNear(expected.pixel, radius * view.ScaleOf(expected.octave), [&](std::uint32_t row) {
    if (std::abs(view.keypoints[row].octave - expected.octave) > 1) return;
    const int bits = HammingDistance(view.descriptors[row], descriptor);
    if (bits <= most_bits && (!best || bits < best->bits || (bits == best->bits && row < best->keypoint)))
      best = Found{row, bits};
  });
  return best;
}

}  // namespace slamdb::detail
