// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <opencv2/imgproc.hpp>

#include "slamdb/model/detail/lens.h"
#include "slamdb/pictures/color_picture.h"

namespace slamdb {
namespace {

// Where the camera sees the ray (x, y, 1): Brown's model, or Kannala-Brandt.
class Eye {
 public:
  explicit Eye(const CameraSettings& settings) : camera_(settings.camera) {
    for (std::size_t row = 0; row < std::min(k_.size(), settings.distortion.size()); ++row)
      k_[row] = settings.distortion[row];
  }

  Eigen::Vector2d See(double x, double y) const {
    const std::vector<float>& p = camera_.parameters;
    Eigen::Vector2d pixel(-1, -1);
    if (camera_.model == CameraModel::kKannalaBrandt8) {
      if (const auto lens = detail::Lens::Of(camera_)) lens->Project({x, y, 1}, pixel);
      return pixel;
    }
    const double r2 = x * x + y * y, radial = 1 + r2 * (k_[0] + r2 * (k_[1] + r2 * k_[4]));
    pixel.x() = p[0] * (x * radial + 2 * k_[2] * x * y + k_[3] * (r2 + 2 * x * x)) + p[2];
    pixel.y() = p[1] * (y * radial + k_[2] * (r2 + 2 * y * y) + 2 * k_[3] * x * y) + p[3];
    return pixel;
  }

 private:
  const Camera& camera_;
  std::array<double, 5> k_{};
};

}  // namespace

ColorPicture Undistorted(const ColorPicture& picture, const CameraSettings& settings) {
  const std::vector<float>& p = settings.camera.parameters;
  const Eye eye(settings);
  cv::Mat places(picture.height, picture.width, CV_32FC2);
  for (int row = 0; row < picture.height; ++row)
    for (int column = 0; column < picture.width; ++column) {
      const Eigen::Vector2d seen = eye.See((column - static_cast<double>(p[2])) / static_cast<double>(p[0]),
                                           (row - static_cast<double>(p[3])) / static_cast<double>(p[1]));
      places.at<cv::Vec2f>(row, column) = {static_cast<float>(seen.x()), static_cast<float>(seen.y())};
    }
  ColorPicture straight{.width = picture.width, .height = picture.height, .pixels = {}};
  straight.pixels.resize(picture.pixels.size());
  const cv::Mat from(picture.height, picture.width, CV_8UC3, const_cast<std::uint8_t*>(picture.pixels.data()));
  cv::Mat to(picture.height, picture.width, CV_8UC3, straight.pixels.data());
  cv::remap(from, to, places, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  return straight;
}

}  // namespace slamdb
