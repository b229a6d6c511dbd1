// SPDX-License-Identifier: BSD-3-Clause
// Level by level: corners in cells, spread by a quadtree, turned, described.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/model/derive.h"
#include "slamdb/pictures/detail/spread.h"
#include "slamdb/pictures/pictures.h"

namespace slamdb {
namespace {

using detail::Concat;
using detail::Corner;
using detail::SpreadCorners;

constexpr int kBorder = 16;       // pixels of a level without corners: descriptors need their surroundings
constexpr int kCornerBorder = 3;  // that FAST itself does not look at
constexpr int kCell = 35;         // pixels
constexpr int kPatch = 31;        // diameter of what a descriptor is of, pixels
constexpr int kRadius = 15;       // of the patch whose centroid gives the orientation

// cv::Exception is nothing that callers of slamdb know.
template <class Work>
auto WithOpenCv(const Work& work) {
  try {
    return work();
  } catch (const cv::Exception& error) {
    throw Error(ErrorKind::kNotPossible, Concat("OpenCV: ", std::string(error.err)));
  }
}

// Half the width of each row of the circular patch, from the middle row outwards; symmetric in both axes.
std::array<int, kRadius + 1> PatchWidths() {
  std::array<int, kRadius + 1> widths{};
  const double half = kRadius * std::sqrt(2.0) / 2;
  const int middle = static_cast<int>(half + 1), low = static_cast<int>(std::ceil(half));
  for (int row = 0; row <= middle; ++row)
    widths[static_cast<std::size_t>(row)] = static_cast<int>(std::lround(std::sqrt(kRadius * kRadius - row * row)));
  for (int row = kRadius, width = 0; row >= low; --row, ++width) {
    while (widths[static_cast<std::size_t>(width)] == widths[static_cast<std::size_t>(width) + 1]) ++width;
    widths[static_cast<std::size_t>(row)] = width;
  }
  return widths;
}

// Degrees of the direction from a corner to the centroid of the gray values about it (Rosin, 1999).
float OrientationAt(const cv::Mat& level, const Corner& corner) {
  static const std::array<int, kRadius + 1> kWidths = PatchWidths();
  int along_x = 0, along_y = 0;
  for (int y = -kRadius; y <= kRadius; ++y) {
    const int width = kWidths[static_cast<std::size_t>(std::abs(y))];
    const std::uint8_t* row = level.ptr<std::uint8_t>(corner.y + y) + corner.x;
    int sum = 0;
    for (int x = -width; x <= width; ++x) {
      along_x += x * row[x];
      sum += row[x];
    }
    along_y += y * sum;
  }
  return cv::fastAtan2(static_cast<float>(along_y), static_cast<float>(along_x));
}

// All corners of a level, relative to its part inside the border.
std::vector<Corner> CornersOf(const cv::Mat& level, const CameraSettings& settings) {
  const int width = level.cols - 2 * kBorder, height = level.rows - 2 * kBorder;
  std::vector<Corner> corners;
  if (width < kCell || height < kCell) return corners;
  const int columns = width / kCell, rows = height / kCell;
  const int cell_width = (width + columns - 1) / columns, cell_height = (height + rows - 1) / rows;
  std::vector<cv::KeyPoint> found;
  for (int top = 0; top < height - 2 * kCornerBorder; top += cell_height)
    for (int left = 0; left < width - 2 * kCornerBorder; left += cell_width) {
      const cv::Rect cell(kBorder + left, kBorder + top, std::min(cell_width + 2 * kCornerBorder, width - left),
                          std::min(cell_height + 2 * kCornerBorder, height - top));
      cv::FAST(level(cell), found, settings.initial_threshold, true);
      if (found.empty()) cv::FAST(level(cell), found, settings.least_threshold, true);
      for (const cv::KeyPoint& each : found)
        corners.push_back({left + static_cast<int>(each.pt.x), top + static_cast<int>(each.pt.y), each.response});
    }
  return corners;
}

// How many features each level gets: in proportion to the side of its picture.
std::vector<std::size_t> SharesOf(std::int32_t features, const CameraSettings& settings) {
  const double factor = 1 / static_cast<double>(settings.scale_factor);
  const auto levels = static_cast<std::size_t>(settings.levels);
  double share = features * (1 - factor) / (1 - std::pow(factor, settings.levels));
  std::vector<std::size_t> shares(levels);
  std::int64_t left = features;
  for (std::size_t level = 0; level + 1 < levels; ++level, share *= factor) {
    shares[level] = static_cast<std::size_t>(std::lround(share));
    left -= static_cast<std::int64_t>(shares[level]);
  }
  shares.back() = static_cast<std::size_t>(std::max<std::int64_t>(left, 0));
  return shares;
}

class Extractor {
 public:
  Extractor(const CameraSettings& settings, PictureFeatures& out)
      : settings_(settings),
        out_(out),
        describer_(cv::ORB::create(1, 1.2F, 1, kBorder, 0, 2, cv::ORB::HARRIS_SCORE, kPatch)) {}

  void AddLevel(const cv::Mat& level, std::int32_t octave, std::size_t count) {
    std::vector<Corner> corners = CornersOf(level, settings_);
    const int width = level.cols - 2 * kBorder, height = level.rows - 2 * kBorder;
    std::vector<cv::KeyPoint> keypoints;
    for (const std::size_t row : SpreadCorners(corners, width, height, count)) {
      const Corner corner{corners[row].x + kBorder, corners[row].y + kBorder, corners[row].response};
      keypoints.emplace_back(cv::Point2f(static_cast<float>(corner.x), static_cast<float>(corner.y)),
                             static_cast<float>(kPatch), OrientationAt(level, corner), corner.response, 0);
    }
    if (keypoints.empty()) return;
    cv::Mat descriptors;
    describer_->compute(level, keypoints, descriptors);  // of all: none is nearer to the border than it asks for
    const float scale = out_.pyramid.factors[static_cast<std::size_t>(octave)];
    for (int row = 0; row < descriptors.rows; ++row) {
      Add(keypoints[static_cast<std::size_t>(row)], octave, scale);
      Descriptor descriptor;
      std::memcpy(descriptor.data(), descriptors.ptr(row), descriptor.size());
      out_.descriptors.push_back(descriptor);
    }
  }

 private:
  void Add(const cv::KeyPoint& keypoint, std::int32_t octave, float scale) {
    const Eigen::Vector2d place = Undistorted(
        settings_, {static_cast<double>(keypoint.pt.x * scale), static_cast<double>(keypoint.pt.y * scale)});
    out_.keypoints.push_back({.angle = keypoint.angle,
                              .response = keypoint.response,
                              .size = static_cast<float>(kPatch) * scale,
                              .x = static_cast<float>(place.x()),
                              .y = static_cast<float>(place.y()),
                              .class_id = -1,
                              .octave = octave});
  }

  const CameraSettings& settings_;
  PictureFeatures& out_;
  cv::Ptr<cv::ORB> describer_;
};

// Of the size that the camera's parameters are for.
cv::Mat Sized(const GrayPicture& picture, const CameraSettings& settings) {
  const cv::Mat whole(picture.height, picture.width, CV_8UC1, const_cast<std::uint8_t*>(picture.pixels.data()));
  if (settings.file_width > 0 && settings.file_height > 0 &&
      (picture.width != settings.file_width || picture.height != settings.file_height))
    throw Error(ErrorKind::kNotPossible,
                Concat("the picture is ", picture.width, " x ", picture.height, ", and the camera's are ",
                       settings.file_width, " x ", settings.file_height));
  const cv::Size wanted(settings.width, settings.height);
  if (wanted.area() == 0 || wanted == whole.size()) return whole;
  cv::Mat scaled;
  cv::resize(whole, scaled, wanted);
  return scaled;
}

}  // namespace

PictureFeatures ExtractFeatures(const GrayPicture& picture, const CameraSettings& settings, std::int32_t features) {
  return WithOpenCv([&] {
    cv::Mat level = Sized(picture, settings);
    const cv::Size whole = level.size();
    PictureFeatures out{.camera = settings.camera,
                        .bounds = UndistortedBounds(settings, whole.width, whole.height),
                        .pyramid = DerivePyramid(settings.levels, settings.scale_factor)};
    Extractor extractor(settings, out);
    const std::vector<std::size_t> shares = SharesOf(features, settings);
    for (std::int32_t octave = 0; octave < settings.levels; ++octave) {
      const float scale = out.pyramid.factors[static_cast<std::size_t>(octave)];
      const cv::Size size(cvRound(static_cast<float>(whole.width) / scale),
                          cvRound(static_cast<float>(whole.height) / scale));
      if (size.width <= 2 * kBorder + kCell || size.height <= 2 * kBorder + kCell) break;
      if (octave > 0) {
        cv::Mat smaller;
        cv::resize(level, smaller, size);
        level = smaller;
      }
      extractor.AddLevel(level, octave, shares[static_cast<std::size_t>(octave)]);
    }
    return out;
  });
}

}  // namespace slamdb
