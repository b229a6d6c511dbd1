// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/stella/detail/lens.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace slamdb::stella {
namespace {

using Eigen::Vector2d;

// What Brown's model does to a place at z = 1.
struct Brown {
  double radial;
  Vector2d tangential;

  Brown(const std::array<double, 5>& k, const Vector2d& place) {
    const double x = place.x(), y = place.y(), r2 = place.squaredNorm();
    radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
    tangential = {2 * k[2] * x * y + k[3] * (r2 + 2 * x * x), k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y};
  }
};

Vector2d UndistortBrown(const std::array<double, 5>& k, const Vector2d& distorted) {
  constexpr int kIterations = 5;
  Vector2d place = distorted;
  for (int i = 0; i < kIterations; ++i) {
    const Brown brown(k, place);
    place = (distorted - brown.tangential) / brown.radial;
  }
  return place;
}

// Kannala and Brandt: how far from the centre a ray at an angle to the axis appears.
double Radius(const std::array<double, 5>& k, double theta) {
  const double t = theta * theta;
  return theta * (1 + t * (k[0] + t * (k[1] + t * (k[2] + t * k[3]))));
}

Vector2d UndistortFisheye(const std::array<double, 5>& k, const Vector2d& distorted) {
  constexpr int kIterations = 12;
  constexpr double kWidest = 1.55;  // radians: a ray at a right angle has no place at z = 1
  const double radius = distorted.norm();
  if (radius < 1e-12) return distorted;
  double theta = std::min(radius, kWidest);
  for (int i = 0; i < kIterations; ++i) {
    const double t = theta * theta;
    const double slope = 1 + t * (3 * k[0] + t * (5 * k[1] + t * (7 * k[2] + t * 9 * k[3])));
    theta = std::clamp(theta - (Radius(k, theta) - radius) / slope, 0.0, kWidest);
  }
  return distorted * (std::tan(theta) / radius);
}

Vector2d DistortFisheye(const std::array<double, 5>& k, const Vector2d& place) {
  const double radius = place.norm();
  return radius < 1e-12 ? place : Vector2d(place * (Radius(k, std::atan(radius)) / radius));
}

// Division by 1 + l r^2 undistorts; what is divided follows from a quadratic equation.
Vector2d DistortDivision(double l, const Vector2d& place) {
  const double root = 1 - 4 * l * place.squaredNorm();
  return place * (2 / (1 + std::sqrt(std::max(root, 0.0))));
}

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

std::int32_t Whole(double pixels) {
  constexpr double kMost = 1e6;
  return static_cast<std::int32_t>(std::clamp(std::isfinite(pixels) ? pixels : 0, -kMost, kMost));
}

}  // namespace

Vector2d Distorted(const LensCamera& camera, const Vector2d& pixel) {
  return Changed(camera, pixel, [&](const Vector2d& place) -> Vector2d {
    if (camera.model == Model::kFisheye) return DistortFisheye(camera.distortion, place);
    if (camera.model == Model::kRadialDivision) return DistortDivision(camera.distortion[0], place);
    const Brown brown(camera.distortion, place);
    return place * brown.radial + brown.tangential;
  });
}

Vector2d Undistorted(const LensCamera& camera, const Vector2d& pixel) {
  return Changed(camera, pixel, [&](const Vector2d& place) -> Vector2d {
    if (camera.model == Model::kFisheye) return UndistortFisheye(camera.distortion, place);
    if (camera.model == Model::kRadialDivision) return place / (1 + camera.distortion[0] * place.squaredNorm());
    return UndistortBrown(camera.distortion, place);
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
  ImageBounds bounds{.grid_columns = 64, .grid_rows = 48};
  const double width = camera.columns, height = camera.rows;
  const bool straight = camera.model == Model::kFisheye || !camera.is_distorted();
  const auto corner = [&](double x, double y) { return straight ? Vector2d(x, y) : Undistorted(camera, {x, y}); };
  const Vector2d upper_left = corner(0, 0), upper_right = corner(width, 0), lower_left = corner(0, height),
                 lower_right = corner(width, height);
  bounds.min_x = Whole(std::min(upper_left.x(), lower_left.x()));
  bounds.max_x = Whole(std::max(upper_right.x(), lower_right.x()));
  bounds.min_y = Whole(std::min(upper_left.y(), upper_right.y()));
  bounds.max_y = Whole(std::max(lower_left.y(), lower_right.y()));
  if (bounds.max_x > bounds.min_x) bounds.inverse_cell_width = 64 / static_cast<float>(bounds.max_x - bounds.min_x);
  if (bounds.max_y > bounds.min_y) bounds.inverse_cell_height = 48 / static_cast<float>(bounds.max_y - bounds.min_y);
  return bounds;
}

bool SetSize(LensCamera& camera, const ImageBounds& bounds) {
  constexpr std::int32_t kReach = 8;  // pixels about the first guess
  const bool is_set = bounds.max_x > bounds.min_x && bounds.max_y > bounds.min_y;
  Vector2d corner = is_set ? Vector2d(bounds.max_x, bounds.max_y) : Vector2d(2 * camera.cx, 2 * camera.cy);
  if (is_set && camera.model != Model::kFisheye && camera.is_distorted()) corner = Distorted(camera, corner);
  const auto size = [](std::int32_t pixels) { return static_cast<std::uint32_t>(std::max(pixels, 0)); };
  const std::int32_t columns = Whole(std::round(corner.x())), rows = Whole(std::round(corner.y()));
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
