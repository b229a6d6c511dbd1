// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/view/detail/encode.h"

namespace slamdb::view {
namespace {

constexpr std::size_t kKeyFramesPerTask = 16;
constexpr double kStepsPerPixel = 8;

// visit(keypoint, row of the point in the scene or -1) for the keypoints of the left camera, as observations mean them.
template <class Visit>
void ForEachKeypoint(const SceneAtlas& atlas, std::uint32_t map, const KeyFrame& keyframe, const Visit& visit) {
  const Features& features = keyframe.features;
  const Column<Keypoint>& keypoints = features.is_fisheye_stereo() ? features.keypoints : features.undistorted;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    if (!std::isfinite(keypoints[i].x) || !std::isfinite(keypoints[i].y)) continue;
    visit(keypoints[i], i < features.map_points.size() ? atlas.PointRow(map, features.map_points[i]) : -1);
  }
}

std::uint16_t Steps(float pixel, std::int32_t corner) {
  const double steps = std::round((double{pixel} - corner) * kStepsPerPixel);
  return static_cast<std::uint16_t>(std::clamp(steps, 0.0, 65535.0));
}

struct KeyFrameOfScene {
  const SceneAtlas* atlas;
  std::uint32_t map;
  const KeyFrame* keyframe;
};

std::vector<KeyFrameOfScene> KeyFramesOf(const Scene& scene) {
  std::vector<KeyFrameOfScene> keyframes;
  keyframes.reserve(scene.keyframes());
  scene.ForEachKeyFrame([&](const SceneAtlas& atlas, std::uint32_t map, const KeyFrame& keyframe) {
    keyframes.push_back({&atlas, map, &keyframe});
  });
  return keyframes;
}

// The keypoints of some keyframes, one behind the other.
struct KeypointPart {
  VarintColumn counts, points;
  std::string x, y;

  void Add(const KeyFrameOfScene& of, bool matched_only) {
    const ImageBounds& bounds = of.keyframe->bounds;
    std::uint64_t count = 0;
    std::int64_t last = 0;
    ForEachKeypoint(*of.atlas, of.map, *of.keyframe, [&](const Keypoint& keypoint, std::int64_t point) {
      if (matched_only && point < 0) return;
      ++count;
      AppendBytes(x, Steps(keypoint.x, bounds.min_x));
      AppendBytes(y, Steps(keypoint.y, bounds.min_y));
      points.AddSigned(point - last);
      last = point;
    });
    counts.Add(count);
  }
};

}  // namespace

KeypointCounts CountKeypoints(const Scene& scene, int threads) {
  const std::vector<KeyFrameOfScene> keyframes = KeyFramesOf(scene);
  std::vector<KeypointCounts> counts(keyframes.size());
  detail::ParallelFor(keyframes.size(), kKeyFramesPerTask, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      ForEachKeypoint(*keyframes[i].atlas, keyframes[i].map, *keyframes[i].keyframe,
                      [&](const Keypoint&, std::int64_t point) {
                        ++counts[i].all;
                        counts[i].matched += point >= 0 ? 1 : 0;
                      });
  });
  KeypointCounts sum;
  for (const KeypointCounts& of_one : counts) {
    sum.all += of_one.all;
    sum.matched += of_one.matched;
  }
  return sum;
}

Columns EncodeKeypoints(const Scene& scene, bool matched_only, int threads) {
  const std::vector<KeyFrameOfScene> keyframes = KeyFramesOf(scene);
  std::vector<KeypointPart> parts((keyframes.size() + kKeyFramesPerTask - 1) / kKeyFramesPerTask);
  detail::ParallelFor(parts.size(), 1, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t part = begin; part < end; ++part)
      for (std::size_t i = part * kKeyFramesPerTask; i < std::min((part + 1) * kKeyFramesPerTask, keyframes.size());
           ++i)
        parts[part].Add(keyframes[i], matched_only);
  });
  Columns columns = {{"keypoints/count", {}}, {"keypoints/x", {}}, {"keypoints/y", {}}, {"keypoints/point", {}}};
  for (KeypointPart& part : parts) {
    columns[0].bytes += part.counts.Take();
    columns[1].bytes += part.x;
    columns[2].bytes += part.y;
    columns[3].bytes += part.points.Take();
  }
  return columns;
}

}  // namespace slamdb::view
