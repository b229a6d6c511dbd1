// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/import/detail/possible.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "slamdb/base/detail/concat.h"
#include "slamdb/model/detail/is_pose.h"

namespace slamdb::detail {
namespace {

constexpr double kMost = 1e18;           // whose square a 32-bit float still holds
constexpr double kMostPixels = 1 << 20;  // of a side of an image
constexpr std::string_view kCause = "; the file is damaged, or was saved after an optimisation that failed";

bool IsCountable(double number) { return std::abs(number) <= kMost; }

std::string Listed(const auto& numbers) {
  std::string list;
  for (const double number : numbers) list += Concat(list.empty() ? "" : " ", number);
  return list;
}

}  // namespace

std::string WhyNoPosition(const Eigen::Vector3d& position) {
  // By its length, which no rotation changes: in the camera's frame it is finite as well.
  if (IsCountable(position.norm())) return {};
  return Concat("the position ", Listed(position), " is not finite, or too far away for 32-bit floats", kCause);
}

std::string WhyNoPose(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& position) {
  constexpr double kLeast = 1e-6;
  const double length = rotation.norm();
  if (length >= kLeast && IsCountable(length)) return WhyNoPosition(position);
  return Concat("the quaternion ", Listed(rotation.coeffs()), " (x y z w) is no rotation", kCause);
}

std::string WhyNoPose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& position) {
  constexpr double kTolerance = 0.01;
  if (rotation.isUnitary(kTolerance) && rotation.determinant() > 0) return WhyNoPosition(position);
  return Concat("the matrix ", Listed(rotation.transpose().reshaped()), " (row by row) is no rotation", kCause);
}

std::string WhyNoScale(double scale) {
  if (scale >= 1 / kMost && scale <= kMost) return {};
  return Concat("the scale ", scale, " is not above 0, or not finite", kCause);
}

std::string WhyNoCamera(double fx, double fy, std::span<const double> others) {
  const auto is_focal_length = [](double number) { return number >= 1 / kMost && number <= kMost; };
  if (!is_focal_length(fx) || !is_focal_length(fy))
    return Concat("the focal lengths ", fx, ' ', fy, " are not above 0, or not finite", kCause);
  if (std::ranges::all_of(others, IsCountable)) return {};
  return Concat("the camera's numbers ", Listed(others), " are not all finite", kCause);
}

std::string WhyNoCameraOrNone(double fx, double fy, std::span<const double> others) {
  const auto is_zero = [](double number) { return number == 0; };
  const bool is_none = is_zero(fx) && is_zero(fy) && std::ranges::all_of(others, is_zero);
  return is_none ? std::string() : WhyNoCamera(fx, fy, others);
}

std::string WhyNoImageSize(double width, double height) {
  const auto is_side = [](double pixels) { return pixels >= 1 && pixels <= kMostPixels; };
  if (is_side(width) && is_side(height)) return {};
  return Concat("images of ", Digits(width, 20), " x ", Digits(height, 20),
                " pixels are impossible; the file is damaged");
}

Rigid3f PoseOf(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation) {
  return {Quaternionf((IsUnit(rotation) ? rotation : rotation.normalized()).cast<float>()), translation.cast<float>()};
}

Rigid3f PoseOf(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) {
  return {Quaternionf(Eigen::Quaterniond(rotation).normalized().cast<float>()), translation.cast<float>()};
}

}  // namespace slamdb::detail
