// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <list>

#include "slamdb/export.h"

namespace slamdb::live {

class KeyFrame;
class MapPoint;

// What local mapping removes again (ORB-SLAM3: LocalMapping). The functions follow its rules, and its order of them.

// What is to become of a point that was made not long ago, when keyframe `current` comes in.
enum class RecentPoint {
  kWatch,         // ask again at the next keyframe
  kKeep,          // it survived three keyframes
  kBad,           // flagged already, by culling or by Replace
  kRarelyFound,   // in less than a quarter of the frames that should have seen it
  kFewObservers,  // two keyframes later, at most 2 observations (monocular) or 3
};
[[nodiscard]] SLAMDB_EXPORT RecentPoint JudgeRecentPoint(MapPoint& point, std::uint64_t current, bool monocular);

// Flags as bad what is to go, and takes from the list all that needs no watching any more, null pointers too.
// Returns how many it flagged.
// ORB-SLAM3: MapPointCulling.
SLAMDB_EXPORT int CullMapPoints(std::list<MapPoint*>& recent, std::uint64_t current, bool monocular);

struct KeyFrameCulling {
  bool monocular = true;
  bool inertial = false;
  bool abort_requested = false;  // look at 20 keyframes instead of 100
};

// Whether more than `share` of the points that a keyframe sees are seen by more than three others at the same or a
// finer octave (at most one above its own). Depth sensors: near points only.
[[nodiscard]] SLAMDB_EXPORT bool IsRedundant(KeyFrame& keyframe, bool monocular, double share);

// Flags redundant covisibles of the current keyframe as bad: more than 90 % of their points are seen by others, or 50 %
// with stereo or depth and IMU.
// With IMU only where the chain of keyframes stays tight enough; the preintegration of the next one then spans the gap.
// Returns how many went; those that must not be erased now (SetNotErase) go at their SetErase, and do not count.
// ORB-SLAM3: KeyFrameCulling.
SLAMDB_EXPORT int CullKeyFrames(KeyFrame& current, const KeyFrameCulling& options);

}  // namespace slamdb::live
