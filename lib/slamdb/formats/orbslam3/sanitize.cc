// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/sanitize.h"

#include <algorithm>

#include "slamdb/model/detail/uninitialised.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {
namespace {

struct Counts {
  UninitialisedCounts uninitialised;
  std::size_t references = 0, flags = 0;
};

void CountFlag(Flag& flag, Counts& counts) {
  if (flag.recorded <= 1) return;
  flag = true;
  ++counts.flags;
}

void SanitizeFlags(Map& map, Counts& counts) {
  for (Flag* flag : {&map.imu_initialized, &map.inertial, &map.imu_ba1, &map.imu_ba2}) CountFlag(*flag, counts);
  for (KeyFrame& keyframe : map.keyframes)
    for (Flag* flag : {&keyframe.first_connection, &keyframe.not_erase, &keyframe.to_be_erased, &keyframe.bad,
                       &keyframe.imu_initialized, &keyframe.has_velocity, &keyframe.imu_calibration.is_set})
      CountFlag(*flag, counts);
  for (MapPoint& point : map.points) CountFlag(point.bad, counts);
}

void SanitizeReferences(Map& map, Counts& counts) {
  const IdTable keyframes = KeyFrameTable(map);
  const auto is_there = [&](KeyFrameId id) { return keyframes.Find(id.value()) != kNoRow; };
  for (MapPoint& point : map.points) {
    if (is_there(point.reference)) continue;
    const auto observer = std::ranges::find_if(point.observations, is_there, &Observation::keyframe);
    const KeyFrameId reference = observer == point.observations.end() ? KeyFrameId() : observer->keyframe;
    if (point.reference != reference) ++counts.references;
    point.reference = reference;
  }
}

void SanitizeMap(Map& map, Counts& counts) {
  const UninitialisedCounts reset = ResetUninitialised(map);
  counts.uninitialised.merge_scales += reset.merge_scales;
  counts.uninitialised.preintegrations += reset.preintegrations;
  counts.uninitialised.body_positions += reset.body_positions;
  counts.uninitialised.noises += reset.noises;
  SanitizeReferences(map, counts);
  SanitizeFlags(map, counts);
}

}  // namespace

std::vector<std::string> SanitizeForOrbslam3(Atlas& atlas) {
  std::vector<std::string> changes;
  const auto tell = [&](std::size_t count, const char* one, const char* many, const char* what) {
    if (count > 0) changes.push_back(std::to_string(count) + " " + (count == 1 ? one : many) + " " + what);
  };
  tell(atlas.repeated_maps.size(), "map pointer", "map pointers", "stored twice or null dropped");
  atlas.repeated_maps.clear();
  std::size_t list_entries = atlas.repeated_cameras.size();
  atlas.repeated_cameras.clear();
  Counts counts;
  for (Map& map : atlas.maps) {
    list_entries += map.repeated_keyframes.size() + map.repeated_points.size();
    map.repeated_keyframes.clear();
    map.repeated_points.clear();
    SanitizeMap(map, counts);
  }
  tell(list_entries, "list entry", "list entries", "stored twice or null dropped");
  tell(std::erase_if(atlas.maps, [](const Map& map) { return map.keyframes.empty(); }), "empty map", "empty maps",
       "dropped");
  const UninitialisedCounts& reset = counts.uninitialised;
  tell(reset.merge_scales, "uninitialised merge scale", "uninitialised merge scales", "(mfScale) set to 0");
  tell(reset.preintegrations, "uninitialised preintegration", "uninitialised preintegrations",
       "(mBackupImuPreintegrated) set to 0");
  tell(reset.body_positions, "uninitialised body position", "uninitialised body positions", "(mOwb) set to 0");
  tell(reset.noises, "uninitialised IMU noise", "uninitialised IMU noises", "(mImuCalib) set to 0");
  tell(counts.references, "reference keyframe", "reference keyframes",
       "outside the map (mBackupRefKFId) set to an observer");
  tell(counts.flags, "flag", "flags", "neither 0 nor 1 set to 1");
  return changes;
}

}  // namespace slamdb::detail
