// SPDX-License-Identifier: BSD-3-Clause
// What holds of any trajectory: frames do not count, nor threads, nor the order of poses.
#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "tests/evaluate/trajectories.h"

namespace slamdb {
namespace {

using Figures = std::vector<double>;

const Similarity3d kMove{1, Eigen::Quaterniond(0.4, 0.1, -0.8, 0.3).normalized(), {12, -3, 5}};
const Similarity3d kResize{0.3, Eigen::Quaterniond(0.9, -0.2, 0.1, 0.4).normalized(), {-2, 7, 1}};
const std::vector<Delta> kDeltas = {
    {1, DeltaUnit::kFrames}, {1, DeltaUnit::kMetres}, {1, DeltaUnit::kSeconds}, {20, DeltaUnit::kDegrees}};

void Append(Figures& figures, const ErrorStatistics& of) {
  figures.insert(figures.end(), {static_cast<double>(of.count), of.rmse, of.mean, of.median, of.std, of.min, of.max,
                                 of.sse, of.p25, of.p75, of.p90, of.p95, of.p99});
}

Figures Absolute(const TrajectoryEvaluation& evaluation) {
  Figures figures;
  const AbsoluteErrors& of = evaluation.absolute;
  for (const auto* statistics : {&of.translation, &of.rotation_degrees, &of.rotation_part, &of.full_transformation})
    Append(figures, *statistics);
  return figures;
}

Figures Relative(const TrajectoryEvaluation& evaluation) {
  Figures figures;
  for (const RelativeErrors& of : evaluation.relative)
    for (const auto* statistics : {&of.translation, &of.rotation_degrees, &of.rotation_part, &of.full_transformation,
                                   &of.point_distance, &of.point_distance_ratio})
      Append(figures, *statistics);
  return figures;
}

void ExpectNear(const Figures& actual, const Figures& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i)
    EXPECT_NEAR(actual[i], expected[i], 1e-9 * std::max(1.0, std::abs(expected[i]))) << "figure " << i;
}

class Properties : public ::testing::TestWithParam<bool> {
 protected:
  TrajectoryEvaluation Of(const std::vector<TrajectoryPose>& estimate, const std::vector<TrajectoryPose>& truth,
                          std::optional<AlignmentKind> alignment = {}, int threads = 0) const {
    return Evaluated(estimate, truth,
                     {.alignment = alignment, .deltas = kDeltas, .all_pairs = GetParam(), .threads = threads});
  }

  const std::vector<TrajectoryPose> truth_ = Walk(300), estimate_ = Disturbed(truth_, 0.03, 0.02);
};

TEST_P(Properties, ATrajectoryHasNoErrorAgainstItself) {
  for (const AlignmentKind kind : {AlignmentKind::kNone, AlignmentKind::kOrigin, AlignmentKind::kScale,
                                   AlignmentKind::kSe3, AlignmentKind::kSim3}) {
    const TrajectoryEvaluation evaluation = Of(truth_, truth_, kind);
    EXPECT_LT(evaluation.absolute.translation.max, 1e-12) << NameOf(kind);
    EXPECT_LT(evaluation.absolute.rotation_degrees.max, 1e-5) << NameOf(kind);
    for (const RelativeErrors& relative : evaluation.relative) EXPECT_LT(relative.translation.max, 1e-12);
  }
}

TEST_P(Properties, RigidMovesOfEitherDoNotCountOnceAligned) {
  const TrajectoryEvaluation still = Of(estimate_, truth_);
  const TrajectoryEvaluation moved = Of(Moved(estimate_, kMove), truth_);
  ExpectNear(Absolute(moved), Absolute(still));
  ExpectNear(Relative(moved), Relative(still));
  const TrajectoryEvaluation elsewhere = Of(estimate_, Moved(truth_, kMove));
  ExpectNear(Absolute(elsewhere), Absolute(still));
  ExpectNear(Relative(elsewhere), Relative(still));
}

TEST_P(Properties, SimilaritiesOfTheEstimateDoNotCountOnceScaled) {
  const TrajectoryEvaluation still = Of(estimate_, truth_, AlignmentKind::kSim3);
  const TrajectoryEvaluation moved = Of(Moved(estimate_, kResize), truth_, AlignmentKind::kSim3);
  ExpectNear(Absolute(moved), Absolute(still));
  ExpectNear(Relative(moved), Relative(still));
}

TEST_P(Properties, RelativeErrorsNeedNoRigidAlignment) {
  const Figures aligned = Relative(Of(estimate_, truth_));
  ExpectNear(Relative(Of(Moved(estimate_, kMove), truth_, AlignmentKind::kNone)), aligned);
  ExpectNear(Relative(Of(estimate_, truth_, AlignmentKind::kOrigin)), aligned);
}

TEST_P(Properties, NoOtherAlignmentLeavesLess) {
  const double sim3 = Of(estimate_, truth_, AlignmentKind::kSim3).absolute.translation.rmse;
  const double se3 = Of(estimate_, truth_, AlignmentKind::kSe3).absolute.translation.rmse;
  EXPECT_LE(sim3, se3);
  EXPECT_LE(se3, Of(estimate_, truth_, AlignmentKind::kOrigin).absolute.translation.rmse);
  EXPECT_LE(se3, Of(estimate_, truth_, AlignmentKind::kNone).absolute.translation.rmse);
}

TEST_P(Properties, TheOrderOfPosesAndTheThreadsDoNotCount) {
  const TrajectoryEvaluation one = Of(estimate_, truth_, {}, 1);
  std::vector<TrajectoryPose> shuffled = estimate_;
  std::ranges::shuffle(shuffled, std::mt19937(3));
  for (const TrajectoryEvaluation& other : {Of(estimate_, truth_, {}, 5), Of(shuffled, truth_)}) {
    EXPECT_EQ(Absolute(other), Absolute(one));
    EXPECT_EQ(Relative(other), Relative(one));
  }
}

TEST_P(Properties, PairsAreInOrderAndAscend) {
  std::vector<TrajectoryPose> estimate;
  for (std::size_t i = 0; i < estimate_.size(); i += 1 + i % 3) estimate.push_back(estimate_[i]);
  const TrajectoryEvaluation evaluation = Of(estimate, truth_);
  EXPECT_EQ(evaluation.poses.size(), estimate.size());
  EXPECT_TRUE(std::ranges::is_sorted(evaluation.poses, {}, &PairedPose::reference_timestamp));
  for (const RelativeErrors& relative : evaluation.relative) {
    EXPECT_FALSE(relative.errors.empty());
    EXPECT_TRUE(std::ranges::is_sorted(relative.errors, {}, &RelativeError::from));
    for (const RelativeError& error : relative.errors) EXPECT_LT(error.from, error.to);
  }
}

INSTANTIATE_TEST_SUITE_P(OneBehindTheOtherAndAll, Properties, ::testing::Bool());

}  // namespace
}  // namespace slamdb
