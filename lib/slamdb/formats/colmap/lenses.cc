// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/colmap/detail/lenses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "slamdb/formats/import/detail/possible.h"
#include "slamdb/model/detail/distortion.h"

namespace slamdb::colmap {
namespace {

struct Layout {
  bool one_focal_length;
  std::size_t rest;  // where what follows focal lengths and centre begins
};
Layout LayoutOf(const Camera& camera) {
  switch (camera.model) {
    case kSimplePinhole:
    case kSimpleRadial:
    case kRadial:
    case kSimpleRadialFisheye:
    case kRadialFisheye:
    case kSimpleDivision:
    case kSimpleFisheye:
      return {true, 3};
    default:
      return {false, 4};
  }
}

bool IsFisheye(std::int32_t model) {
  return model == kOpencvFisheye || model == kSimpleRadialFisheye || model == kRadialFisheye ||
         model == kSimpleFisheye || model == kFisheye;
}

// k4 to k6 of a rational model.
bool IsRational(const Camera& camera) {
  return camera.model == kFullOpencv &&
         std::any_of(camera.parameters.begin() + 9, camera.parameters.end(), [](double k) { return k != 0; });
}

// ---- where the point (u, v, 1) is seen, in focal lengths

Eigen::Vector2d DistortRational(const double* k, const Eigen::Vector2d& at) {
  const double r2 = at.squaredNorm();
  const detail::Brown brown(k, at);
  return at * (brown.radial / (1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])))) + brown.tangential;
}

// Devernay and Faugeras, 2001.
Eigen::Vector2d DistortFov(const double* omega, const Eigen::Vector2d& at) {
  constexpr double kSmall = 1e-6;
  const double r = at.norm(), tangent = 2 * std::tan(*omega / 2);
  if (std::abs(*omega) < kSmall) return at;
  return at * (r < kSmall ? tangent / *omega : std::atan(r * tangent) / (r * *omega));
}

Eigen::Vector2d DistortThinPrism(const double* k, const Eigen::Vector2d& at) {
  constexpr double kSmall = 1e-12;
  const double r = at.norm();
  const Eigen::Vector2d bent = r < kSmall ? at : Eigen::Vector2d(at * (std::atan(r) / r));
  const double u = bent.x(), v = bent.y(), r2 = bent.squaredNorm();
  const double radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * (k[4] + r2 * k[5])));
  return {u * radial + 2 * k[2] * u * v + k[3] * (r2 + 2 * u * u) + k[6] * r2,
          v * radial + 2 * k[3] * u * v + k[2] * (r2 + 2 * v * v) + k[7] * r2};
}

// Khomutenko et al., RA-L 2016: alpha, beta.
Eigen::Vector2d DistortEnhancedUnified(const double* k, const Eigen::Vector2d& at) {
  return at / (k[0] * std::sqrt(k[1] * at.squaredNorm() + 1) + 1 - k[0]);
}

Eigen::Vector2d Distort(const Camera& camera, const Eigen::Vector2d& at) {
  const double* rest = camera.parameters.data() + LayoutOf(camera).rest;
  switch (camera.model) {
    case kPinhole:
      return at;
    case kOpencv: {
      const std::array<double, 5> k = {rest[0], rest[1], rest[2], rest[3]};
      return detail::DistortBrown(k.data(), at);
    }
    case kFullOpencv:
      return DistortRational(rest, at);
    case kOpencvFisheye:
      return detail::DistortKannalaBrandt(rest, at);
    case kFov:
      return DistortFov(rest, at);
    case kThinPrismFisheye:
      return DistortThinPrism(rest, at);
    case kSimpleDivision:
    case kDivision:
      return detail::DistortDivision(*rest, at);
    default:
      return DistortEnhancedUnified(rest, at);
  }
}

// Newton's method, with differences for derivatives.
std::optional<Eigen::Vector2d> Undistort(const Camera& camera, const Eigen::Vector2d& seen) {
  constexpr int kSteps = 50;
  constexpr double kDifference = 1e-6, kEnough = 1e-12;
  Eigen::Vector2d at = seen;
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::Vector2d off = Distort(camera, at) - seen;
    Eigen::Matrix2d slope;
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d aside = Eigen::Vector2d::Unit(axis) * kDifference;
      slope.col(axis) = (Distort(camera, at + aside) - Distort(camera, at - aside)) / (2 * kDifference);
    }
    const double determinant = slope.determinant();
    if (!off.allFinite() || !(std::abs(determinant) > kEnough)) return std::nullopt;
    Eigen::Matrix2d inverse;
    inverse << slope(1, 1), -slope(0, 1), -slope(1, 0), slope(0, 0);
    const Eigen::Vector2d change = inverse * off / determinant;
    at -= change;
    if (change.squaredNorm() < kEnough * kEnough) return at;
  }
  return std::nullopt;
}

std::vector<double> DistortionOf(const Camera& camera) {
  const std::vector<double>& p = camera.parameters;
  switch (camera.model) {
    case kSimpleRadial:
      return {p[3], 0, 0, 0};
    case kRadial:
      return {p[3], p[4], 0, 0};
    case kOpencv:
      return {p[4], p[5], p[6], p[7]};
    case kFullOpencv:
      return {p[4], p[5], p[6], p[7], p[8]};
    default:
      return {};
  }
}

std::vector<double> FisheyeOf(const Camera& camera) {
  std::vector<double> k(camera.parameters.begin() + static_cast<std::ptrdiff_t>(LayoutOf(camera).rest),
                        camera.parameters.end());
  k.resize(4, 0);
  return k;
}

}  // namespace

Camera CameraOf(const CameraSettings& settings, std::uint32_t id) {
  Camera camera{.id = id,
                .model = kPinhole,
                .width = static_cast<std::uint64_t>(settings.width),
                .height = static_cast<std::uint64_t>(settings.height),
                .parameters = {}};
  for (const float parameter : settings.camera.parameters) camera.parameters.push_back(static_cast<double>(parameter));
  camera.parameters[2] += kHalfPixel;
  camera.parameters[3] += kHalfPixel;
  std::vector<double> distortion = settings.distortion;
  if (settings.camera.model == CameraModel::kKannalaBrandt8) {
    camera.model = kOpencvFisheye;
    return camera;
  }
  if (distortion.empty()) return camera;
  camera.model = distortion.size() > 4 ? kFullOpencv : kOpencv;
  distortion.resize(camera.model == kOpencv ? 4 : 8, 0);
  camera.parameters.insert(camera.parameters.end(), distortion.begin(), distortion.end());
  return camera;
}

std::optional<Eigen::Vector2d> SeenBy(const Camera& camera, const Eigen::Vector3d& x_in_camera) {
  if (!(x_in_camera.z() > 0)) return std::nullopt;
  const std::vector<double>& p = camera.parameters;
  const Eigen::Vector2d at = Distort(camera, x_in_camera.head<2>() / x_in_camera.z());
  return Eigen::Vector2d(p[0] * at.x() + p[2], p[1] * at.y() + p[3]);
}

std::string WhyNoCamera(const Camera& camera) {
  std::string why = detail::WhyNoImageSize(static_cast<double>(camera.width), static_cast<double>(camera.height));
  if (!why.empty() || camera.model == kEquirectangular) return why;
  const std::span<const double> numbers = camera.parameters;
  const std::size_t focal_lengths = LayoutOf(camera).one_focal_length ? 1 : 2;
  return detail::WhyNoCamera(numbers[0], numbers[focal_lengths - 1], numbers.subspan(focal_lengths));
}

const char* WhyNotRead(const Camera& camera) {
  if (camera.model == kEquirectangular) return "panoramas have no pinhole, and slamdb no camera for them";
  if (camera.model == kRadTanThinPrismFisheye) return "slamdb knows no such lens";
  return nullptr;
}

bool NeedsUndistorting(const Camera& camera) {
  return IsRational(camera) || camera.model == kFov || camera.model == kThinPrismFisheye ||
         camera.model == kSimpleDivision || camera.model == kDivision || camera.model == kEucm;
}

CameraSettings SettingsOf(const Camera& camera, CameraId id) {
  const Layout layout = LayoutOf(camera);
  const std::vector<double>& p = camera.parameters;
  CameraSettings settings;
  settings.camera.id = id;
  settings.width = static_cast<std::int32_t>(camera.width);
  settings.height = static_cast<std::int32_t>(camera.height);
  std::vector<double> parameters = {p[0], layout.one_focal_length ? p[0] : p[1], p[layout.rest - 2] - kHalfPixel,
                                    p[layout.rest - 1] - kHalfPixel};
  if (IsFisheye(camera.model)) {
    settings.camera.model = CameraModel::kKannalaBrandt8;
    settings.camera.recorded_type = 1;
    const std::vector<double> k = FisheyeOf(camera);
    parameters.insert(parameters.end(), k.begin(), k.end());
  } else if (!NeedsUndistorting(camera)) {
    settings.distortion = DistortionOf(camera);
  }
  for (const double parameter : parameters) settings.camera.parameters.push_back(static_cast<float>(parameter));
  return settings;
}

Eigen::Vector2d UndistortedBy(const Camera& camera, const Eigen::Vector2d& pixel) {
  const Layout layout = LayoutOf(camera);
  const std::vector<double>& p = camera.parameters;
  const Eigen::Array2d focal(p[0], layout.one_focal_length ? p[0] : p[1]);
  const Eigen::Array2d center(p[layout.rest - 2] - kHalfPixel, p[layout.rest - 1] - kHalfPixel);
  const auto at = Undistort(camera, ((pixel.array() - center) / focal).matrix());
  return at ? Eigen::Vector2d((at->array() * focal + center).matrix()) : pixel;
}

void EstimateSize(const ImageBounds& bounds, CameraSettings& settings) {
  constexpr int kSteps = 20;
  constexpr std::int32_t kUsual = 8, kOff = 2, kLargest = 100'000;  // sides are mostly multiples of that
  const auto usual = [&](std::int32_t side) {
    const std::int32_t near = (side + kUsual / 2) / kUsual * kUsual;
    return settings.distortion.empty() || std::abs(near - side) > kOff ? side : near;
  };
  std::int32_t width = std::clamp(bounds.max_x, 1, kLargest), height = std::clamp(bounds.max_y, 1, kLargest);
  if (!settings.distortion.empty())
    for (int step = 0; step < kSteps; ++step) {
      const ImageBounds found = UndistortedBounds(settings, width, height);
      width = std::clamp(width + (bounds.max_x - found.max_x), 1, kLargest);
      height = std::clamp(height + (bounds.max_y - found.max_y), 1, kLargest);
    }
  settings.width = usual(width);
  settings.height = usual(height);
}

}  // namespace slamdb::colmap
