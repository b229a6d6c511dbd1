// SPDX-License-Identifier: BSD-3-Clause
// Keypoints: where they are, on which level, and what a second image or a depth camera says of them.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/checks/detail/catalogue.h"
#include "slamdb/checks/detail/visit.h"
#include "slamdb/model/detail/distortion.h"
#include "slamdb/model/detail/lens_numbers.h"

namespace slamdb::detail {
namespace {

// visit(name, column) for the keypoint columns in use: rectified stereo leaves unused ones of the right image.
template <class Visit>
void ForEachKeypointColumn(const Features& features, const Visit& visit) {
  visit("", features.keypoints);
  visit("undistorted ", features.undistorted);
  if (features.is_fisheye_stereo()) visit("right ", features.right_keypoints);
}

// Reports the first offender of each keypoint column, with how many there are.
template <class Offends, class Describe>
void CheckKeypoints(const Subject& subject, const Offends& offends, const Describe& describe, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    ForEachKeypointColumn(keyframe.features, [&](std::string_view column, const Column<Keypoint>& keypoints) {
      const auto breaks = [&](const Keypoint& keypoint) { return offends(keyframe, keypoint); };
      const auto first = std::ranges::find_if(keypoints, breaks);
      if (first == keypoints.end()) return;
      const auto row = static_cast<std::size_t>(first - keypoints.begin());
      const auto count = std::count_if(first, keypoints.end(), breaks);
      findings.Add(PlaceOf(map, keyframe, row), count, " ", column, "keypoints ", describe(keyframe, *first));
    });
  });
}

// visit(map, keyframe, row) for the keypoints with a right coordinate and a depth, or -1 for none.
template <class AnyAtlas, class Visit>
void ForEachStereoRow(AnyAtlas& atlas, const Visit& visit) {
  for (auto& map : atlas.maps)
    for (auto& keyframe : map.keyframes) {
      if (keyframe.bad || keyframe.features.is_fisheye_stereo()) continue;
      const std::size_t rows = std::min(keyframe.features.right_x.size(), keyframe.features.depth.size());
      for (std::size_t row = 0; row < rows; ++row) visit(map, keyframe, row);
    }
}

constexpr float kSamePixel = 0.1F;  // real maps stay below: none has a finding

// Where a camera with the lens of a keyframe has a detected keypoint in the undistorted image.
class Undistort {
 public:
  // nullopt: the lens is not known.
  static std::optional<Undistort> Of(const KeyFrame& keyframe) {
    const Intrinsics& intrinsics = keyframe.intrinsics;
    if (!(intrinsics.fx > 0) || !(intrinsics.fy > 0) || keyframe.distortion.data.empty()) return std::nullopt;
    const std::optional<std::vector<double>> coefficients = RecordedDistortion(keyframe);
    if (!coefficients) return std::nullopt;
    Undistort undistort(intrinsics);
    std::ranges::copy(*coefficients, undistort.coefficients_.begin());
    return undistort;
  }

  // nullopt: beyond where the lens model means anything.
  std::optional<Eigen::Vector2d> operator()(const Keypoint& keypoint) const {
    const Eigen::Vector2d pixel(keypoint.x, keypoint.y);
    // As ORB-SLAM3 decides it: by k1 alone.
    if (coefficients_[0] == 0) return pixel;
    return UndistortBrownPixel(coefficients_.data(), focal_, center_, pixel);
  }

 private:
  explicit Undistort(const Intrinsics& intrinsics)
      : focal_(intrinsics.fx, intrinsics.fy), center_(intrinsics.cx, intrinsics.cy) {}

  std::array<double, 5> coefficients_{};
  Eigen::Vector2d focal_, center_;
};

}  // namespace

void CheckOctave(const Subject& subject, Findings& findings) {
  const auto outside = [](const KeyFrame& keyframe, const Keypoint& keypoint) {
    return keypoint.octave < 0 || keypoint.octave >= keyframe.pyramid.levels;
  };
  const auto describe = [](const KeyFrame& keyframe, const Keypoint& keypoint) {
    return [&keyframe, &keypoint] {
      return "are on no level of the pyramid; the first on " + std::to_string(keypoint.octave) + " of " +
             std::to_string(keyframe.pyramid.levels);
    };
  };
  CheckKeypoints(subject, outside, describe, findings);
}

void CheckKeypointFinite(const Subject& subject, Findings& findings) {
  const auto infinite = [](const KeyFrame&, const Keypoint& keypoint) {
    return !std::isfinite(keypoint.x) || !std::isfinite(keypoint.y);
  };
  const auto describe = [](const KeyFrame&, const Keypoint&) { return "are not at a finite place"; };
  CheckKeypoints(subject, infinite, describe, findings);
}

void CheckStereoMatch(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    const auto check = [&](const Column<std::int32_t>& matches, std::int32_t count, const char* from, const char* to) {
      for (std::size_t row = 0; row < matches.size(); ++row)
        if (matches[row] < -1 || matches[row] >= count)
          findings.Add(PlaceOf(map, keyframe, row), from, " keypoint matches ", to, " keypoint ", matches[row], " of ",
                       count);
    };
    const Features& features = keyframe.features;
    if (!features.is_fisheye_stereo()) return;
    check(features.right_of_left, features.right_count, "left", "right");
    check(features.left_of_right, features.left_count, "right", "left");
  });
}

// ORB-SLAM3 makes the undistorted keypoints from the detected ones, and of two fisheye images it uses the detected
// ones.
void CheckKeypointUndistorted(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    const Features& features = keyframe.features;
    if (features.is_fisheye_stereo()) return;
    const std::optional<Undistort> undistort = Undistort::Of(keyframe);
    if (!undistort) return;
    const std::size_t rows = std::min(features.keypoints.size(), features.undistorted.size());
    std::optional<std::size_t> first;
    std::size_t count = 0;
    for (std::size_t row = 0; row < rows; ++row) {
      const Keypoint& recorded = features.undistorted[row];
      const std::optional<Eigen::Vector2d> expected = (*undistort)(features.keypoints[row]);
      // What is not finite is found by keypoint-finite.
      if (!expected || !((*expected - Eigen::Vector2d(recorded.x, recorded.y)).norm() > kSamePixel)) continue;
      if (!first) first = row;
      ++count;
    }
    if (!first) return;
    const Keypoint &detected = features.keypoints[*first], &recorded = features.undistorted[*first];
    findings.Add(PlaceOf(map, keyframe, *first), count,
                 " undistorted keypoints are not where the lens has them; the first, detected at ", detected.x, ", ",
                 detected.y, ", at ", recorded.x, ", ", recorded.y);
  });
}

void CheckStereoFinite(const Subject& subject, Findings& findings) {
  ForEachStereoRow(subject.atlas, [&](const Map& map, const KeyFrame& keyframe, std::size_t row) {
    const float right = keyframe.features.right_x[row], depth = keyframe.features.depth[row];
    if (!std::isfinite(right) || !std::isfinite(depth))
      findings.Add(PlaceOf(map, keyframe, row), "has right coordinate ", right, " and depth ", depth);
  });
}

// Each says the other; where neither is known, the keypoint has been seen in one image.
std::size_t RestoreStereo(Atlas& atlas) {
  std::size_t restored = 0;
  ForEachStereoRow(atlas, [&](const Map&, KeyFrame& keyframe, std::size_t row) {
    float &right = keyframe.features.right_x[row], &depth = keyframe.features.depth[row];
    if (std::isfinite(right) && std::isfinite(depth)) return;
    const float x = row < keyframe.features.undistorted.size() ? keyframe.features.undistorted[row].x : -1;
    const float baseline = keyframe.intrinsics.baseline_fx;
    if (std::isfinite(right)) {
      depth = right >= 0 ? baseline / (x - right) : -1;
    } else if (std::isfinite(depth)) {
      right = depth > 0 ? x - baseline / depth : -1;
    }
    if (!std::isfinite(right) || !std::isfinite(depth) || (right >= 0 && !(depth > 0))) right = depth = -1;
    ++restored;
  });
  return restored;
}

void CheckStereoDepth(const Subject& subject, Findings& findings) {
  ForEachStereoRow(subject.atlas, [&](const Map& map, const KeyFrame& keyframe, std::size_t row) {
    const Features& features = keyframe.features;
    const float right = features.right_x[row], depth = features.depth[row];
    if (!(right >= 0) || !std::isfinite(depth)) return;  // stereo-finite
    const float baseline = keyframe.intrinsics.baseline_fx;
    const bool comparable = depth > 0 && baseline > 0 && row < features.undistorted.size();
    if (!(depth > 0) || (comparable && std::abs(features.undistorted[row].x - right - baseline / depth) > kSamePixel))
      findings.Add(PlaceOf(map, keyframe, row), "has right coordinate ", right, ", but depth ", depth);
  });
}

}  // namespace slamdb::detail
