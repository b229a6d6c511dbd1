// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/up.h"

namespace slamdb {

// What a map was made with, judged by what its keyframes hold.
enum class MapSensor {
  kUnknown,  // no keyframes
  kMonocular,
  kStereoOrRgbd,   // one camera with depths: a file does not tell a rectified pair from a depth camera
  kFisheyeStereo,  // two cameras
};
// For people: `monocular`, `stereo or RGB-D with IMU`; `no keyframes`.
[[nodiscard]] SLAMDB_EXPORT std::string SensorText(MapSensor sensor, bool has_imu);

// Whether lengths of a map are metres: every sensor but a lone camera tells them, and an initialised IMU does for that
// one. A few keyframes with depths tell them for all: a map of a lone camera may have been joined with theirs.
//
// Cost: linear in keyframes without depths.
[[nodiscard]] SLAMDB_EXPORT bool IsMetric(const Map& map);

// Of a set of numbers; all 0 when it is empty.
struct Distribution {
  std::uint64_t count = 0;
  double mean = 0, median = 0, max = 0;  // the median of an even number is the upper one
};

// How many keyframes or points stem from a map that may have been merged into this one.
struct OriginCount {
  std::uint32_t map = 0;
  std::uint64_t count = 0;
  friend bool operator==(const OriginCount&, const OriginCount&) = default;
};

struct MapStatistics {
  static constexpr std::size_t kHistogramSize = 33;

  MapId id;
  MapSensor sensor = MapSensor::kUnknown;
  bool has_imu = false;  // calibrated keyframes, or the map says it is inertial
  bool metric = false;   // see IsMetric
  Up up;                 // see UpOf

  std::uint64_t keyframes = 0, points = 0;  // all that are stored, the bad ones too
  std::uint64_t bad_keyframes = 0, bad_points = 0;
  std::uint64_t landmarks = 0;                    // of MRPT
  std::uint64_t features = 0;                     // sum of KeyFrame N
  std::uint64_t observations = 0;                 // of points by keyframes
  std::uint64_t covisibility_edges = 0;           // each pair of keyframes once, whichever of them lists it
  std::uint64_t loop_edges = 0, merge_edges = 0;  // likewise

  Eigen::AlignedBox3f bounding_box;     // of the good points at finite places; world; empty when there are none
  double trajectory_length = 0;         // metres or map units, through the camera centres of good keyframes by time
  double begin_time = 0, end_time = 0;  // seconds, of good keyframes with a finite timestamp

  Distribution observers;                         // keyframes that observe a good point
  std::vector<std::uint64_t> observer_histogram;  // good points by observers; the last of kHistogramSize: or more
  Distribution reprojection_error;                // pixels at full size, per observation that can be projected
  std::uint64_t unprojectable = 0;                // of each camera: behind it, dangling, or not finite

  std::uint64_t components = 0;         // connected parts of the covisibility graph of good keyframes
  std::uint64_t largest_component = 0;  // keyframes

  bool imu_initialized = false, inertial = false, imu_ba1 = false, imu_ba2 = false;
  std::vector<OriginCount> origins;                             // of keyframes, by map id
  KeyFrameId initial_keyframe, lowest_keyframe;                 // as recorded
  std::uint64_t max_keyframe_id = 0;                            // as recorded
  std::uint64_t largest_keyframe_id = 0, largest_point_id = 0;  // found; 0 when there are none
};

struct AtlasStatistics {
  std::vector<MapStatistics> maps;  // in the order of Atlas::maps
  std::uint64_t cameras = 0;
  std::uint64_t keyframes = 0, points = 0, bad_keyframes = 0, bad_points = 0;  // sums over the maps
  std::uint64_t features = 0, observations = 0, covisibility_edges = 0, loop_edges = 0, merge_edges = 0;
  double trajectory_length = 0;
};

// What is in each map, counted and measured, and the sums over all of them.
// Trusts nothing: dangling ids, rows outside their columns and numbers that are not finite are left out of what they
// would spoil.
//
// Throws nothing but std::bad_alloc.
// Cost: linear. `threads` 0: every core; the result is the same for any number. Thread-safe.
SLAMDB_EXPORT AtlasStatistics ComputeStatistics(const Atlas& atlas, int threads = 0);

}  // namespace slamdb
