// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <random>
#include <string>
#include <vector>

#include "slamdb/model/derive.h"
#include "slamdb/model/umeyama.h"
#include "slamdb/synthetic/synthesize.h"

// Synthetic maps whose truth is known, what shakes them, and how far from the truth they are.
namespace slamdb::testing {

struct OptimizeWorld {
  const char* name;
  Sensor sensor;
  bool inertial;
};

inline constexpr OptimizeWorld kOptimizeWorlds[] = {
    {"Monocular", Sensor::kMonocular, false},
    {"MonocularInertial", Sensor::kMonocular, true},
    {"Stereo", Sensor::kStereo, false},
    {"StereoInertial", Sensor::kStereo, true},
    {"Rgbd", Sensor::kRgbd, false},
    {"FisheyeStereo", Sensor::kFisheyeStereo, false},
    {"FisheyeStereoInertial", Sensor::kFisheyeStereo, true},
};

// Keypoints without noise, so that the truth has no reprojection error.
inline Atlas MakeTruth(const OptimizeWorld& world, std::size_t keyframes = 12) {
  return SynthesizeAtlas({.sensor = world.sensor,
                          .inertial = world.inertial,
                          .keyframes = keyframes,
                          .points = 300,
                          .features = 250,
                          .pixel_noise = 0,
                          .loops = false});
}

class Shaker {
 public:
  Eigen::Vector3f Step(float size) { return {Number() * size, Number() * size, Number() * size}; }

  // All but the initial keyframe.
  void ShakePoses(Map& map, float radians, float lengths) {
    for (KeyFrame& keyframe : map.keyframes) {
      if (keyframe.id == map.initial_keyframe) continue;
      const Eigen::Vector3f turn = Step(radians);
      const Quaternionf by(Eigen::AngleAxisf(turn.norm(), turn.normalized()));
      keyframe.camera_from_world.rotation = by * keyframe.camera_from_world.rotation;
      keyframe.camera_from_world.rotation.normalize();
      keyframe.camera_from_world.translation += Step(lengths);
    }
  }
  void ShakePoints(Map& map, float lengths) {
    for (MapPoint& point : map.points) point.position += Step(lengths);
  }

 private:
  float Number() { return static_cast<float>(random_()) / static_cast<float>(std::mt19937::max()) * 2 - 1; }
  std::mt19937 random_{7};
};

inline std::vector<Eigen::Vector3d> CentersOf(const Map& map) {
  std::vector<Eigen::Vector3d> centers;
  for (const KeyFrame& keyframe : map.keyframes) centers.emplace_back(CameraCenter(keyframe).cast<double>());
  return centers;
}

// The largest distance of a camera from where it is in truth. `aligned`: after the best similarity.
inline double LargestOffset(const Map& map, const Map& truth, bool aligned = false) {
  const std::vector<Eigen::Vector3d> is = CentersOf(map), should = CentersOf(truth);
  if (aligned) {
    const std::vector<double> residuals = SolveUmeyama(is, should, {}).residuals;
    return *std::max_element(residuals.begin(), residuals.end());
  }
  double largest = 0;
  for (std::size_t row = 0; row < is.size(); ++row) largest = std::max(largest, (is[row] - should[row]).norm());
  return largest;
}

}  // namespace slamdb::testing
