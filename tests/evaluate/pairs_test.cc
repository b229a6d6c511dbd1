// SPDX-License-Identifier: BSD-3-Clause
// Which poses are held against which: in time, and over a distance.
#include <gmock/gmock.h>

#include <numbers>
#include <utility>

#include "slamdb/base/error.h"
#include "tests/evaluate/trajectories.h"
#include "tests/support/error_of.h"

namespace slamdb {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Times = std::vector<std::pair<double, double>>;

// The times of the pairs, without any alignment.
Times PairsOf(const std::vector<double>& estimate, const std::vector<double>& truth, EvaluationOptions options = {}) {
  options.alignment = AlignmentKind::kNone;
  Times pairs;
  const TrajectoryEvaluation evaluation = Evaluated(AlongX(estimate), AlongX(truth), options);
  for (const PairedPose& pose : evaluation.poses) pairs.emplace_back(pose.timestamp, pose.reference_timestamp);
  return pairs;
}

TEST(TimePairs, AreTheNearestWithinTheLimit) {
  EXPECT_THAT(PairsOf({1, 2, 3.5}, {0.5, 0.9921875, 2.25, 3.5}),
              ElementsAre(std::pair(1, 0.9921875), std::pair(3.5, 3.5)));
  // 0.0078125 is a power of two: differences are exact, and the limit itself is within.
  EXPECT_THAT(PairsOf({1}, {1.0078125}, {.max_time_difference = 0.0078125}).size(), 1U);
  EXPECT_THAT(PairsOf({1, 5}, {1.0078125, 5}, {.max_time_difference = 0.0078}).size(), 1U);
}

// As evo does it: every pose of the shorter one finds its own.
TEST(TimePairs, OfTheLongerTrajectoryMayBeTakenTwice) {
  EXPECT_THAT(PairsOf({1, 1.015625}, {0, 1.0078125, 2}),
              ElementsAre(std::pair(1, 1.0078125), std::pair(1.015625, 1.0078125)));
  EXPECT_THAT(PairsOf({0, 1.0078125, 2}, {1, 1.015625}),
              ElementsAre(std::pair(1.0078125, 1), std::pair(1.0078125, 1.015625)));
}

TEST(TimePairs, OfEquallyNearOnesIsTheFirst) {
  EXPECT_THAT(PairsOf({1}, {0.9921875, 1.0078125}), ElementsAre(std::pair(1, 0.9921875)));
  const std::vector<TrajectoryPose> truth = {PoseAt(1, 10, 0, 0), PoseAt(1, 20, 0, 0), PoseAt(2, 30, 0, 0)};
  const TrajectoryEvaluation evaluation =
      Evaluated({PoseAt(1.0078125, 0, 0, 0)}, truth, {.alignment = AlignmentKind::kNone});
  EXPECT_EQ(evaluation.poses.at(0).reference_position.x(), 10) << "the first of two at one time";
  EXPECT_THAT(evaluation.warnings, Contains(HasSubstr("1 pose of the truth at a time that another one has already")));
}

TEST(TimePairs, TheTruthsClockMayBeAhead) {
  EXPECT_THAT(PairsOf({1, 2}, {11, 12, 13}, {.time_offset = 10}), ElementsAre(std::pair(1, 11), std::pair(2, 12)));
  EXPECT_THAT(PairsOf({1, 2, 3}, {11, 12}, {.time_offset = 10}), ElementsAre(std::pair(1, 11), std::pair(2, 12)));
}

TEST(TimePairs, TheOffsetCanBeFound) {
  const std::vector<TrajectoryPose> truth = Walk(400);
  std::vector<TrajectoryPose> estimate = truth;
  for (TrajectoryPose& pose : estimate) pose.timestamp -= 2.35;
  const TrajectoryEvaluation evaluation = Evaluated(estimate, truth, {.estimate_time_offset = true});
  EXPECT_NEAR(evaluation.time_offset, 2.35, 0.01);
  EXPECT_LT(evaluation.absolute.translation.rmse, 0.02);
}

TEST(TimePairs, AreInOrderOfTimeWhateverTheInput) {
  EXPECT_THAT(PairsOf({3, 1, 2}, {2, 3, 1, 4}), ElementsAre(std::pair(1, 1), std::pair(2, 2), std::pair(3, 3)));
  const TrajectoryEvaluation evaluation =
      Evaluated(AlongX({3, 1, 2}), AlongX({1, 2, 3}), {.alignment = AlignmentKind::kNone});
  EXPECT_THAT(evaluation.warnings, Contains(HasSubstr("the estimate are not in order of time")));
}

TEST(IndexPairs, NeedEqualCountsAndNoTimes) {
  EXPECT_THAT(PairsOf({1, 2}, {50, 70}, {.by_index = true}), ElementsAre(std::pair(1, 50), std::pair(2, 70)));
  EXPECT_EQ(ErrorOf([] { PairsOf({1, 2}, {50}, {.by_index = true}); }).kind(), ErrorKind::kUsage);
}

// ---- over a distance

using Steps = std::vector<std::pair<std::size_t, std::size_t>>;

Steps StepsOf(const std::vector<TrajectoryPose>& poses, const Delta& delta, EvaluationOptions options = {}) {
  options.alignment = AlignmentKind::kNone;
  options.deltas = {delta};
  Steps steps;
  const TrajectoryEvaluation evaluation = Evaluated(poses, poses, options);
  for (const RelativeError& error : evaluation.relative.at(0).errors) steps.emplace_back(error.from, error.to);
  return steps;
}

const EvaluationOptions kAll = {.all_pairs = true};

TEST(RelativePairs, ByFrames) {
  const std::vector<TrajectoryPose> poses = AlongX({0, 1, 2, 3, 4, 5});
  EXPECT_THAT(StepsOf(poses, {2, DeltaUnit::kFrames}), ElementsAre(std::pair(0, 2), std::pair(2, 4)));
  EXPECT_THAT(StepsOf(poses, {4, DeltaUnit::kFrames}, kAll), ElementsAre(std::pair(0, 4), std::pair(1, 5)));
  EXPECT_THAT(StepsOf(poses, {6, DeltaUnit::kFrames}), IsEmpty());
  EXPECT_THAT(StepsOf(poses, {1e14, DeltaUnit::kFrames}, kAll), IsEmpty());
}

TEST(RelativePairs, ByMetres) {
  const std::vector<TrajectoryPose> poses = AlongX({0, 0.5, 1, 1.75, 2.5, 3, 4});
  // From where one metre was gone first, at pose 2; 0.75 are not enough, 1.5 are.
  EXPECT_THAT(StepsOf(poses, {1, DeltaUnit::kMetres}), ElementsAre(std::pair(2, 4), std::pair(4, 6)));
  // Nearest to a metre on, a tenth off at most: from 0 and from 3; from 0.5 it is 1.25 on, from 1 0.75.
  EXPECT_THAT(StepsOf(poses, {1, DeltaUnit::kMetres}, kAll), ElementsAre(std::pair(0, 2), std::pair(5, 6)));
  EXPECT_THAT(StepsOf(poses, {1, DeltaUnit::kMetres}, {.delta_tolerance = 0.25, .all_pairs = true}),
              ElementsAre(std::pair(0, 2), std::pair(1, 3), std::pair(2, 3), std::pair(3, 4), std::pair(5, 6)));
}

TEST(RelativePairs, ByMetresGoneAndNotAsTheCrowFlies) {
  const std::vector<TrajectoryPose> poses = {PoseAt(0, 0, 0, 0), PoseAt(1, 1, 0, 0), PoseAt(2, 0, 0, 0),
                                             PoseAt(3, 1, 0, 0)};
  EXPECT_THAT(StepsOf(poses, {2, DeltaUnit::kMetres}, kAll), ElementsAre(std::pair(0, 2), std::pair(1, 3)));
}

TEST(RelativePairs, BySecondsAreTheNearest) {
  const std::vector<TrajectoryPose> poses = AlongX({0, 0.5, 1.0625, 2, 7, 8});
  // 1.0625 is nearest to 1, 2 to 2.0625; nothing is near 3, so it begins anew behind the gap.
  EXPECT_THAT(StepsOf(poses, {1, DeltaUnit::kSeconds}), ElementsAre(std::pair(0, 2), std::pair(2, 3), std::pair(4, 5)));
  EXPECT_THAT(StepsOf(poses, {1.5, DeltaUnit::kSeconds}, kAll), ElementsAre(std::pair(1, 3)));
}

std::vector<TrajectoryPose> Turning(const std::vector<double>& degrees) {
  std::vector<TrajectoryPose> poses;
  for (const double angle : degrees)
    poses.push_back(
        PoseAt(static_cast<double>(poses.size()), 0, 0, 0,
               Eigen::Quaterniond(Eigen::AngleAxisd(angle * std::numbers::pi / 180, Eigen::Vector3d::UnitY()))));
  return poses;
}

TEST(RelativePairs, ByDegreesTurned) {
  const std::vector<TrajectoryPose> poses = Turning({0, 20, 41, 20, -1, 10});
  EXPECT_THAT(StepsOf(poses, {40, DeltaUnit::kDegrees}), ElementsAre(std::pair(0, 2), std::pair(2, 4)));
  // Between two poses themselves, a tenth off at most.
  EXPECT_THAT(StepsOf(poses, {20, DeltaUnit::kDegrees}, kAll),
              ElementsAre(std::pair(0, 1), std::pair(0, 3), std::pair(1, 2), std::pair(1, 4), std::pair(2, 3),
                          std::pair(3, 4)));
}

TEST(RelativePairs, AllByDegreesAreRefusedWhereTheyWouldBeTooMany) {
  const std::vector<TrajectoryPose> many = Walk(4'001);
  const Error error = ErrorOf([&] { StepsOf(many, {10, DeltaUnit::kDegrees}, kAll); });
  EXPECT_EQ(error.kind(), ErrorKind::kUsage);
  EXPECT_THAT(error.problem(), HasSubstr("4,000 at most"));
  EXPECT_FALSE(StepsOf(many, {10, DeltaUnit::kDegrees}).empty());
  EXPECT_EQ(StepsOf(Walk(100'000), {1, DeltaUnit::kMetres}, kAll).size() > 90'000, true) << "and others are linear";
}

TEST(RelativePairs, DistancesMayBeThoseOfTheTruth) {
  const std::vector<TrajectoryPose> truth = AlongX({0, 1, 2, 3, 4});
  const std::vector<TrajectoryPose> half = Moved(truth, {0.5, Eigen::Quaterniond::Identity(), {0, 0, 0}});
  EvaluationOptions options{.alignment = AlignmentKind::kNone, .deltas = {{1, DeltaUnit::kMetres}}, .all_pairs = true};
  EXPECT_EQ(Evaluated(half, truth, options).relative[0].errors.at(0).to, 2U);
  options.pairs_from_reference = true;
  EXPECT_EQ(Evaluated(half, truth, options).relative[0].errors.at(0).to, 1U);
}

TEST(Deltas, AreWrittenAsTheyAreRead) {
  for (const auto& [text, written] : std::vector<std::pair<const char*, const char*>>{{"1f", "1 frame"},
                                                                                      {"10 frames", "10 frames"},
                                                                                      {"0.5m", "0.5 m"},
                                                                                      {" 2 s", "2 s"},
                                                                                      {"90deg", "90 degrees"},
                                                                                      {"90d", "90 degrees"}})
    EXPECT_EQ(ToString(ParseDelta(text)), written);
  for (const char* text : {"", "1", "m", "1 km", "-1m", "0s", "1.5f", "nan m", "inf m", "200deg", "1..2m", "m1"})
    EXPECT_EQ(ErrorOf([&] { (void)ParseDelta(text); }).kind(), ErrorKind::kUsage) << text;
}

}  // namespace
}  // namespace slamdb
