// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "slamdb/edit/frame/align_trajectory.h"

namespace slamdb::detail {

// How poses were to be paired with a reference, and what a sentence calls all that.
struct Pairing {
  double max_time_difference = 0, time_offset = 0;  // seconds
  std::string_view whole, parts;                    // `map`, `keyframes`
  std::string_view options;                         // the struct that has the time offset and the time difference
};

// Why so few poses find a partner: `the map covers 1 to 5 s, the reference ...`, and what may help. Both by time.
std::string WhyUnpaired(const std::vector<TimedPosition>& poses, const std::vector<TimedPosition>& reference,
                        const Pairing& pairing);

// Whether the times are 0, 1, 2, ...
template <class Poses>
bool AreFrameNumbers(const Poses& poses) {
  double next = 0;
  for (const auto& pose : poses)
    if (pose.timestamp != next++) return false;
  return poses.size() > 1;
}

}  // namespace slamdb::detail
