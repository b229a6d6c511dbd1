// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "slamdb/evaluate/evaluate.h"

namespace slamdb::detail {

// The angle of a rotation, 0 to pi.
double AngleOf(const Eigen::Quaterniond& rotation);

// A path along which distances are measured.
struct Path {
  std::vector<double> times;
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Quaterniond> rotations;
};

// The indices of poses that are `delta` apart along the path, the earlier one first, in order of the earlier ones.
// Metres and degrees are those gone from pose to pose, and not as the crow flies, but for all pairs in degrees.
//   one behind the other  frames: every so many poses. Metres: from where the way first is long enough, on to where
//                         it is so again (the stretch before the first is of no pair). Degrees: the same, from the
//                         first pose. Seconds: to the pose that is nearest to so much later, within the tolerance;
//                         where there is none, a pose later
//   from every pose       frames: so many poses on. Metres, seconds: to the pose that is nearest to so far on, within
//                         the tolerance. Degrees: to every later pose that is turned so far, within the tolerance
//
// Throws Error (kUsage): the delta is none, or too many poses for all pairs in degrees.
using IndexPairs = std::vector<std::pair<std::size_t, std::size_t>>;
IndexPairs PairsApart(const Path& path, const Delta& delta, const EvaluationOptions& options);

}  // namespace slamdb::detail
