// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <string>
#include <vector>

#include "slamdb/checks/check.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/boost_reference/boost_reference.h"
#include "tests/support/temporary_folder.h"

namespace slamdb::testing {

// A small atlas of every sensor kind, with and without IMU, and one of several maps.
inline std::vector<SyntheticOptions> SensorKinds() {
  std::vector<SyntheticOptions> kinds;
  for (const Sensor sensor : {Sensor::kMonocular, Sensor::kStereo, Sensor::kRgbd, Sensor::kFisheyeStereo})
    for (const bool inertial : {false, true})
      kinds.push_back({.sensor = sensor, .inertial = inertial, .keyframes = 12, .points = 260, .features = 200});
  kinds.push_back({.sensor = Sensor::kRgbd, .maps = 3, .keyframes = 8, .points = 150, .features = 120});
  return kinds;
}

inline std::string NameOf(const SyntheticOptions& kind) {
  constexpr const char* kNames[] = {"mono", "stereo", "rgbd", "fisheye"};
  return std::string(kNames[static_cast<int>(kind.sensor)]) + (kind.inertial ? " inertial" : "") +
         (kind.maps > 1 ? " maps" : "");
}

// The rules of severity warning and error that find something.
inline std::set<std::string> Troubles(const Atlas& atlas) {
  std::set<std::string> troubles;
  for (const RuleResult& result : CheckAtlas(atlas, {}).results)
    if (result.severity != Severity::kNote) troubles.insert(result.id);
  return troubles;
}

// Those that find something in `after` and did not in `before`.
inline std::set<std::string> NewTroubles(const std::set<std::string>& before, const Atlas& after) {
  std::set<std::string> troubles = Troubles(after);
  troubles.erase("atlas-not-empty");  // a part may be of nothing, which the verbs refuse to write
  for (const std::string& known : before) troubles.erase(known);
  return troubles;
}

// How many keyframes stock Boost reads from what is written of the atlas. Throws what Boost throws.
inline std::size_t KeyFramesThatBoostReads(const Atlas& atlas, const std::string& path) {
  Notices notices;
  Atlas binary = atlas;
  binary.encoding = {};
  WriteOrbslam3(binary, path, WriteOptions{.overwrite = true, .sync = false}, notices);
  std::size_t keyframes = 0;
  for (const Map& map : reference::Load(path, reference::Encoding::kBinary).maps) keyframes += map.keyframes.size();
  return keyframes;
}

}  // namespace slamdb::testing
