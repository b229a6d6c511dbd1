// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/synthetic/synthesize.h"

namespace slamdb::live {

// A small world for each kind of sensor, one of them inertial, one of several maps.
inline std::vector<SyntheticOptions> Kinds() {
  std::vector<SyntheticOptions> kinds;
  for (const Sensor sensor : {Sensor::kMonocular, Sensor::kStereo, Sensor::kRgbd, Sensor::kFisheyeStereo})
    kinds.push_back({.sensor = sensor,
                     .inertial = sensor == Sensor::kStereo,
                     .maps = sensor == Sensor::kRgbd ? 3 : 1,
                     .keyframes = 12,
                     .points = 260,
                     .features = 200});
  return kinds;
}

}  // namespace slamdb::live
