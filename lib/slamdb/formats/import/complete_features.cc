// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "slamdb/formats/import/detail/complete.h"
#include "slamdb/formats/import/detail/completed.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/image_bounds.h"

namespace slamdb::detail {
namespace {

constexpr std::int32_t kLevels = 8;
constexpr float kScaleFactor = 1.2F;
constexpr float kFarthest = 1 << 20;  // pixels: what lies beyond is a damaged keypoint

bool IsSet(const ImageBounds& bounds) { return bounds.max_x > bounds.min_x && bounds.max_y > bounds.min_y; }

// From the corner (0, 0), about the principal point, and around all keypoints.
ImageBounds BoundsOf(const Column<Keypoint>& keypoints, const Intrinsics& intrinsics) {
  float min_x = 0, min_y = 0, max_x = 2 * intrinsics.cx, max_y = 2 * intrinsics.cy;
  for (const Keypoint& keypoint : keypoints) {
    if (!(std::abs(keypoint.x) < kFarthest && std::abs(keypoint.y) < kFarthest)) continue;
    min_x = std::min(min_x, keypoint.x);
    min_y = std::min(min_y, keypoint.y);
    max_x = std::max(max_x, keypoint.x + 1);
    max_y = std::max(max_y, keypoint.y + 1);
  }
  const auto whole = [](float value) { return static_cast<std::int32_t>(value); };
  ImageBounds bounds;
  bounds.min_x = whole(std::floor(min_x));
  bounds.min_y = whole(std::floor(min_y));
  bounds.max_x = whole(std::ceil(std::clamp(max_x, 1.0F, kFarthest)));
  bounds.max_y = whole(std::ceil(std::clamp(max_y, 1.0F, kFarthest)));
  SetGrid(bounds);
  return bounds;
}

void CompleteColumns(Features& features) {
  if (features.keypoints.empty()) features.keypoints = features.undistorted;
  if (features.undistorted.empty()) features.undistorted = features.keypoints;
  const std::size_t left = features.keypoints.size();
  const std::size_t all = left + (features.is_fisheye_stereo() ? features.right_keypoints.size() : 0);
  if (features.count == 0) features.count = static_cast<std::int32_t>(all);
  if (features.right_x.empty()) features.right_x.assign(left, -1);
  if (features.depth.empty()) features.depth.assign(left, -1);
  if (features.map_points.empty()) features.map_points.assign(all, MapPointId());
  if (features.descriptors.empty()) features.descriptors_form = MatrixForm::kEmpty;
}

void CompletePyramid(KeyFrame& keyframe) {
  if (keyframe.pyramid.levels > 0) return;
  constexpr std::int32_t kMostLevels = 32;
  std::int32_t levels = kLevels;
  for (const Keypoint& keypoint : keyframe.features.keypoints)
    if (keypoint.octave < kMostLevels) levels = std::max(levels, keypoint.octave + 1);
  keyframe.pyramid = DerivePyramid(levels, kScaleFactor);
}

}  // namespace

ImageBounds BoundsOfImage(std::int32_t width, std::int32_t height) {
  ImageBounds bounds;
  bounds.max_x = std::max(width, 1);
  bounds.max_y = std::max(height, 1);
  SetGrid(bounds);
  return bounds;
}

void SetPinhole(KeyFrame& keyframe, float fx, float fy, float cx, float cy) {
  Intrinsics& intrinsics = keyframe.intrinsics;
  intrinsics.fx = fx;
  intrinsics.fy = fy;
  intrinsics.cx = cx;
  intrinsics.cy = cy;
  intrinsics.inverse_fx = 1 / fx;
  intrinsics.inverse_fy = 1 / fy;
  keyframe.calibration_matrix << fx, 0, cx, 0, fy, cy, 0, 0, 1;
}

void CompleteFeatures(KeyFrame& keyframe, Completed& completed) {
  Features& features = keyframe.features;
  const Intrinsics& intrinsics = keyframe.intrinsics;
  if (intrinsics.inverse_fx == 0 && intrinsics.fx != 0 && intrinsics.fy != 0)
    SetPinhole(keyframe, intrinsics.fx, intrinsics.fy, intrinsics.cx, intrinsics.cy);
  CompleteColumns(features);
  if (features.keypoints.empty()) return;
  CompletePyramid(keyframe);
  if (!IsSet(keyframe.bounds)) keyframe.bounds = BoundsOf(features.undistorted, intrinsics);
  if (keyframe.bounds.grid_columns == 0) SetGrid(keyframe.bounds);
  if (!features.grid.empty()) return;
  features.grid = DeriveGrid(features.undistorted, keyframe.bounds);
  if (features.is_fisheye_stereo()) features.right_grid = DeriveGrid(features.right_keypoints, keyframe.bounds);
  ++completed.grids;
}

}  // namespace slamdb::detail
