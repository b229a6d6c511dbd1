// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "slamdb/base/column.h"
#include "slamdb/model/ids.h"

namespace slamdb {

// An ORB keypoint. cv::KeyPoint.
// Members in the order of the .osa file, so that whole columns are copied at once.
struct Keypoint {
  float angle;            // degrees, [0, 360)
  float response;         // detector score
  float size;             // diameter of the patch, pixels
  float x, y;             // pixels; undistorted positions may lie outside the image
  std::int32_t class_id;  // -1
  std::int32_t octave;    // pyramid level, 0 = full size

  friend bool operator==(const Keypoint&, const Keypoint&) = default;
};
static_assert(sizeof(Keypoint) == 28);

// 256 bits of ORB. Compared by Hamming distance.
using Descriptor = std::array<std::uint8_t, 32>;

// How a descriptor matrix without rows, or with cv::Mat's "not continuous" flag, stands in the file.
// kUsual is `32 columns, continuous`.
// An empty cv::Mat has no columns, and ORB-SLAM3 sets its flag when it loads and saves one.
enum class MatrixForm : std::uint8_t { kUsual, kUsualNotContinuous, kEmpty, kEmptyContinuous };

// The keypoints of an image binned into cells for look-up by place.
// Compressed by rows: cell c of column k is cell_sizes[k * rows + c] entries of `keypoints`, one cell behind the other.
// ORB-SLAM3: mGrid[column][row] -> keypoint rows.
struct FeatureGrid {
  Column<std::uint32_t>
      column_sizes;  // cells in each column: mnGridRows each in a sound grid, none when there is no grid
  Column<std::uint32_t> cell_sizes;  // keypoints in each cell, column after column
  Column<std::uint64_t> keypoints;   // rows of the keypoint column, cell after cell

  bool empty() const { return column_sizes.empty(); }
  friend bool operator==(const FeatureGrid&, const FeatureGrid&) = default;
};

// The bag of words: words of the vocabulary with their TF-IDF weights, sorted by word, L1 norm 1.
// DBoW2::BowVector.
struct BagOfWords {
  Column<std::uint32_t> words;
  Column<double> weights;  // same length
  friend bool operator==(const BagOfWords&, const BagOfWords&) = default;
};

// Keypoint rows grouped by the vocabulary node four levels above their word.
// Node n has the next sizes[n] entries of `features`.
// DBoW2::FeatureVector.
struct FeatureVector {
  Column<std::uint32_t> nodes;     // ascending
  Column<std::uint32_t> sizes;     // same length
  Column<std::uint32_t> features;  // keypoint rows, node after node
  friend bool operator==(const FeatureVector&, const FeatureVector&) = default;
};

// The features of a keyframe as columns: row r is keypoint r.
// All as recorded: lengths may disagree in a damaged file.
//
// Shapes, for one camera, or a rectified stereo or RGB-D pair: `count` rows in all columns but those of the right
// camera.
// Shapes, for a fisheye stereo pair, where `count` = left_count + right_count:
//   descriptors, map_points                       `count` rows, left ones first
//   keypoints, undistorted, right_x, depth        left_count rows
//   right_keypoints                               right_count rows
struct Features {
  std::int32_t count = 0;          //                                            N
  std::int32_t left_count = -1;    // -1 unless fisheye stereo                   NLeft
  std::int32_t right_count = -1;   //                                            NRight
  Column<Keypoint> keypoints;      // as detected                                mvKeys
  Column<Keypoint> undistorted;    // lens distortion removed                    mvKeysUn
  Column<float> right_x;           // column in the right image, < 0: none       mvuRight
  Column<float> depth;             // metres, < 0: none                          mvDepth
  Column<Descriptor> descriptors;  //                                            mDescriptors
  MatrixForm descriptors_form = MatrixForm::kUsual;
  Column<MapPointId> map_points;       // the point that the keypoint sees, or none  mvBackupMapPointsId
  Column<Keypoint> right_keypoints;    //                                            mvKeysRight
  Column<std::int32_t> right_of_left;  // match in the other image, -1: none         mvLeftToRightMatch
  Column<std::int32_t> left_of_right;  //                                            mvRightToLeftMatch
  FeatureGrid grid, right_grid;        //                                            mGrid, mGridRight
  BagOfWords bag_of_words;             //                                            mBowVec
  FeatureVector feature_vector;        //                                            mFeatVec

  bool is_fisheye_stereo() const { return left_count >= 0; }
};

}  // namespace slamdb
