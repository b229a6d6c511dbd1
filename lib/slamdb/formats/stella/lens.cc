// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/stella/detail/lens.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "slamdb/model/detail/distortion.h"
#include "slamdb/model/detail/image_bounds.h"

namespace slamdb::stella {
namespace {

using Eigen::Vector2d;

template <class Change>
Vector2d Changed(const LensCamera& camera, const Vector2d& pixel, const Change& change) {
  const Eigen::Array2d focal(camera.fx, camera.fy), center(camera.cx, camera.cy);
  const Vector2d place = (pixel.array() - center) / focal;
  return (change(place).array() * focal + center).matrix();
}

template <class Change>
Column<Keypoint> ChangedAll(const LensCamera& camera, const Column<Keypoint>& keypoints, const Change& change) {
  Column<Keypoint> changed = keypoints;
  if (camera.model != Model::kFisheye && !camera.is_distorted()) return changed;
  for (Keypoint& keypoint : changed) {
    const Vector2d pixel = change(camera, {static_cast<double>(keypoint.x), static_cast<double>(keypoint.y)});
    keypoint.x = static_cast<float>(pixel.x());
    keypoint.y = static_cast<float>(pixel.y());
  }
  return changed;
}

using Corners = std::tuple<std::int32_t, std::int32_t, std::int32_t, std::int32_t>;
Corners CornersOf(const ImageBounds& bounds) { return {bounds.min_x, bounds.min_y, bounds.max_x, bounds.max_y}; }

}  // namespace

Vector2d Distorted(const LensCamera& camera, const Vector2d& pixel) {
  const double* k = camera.distortion.data();
  return Changed(camera, pixel, [&](const Vector2d& place) {
    if (camera.model == Model::kFisheye) return detail::DistortKannalaBrandt(k, place);
    if (camera.model == Model::kRadialDivision) return detail::DistortDivision(*k, place);
    return detail::DistortBrown(k, place);
  });
}

Vector2d Undistorted(const LensCamera& camera, const Vector2d& pixel) {
  const double* k = camera.distortion.data();
  return Changed(camera, pixel, [&](const Vector2d& place) {
    if (camera.model == Model::kFisheye) return detail::UndistortKannalaBrandt(k, place);
    if (camera.model == Model::kRadialDivision) return detail::UndistortDivision(*k, place);
    return detail::UndistortBrown(k, place).value_or(place);
  });
}

Column<Keypoint> Distorted(const LensCamera& camera, const Column<Keypoint>& keypoints) {
  return ChangedAll(camera, keypoints,
                    [](const LensCamera& lens, const Vector2d& pixel) { return Distorted(lens, pixel); });
}

Column<Keypoint> Undistorted(const LensCamera& camera, const Column<Keypoint>& keypoints) {
  return ChangedAll(camera, keypoints,
                    [](const LensCamera& lens, const Vector2d& pixel) { return Undistorted(lens, pixel); });
}

ImageBounds BoundsOf(const LensCamera& camera) {
  const bool straight = camera.model == Model::kFisheye || !camera.is_distorted();
  ImageBounds bounds = detail::BoundsOfCorners(camera.columns, camera.rows, [&](const Vector2d& corner) {
    return straight ? corner : Undistorted(camera, corner);
  });
  detail::SetGrid(bounds);
  return bounds;
}

bool SetSize(LensCamera& camera, const ImageBounds& bounds) {
  constexpr std::int32_t kReach = 8;  // pixels about the first guess
  const bool is_set = bounds.max_x > bounds.min_x && bounds.max_y > bounds.min_y;
  Vector2d corner = is_set ? Vector2d(bounds.max_x, bounds.max_y) : Vector2d(2 * camera.cx, 2 * camera.cy);
  if (is_set && camera.model != Model::kFisheye && camera.is_distorted()) corner = Distorted(camera, corner);
  const auto size = [](std::int32_t pixels) { return static_cast<std::uint32_t>(std::max(pixels, 0)); };
  const std::int32_t columns = detail::WholePixels(std::round(corner.x())),
                     rows = detail::WholePixels(std::round(corner.y()));
  LensCamera tried = camera;
  for (std::int32_t reach = 0; is_set && reach <= kReach; ++reach)
    for (std::int32_t x = -reach; x <= reach; ++x)
      for (std::int32_t y = -reach; y <= reach; ++y) {
        if (std::max(std::abs(x), std::abs(y)) != reach) continue;
        tried.columns = size(columns + x);
        tried.rows = size(rows + y);
        if (CornersOf(BoundsOf(tried)) != CornersOf(bounds)) continue;
        camera.columns = tried.columns;
        camera.rows = tried.rows;
        return true;
      }
  camera.columns = size(columns);
  camera.rows = size(rows);
  return false;
}

}  // namespace slamdb::stella
