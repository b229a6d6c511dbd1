// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/camera.h"

#include <cmath>
#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/model/derive.h"

namespace slamdb::live {
namespace {

constexpr float kSameParameter = 1e-6F;

slamdb::Camera MakeRecord(CameraModel model, std::vector<float> parameters, std::size_t wanted) {
  if (parameters.size() != wanted)
    throw Error(ErrorKind::kUsage,
                slamdb::detail::Concat("a camera of this model has ", wanted, " parameters, not ", parameters.size()));
  return {.model = model, .recorded_type = static_cast<std::uint32_t>(model), .parameters = std::move(parameters)};
}

}  // namespace

Eigen::Vector2f GeometricCamera::project(const Eigen::Vector3f& x_in_camera) const {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  return Project(record_, x_in_camera).value_or(Eigen::Vector2f(kNone, kNone));
}

Eigen::Vector2d GeometricCamera::project(const Eigen::Vector3d& x_in_camera) const {
  return project(Eigen::Vector3f(x_in_camera.cast<float>())).cast<double>();
}

cv::Point2f GeometricCamera::project(const cv::Point3f& x_in_camera) const {
  const Eigen::Vector2f pixel = project(Eigen::Vector3f(x_in_camera.x, x_in_camera.y, x_in_camera.z));
  return {pixel.x(), pixel.y()};
}

Eigen::Vector3f GeometricCamera::unprojectEig(const cv::Point2f& pixel) const {
  return Unproject(record_, Eigen::Vector2f(pixel.x, pixel.y));
}

cv::Point3f GeometricCamera::unproject(const cv::Point2f& pixel) const {
  const Eigen::Vector3f ray = unprojectEig(pixel);
  return {ray.x(), ray.y(), ray.z()};
}

std::size_t GeometricCamera::RequireParameter(std::size_t i) const {
  if (i >= size())
    throw Error(ErrorKind::kUsage, slamdb::detail::Concat("the camera has ", size(), " parameters: none has number ",
                                                          static_cast<std::int64_t>(i)));
  return i;
}

Eigen::Matrix3f GeometricCamera::toK_() const {
  Eigen::Matrix3f matrix = Eigen::Matrix3f::Identity();
  matrix(0, 0) = getParameter(0);
  matrix(1, 1) = getParameter(1);
  matrix(0, 2) = getParameter(2);
  matrix(1, 2) = getParameter(3);
  return matrix;
}

cv::Mat GeometricCamera::toK() const {
  const Eigen::Matrix3f matrix = toK_();
  cv::Mat result(3, 3, CV_32F);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) result.at<float>(row, column) = matrix(row, column);
  return result;
}

bool GeometricCamera::IsEqual(const GeometricCamera& other) const {
  if (record_.model != other.record_.model || size() != other.size()) return false;
  if (record_.model == CameraModel::kKannalaBrandt8 &&
      !(std::abs(record_.precision - other.record_.precision) <= kSameParameter))
    return false;
  for (std::size_t i = 0; i < size(); ++i)
    if (!(std::abs(record_.parameters[i] - other.record_.parameters[i]) <= kSameParameter)) return false;
  return true;
}

Pinhole::Pinhole(std::vector<float> parameters)
    : GeometricCamera(MakeRecord(CameraModel::kPinhole, std::move(parameters), 4)) {}

KannalaBrandt8::KannalaBrandt8(std::vector<float> parameters, float precision)
    : GeometricCamera([&] {
        slamdb::Camera record = MakeRecord(CameraModel::kKannalaBrandt8, std::move(parameters), 8);
        record.precision = precision;
        return record;
      }()) {}

}  // namespace slamdb::live
