// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/detail/unpaired.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/median.h"

namespace slamdb::detail {
namespace {

std::string Seconds(double seconds) {
  constexpr double kNoTime = 1e15;  // which would only be long
  return std::abs(seconds) < kNoTime ? Fixed(seconds, 3) : Digits(seconds);
}

std::string Span(const std::vector<TimedPosition>& positions) {
  if (positions.empty()) return "no time at all";
  return Concat(Seconds(positions.front().timestamp), " to ", Seconds(positions.back().timestamp), " s");
}

// The median of how far poses are from the nearest position in time.
std::optional<double> NearestTimes(const std::vector<TimedPosition>& poses, const std::vector<TimedPosition>& reference,
                                   double offset) {
  if (poses.empty() || reference.empty()) return std::nullopt;
  std::vector<double> distances;
  for (const TimedPosition& pose : poses) {
    const double time = pose.timestamp + offset;
    const auto after = std::ranges::lower_bound(reference, time, {}, &TimedPosition::timestamp);
    double distance = after == reference.end() ? INFINITY : after->timestamp - time;
    if (after != reference.begin()) distance = std::min(distance, time - (after - 1)->timestamp);
    distances.push_back(distance);
  }
  return MedianOf(std::move(distances));
}

}  // namespace

std::string WhyUnpaired(const std::vector<TimedPosition>& poses, const std::vector<TimedPosition>& reference,
                        const Pairing& pairing) {
  const auto& [most, offset, whole, parts, options] = pairing;
  std::string why = Concat("the ", whole, " covers ", Span(poses), ", the reference ", Span(reference));
  if (offset != 0) why += Concat(" by a clock that is ahead by ", Seconds(offset), " s");
  const bool apart = !poses.empty() && !reference.empty() &&
                     (poses.back().timestamp + offset < reference.front().timestamp ||
                      reference.back().timestamp < poses.front().timestamp + offset);
  if (AreFrameNumbers(reference))
    why +=
        "; the reference's times are frame numbers, 0, 1, 2, ..., as a KITTI trajectory without times has them: give "
        "TrajectoryReadOptions::times";
  else if (apart)
    why += Concat("; if the reference's clock is ahead by ",
                  Seconds(reference.front().timestamp - poses.front().timestamp), " s, both begin at once: give ",
                  options, "::time_offset, or let it be estimated (estimate_time_offset)");
  else if (const auto nearest = NearestTimes(poses, reference, offset))
    why += Concat("; half of the ", parts, " are ", Digits(*nearest, 3), " s or more from the nearest position, and ",
                  options, "::max_time_difference allows ", Digits(most, 3), " s");
  return why;
}

}  // namespace slamdb::detail
