// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/build/detail/new_features.h"

#include <algorithm>
#include <cmath>

#include "slamdb/build/detail/columns.h"
#include "slamdb/formats/import/detail/keypoints.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/image_bounds.h"
#include "slamdb/pictures/detail/record_camera.h"

namespace slamdb::detail {
namespace {

constexpr float kFarthest = 1 << 20;  // pixels

// Keypoints of a right picture are features of their own in a fisheye pair alone; of a rectified one they are kept.
std::size_t RightRows(const NewKeyFrames& given, const Features& features) {
  return given.right_camera ? features.right_keypoints.size() : 0;
}

// The features of one keyframe while they are looked at.
class Inspection {
 public:
  Inspection(const NewKeyFrames& given, std::size_t row)
      : given_(given), features_(given.features[row]), row_(row), left_(features_.keypoints.size()) {}

  void RequireAll() const {
    const std::size_t right = RightRows(given_, features_);
    Length("undistorted", features_.undistorted, left_);
    Length("descriptors", features_.descriptors, left_ + right);
    Length("right_x", features_.right_x, left_);
    Length("depth", features_.depth, left_);
    Matches("right_of_left", features_.right_of_left, left_, right);
    Matches("left_of_right", features_.left_of_right, right, left_);
    Keypoints("keypoints", features_.keypoints);
    Keypoints("undistorted", features_.undistorted);
    Keypoints("right_keypoints", features_.right_keypoints);
    Numbers("right_x", features_.right_x);
    Numbers("depth", features_.depth);
    const bool has_baseline = given_.baseline > 0 || given_.right_camera;
    if (has_baseline || !(HasAny(features_.right_x) || HasAny(features_.depth))) return;
    Fail("depth: of a rectified pair or an RGB-D camera needs its baseline; baseline= says it");
  }

 private:
  template <class... Parts>
  [[noreturn]] void Fail(const Parts&... parts) const {
    RefuseRow("features", row_, "- ", parts...);
  }

  template <class List>
  void Length(std::string_view column, const List& list, std::size_t length) const {
    if (!list.empty() && list.size() != length)
      Fail(column, ": has ", list.size(), " rows, but there are ", length, " keypoints");
  }

  void Matches(std::string_view column, const Column<std::int32_t>& rows, std::size_t length, std::size_t end) const {
    Length(column, rows, length);
    const auto is_row = [&](std::int32_t row) { return row >= -1 && row < static_cast<std::int64_t>(end); };
    const auto wrong = std::ranges::find_if_not(rows, is_row);
    if (wrong != rows.end())
      Fail(column, ": keypoint ", wrong - rows.begin(), " matches ", *wrong, " of ", end, "; -1 is none");
  }

  void Keypoints(std::string_view column, const Column<Keypoint>& keypoints) const {
    for (std::size_t i = 0; i < keypoints.size(); ++i) {
      const Keypoint& keypoint = keypoints[i];
      if (!(std::abs(keypoint.x) <= kFarthest && std::abs(keypoint.y) <= kFarthest))
        Fail(column, ": keypoint ", i, " is at no finite place, or in no picture");
      if (!std::isfinite(keypoint.angle) || !std::isfinite(keypoint.response) || !(keypoint.size >= 0) ||
          !std::isfinite(keypoint.size))
        Fail(column, ": keypoint ", i, " has an angle, response or size that is not finite, or a size below 0");
      if (keypoint.octave < 0 || keypoint.octave >= given_.levels)
        Fail(column, ": keypoint ", i, " is of octave ", keypoint.octave, ", but the pyramid has ", given_.levels,
             " levels; levels= says how many");
    }
  }

  void Numbers(std::string_view column, const Column<float>& numbers) const {
    const auto wrong = std::ranges::find_if_not(numbers, [](float number) { return std::isfinite(number); });
    if (wrong != numbers.end()) Fail(column, ": keypoint ", wrong - numbers.begin(), " has none; -1 says so");
  }

  static bool HasAny(const Column<float>& numbers) {
    return std::ranges::any_of(numbers, [](float number) { return number >= 0; });
  }

  const NewKeyFrames& given_;
  const Features& features_;
  const std::size_t row_;
  const std::size_t left_;
};

void SetSizes(const ScalePyramid& pyramid, Column<Keypoint>& keypoints) {
  for (Keypoint& keypoint : keypoints)
    if (keypoint.size == 0) keypoint.size = PatchAt(keypoint.octave, pyramid);
}

float NumberOrNone(float number) { return std::isfinite(number) ? number : -1; }

// What is derived of what is given; another keyframe's may still be there.
void ForgetDerived(bool is_pair, Features& features) {
  features.left_count = features.right_count = -1;
  features.descriptors_form = MatrixForm::kUsual;
  features.grid = features.right_grid = {};
  features.bag_of_words = {};
  features.feature_vector = {};
  if (!is_pair) features.right_of_left.clear(), features.left_of_right.clear();  // which hold -1 alone
}

// ORB-SLAM3 looks into the cells of pictures without keypoints, too.
void SetEmptyGrids(KeyFrame& keyframe) {
  Features& features = keyframe.features;
  if (keyframe.bounds.max_x <= keyframe.bounds.min_x) return;
  SetGrid(keyframe.bounds);
  features.grid = DeriveGrid(features.undistorted, keyframe.bounds);
  if (features.is_fisheye_stereo()) features.right_grid = DeriveGrid(features.right_keypoints, keyframe.bounds);
}

// Of a rectified pair the column in the right picture and the depth tell each other: x - right_x = baseline * fx /
// depth.
void CompleteStereo(const Intrinsics& intrinsics, Features& features) {
  for (std::size_t i = 0; i < features.keypoints.size(); ++i) {
    const float x = features.undistorted[i].x;
    float &right_x = features.right_x[i], &depth = features.depth[i];
    if (right_x >= 0 && !(depth > 0)) {
      const float disparity = x - right_x;
      depth = disparity > 0 ? NumberOrNone(intrinsics.baseline_fx / disparity) : -1;
    } else if (depth > 0 && !(right_x >= 0)) {
      right_x = NumberOrNone(x - intrinsics.baseline_fx / depth);
    }
  }
}

}  // namespace

void RequireFeatures(const NewKeyFrames& given, std::size_t row) { Inspection(given, row).RequireAll(); }

void CompleteNewFeatures(const CameraSettings& settings, const NewKeyFrames& given, KeyFrame& keyframe) {
  Features& features = keyframe.features;
  ForgetDerived(given.right_camera.has_value(), features);
  SetSizes(keyframe.pyramid, features.keypoints);
  SetSizes(keyframe.pyramid, features.right_keypoints);
  if (features.undistorted.empty()) features.undistorted = WithoutDistortion(settings, features.keypoints);
  SetSizes(keyframe.pyramid, features.undistorted);
  const std::size_t left = features.keypoints.size(), right = RightRows(given, features);
  if (given.right_camera) {
    features.left_count = static_cast<std::int32_t>(left);
    features.right_count = static_cast<std::int32_t>(right);
    features.right_of_left.resize(left, -1);
    features.left_of_right.resize(right, -1);
  }
  features.right_x.resize(left, -1);
  features.depth.resize(left, -1);
  if (!given.right_camera) CompleteStereo(keyframe.intrinsics, features);
  features.count = static_cast<std::int32_t>(left + right);
  features.map_points.assign(left + right, MapPointId());
  if (left == 0) SetEmptyGrids(keyframe);
}

}  // namespace slamdb::detail
