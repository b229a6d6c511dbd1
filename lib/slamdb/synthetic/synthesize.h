// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "slamdb/base/progress.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

enum class Sensor { kMonocular, kStereo, kRgbd, kFisheyeStereo };

struct SyntheticOptions {
  Sensor sensor = Sensor::kMonocular;
  bool inertial = false;  // IMU calibration, preintegration with measurements, velocities, an unbroken chain
  int maps = 1;
  std::size_t keyframes = 20;  // per map
  std::size_t points = 1000;   // per map
  std::size_t features = 500;  // at most, per keyframe (both images of a fisheye pair together)
  double pixel_noise = 0.5;    // standard deviation of keypoint positions at octave 0
  bool loops = true;           // loop edges where the camera comes back
  std::uint64_t seed = 1;
  int threads = 0;
  Progress progress;
};

// Makes a sound, geometrically consistent atlas as ORB-SLAM3 would have saved it.
// A camera goes round a room whose walls carry the points.
// Every keypoint is the noisy projection of a point, or clutter.
// Octaves, distance ranges, normals, descriptors, grids, covisibility, spanning tree, bags of words and counters follow
// from that.
// The words of its bags are below 1,000,000 and its vocabulary is made up.
// `check` finds nothing in it.
// Equal options give equal bytes on every machine.
//
// Throws Error (kUsage) when an option is out of its range, or the options contradict themselves.
// Cost: linear in the number of features.
SLAMDB_EXPORT Atlas SynthesizeAtlas(const SyntheticOptions& options);

}  // namespace slamdb
