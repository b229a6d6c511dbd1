// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/detail/lens.h"

#include <algorithm>
#include <cmath>

#include "slamdb/model/detail/distortion.h"

namespace slamdb::detail {
namespace {

// In front of the camera, in units of the map: nearer ones would divide by nothing.
constexpr double kNearest = 1e-9;

bool ProjectPinhole(const Lens& lens, const Eigen::Vector3d& point, Eigen::Vector2d& pixel,
                    Eigen::Matrix<double, 2, 3>* by_point) {
  if (!(point.z() > kNearest)) return false;
  const double inverse = 1 / point.z(), x = point.x() * inverse, y = point.y() * inverse;
  pixel = {lens.fx * x + lens.cx, lens.fy * y + lens.cy};
  if (by_point != nullptr)
    *by_point << lens.fx * inverse, 0, -lens.fx * x * inverse, 0, lens.fy * inverse, -lens.fy * y * inverse;
  return true;
}

// Kannala and Brandt, PAMI 2006: the distance from the centre is a polynomial of the angle to the optical axis.
bool ProjectKannalaBrandt(const Lens& lens, const Eigen::Vector3d& point, Eigen::Vector2d& pixel,
                          Eigen::Matrix<double, 2, 3>* by_point) {
  const double across2 = point.x() * point.x() + point.y() * point.y(), across = std::sqrt(across2);
  if (across < kNearest) return ProjectPinhole(lens, point, pixel, by_point);
  if (!std::isfinite(across2 + point.z())) return false;
  const double theta = std::atan2(across, point.z());
  const double* k = lens.k.data();
  const double radius = KannalaBrandtRadius(k, theta);
  const double x = point.x() / across, y = point.y() / across;
  pixel = {lens.fx * radius * x + lens.cx, lens.fy * radius * y + lens.cy};
  if (by_point == nullptr) return true;
  const double slope = KannalaBrandtSlope(k, theta);
  // theta grows by z / |point|^2 along the direction across, and falls by across / |point|^2 along z.
  const double length2 = across2 + point.z() * point.z();
  const double along = slope * point.z() / length2, sideways = radius / across;
  const double by_z = -slope * across / length2;
  *by_point << lens.fx * (along * x * x + sideways * y * y), lens.fx * (along - sideways) * x * y, lens.fx * by_z * x,
      lens.fy * (along - sideways) * x * y, lens.fy * (along * y * y + sideways * x * x), lens.fy * by_z * y;
  return true;
}

}  // namespace

std::optional<Lens> Lens::Of(const Camera& camera) {
  if (camera.model == CameraModel::kEquirectangular) return std::nullopt;
  const std::size_t needed = camera.model == CameraModel::kPinhole ? 4 : 8;
  if (camera.parameters.size() != needed) return std::nullopt;
  if (!std::ranges::all_of(camera.parameters, [](float value) { return std::isfinite(value); })) return std::nullopt;
  Lens lens{.model = camera.model,
            .fx = static_cast<double>(camera.parameters[0]),
            .fy = static_cast<double>(camera.parameters[1]),
            .cx = static_cast<double>(camera.parameters[2]),
            .cy = static_cast<double>(camera.parameters[3])};
  for (std::size_t i = 4; i < needed; ++i) lens.k[i - 4] = static_cast<double>(camera.parameters[i]);
  if (!(lens.fx > 0 && lens.fy > 0)) return std::nullopt;
  return lens;
}

bool Lens::Project(const Eigen::Vector3d& point, Eigen::Vector2d& pixel) const {
  return model == CameraModel::kPinhole ? ProjectPinhole(*this, point, pixel, nullptr)
                                        : ProjectKannalaBrandt(*this, point, pixel, nullptr);
}

bool Lens::Project(const Eigen::Vector3d& point, Eigen::Vector2d& pixel, Eigen::Matrix<double, 2, 3>& by_point) const {
  return model == CameraModel::kPinhole ? ProjectPinhole(*this, point, pixel, &by_point)
                                        : ProjectKannalaBrandt(*this, point, pixel, &by_point);
}

}  // namespace slamdb::detail
