// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

struct FuseOptions {
  double radius = 3;  // pixels at the point's pyramid level, seen from its reference keyframe
  int hamming = 50;   // bits in which descriptors may differ; ORB-SLAM3's TH_LOW
  // Points that are known to be the same thing, wherever they lie and stand in the list: fused before others are
  // sought. The first of each pair survives. Pairs are taken in their order: one whose points went into others is of
  // these. Those that are not there are passed over.
  std::vector<std::pair<MapPointId, MapPointId>> known;
  int threads = 0;    // 0: every core
  Progress progress;  // may be empty
};

struct FuseReport {
  std::uint64_t candidates = 0;     // pairs near enough and alike
  std::uint64_t fused = 0;          // points that went into another
  std::uint64_t seen_together = 0;  // pairs kept apart, because a keyframe sees both
  std::uint64_t observations = 0;   // moved to the other point
  std::uint64_t cleared_slots = 0;  // of keyframes, which held a fused point without being its observer
  std::uint64_t keyframes = 0;      // whose covisibility was counted anew
  double mean_distance = 0;         // between fused points, map units
  std::vector<std::pair<MapPointId, MapPointId>> replaced;  // {gone, survivor}, ascending
};

// Fuses points that are in the map twice: each point from row `second` of the list on with the one before that row
// which is most alike.
// Both must be at one place, within `radius` times the smaller of their uncertainties (one pixel at the pyramid level
// and distance of the reference keyframe; at most four times the median).
// No keyframe may see both, known pairs included.
// The most alike pairs go first; equal ones by row.
// The point of the first part survives, as in ORB-SLAM3's MapPoint::Replace:
//   slots and observations of the other become its own
//   count, its most distinctive descriptor and its normal are computed anew
//   its position, reference and distance range stay
//   the other is gone from the map
// Covisibility is counted anew for all keyframes that see a fused point.
//
// Throws nothing but std::bad_alloc and what the listener to its progress throws.
// Cost: linear, in place, but for sorting the pairs; the result is the same for any number of threads.
SLAMDB_EXPORT FuseReport FusePoints(Map& map, std::size_t second, const FuseOptions& options = {});

// Fuses points that are known to be the same thing (FuseOptions::known), and seeks no others. Landmarks of points that
// went into others become those of these.
//
// Throws nothing but std::bad_alloc.
// Cost: linear, in place.
SLAMDB_EXPORT FuseReport FusePairs(Map& map, std::vector<std::pair<MapPointId, MapPointId>> pairs);

}  // namespace slamdb
