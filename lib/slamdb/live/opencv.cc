// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/opencv.h"

#include <cstring>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"

namespace slamdb::live {
namespace {

constexpr int kDescriptorBytes = static_cast<int>(sizeof(Descriptor));

void RequireLength(const char* column, std::size_t found, std::size_t expected) {
  if (found != expected)
    throw Error(ErrorKind::kUsage,
                slamdb::detail::Concat(column, " has ", found, " entries, but there are ", expected, " keypoints"));
}

// A column of that length; where the caller has none, `none` in every row.
template <class Value>
Column<Value> Complete(const char* name, const std::vector<Value>& values, std::size_t length, Value none) {
  if (values.empty()) return Column<Value>(length, none);
  RequireLength(name, values.size(), length);
  return Column<Value>(values.begin(), values.end());
}

// What both kinds have.
Features LeftImage(const ImageFeatures& image) {
  const std::size_t rows = image.mvKeys.size();
  if (!image.mvKeysUn.empty()) RequireLength("mvKeysUn", image.mvKeysUn.size(), rows);
  Features features;
  features.keypoints = FromOpenCv(image.mvKeys);
  features.undistorted = image.mvKeysUn.empty() ? features.keypoints : FromOpenCv(image.mvKeysUn);
  features.right_x = Complete("mvuRight", image.mvuRight, rows, -1.0F);
  features.depth = Complete("mvDepth", image.mvDepth, rows, -1.0F);
  features.descriptors = DescriptorRows(image.mDescriptors);
  return features;
}

// cv::Mat has no view of constant data.
template <class Value>
void* Writable(const Column<Value>& column) {
  return const_cast<Value*>(column.data());
}

}  // namespace

std::vector<cv::KeyPoint> ToOpenCv(const Column<Keypoint>& keypoints) {
  std::vector<cv::KeyPoint> converted;
  converted.reserve(keypoints.size());
  for (const Keypoint& keypoint : keypoints) converted.push_back(ToOpenCv(keypoint));
  return converted;
}

Column<Keypoint> FromOpenCv(const std::vector<cv::KeyPoint>& keypoints) {
  Column<Keypoint> converted;
  converted.reserve(keypoints.size());
  for (const cv::KeyPoint& keypoint : keypoints) converted.push_back(FromOpenCv(keypoint));
  return converted;
}

cv::Mat DescriptorMatrix(const Column<Descriptor>& descriptors) {
  if (descriptors.empty()) return {};
  return {static_cast<int>(descriptors.size()), kDescriptorBytes, CV_8U, Writable(descriptors)};
}

Column<Descriptor> DescriptorRows(const cv::Mat& matrix) {
  if (matrix.empty()) return {};
  if (matrix.dims != 2 || matrix.type() != CV_8U || matrix.cols != kDescriptorBytes)
    throw Error(ErrorKind::kUsage, slamdb::detail::Concat("descriptors of ", matrix.cols, " columns of type ",
                                                          matrix.type(), ", expected 32 of type 0 (CV_8U)"));
  Column<Descriptor> descriptors(static_cast<std::size_t>(matrix.rows));
  for (int row = 0; row < matrix.rows; ++row)
    std::memcpy(&descriptors[static_cast<std::size_t>(row)], matrix.ptr(row), sizeof(Descriptor));
  return descriptors;
}

cv::Mat ViewMatrix(const Matrix& matrix) {
  const bool is_type = matrix.type >= 0 && matrix.type == (matrix.type & CV_MAT_TYPE_MASK);
  if (!is_type || matrix.rows <= 0 || matrix.columns <= 0) return {};
  const std::size_t entries = static_cast<std::size_t>(matrix.rows) * static_cast<std::size_t>(matrix.columns);
  if (matrix.data.size() != entries * static_cast<std::size_t>(CV_ELEM_SIZE(matrix.type))) return {};
  return {matrix.rows, matrix.columns, matrix.type, Writable(matrix.data)};
}

Matrix CopyMatrix(const cv::Mat& matrix) {
  if (matrix.dims > 2)
    throw Error(ErrorKind::kUsage, slamdb::detail::Concat("a matrix of ", matrix.dims, " dimensions, expected 2"));
  Matrix copy;
  copy.rows = matrix.rows;
  copy.columns = matrix.cols;
  copy.type = matrix.type();
  copy.continuous = true;
  const std::size_t row_bytes = static_cast<std::size_t>(matrix.cols) * matrix.elemSize();
  copy.data.resize(static_cast<std::size_t>(matrix.rows) * row_bytes);
  for (int row = 0; row < matrix.rows && row_bytes > 0; ++row)
    std::memcpy(copy.data.data() + static_cast<std::size_t>(row) * row_bytes, matrix.ptr(row), row_bytes);
  return copy;
}

Features FeaturesOfImage(const ImageFeatures& image) {
  Features features = LeftImage(image);
  features.count = static_cast<std::int32_t>(image.mvKeys.size());
  RequireLength("mDescriptors", features.descriptors.size(), image.mvKeys.size());
  return features;
}

Features FeaturesOfFisheyePair(const ImageFeatures& image) {
  const std::size_t left = image.mvKeys.size(), right = image.mvKeysRight.size();
  Features features = LeftImage(image);
  RequireLength("mDescriptors", features.descriptors.size(), left + right);
  features.count = static_cast<std::int32_t>(left + right);
  features.left_count = static_cast<std::int32_t>(left);
  features.right_count = static_cast<std::int32_t>(right);
  features.right_keypoints = FromOpenCv(image.mvKeysRight);
  features.right_of_left = Complete("mvLeftToRightMatch", image.mvLeftToRightMatch, left, -1);
  features.left_of_right = Complete("mvRightToLeftMatch", image.mvRightToLeftMatch, right, -1);
  return features;
}

}  // namespace slamdb::live
