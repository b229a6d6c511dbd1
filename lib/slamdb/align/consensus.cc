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
constexpr std::size_t kMostGrouped = 2000;  // hypotheses, those with the most inliers
constexpr double kMostShift = 0.05;         // of the first map's median depth, at the second's camera

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

namespace {

// Groups hypotheses greedily: the one that most inliers agree with leads, and takes along who agrees with all so far.
class Grouping {
 public:
  Grouping(const MapPair& pair, std::span<const Hypothesis> hypotheses) : pair_(pair), hypotheses_(hypotheses) {
    left_.resize(hypotheses.size());
    std::iota(left_.begin(), left_.end(), 0U);
    std::ranges::stable_sort(left_, std::greater(), [&](std::uint32_t row) { return Weight(row); });
    left_.resize(std::min(left_.size(), kMostGrouped));
    support_.assign(hypotheses.size(), 0);
    for (const std::uint32_t row : left_)
      for (const std::uint32_t other : left_)
        if (Agree(row, other)) support_[row] += Weight(other);
  }

  bool done() const { return left_.empty(); }

  Consensus Next() {
    const auto support = [&](std::uint32_t row) { return support_[row]; };
    Consensus consensus{.members = {*std::ranges::max_element(left_, {}, support)}};
    for (const std::uint32_t row : left_)
      if (row != consensus.members.front() &&
          std::ranges::all_of(consensus.members, [&](std::uint32_t member) { return Agree(member, row); }))
        consensus.members.push_back(row);
    std::set<std::uint32_t> keyframes;
    for (const std::uint32_t row : consensus.members) {
      consensus.inliers += Weight(row);
      keyframes.insert(hypotheses_[row].candidate.second);
    }
    consensus.second_keyframes = keyframes.size();
    Remove(consensus.members);
    return consensus;
  }

 private:
  bool Agree(std::uint32_t a, std::uint32_t b) const { return detail::Agree(pair_, hypotheses_[a], hypotheses_[b]); }
  std::size_t Weight(std::uint32_t row) const { return hypotheses_[row].inliers.size(); }

  void Remove(const std::vector<std::uint32_t>& members) {
    const std::set<std::uint32_t> gone(members.begin(), members.end());
    std::erase_if(left_, [&](std::uint32_t row) { return gone.contains(row); });
    for (const std::uint32_t row : left_)
      for (const std::uint32_t member : members)
        if (Agree(row, member)) support_[row] -= Weight(member);
  }

  const MapPair& pair_;
  const std::span<const Hypothesis> hypotheses_;
  std::vector<std::uint32_t> left_;   // most inliers first
  std::vector<std::size_t> support_;  // inliers of all left that agree, by row
};

}  // namespace

std::vector<Consensus> FindConsensus(const MapPair& pair, std::span<const Hypothesis> hypotheses) {
  std::vector<Consensus> found;
  for (Grouping grouping(pair, hypotheses); !grouping.done();) found.push_back(grouping.Next());
  std::ranges::stable_sort(found, std::greater(), &Consensus::inliers);
  return found;
}

}  // namespace slamdb::detail
