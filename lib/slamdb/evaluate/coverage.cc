// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/evaluate/detail/coverage.h"

#include <algorithm>
#include <cmath>

#include "slamdb/model/detail/gaps.h"

namespace slamdb::detail {
namespace {

// The way gone up to each pose.
std::vector<double> WaysOf(const Poses& poses) {
  std::vector<double> ways(poses.size());
  for (std::size_t i = 1; i < poses.size(); ++i)
    ways[i] = ways[i - 1] + (poses[i].position - poses[i - 1].position).norm();
  return ways;
}

double GapLimit(const Poses& reference, const std::vector<PairedTrajectories::Pair>& pairs) {
  std::vector<double> times;
  for (const PairedTrajectories::Pair& pair : pairs) times.push_back(reference[pair.reference].timestamp);
  return GapBetween(times);
}

}  // namespace

TrajectoryCoverage CoverageOf(const PairedTrajectories& paired) {
  const Poses &estimate = paired.estimate, &reference = paired.reference;
  const std::vector<PairedTrajectories::Pair>& pairs = paired.pairs;
  const std::vector<double> ways = WaysOf(reference);
  const auto [first_estimate, last_estimate] = std::ranges::minmax(estimate, {}, &TrajectoryPose::timestamp);
  const auto [first, last] = std::ranges::minmax(reference, {}, &TrajectoryPose::timestamp);
  TrajectoryCoverage coverage{.estimate_poses = estimate.size(),
                              .reference_poses = reference.size(),
                              .pairs = pairs.size(),
                              .estimate_begin = first_estimate.timestamp,
                              .estimate_end = last_estimate.timestamp,
                              .reference_begin = first.timestamp,
                              .reference_end = last.timestamp,
                              .estimate_length = WaysOf(estimate).back(),
                              .reference_length = ways.back(),
                              .gap_limit = GapLimit(reference, pairs)};
  const auto stretch = [&](std::size_t from, std::size_t to, bool is_covered) {
    const double begin = reference[from].timestamp, end = reference[to].timestamp, length = ways[to] - ways[from];
    if (end - begin > coverage.gap_limit)
      coverage.gaps.push_back({begin, end, length});
    else if (is_covered)
      coverage.covered_duration += end - begin, coverage.covered_length += length;
  };
  stretch(0, pairs.front().reference, false);
  for (std::size_t i = 1; i < pairs.size(); ++i) stretch(pairs[i - 1].reference, pairs[i].reference, true);
  stretch(pairs.back().reference, reference.size() - 1, false);
  for (const auto& [mine, truth] : pairs)
    coverage.largest_time_difference =
        std::max(coverage.largest_time_difference,
                 std::abs(estimate[mine].timestamp + paired.time_offset - reference[truth].timestamp));
  return coverage;
}

}  // namespace slamdb::detail
