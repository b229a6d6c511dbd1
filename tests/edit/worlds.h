// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <string>

#include "slamdb/base/error.h"
#include "slamdb/checks/check.h"
#include "slamdb/synthetic/synthesize.h"

// Small synthetic atlases of every kind of sensor, what `check` says of them, and what errors say.
namespace slamdb {

struct World {
  const char* name;
  Sensor sensor;
  bool inertial;
};

inline constexpr World kWorlds[] = {
    {"Monocular", Sensor::kMonocular, false},
    {"MonocularInertial", Sensor::kMonocular, true},
    {"Stereo", Sensor::kStereo, false},
    {"StereoInertial", Sensor::kStereo, true},
    {"Rgbd", Sensor::kRgbd, false},
    {"FisheyeStereo", Sensor::kFisheyeStereo, false},
    {"FisheyeStereoInertial", Sensor::kFisheyeStereo, true},
};

inline std::string NameOfWorld(const ::testing::TestParamInfo<World>& info) { return info.param.name; }

inline Atlas MakeWorld(const World& world, int maps, std::uint64_t seed = 1) {
  return SynthesizeAtlas({.sensor = world.sensor,
                          .inertial = world.inertial,
                          .maps = maps,
                          .keyframes = 12,
                          .points = 200,
                          .features = 200,
                          .seed = seed});
}

// How many findings each rule of severity warning or error has.
inline std::map<std::string, std::uint64_t> TroubleCounts(const Atlas& atlas) {
  std::map<std::string, std::uint64_t> counts;
  for (const RuleResult& result : CheckAtlas(atlas, {}).results)
    if (result.severity != Severity::kNote) counts[result.id] = result.count;
  return counts;
}

inline std::string ErrorOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace slamdb
