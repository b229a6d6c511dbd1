// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "slamdb/base/progress.h"
#include "slamdb/base/report_files.h"
#include "slamdb/edit/part/coverage.h"
#include "slamdb/edit/part/subset.h"
#include "slamdb/export.h"

namespace slamdb {

// In place of a number: the one that ORB-SLAM3 has for the sensor of each map.
struct OfSensor {
  friend bool operator==(const OfSensor&, const OfSensor&) = default;
};
template <class Number>
using OrOfSensor = std::variant<OfSensor, Number>;

// What to cull; what is left at its default culls nothing.
// ORB-SLAM3's rules are those of its LocalMapping. What it also goes by, the share of views in which a point was found,
// is not in its files.
struct CullOptions {
  // Keyframes of whose points this share, 0 to 1, is seen by `redundant_observers` others at the same scale or a finer
  // one (an octave at most one above). In a keyframe with depths only points not beyond the depth threshold count.
  // OfSensor: 0.9, and 0.5 for stereo and RGB-D with IMU.
  std::optional<OrOfSensor<double>> redundancy;
  int redundant_observers = 3;

  // Points with fewer observations, one with depth counting twice; not those that the last two keyframes made.
  // OfSensor: 3 for monocular maps, 4 for others.
  std::optional<OrOfSensor<int>> min_observations;

  // Points whose root mean square reprojection error is larger, in pixels of the octave where each keypoint was found;
  // ORB-SLAM3's bundle adjustment drops observations beyond sqrt(5.991) = 2.45.
  std::optional<double> max_error;

  // Points that no two keyframes see from directions at least so far apart, degrees, and none with depth. ORB-SLAM3
  // triangulates from 1.15 degrees (cosine 0.9998).
  std::optional<double> min_parallax;

  // Points that no keyframe at or after this time observes, seconds.
  std::optional<double> unseen_since;

  int threads = 0;    // 0: every core
  Progress progress;  // may be empty

  static CullOptions Orbslam3() {
    CullOptions options;
    options.redundancy = OfSensor();
    options.min_observations = OfSensor();
    return options;
  }

  // Those of ORB-SLAM3 unless some rule is asked for.
  void UseOrbslam3UnlessAsked() {
    if (redundancy || min_observations || max_error || min_parallax || unseen_since) return;
    redundancy = OfSensor();
    min_observations = OfSensor();
  }
};

struct CullReport {
  std::uint64_t redundant_keyframes = 0;
  // Points by the first rule that took them, in this order; `unheld` went since the culled keyframes held them.
  std::uint64_t bad_points = 0, few_observations = 0, large_errors = 0, small_parallax = 0, unseen = 0, unheld = 0;
  SubsetReport removed;  // all in all
  Coverage coverage;
};

// Culls points, then keyframes, oldest first, each seeing what those before it left.
// Points that culled keyframes leave with 2 observations or fewer go too, as in MapPoint::EraseObservation.
// The first keyframe of a map, the one that bundle adjustment fixes, and those that must not be erased (loop and merge
// edges) always stay.
// In maps with IMU keyframes go only where ORB-SLAM3 lets the gap in time grow: to 0.5 s, or 3 s for older ones and
// those without motion.
// Bad points go in any case.
//
// Throws Error (kUsage), before anything changes, when an option makes no sense.
// Cost: linear, in place, but for points that very many keyframes see; the result is the same for any number of
// threads.
SLAMDB_EXPORT CullReport Cull(Atlas& atlas, const CullOptions& options = {});

// As schema/cull.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const CullReport& report, const ReportFiles& files = {});

}  // namespace slamdb
