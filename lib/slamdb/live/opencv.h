// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/features.h"
#include "slamdb/model/keyframe.h"

// Between OpenCV's types and the columns of a keyframe.
namespace slamdb::live {

// Keypoints, member by member; nothing is lost either way.
inline cv::KeyPoint ToOpenCv(const Keypoint& keypoint) {
  return {keypoint.x, keypoint.y, keypoint.size, keypoint.angle, keypoint.response, keypoint.octave, keypoint.class_id};
}
inline Keypoint FromOpenCv(const cv::KeyPoint& keypoint) {
  return {keypoint.angle, keypoint.response, keypoint.size,  keypoint.pt.x,
          keypoint.pt.y,  keypoint.class_id, keypoint.octave};
}
[[nodiscard]] SLAMDB_EXPORT std::vector<cv::KeyPoint> ToOpenCv(const Column<Keypoint>& keypoints);
[[nodiscard]] SLAMDB_EXPORT Column<Keypoint> FromOpenCv(const std::vector<cv::KeyPoint>& keypoints);

// Descriptors as a matrix of N x 32, CV_8U; without rows an empty matrix.
// A view: it holds as long as the column, and must not be written.
[[nodiscard]] SLAMDB_EXPORT cv::Mat DescriptorMatrix(const Column<Descriptor>& descriptors);
// The rows of a matrix of N x 32, CV_8U, copied; none of an empty matrix.
// Throws Error (kUsage) for any other.
[[nodiscard]] SLAMDB_EXPORT Column<Descriptor> DescriptorRows(const cv::Mat& matrix);

// A small matrix of any type, as mDistCoef is.
// A view: it holds as long as the record, and must not be written. Empty where the record's sizes do not fit its bytes.
[[nodiscard]] SLAMDB_EXPORT cv::Mat ViewMatrix(const Matrix& matrix);
// The same, copied. At most two dimensions; throws Error (kUsage) for more.
[[nodiscard]] SLAMDB_EXPORT Matrix CopyMatrix(const cv::Mat& matrix);

// What ORB extraction gives, with the names of ORB-SLAM3's Frame.
struct ImageFeatures {
  std::vector<cv::KeyPoint> mvKeys;    // as detected; of a fisheye pair the left ones
  std::vector<cv::KeyPoint> mvKeysUn;  // undistorted; empty: as detected
  cv::Mat mDescriptors;                // N x 32, CV_8U; of a fisheye pair left ones first
  std::vector<float> mvuRight;         // column in the right image, < 0: none; empty: none at all
  std::vector<float> mvDepth;          // metres, < 0: none; empty: none at all

  // A fisheye pair only.
  std::vector<cv::KeyPoint> mvKeysRight;
  std::vector<int> mvLeftToRightMatch, mvRightToLeftMatch;  // row in the other image, -1: none; empty: none at all
};

// The features of one image, or of a rectified stereo or depth pair.
// Throws Error (kUsage) when the lengths of the columns disagree.
[[nodiscard]] SLAMDB_EXPORT Features FeaturesOfImage(const ImageFeatures& image);
// The features of a fisheye pair, also where one image has none.
// Throws Error (kUsage) when the lengths of the columns disagree.
[[nodiscard]] SLAMDB_EXPORT Features FeaturesOfFisheyePair(const ImageFeatures& image);

}  // namespace slamdb::live
