// SPDX-License-Identifier: BSD-3-Clause
// 1. Offsets on a grid: how far the keyframes go between two of them, and how far the reference goes meanwhile. Neither
//    depends on the frames that the two are in.
// 2. The best of these: the residuals of the alignment under each, refined by golden section.
#include "slamdb/edit/frame/detail/time_offset.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "slamdb/base/detail/median.h"
#include "slamdb/base/error.h"

namespace slamdb::detail {
namespace {

using Positions = std::vector<TimedPosition>;

double MedianStep(const Positions& positions) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < positions.size(); ++i)
    steps.push_back(positions[i].timestamp - positions[i - 1].timestamp);
  if (steps.empty()) return 1;
  const double median = MedianOf(std::move(steps));
  return median > 0 ? median : 1;
}

double DurationOf(const Positions& positions) { return positions.back().timestamp - positions.front().timestamp; }

// As in PairsAt.
std::optional<Eigen::Vector3d> PositionAt(const std::vector<TimedPosition>& reference, double time, double most) {
  const auto there = [](const TimedPosition& sample) {
    return sample.position.allFinite() ? std::optional(sample.position) : std::nullopt;
  };
  const auto after = std::ranges::lower_bound(reference, time, {}, &TimedPosition::timestamp);
  const double to_after = after == reference.end() ? INFINITY : after->timestamp - time;
  if (after == reference.begin()) return to_after <= most ? there(*after) : std::nullopt;
  const auto before = after - 1;
  const double to_before = time - before->timestamp;
  if (std::min(to_before, to_after) > most) return std::nullopt;
  const double gap = to_before + to_after;
  if (gap > 2 * most || !there(*before) || !there(*after)) return there(to_before < to_after ? *before : *after);
  return Eigen::Vector3d(before->position + to_before / gap * (after->position - before->position));
}

struct Candidate {
  double offset = 0, score = 0;
};

class Search {
 public:
  Search(const Positions& keyframes, const Positions& reference, const TrajectoryAlignmentOptions& options)
      : keyframes_(keyframes), reference_(reference), options_(options) {
    reach_ = std::max(options.max_time_difference, MedianStep(reference));
    for (std::size_t i = 1; i < keyframes.size(); ++i)
      lengths_.push_back((keyframes[i].position - keyframes[i - 1].position).norm());
  }

  std::optional<TimeOffset> Run() const {
    std::vector<Candidate> candidates = Peaks();
    for (Candidate& candidate : candidates) candidate.score = Misfit(candidate.offset);
    std::erase_if(candidates, [](const Candidate& candidate) { return !std::isfinite(candidate.score); });
    if (candidates.empty()) return std::nullopt;
    KeepBest(candidates, kRefined, std::less<>());
    for (Candidate& candidate : candidates) Refine(candidate);
    std::ranges::sort(candidates, {}, &Candidate::score);
    TimeOffset found{candidates[0].offset, candidates[0].offset, reach_};
    constexpr double kAsGood = 1.5;
    for (const Candidate& other : candidates)
      if (std::abs(other.offset - found.seconds) > 4 * step() && other.score <= kAsGood * candidates[0].score) {
        found.rival = other.offset;
        break;
      }
    return found;
  }

 private:
  static constexpr std::size_t kAligned = 100, kRefined = 8;

  template <class Better>
  static void KeepBest(std::vector<Candidate>& candidates, std::size_t most, const Better& better) {
    std::ranges::stable_sort(candidates, better, &Candidate::score);
    if (candidates.size() > most) candidates.resize(most);
  }

  // The reference's time of the first keyframe, from where half of the shorter one overlaps to where it ends to.
  double first_offset() const {
    return reference_.front().timestamp - keyframes_.front().timestamp - Slack(keyframes_);
  }
  double last_offset() const { return reference_.back().timestamp - keyframes_.back().timestamp + Slack(keyframes_); }
  double Slack(const Positions& keyframes) const {
    const double duration = DurationOf(keyframes);
    return duration - std::min(duration, DurationOf(reference_)) / 2;
  }
  double step() const {
    constexpr double kMostSteps = 20'000;
    return std::max({std::min(MedianStep(reference_), MedianStep(keyframes_) / 4),
                     (last_offset() - first_offset()) / kMostSteps, 1e-4});
  }

  // Local maxima of the agreement of speeds, the best ones.
  std::vector<Candidate> Peaks() const {
    const double first = first_offset(), width = step();
    const auto count = static_cast<std::size_t>(std::max(0.0, (last_offset() - first) / width)) + 2;
    std::vector<double> scores(count + 2, -1);
    for (std::size_t i = 0; i < count; ++i) scores[i + 1] = Agreement(first + static_cast<double>(i) * width);
    std::vector<Candidate> peaks;
    for (std::size_t i = 1; i <= count; ++i)
      if (scores[i] > 0 && scores[i] >= scores[i - 1] && scores[i] >= scores[i + 1])
        peaks.push_back({first + static_cast<double>(i - 1) * width, scores[i]});
    KeepBest(peaks, kAligned, std::greater<>());
    return peaks;
  }

  // How alike the ways between keyframes are, times the share of them that the reference covers.
  double Agreement(double offset) const {
    double sum_a = 0, sum_b = 0, sum_aa = 0, sum_bb = 0, sum_ab = 0, count = 0;
    std::optional<Eigen::Vector3d> before = At(0, offset);
    for (std::size_t i = 1; i < keyframes_.size(); ++i) {
      const std::optional<Eigen::Vector3d> here = At(i, offset);
      if (before && here) {
        const double a = lengths_[i - 1], b = (*here - *before).norm();
        sum_a += a, sum_b += b, sum_aa += a * a, sum_bb += b * b, sum_ab += a * b, ++count;
      }
      before = here;
    }
    if (count < 2 || !(sum_aa + sum_bb > 0)) return -1;
    const double variances = (sum_aa - sum_a * sum_a / count) * (sum_bb - sum_b * sum_b / count);
    const double correlation = variances > 0 ? (sum_ab - sum_a * sum_b / count) / std::sqrt(variances) : 0;
    const double likeness = options_.fit.with_scale ? correlation : 2 * sum_ab / (sum_aa + sum_bb);
    return (correlation + likeness + 2) / 4 * count / static_cast<double>(lengths_.size());
  }

  std::optional<Eigen::Vector3d> At(std::size_t keyframe, double offset) const {
    return PositionAt(reference_, keyframes_[keyframe].timestamp + offset, reach_);
  }

  // What the alignment leaves of the reference's spread, the worse the fewer pairs say so; infinite when there is none.
  double Misfit(double offset) const {
    const Pairs pairs = PairsAt(keyframes_, reference_, offset, reach_);
    if (pairs.source.size() < kFewestPairs) return std::numeric_limits<double>::infinity();
    try {
      const UmeyamaResult fit = SolveUmeyama(pairs.source, pairs.target, options_.fit);
      const auto inliers = static_cast<double>(std::ranges::count(fit.inliers, 1));
      const double share = inliers / static_cast<double>(keyframes_.size());
      return fit.spread > 0 ? fit.rms / fit.spread / (share * share) : std::numeric_limits<double>::infinity();
    } catch (const Error&) {  // pairs on one line, or no agreement among them
      return std::numeric_limits<double>::infinity();
    }
  }

  void Refine(Candidate& candidate) const {
    constexpr double kGolden = 0.6180339887498949;
    constexpr double kFine = 1e-6;  // seconds
    double low = candidate.offset - step(), high = candidate.offset + step();
    double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
    double at_left = Misfit(left), at_right = Misfit(right);
    while (high - low > kFine) {
      if (at_left <= at_right) {
        high = right, right = left, at_right = at_left;
        left = high - kGolden * (high - low);
        at_left = Misfit(left);
      } else {
        low = left, left = right, at_left = at_right;
        right = low + kGolden * (high - low);
        at_right = Misfit(right);
      }
    }
    const double refined = std::min(at_left, at_right);
    if (refined <= candidate.score) candidate = {at_left <= at_right ? left : right, refined};
  }

  const Positions &keyframes_, &reference_;
  const TrajectoryAlignmentOptions& options_;
  double reach_ = 0;
  std::vector<double> lengths_;  // of the ways from one keyframe to the next
};

}  // namespace

Pairs PairsAt(const std::vector<TimedPosition>& keyframes, const std::vector<TimedPosition>& reference, double offset,
              double most) {
  Pairs pairs;
  for (const auto& [time, position] : keyframes) {
    const auto there = PositionAt(reference, time + offset, most);
    if (!there) continue;
    pairs.times.push_back(time);
    pairs.source.push_back(position);
    pairs.target.push_back(*there);
  }
  return pairs;
}

std::optional<TimeOffset> EstimateTimeOffset(const std::vector<TimedPosition>& keyframes,
                                             const std::vector<TimedPosition>& reference,
                                             const TrajectoryAlignmentOptions& options) {
  if (keyframes.size() < kFewestPairs || reference.size() < kFewestPairs) return std::nullopt;
  return Search(keyframes, reference, options).Run();
}

}  // namespace slamdb::detail
