// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/detail/mixture.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "slamdb/base/detail/concat.h"
#include "slamdb/edit/frame/detail/unit.h"
#include "slamdb/model/statistics.h"

namespace slamdb::detail {
namespace {

constexpr const char* kOneSensor = "; ORB-SLAM3 takes all maps of an atlas for those of the sensor that it runs with";

// Landmarks alone tell nothing of what made them.
bool HasSensor(const Map& map) { return !map.keyframes.empty(); }

// The one of which `has` is true first, when it is true of one alone.
template <class Has>
bool DiffersIn(const NamedMap& a, const NamedMap& b, const Has& has, const NamedMap*& with, const NamedMap*& without) {
  if (has(*a.map) == has(*b.map)) return false;
  with = has(*a.map) ? &a : &b;
  without = has(*a.map) ? &b : &a;
  return true;
}

// How far the inertial initialisation has come.
int InertialStage(const Map& map) {
  return !map.inertial || !map.imu_initialized ? 0 : map.imu_ba2 ? 3 : map.imu_ba1 ? 2 : 1;
}

void WarnOfInertia(const NamedMap& a, const NamedMap& b, bool joined, std::vector<Mixture>& mixtures) {
  const NamedMap *with = nullptr, *without = nullptr;
  const auto inertial = [](const Map& map) { return bool{map.inertial}; };
  const auto initialised = [](const Map& map) { return InertialStage(map) > 0; };
  if (DiffersIn(a, b, inertial, with, without)) {
    mixtures.push_back({"IMU", Concat(with->name, " has an IMU", initialised(*with->map) ? " that is initialised" : "",
                                      ", ", without->name, " has none",
                                      joined ? ": the joined map counts as not inertial, and its IMU as not initialised"
                                             : kOneSensor)});
  } else if (DiffersIn(a, b, initialised, with, without)) {
    mixtures.push_back(
        {"IMU", Concat("the IMU of ", with->name, " is initialised, that of ", without->name, " is not",
                       joined ? ": the joined map counts as not initialised, and ORB-SLAM3 initialises it anew" : "")});
  } else if (joined && InertialStage(*a.map) != InertialStage(*b.map)) {
    const bool first = InertialStage(*a.map) > InertialStage(*b.map);
    mixtures.push_back({"IMU", Concat("inertial bundle adjustment has come further in ", (first ? a : b).name,
                                      " than in ", (first ? b : a).name, ": the joined map counts as this one")});
  }
}

void WarnOfStereo(const NamedMap& a, const NamedMap& b, bool joined, std::vector<Mixture>& mixtures) {
  const NamedMap *with = nullptr, *without = nullptr;
  if (DiffersIn(a, b, HasStereo, with, without))
    mixtures.push_back(
        {"stereo",
         Concat(with->name, " has stereo or depth, ", without->name, " is monocular",
                joined ? ": ORB-SLAM3 takes all keyframes for those of the sensor that it runs with" : kOneSensor)});
}

bool IsClose(double x, double y) { return std::abs(x - y) <= 1e-3 * std::max(std::abs(x), std::abs(y)); }

std::set<CameraId> CamerasOf(const Map& map) {
  std::set<CameraId> cameras;
  for (const KeyFrame& keyframe : map.keyframes)
    for (const CameraId camera : {keyframe.camera, keyframe.right_camera})
      if (camera) cameras.insert(camera);
  return cameras;
}

// As ORB-SLAM3 keeps them in each keyframe, whatever its camera says.
bool SameIntrinsics(const Map& a, const Map& b) {
  if (a.keyframes.empty() || b.keyframes.empty()) return true;
  const Intrinsics &first = a.keyframes.front().intrinsics, &second = b.keyframes.front().intrinsics;
  const auto close = [](float x, float y) { return IsClose(static_cast<double>(x), static_cast<double>(y)); };
  return close(first.fx, second.fx) && close(first.fy, second.fy) && close(first.cx, second.cx) &&
         close(first.cy, second.cy) &&
         (first.baseline_fx <= 0 || second.baseline_fx <= 0 || close(first.baseline_fx, second.baseline_fx));
}

void WarnOfCameras(const NamedMap& a, const NamedMap& b, std::vector<Mixture>& mixtures) {
  const std::set<CameraId> first = CamerasOf(*a.map), second = CamerasOf(*b.map);
  const bool shares = first.empty() || second.empty() ||
                      std::ranges::any_of(second, [&](CameraId camera) { return first.contains(camera); });
  if (shares && SameIntrinsics(*a.map, *b.map)) return;
  mixtures.push_back(
      {"cameras", Concat(a.name, " and ", b.name, shares ? " have other intrinsics" : " have other cameras",
                         ": a camera that is localised must be the one that made the map, or be calibrated as it")});
}

}  // namespace

bool HasArbitraryScale(const Map& map) { return HasSensor(map) && !IsMetric(map); }

std::vector<Mixture> MixturesOf(const NamedMap& first, const NamedMap& second, Together together) {
  const bool joined = together == Together::kJoined;
  std::vector<Mixture> mixtures;
  if (!HasSensor(*first.map) || !HasSensor(*second.map)) return mixtures;
  WarnOfInertia(first, second, joined, mixtures);
  WarnOfStereo(first, second, joined, mixtures);
  const NamedMap *metric = nullptr, *arbitrary = nullptr;
  if (!joined && DiffersIn(first, second, IsMetric, metric, arbitrary))
    mixtures.push_back({"scale", Concat("the scale of ", metric->name, " is metric, that of ", arbitrary->name,
                                        ", which is monocular without initialised IMU, is arbitrary")});
  WarnOfCameras(first, second, mixtures);
  return mixtures;
}

std::string ScaleProblem(const NamedMap& first, const NamedMap& second, double scale) {
  const NamedMap *metric = nullptr, *arbitrary = nullptr;
  if (!HasSensor(*first.map) || !HasSensor(*second.map)) return {};
  if (IsMetric(*first.map) && IsMetric(*second.map) && !IsClose(scale, 1))
    return Concat(
        "the scales of ", first.name, " and ", second.name, " are metric both, and the transform has a scale of ",
        scale,
        ": lengths of the second would be wrong in the joined map, and its baselines others than those of the first");
  if (scale != 1 || !DiffersIn(first, second, IsMetric, metric, arbitrary)) return {};
  return Concat("the scale of ", arbitrary->name,
                ", which is monocular without initialised IMU, is arbitrary, that of ", metric->name,
                " is metric: a transform of scale 1 leaves both in one map");
}

std::string ScaleWarning(const NamedMap& first, const NamedMap& second, double scale) {
  if (!HasSensor(*second.map) || !HasArbitraryScale(*first.map)) return {};
  if (scale == 1 && !IsMetric(*second.map))
    return Concat("the scales of ", first.name, " and ", second.name,
                  ", monocular without initialised IMU, are arbitrary: "
                  "a transform of scale 1 is right only where both are the same");
  if (scale != 1 && IsMetric(*second.map))
    return Concat("the metric scale of ", second.name, " is lost: the joined map has that of ", first.name,
                  ", which is monocular without initialised IMU, and arbitrary");
  return {};
}

}  // namespace slamdb::detail
