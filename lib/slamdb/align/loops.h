// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/align/align.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/similarity.h"

namespace slamdb {

enum class LoopVerdict {
  kMissed,    // the map is at one place twice and does not know: to be closed
  kClosed,    // it is at one place twice, and lies there as the pictures say: nothing to close
  kDoubtful,  // something agrees, but it could be a look-alike
  kRefuted,   // what agrees is contradicted by the pictures
};

// `missed`, `closed`, `doubtful`, `refuted`.
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(LoopVerdict verdict);

// What a verdict rests on: keyframes and points about both ends alone, as a map that drifted fits nowhere else.
struct LoopEvidence {
  std::uint64_t agreeing = 0;              // pairs of keyframes that agree
  std::uint64_t first_keyframes = 0;       // different ones in these, of the earlier end
  std::uint64_t second_keyframes = 0;      // of the later end
  std::uint64_t contradicting = 0;         // pairs about the same ends that agree on something else
  std::uint64_t points = 0;                // pairs of points that are the same thing
  double extent = 0;                       // of their patch, across its second axis, in median depths
  double found_share = 0, cell_share = 0;  // as in AlignmentEvidence
  double front_share = 0;                  // likewise
  std::uint64_t views = 0;                 // pictures that should see enough of the other end to tell
  std::uint64_t agreeing_views = 0;        // that find a fifth of it
};

// How far the later end is from where it should be.
struct LoopGap {
  double translation = 0;  // of the later camera, the map's units
  double path = 0;         // that the camera went between the two ends, likewise
  double degrees = 0;
  double scale = 1;  // a length at the earlier end per length at the later one
};

// One place that a map is at twice.
struct Loop {
  LoopVerdict verdict = LoopVerdict::kRefuted;
  std::string reason;  // one sentence: what decided
  LoopGap gap;
  LoopEvidence evidence;
  std::vector<AlignedPair> pairs;      // that agree, most inliers first; the first of each is the earlier keyframe
  std::vector<MatchedPoints> matches;  // the first of the earlier end
};

struct LoopSearch {
  std::uint64_t candidates = 0;  // pairs of keyframes that were compared
  std::vector<Loop> loops;       // the surest first
};

// Finds places that a map is at twice and does not know: keyframes that are far apart in its covisibility and yet see
// the same. Each is verified about its two ends: several pairs of keyframes must agree, and the pictures of each end
// must show what the other end holds.
// Deterministic: the result is the same for any number of threads.
//
// A map without descriptors has none.
// Cost: about three comparisons for each keyframe, of a millisecond; covisibility and words for each pair of keyframes.
// After ORB-SLAM3's loop closing (Campos et al., TRO 2021), with the verification that offline allows.
[[nodiscard]] SLAMDB_EXPORT LoopSearch FindLoops(MapRef map, const AlignOptions& options = {});

}  // namespace slamdb
