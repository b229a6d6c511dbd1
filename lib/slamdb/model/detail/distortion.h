// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>

// What lenses do to a place at z = 1, in focal lengths, and back.
namespace slamdb::detail {

// Kannala and Brandt, PAMI 2006: how far from the centre a ray at an angle to the axis appears. k1 k2 k3 k4.
template <class Coefficient, class Number>
Number KannalaBrandtRadius(const Coefficient* k, Number theta) {
  const Number t2 = theta * theta;
  return theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
}
// Its derivative by the angle.
template <class Number>
Number KannalaBrandtSlope(const Number* k, Number theta) {
  const Number t2 = theta * theta;
  return 1 + t2 * (3 * k[0] + t2 * (5 * k[1] + t2 * (7 * k[2] + t2 * 9 * k[3])));
}

inline Eigen::Vector2d DistortKannalaBrandt(const double* k, const Eigen::Vector2d& place) {
  constexpr double kSmall = 1e-12;
  const double radius = place.norm();
  return radius < kSmall ? place : Eigen::Vector2d(place * (KannalaBrandtRadius(k, std::atan(radius)) / radius));
}

// Newton's method. A ray at a right angle to the axis has no place at z = 1; what lies beyond is put a little inside.
inline Eigen::Vector2d UndistortKannalaBrandt(const double* k, const Eigen::Vector2d& distorted) {
  constexpr int kSteps = 12;
  constexpr double kSmall = 1e-12, kWidest = 1.55;  // radians
  const double radius = distorted.norm();
  if (radius < kSmall) return distorted;
  double theta = std::min(radius, kWidest);
  for (int step = 0; step < kSteps; ++step)
    theta = std::clamp(theta - (KannalaBrandtRadius(k, theta) - radius) / KannalaBrandtSlope(k, theta), 0.0, kWidest);
  return distorted * (std::tan(theta) / radius);
}

// Brown's model at a place: k1 k2 p1 p2 k3.
struct Brown {
  double radial;
  Eigen::Vector2d tangential;

  Brown(const double* k, const Eigen::Vector2d& place) {
    const double x = place.x(), y = place.y(), r2 = place.squaredNorm();
    radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
    tangential = {2 * k[2] * x * y + k[3] * (r2 + 2 * x * x), k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y};
  }
};

inline Eigen::Vector2d DistortBrown(const double* k, const Eigen::Vector2d& place) {
  const Brown brown(k, place);
  return place * brown.radial + brown.tangential;
}

// By iterating as often as cv::undistortPoints does by default, and so as the keypoints that maps record. nullopt:
// beyond where the model means anything.
inline std::optional<Eigen::Vector2d> UndistortBrown(const double* k, const Eigen::Vector2d& distorted) {
  constexpr int kSteps = 5;
  Eigen::Vector2d place = distorted;
  for (int step = 0; step < kSteps; ++step) {
    const Brown brown(k, place);
    if (!(brown.radial > 0)) return std::nullopt;
    place = (distorted - brown.tangential) / brown.radial;
  }
  return place;
}

// The same of a pixel, by focal lengths and centre of the image.
inline std::optional<Eigen::Vector2d> UndistortBrownPixel(const double* k, const Eigen::Vector2d& focal,
                                                          const Eigen::Vector2d& center, const Eigen::Vector2d& pixel) {
  const std::optional<Eigen::Vector2d> place = UndistortBrown(k, (pixel - center).cwiseQuotient(focal));
  if (!place) return std::nullopt;
  return place->cwiseProduct(focal) + center;
}

// Fitzgibbon, 2001: division by 1 + k r^2 undistorts; what is divided follows from a quadratic equation.
inline Eigen::Vector2d UndistortDivision(double k, const Eigen::Vector2d& distorted) {
  return distorted / (1 + k * distorted.squaredNorm());
}
inline Eigen::Vector2d DistortDivision(double k, const Eigen::Vector2d& place) {
  return place * (2 / (1 + std::sqrt(std::max(1 - 4 * k * place.squaredNorm(), 0.0))));
}

}  // namespace slamdb::detail
