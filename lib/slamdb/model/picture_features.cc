// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/picture_features.h"

#include <algorithm>

namespace slamdb {

PictureFeatures FeaturesOf(const Atlas& atlas, const KeyFrame& keyframe) {
  const auto camera = std::ranges::find(atlas.cameras, keyframe.camera, &Camera::id);
  if (camera == atlas.cameras.end()) return {};
  const Features& features = keyframe.features;
  const bool pair = features.is_fisheye_stereo();
  const Column<Keypoint>& keypoints = pair ? features.keypoints : features.undistorted;
  const std::span<const Descriptor> descriptors = LeftDescriptors(features);
  const std::size_t count = std::min(keypoints.size(), descriptors.size());
  const auto rows = static_cast<std::ptrdiff_t>(count);
  return {.camera = *camera,
          .bounds = keyframe.bounds,
          .pyramid = keyframe.pyramid,
          .keypoints = {keypoints.begin(), keypoints.begin() + rows},
          .descriptors = {descriptors.begin(), descriptors.begin() + rows}};
}

std::span<const Descriptor> LeftDescriptors(const Features& features) {
  const std::span<const Descriptor> all(features.descriptors);
  if (!features.is_fisheye_stereo()) return all;
  return all.first(std::min(all.size(), static_cast<std::size_t>(features.left_count)));
}

}  // namespace slamdb
