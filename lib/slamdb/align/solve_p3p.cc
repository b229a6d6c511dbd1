// SPDX-License-Identifier: BSD-3-Clause
// 1. The ratio v of the distances of the third and the first point is a root of a quartic, which the law of cosines
// gives
//    for the three pairs of rays.
// 2. With it follow the ratio u of the second and the first, and the distances.
// 3. The points at these distances along the rays are the points in the camera frame: the pose lays one triangle on the
//    other.
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "slamdb/align/detail/camera_pose.h"

namespace slamdb::detail {
namespace {

using Quartic = std::array<double, 5>;  // coefficients, of the constant first

constexpr double kImaginary = 1e-4;  // below which a root passes for real: a double root splits
constexpr int kPolishings = 2;

// The real roots above 0.
std::vector<double> RootsOf(const Quartic& quartic) {
  double largest = 0;
  for (const double coefficient : quartic) largest = std::max(largest, std::abs(coefficient));
  if (!(std::abs(quartic[4]) > 1e-12 * largest)) return {};
  Eigen::Matrix4d companion = Eigen::Matrix4d::Zero();
  for (int row = 0; row < 4; ++row) companion(row, 3) = -quartic[static_cast<std::size_t>(row)] / quartic[4];
  companion.bottomLeftCorner<3, 3>().setIdentity();
  if (!companion.allFinite()) return {};
  const Eigen::Vector4cd values = companion.eigenvalues();
  std::vector<double> roots;
  for (const std::complex<double>& value : values) {
    if (!(std::abs(value.imag()) < kImaginary * (1 + std::abs(value.real())))) continue;
    double root = value.real();
    for (int i = 0; i < kPolishings; ++i) {
      const double at =
          quartic[0] + root * (quartic[1] + root * (quartic[2] + root * (quartic[3] + root * quartic[4])));
      const double slope = quartic[1] + root * (2 * quartic[2] + root * (3 * quartic[3] + root * 4 * quartic[4]));
      if (slope != 0) root -= at / slope;
    }
    if (root > 0 && std::isfinite(root)) roots.push_back(root);
  }
  return roots;
}

// Axes of a triangle's own: along its first side, and across it in its plane.
Eigen::Matrix3d AxesOf(const std::array<Eigen::Vector3d, 3>& points) {
  Eigen::Matrix3d axes;
  axes.col(0) = (points[1] - points[0]).normalized();
  axes.col(2) = axes.col(0).cross(points[2] - points[0]).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

CameraPose LayOn(const std::array<Eigen::Vector3d, 3>& in_camera, const std::array<Eigen::Vector3d, 3>& points) {
  CameraPose pose;
  pose.rotation = AxesOf(in_camera) * AxesOf(points).transpose();
  pose.translation =
      (in_camera[0] + in_camera[1] + in_camera[2]) / 3 - pose.rotation * ((points[0] + points[1] + points[2]) / 3);
  return pose;
}

}  // namespace

std::vector<CameraPose> SolveP3p(const std::array<Eigen::Vector3d, 3>& rays,
                                 const std::array<Eigen::Vector3d, 3>& points) {
  const double a2 = (points[1] - points[2]).squaredNorm(), b2 = (points[0] - points[2]).squaredNorm(),
               c2 = (points[0] - points[1]).squaredNorm();
  const double area = (points[1] - points[0]).cross(points[2] - points[0]).squaredNorm();
  if (!(area > 1e-12 * b2 * c2)) return {};
  const double cos_a = rays[1].dot(rays[2]), cos_b = rays[0].dot(rays[2]), cos_c = rays[0].dot(rays[1]);
  const double p = (a2 - c2) / b2, q = (a2 + c2) / b2;
  const double a_share = a2 / b2, c_share = c2 / b2;
  const Quartic quartic = {(1 + p) * (1 + p) - 4 * a_share * cos_c * cos_c,
                           4 * (-p * (1 + p) * cos_b + 2 * a_share * cos_c * cos_c * cos_b - (1 - q) * cos_a * cos_c),
                           2 * (p * p - 1 + 2 * p * p * cos_b * cos_b + 2 * (1 - c_share) * cos_a * cos_a -
                                4 * q * cos_a * cos_b * cos_c + 2 * (1 - a_share) * cos_c * cos_c),
                           4 * (p * (1 - p) * cos_b - (1 - q) * cos_a * cos_c + 2 * c_share * cos_a * cos_a * cos_b),
                           (p - 1) * (p - 1) - 4 * c_share * cos_a * cos_a};
  std::vector<CameraPose> poses;
  for (const double v : RootsOf(quartic)) {
    const double below = 2 * (cos_c - v * cos_a);
    if (below == 0) continue;
    const double u = ((p - 1) * v * v - 2 * p * cos_b * v + 1 + p) / below;
    const double first = std::sqrt(b2 / (1 + v * v - 2 * v * cos_b));
    if (!(u > 0) || !std::isfinite(u * first)) continue;
    const CameraPose pose = LayOn({first * rays[0], first * u * rays[1], first * v * rays[2]}, points);
    if (pose.rotation.allFinite() && pose.translation.allFinite()) poses.push_back(pose);
  }
  return poses;
}

}  // namespace slamdb::detail
