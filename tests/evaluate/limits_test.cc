// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/evaluate/limits.h"

#include <gmock/gmock.h>

#include "tests/evaluate/trajectories.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// Two of four poses of the estimate are paired, over 1 of 4 seconds; each is 0.5 off.
EvaluationReport Report() {
  std::vector<TrajectoryPose> estimate = AlongX({0, 1, 50, 51});
  for (TrajectoryPose& pose : estimate) pose.position.y() += 0.5;
  return EvaluateTrajectories({{MapId(2), estimate}}, AlongX({0, 1, 2, 3, 4}),
                              {.alignment = AlignmentKind::kNone, .deltas = {{1, DeltaUnit::kFrames}}});
}

TEST(Limits, HoldUpToThemselves) {
  EXPECT_THAT(BreachesOf(Report(), {}), IsEmpty());
  EXPECT_THAT(BreachesOf(Report(), {.max_ate_rmse = 0.5,
                                    .max_ate = 0.5,
                                    .max_rotation_rmse = 0,
                                    .max_rpe_rmse = 0,
                                    .min_paired = 50,
                                    .min_coverage = 25}),
              IsEmpty());
}

TEST(Limits, AreBrokenEachByItself) {
  EXPECT_THAT(BreachesOf(Report(), {.max_ate_rmse = 0.25}),
              ElementsAre("map 2: the absolute error of positions (rmse) is 0.5 m, above the limit of 0.25 m"));
  EXPECT_THAT(BreachesOf(Report(), {.max_ate = 0.49}), SizeIs(1));
  EXPECT_THAT(BreachesOf(Report(), {.min_paired = 51}),
              ElementsAre("map 2: the share of poses that are paired is 50%, below the limit of 51%"));
  EXPECT_THAT(BreachesOf(Report(), {.min_coverage = 25.1}), SizeIs(1));
  EvaluationReport turned = Report();
  turned.evaluations[0].absolute.rotation_degrees.rmse = 3;
  turned.evaluations[0].relative[0].translation.rmse = 1;
  EXPECT_THAT(BreachesOf(turned, {.max_rotation_rmse = 2}), SizeIs(1));
  EXPECT_THAT(BreachesOf(turned, {.max_rpe_rmse = 0.9}),
              ElementsAre("map 2: the relative error over 1 frame (rmse) is 1 m, above the limit of 0.9 m"));
}

TEST(Limits, AreBrokenByWhatWasNotMeasured) {
  EvaluationReport report = Report();
  report.evaluations[0].relative[0].translation = {};
  EXPECT_THAT(BreachesOf(report, {.max_rpe_rmse = 100}), SizeIs(1));
  report.evaluations[0].relative[0].errors.clear();
  EXPECT_THAT(BreachesOf(report, {.max_rpe_rmse = 100}),
              ElementsAre("map 2: the relative error over 1 frame has no pair of poses, and so holds no limit"));
  report.unevaluated.push_back({MapId(5), "too few pairs"});
  EXPECT_THAT(BreachesOf(report, {.max_ate_rmse = 100}),
              ElementsAre("map 5: could not be evaluated, and so holds no limit"));
  EXPECT_THAT(BreachesOf(report, {}), IsEmpty());
}

}  // namespace
}  // namespace slamdb
