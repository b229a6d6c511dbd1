// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "slamdb/model/atlas.h"

// What the times and orientations of keyframes can be: the bits of something else, read in another layout, seldom are.
namespace slamdb::orbslam3 {

// Keyframes of a map by their ids, which count up in time.
std::vector<const KeyFrame*> ById(const Map& map);

// Whether a keyframe may have been made then; the bits of something else are below 1e-6 or above 1e11 seconds.
bool IsTime(double seconds);
// The same of the next keyframe of a map, as most are.
bool IsTimeBehind(double last, double seconds);

// How many keyframes have no sensible time or orientation, or a time in front of the last one's.
std::uint64_t CountImplausible(const Atlas& atlas);
// Whether more than one keyframe in two is such.
bool LooksLikeAnotherLayout(const Atlas& atlas, std::uint64_t implausible);

}  // namespace slamdb::orbslam3
