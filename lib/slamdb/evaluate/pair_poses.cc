// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/evaluate/detail/pair_poses.h"

#include <algorithm>
#include <cmath>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/detail/time_offset.h"
#include "slamdb/edit/frame/detail/unpaired.h"

namespace slamdb::detail {
namespace {

bool IsFinite(const TrajectoryPose& pose) {
  return std::isfinite(pose.timestamp) && pose.position.allFinite() && pose.rotation.coeffs().allFinite() &&
         pose.rotation.squaredNorm() > 0;
}

void Normalize(TrajectoryPose& pose) { pose.rotation.normalize(); }

// The finite poses by time; warns of what was not so.
Poses InOrder(std::span<const TrajectoryPose> poses, std::string_view whose, std::vector<std::string>& warnings) {
  Poses kept;
  kept.reserve(poses.size());
  std::ranges::copy_if(poses, std::back_inserter(kept), IsFinite);
  std::ranges::for_each(kept, Normalize);
  if (kept.size() < poses.size())
    warnings.push_back(
        Concat(Counted(poses.size() - kept.size(), "pose"), " of the ", whose, " left out, which are not finite"));
  if (!std::ranges::is_sorted(kept, {}, &TrajectoryPose::timestamp)) {
    std::ranges::stable_sort(kept, {}, &TrajectoryPose::timestamp);
    warnings.push_back(Concat("the poses of the ", whose, " are not in order of time, and were sorted"));
  }
  std::size_t repeated = 0;
  for (std::size_t i = 1; i < kept.size(); ++i) repeated += kept[i].timestamp == kept[i - 1].timestamp;
  if (repeated > 0)
    warnings.push_back(Concat(Counted(repeated, "pose"), " of the ", whose, " at a time that another one has already"));
  return kept;
}

// Of ascending times, the place of the one nearest to `time`; the first of equally near ones.
std::size_t NearestOf(const std::vector<double>& times, double time) {
  const auto after = std::ranges::lower_bound(times, time);
  if (after == times.begin()) return 0;
  const auto before = std::ranges::lower_bound(times.begin(), after, *(after - 1));
  const bool is_before = after == times.end() || time - *before <= *after - time;
  return static_cast<std::size_t>((is_before ? before : after) - times.begin());
}

// Nearest in time: each pose of the shorter trajectory, in its order. The time offset moves the longer one, so that
// sums are rounded as evo rounds them.
void PairByTime(PairedTrajectories& paired, double most) {
  const bool estimate_is_longer = paired.estimate.size() > paired.reference.size();
  const Poses& shorter = estimate_is_longer ? paired.reference : paired.estimate;
  const Poses& longer = estimate_is_longer ? paired.estimate : paired.reference;
  const double offset = estimate_is_longer ? paired.time_offset : -paired.time_offset;
  if (longer.empty()) return;
  std::vector<double> times;
  times.reserve(longer.size());
  for (const TrajectoryPose& pose : longer) times.push_back(pose.timestamp + offset);
  for (std::size_t i = 0; i < shorter.size(); ++i) {
    const std::size_t nearest = NearestOf(times, shorter[i].timestamp);
    if (!(std::abs(times[nearest] - shorter[i].timestamp) <= most)) continue;
    paired.pairs.push_back(estimate_is_longer ? PairedTrajectories::Pair{nearest, i}
                                              : PairedTrajectories::Pair{i, nearest});
  }
}

void PairByIndex(PairedTrajectories& paired, std::span<const TrajectoryPose> estimate,
                 std::span<const TrajectoryPose> reference) {
  if (estimate.size() != reference.size())
    throw Error(ErrorKind::kUsage, Concat("only trajectories of equal length are paired by index; the estimate has ",
                                          Counted(estimate.size(), "pose"), ", the truth ", reference.size()));
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    if (!IsFinite(estimate[i]) || !IsFinite(reference[i])) continue;
    paired.pairs.push_back({paired.estimate.size(), paired.reference.size()});
    Normalize(paired.estimate.emplace_back(estimate[i]));
    Normalize(paired.reference.emplace_back(reference[i]));
  }
  if (paired.pairs.size() < estimate.size())
    paired.warnings.push_back(
        Concat(Counted(estimate.size() - paired.pairs.size(), "pair"), " left out, which are not finite"));
}

std::vector<TimedPosition> PositionsOf(const Poses& poses) {
  std::vector<TimedPosition> positions;
  positions.reserve(poses.size());
  for (const TrajectoryPose& pose : poses) positions.push_back({pose.timestamp, pose.position});
  return positions;
}

// Some of the poses, evenly spaced in the list: keyframes enough to find a time offset by, which takes time for each.
std::vector<TimedPosition> Thinned(std::vector<TimedPosition> positions) {
  constexpr std::size_t kEnough = 1'000;
  const std::size_t step = std::max<std::size_t>(1, positions.size() / kEnough);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < positions.size(); i += step) positions[kept++] = positions[i];
  positions.resize(kept);
  return positions;
}

// Finds the clocks' offset and how far apart the poses of a pair may then be.
double FindTimeOffset(PairedTrajectories& paired, bool with_scale, double most) {
  const TrajectoryAlignmentOptions options{.max_time_difference = most, .fit = {.with_scale = with_scale}};
  const auto found = EstimateTimeOffset(Thinned(PositionsOf(paired.estimate)), PositionsOf(paired.reference), options);
  if (!found) return most;
  paired.time_offset = found->seconds;
  if (found->rival != found->seconds)
    paired.warnings.push_back(Concat("the time offset is not certain: ", Fixed(found->rival, 3),
                                     " s fits nearly as well as ", Fixed(found->seconds, 3), " s"));
  return found->reach;
}

}  // namespace

PairedTrajectories PairPoses(std::span<const TrajectoryPose> estimate, std::span<const TrajectoryPose> reference,
                             bool with_scale, const EvaluationOptions& options) {
  PairedTrajectories paired;
  if (options.by_index) {
    PairByIndex(paired, estimate, reference);
    return paired;
  }
  paired.estimate = InOrder(estimate, "estimate", paired.warnings);
  paired.reference = InOrder(reference, "truth", paired.warnings);
  if (AreFrameNumbers(paired.estimate) && AreFrameNumbers(paired.reference))
    paired.warnings.emplace_back("the times of both are frame numbers, so that seconds are frames");
  paired.time_offset = options.time_offset;
  PairByTime(paired, options.estimate_time_offset ? FindTimeOffset(paired, with_scale, options.max_time_difference)
                                                  : options.max_time_difference);
  return paired;
}

std::string WhyFewPairs(const PairedTrajectories& paired, const EvaluationOptions& options) {
  const auto estimate = PositionsOf(paired.estimate), reference = PositionsOf(paired.reference);
  std::string why = WhyUnpaired(estimate, reference,
                                {.max_time_difference = options.max_time_difference,
                                 .time_offset = paired.time_offset,
                                 .whole = "estimate",
                                 .parts = "its poses",
                                 .options = "EvaluationOptions"});
  if (AreFrameNumbers(estimate) && !AreFrameNumbers(reference)) why += "; the times of the estimate are frame numbers";
  if (estimate.size() == reference.size() && !estimate.empty() && !options.by_index)
    why += "; both have as many poses: EvaluationOptions::by_index pairs the first with the first";
  return why;
}

}  // namespace slamdb::detail
