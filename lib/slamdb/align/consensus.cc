// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/consensus.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>

namespace slamdb::detail {
namespace {

constexpr double kMostTurn = 3 * std::numbers::pi / 180;
constexpr double kMostLogScale = 0.06;
constexpr double kMostShift = 0.05;  // of the first map's median depth, at the second's camera

}  // namespace

bool Agree(const MapPair& pair, const Hypothesis& a, const Hypothesis& b, double slack) {
  const Similarity3d &one = a.first_from_second, &other = b.first_from_second;
  if (one.rotation.angularDistance(other.rotation) > slack * kMostTurn) return false;
  if (std::abs(std::log(one.scale / other.scale)) > slack * kMostLogScale) return false;
  const double most = slack * kMostShift * pair.first.views.median_depth();
  const auto shift = [&](const Hypothesis& hypothesis) {
    const Eigen::Vector3d& center = pair.second.views.views()[hypothesis.candidate.second].center;
    return (one * center - other * center).norm();
  };
  return shift(a) <= most && shift(b) <= most;
}

std::vector<Consensus> FindConsensus(const MapPair& pair, std::span<const Hypothesis> hypotheses) {
  std::vector<std::uint32_t> left(hypotheses.size());
  std::iota(left.begin(), left.end(), 0U);
  std::ranges::stable_sort(left, std::greater(), [&](std::uint32_t row) { return hypotheses[row].inliers.size(); });
  const auto agree = [&](std::uint32_t a, std::uint32_t b) { return Agree(pair, hypotheses[a], hypotheses[b]); };
  const auto support = [&](std::uint32_t row) {
    std::size_t inliers = 0;
    for (const std::uint32_t other : left)
      if (agree(row, other)) inliers += hypotheses[other].inliers.size();
    return inliers;
  };
  std::vector<Consensus> found;
  while (!left.empty()) {
    Consensus consensus{.members = {*std::ranges::max_element(left, {}, support)}};
    for (const std::uint32_t row : left)
      if (row != consensus.members.front() &&
          std::ranges::all_of(consensus.members, [&](std::uint32_t member) { return agree(member, row); }))
        consensus.members.push_back(row);
    std::set<std::uint32_t> keyframes;
    for (const std::uint32_t row : consensus.members) {
      consensus.inliers += hypotheses[row].inliers.size();
      keyframes.insert(hypotheses[row].candidate.second);
    }
    consensus.second_keyframes = keyframes.size();
    std::erase_if(
        left, [&](std::uint32_t row) { return std::ranges::find(consensus.members, row) != consensus.members.end(); });
    found.push_back(std::move(consensus));
  }
  std::ranges::stable_sort(found, std::greater(), &Consensus::inliers);
  return found;
}

}  // namespace slamdb::detail
