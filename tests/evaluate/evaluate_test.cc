// SPDX-License-Identifier: BSD-3-Clause
// Figures that are worked out by hand, and inputs that are odd.
#include "slamdb/evaluate/evaluate.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "slamdb/base/error.h"
#include "tests/evaluate/trajectories.h"
#include "tests/support/error_of.h"

namespace slamdb {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Eigen::Quaterniond QuarterTurn() {
  return Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()));
}

// Two steps along x and one along y. The second pose is 0.3 and 0.4 off, the last one 1.2 off and a quarter turn.
const std::vector<TrajectoryPose> kTruth = {PoseAt(0, 0, 0, 0), PoseAt(1, 1, 0, 0), PoseAt(2, 2, 0, 0),
                                            PoseAt(3, 2, 1, 0)};
const std::vector<TrajectoryPose> kEstimate = {PoseAt(0, 0, 0, 0), PoseAt(1, 1, 0.3, 0.4), PoseAt(2, 2, 0, 0),
                                               PoseAt(3, 2, 1, 1.2, QuarterTurn())};

TEST(Evaluate, AbsoluteErrors) {
  const TrajectoryEvaluation evaluation = Evaluated(kEstimate, kTruth, {.alignment = AlignmentKind::kNone});
  const AbsoluteErrors& absolute = evaluation.absolute;
  EXPECT_DOUBLE_EQ(absolute.translation.rmse, 0.65);  // sqrt((0.5^2 + 1.2^2) / 4)
  EXPECT_DOUBLE_EQ(absolute.translation.median, 0.25);
  EXPECT_DOUBLE_EQ(absolute.rotation_degrees.max, 90);
  EXPECT_DOUBLE_EQ(absolute.rotation_degrees.rmse, 45);                     // sqrt(90^2 / 4)
  EXPECT_DOUBLE_EQ(absolute.rotation_part.max, 2);                          // |(-1 -1, 1 -1)|: four entries of one
  EXPECT_DOUBLE_EQ(absolute.full_transformation.max, std::sqrt(4 + 1.44));  // that, and 1.2
  EXPECT_DOUBLE_EQ(absolute.full_transformation.sse, 4 + 1.69);
  ASSERT_EQ(evaluation.poses.size(), 4U);
  EXPECT_DOUBLE_EQ(evaluation.poses[1].translation_error, 0.5);
  EXPECT_DOUBLE_EQ(evaluation.poses[3].rotation_error_degrees, 90);
}

TEST(Evaluate, RelativeErrorsOverFrames) {
  const TrajectoryEvaluation evaluation =
      Evaluated(kEstimate, kTruth, {.alignment = AlignmentKind::kNone, .deltas = {{1, DeltaUnit::kFrames}}});
  const RelativeErrors& relative = evaluation.relative.at(0);
  // Moves of the estimate less those of the truth: (0, 0.3, 0.4), (0, -0.3, -0.4), (0, 0, 1.2).
  ASSERT_EQ(relative.errors.size(), 3U);
  EXPECT_DOUBLE_EQ(relative.errors[0].translation, 0.5);
  EXPECT_DOUBLE_EQ(relative.errors[1].translation, 0.5);
  EXPECT_DOUBLE_EQ(relative.errors[2].translation, 1.2);
  EXPECT_DOUBLE_EQ(relative.rotation_degrees.sse, 8100);
  // The estimate went sqrt(1.25) where the truth went 1, twice, and then sqrt(1 + 1.44).
  EXPECT_DOUBLE_EQ(relative.point_distance.min, std::sqrt(1.25) - 1);
  EXPECT_DOUBLE_EQ(relative.point_distance.max, std::sqrt(2.44) - 1);
  EXPECT_DOUBLE_EQ(relative.point_distance_ratio.max, 100 * (std::sqrt(2.44) - 1));
}

// A turn before a move bends the move: what counts is the motion in the frame of the earlier pose.
TEST(Evaluate, RelativeErrorsAreInTheFrameOfThePose) {
  const std::vector<TrajectoryPose> truth = {PoseAt(0, 0, 0, 0), PoseAt(1, 1, 0, 0)};
  const std::vector<TrajectoryPose> estimate = {PoseAt(0, 5, 5, 5, QuarterTurn()), PoseAt(1, 5, 6, 5, QuarterTurn())};
  const TrajectoryEvaluation evaluation =
      Evaluated(estimate, truth, {.alignment = AlignmentKind::kNone, .deltas = {{1, DeltaUnit::kFrames}}});
  EXPECT_NEAR(evaluation.relative.at(0).translation.max, 0, 1e-15);
  EXPECT_NEAR(evaluation.relative.at(0).rotation_degrees.max, 0, 1e-6);
}

TEST(Evaluate, AlignsASquareThatIsTooLarge) {
  // Corners at 1 and at 1.2 from the middle in x and y; the best rigid fit leaves them where they are.
  std::vector<TrajectoryPose> truth, estimate;
  for (const auto& [x, y] : {std::pair{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}) {
    const auto time = static_cast<double>(truth.size());
    truth.push_back(PoseAt(time, 10 + x, y, 3));
    estimate.push_back(PoseAt(time, 1.2 * y, -1.2 * x, 0, QuarterTurn().conjugate()));  // a quarter turn, and moved
  }
  const auto rmse = [&](AlignmentKind kind) {
    return Evaluated(estimate, truth, {.alignment = kind}).absolute.translation.rmse;
  };
  EXPECT_NEAR(rmse(AlignmentKind::kSe3), 0.2 * std::numbers::sqrt2, 1e-12);
  EXPECT_NEAR(rmse(AlignmentKind::kSim3), 0, 1e-12);
  const TrajectoryEvaluation sim3 = Evaluated(estimate, truth, {.alignment = AlignmentKind::kSim3});
  EXPECT_NEAR(sim3.alignment.reference_from_estimate.scale, 1 / 1.2, 1e-12);
  EXPECT_NEAR(sim3.absolute.rotation_degrees.max, 0, 1e-6);
  // Only scaled the corners are at 1 from the origin, and those of the truth at (10, 0, 3) from it.
  const TrajectoryEvaluation scale = Evaluated(estimate, truth, {.alignment = AlignmentKind::kScale});
  EXPECT_NEAR(scale.alignment.reference_from_estimate.scale, 1 / 1.2, 1e-12);
  EXPECT_NEAR(scale.poses[0].position.x(), 1, 1e-12);
  // The first corner onto the first: the second is 2.4 away from it in the truth's x, where 2 are right.
  const TrajectoryEvaluation origin = Evaluated(estimate, truth, {.alignment = AlignmentKind::kOrigin});
  EXPECT_NEAR(origin.poses[0].translation_error, 0, 1e-12);
  EXPECT_NEAR(origin.poses[1].translation_error, 0.4, 1e-12);
  EXPECT_NEAR(origin.poses[2].translation_error, 0.4 * std::numbers::sqrt2, 1e-12);
}

TEST(Evaluate, AlignsByTheFirstPairsOnly) {
  std::vector<TrajectoryPose> estimate = kTruth;
  estimate.push_back(PoseAt(4, 9, 9, 9));
  std::vector<TrajectoryPose> truth = kTruth;
  truth.push_back(PoseAt(4, 9, 9, 8));
  const TrajectoryEvaluation evaluation = Evaluated(estimate, truth, {.align_first = 4});
  EXPECT_EQ(evaluation.alignment.pairs, 4U);
  EXPECT_NEAR(evaluation.absolute.translation.max, 1, 1e-12);
  EXPECT_GT(Evaluated(estimate, truth).poses[0].translation_error, 0.05) << "the last one pulls";
}

TEST(Evaluate, OpenScaleIsSolvedForByDefault) {
  const auto kind = [](bool open_scale) {
    return EvaluateTrajectory({.map = {}, .poses = kTruth, .open_scale = open_scale}, kTruth).alignment.kind;
  };
  EXPECT_EQ(kind(true), AlignmentKind::kSim3);
  EXPECT_EQ(kind(false), AlignmentKind::kSe3);
}

// ---- degenerate and hostile

TEST(Evaluate, OfALineTheDistancesHoldAndAWarningTellsOfTheRotation) {
  const std::vector<TrajectoryPose> truth = AlongX({0, 1, 2, 3, 4});
  std::vector<TrajectoryPose> estimate = Moved(truth, {1, QuarterTurn(), {1, 2, 3}});
  const TrajectoryEvaluation evaluation = Evaluated(estimate, truth);
  EXPECT_TRUE(evaluation.alignment.on_line);
  EXPECT_NEAR(evaluation.absolute.translation.max, 0, 1e-12);
  EXPECT_THAT(evaluation.warnings, Contains(HasSubstr("on one line")));
  EXPECT_FALSE(Evaluated(estimate, truth, {.alignment = AlignmentKind::kOrigin}).alignment.on_line);
}

TEST(Evaluate, StandingStillTellsNoRotation) {
  const std::vector<TrajectoryPose> still = {PoseAt(0, 0.1, 0.2, 0.3), PoseAt(1, 0.1, 0.2, 0.3),
                                             PoseAt(2, 0.1, 0.2, 0.3), PoseAt(3, 0.1, 0.2, 0.3)};
  for (const AlignmentKind kind : {AlignmentKind::kSe3, AlignmentKind::kSim3, AlignmentKind::kScale})
    for (const bool swapped : {false, true}) {
      const Error error =
          ErrorOf([&] { (void)Evaluated(swapped ? kTruth : still, swapped ? still : kTruth, {.alignment = kind}); });
      EXPECT_EQ(error.kind(), ErrorKind::kNotPossible);
      EXPECT_THAT(error.problem(), AllOf(HasSubstr("in one place"), HasSubstr("can be origin or none")));
    }
  EXPECT_EQ(Evaluated(still, kTruth, {.alignment = AlignmentKind::kOrigin}).absolute.translation.min, 0);
}

TEST(Evaluate, TooFewPairsNameBothSpansAndTheOffset) {
  std::vector<TrajectoryPose> later = kTruth;
  for (TrajectoryPose& pose : later) pose.timestamp += 1000.5;
  const Error error = ErrorOf([&] { (void)Evaluated(kTruth, later); });
  EXPECT_EQ(error.kind(), ErrorKind::kNotPossible);
  EXPECT_THAT(error.problem(),
              AllOf(HasSubstr("0 of 4 poses have a pose of the truth"), HasSubstr("0.000 to 3.000 s"),
                    HasSubstr("1000.500 to 1003.500 s"), HasSubstr("ahead by 1000.500 s"),
                    HasSubstr("EvaluationOptions::time_offset"), HasSubstr("EvaluationOptions::by_index")));
  EXPECT_EQ(Evaluated(kTruth, later, {.time_offset = 1000.5}).absolute.translation.count, 4U);
  EXPECT_EQ(Evaluated(kTruth, later, {.by_index = true}).absolute.translation.count, 4U);
}

TEST(Evaluate, TwoPairsDoForNoAlignment) {
  const std::vector<TrajectoryPose> two(kTruth.begin(), kTruth.begin() + 2);
  EXPECT_EQ(ErrorOf([&] { (void)Evaluated(two, kTruth); }).kind(), ErrorKind::kNotPossible);
  EXPECT_EQ(Evaluated(two, kTruth, {.alignment = AlignmentKind::kNone}).absolute.translation.count, 2U);
  EXPECT_EQ(ErrorOf([&] { (void)Evaluated({}, kTruth, {.alignment = AlignmentKind::kNone}); }).kind(),
            ErrorKind::kNotPossible);
  EXPECT_EQ(ErrorOf([&] { (void)Evaluated(kTruth, {}, {.alignment = AlignmentKind::kOrigin}); }).kind(),
            ErrorKind::kNotPossible);
}

TEST(Evaluate, PosesThatAreNotFiniteAreLeftOutAndCounted) {
  std::vector<TrajectoryPose> estimate = kTruth;
  estimate.push_back(PoseAt(kNan, 0, 0, 0));
  estimate.push_back(PoseAt(3.001, kNan, 0, 0));
  estimate.push_back(PoseAt(3.002, 0, 0, 0, Eigen::Quaterniond(0, 0, 0, 0)));
  const TrajectoryEvaluation evaluation = Evaluated(estimate, kTruth);
  EXPECT_EQ(evaluation.coverage.estimate_poses, 4U);
  EXPECT_NEAR(evaluation.absolute.translation.max, 0, 1e-12);
  EXPECT_THAT(evaluation.warnings, Contains(HasSubstr("3 poses of the estimate left out")));
}

TEST(Evaluate, ScaledQuaternionsAreRotations) {
  std::vector<TrajectoryPose> estimate = kTruth;
  for (TrajectoryPose& pose : estimate) pose.rotation.coeffs() *= -7;
  EXPECT_NEAR(Evaluated(estimate, kTruth).absolute.rotation_degrees.max, 0, 1e-6);
}

TEST(Evaluate, AnOpenScaleThatIsNotSolvedForIsTold) {
  const TrajectoryEvaluation evaluation =
      Evaluated(Moved(kTruth, {0.25, Eigen::Quaterniond::Identity(), {0, 0, 0}}), kTruth);
  EXPECT_THAT(evaluation.warnings, Contains(AllOf(HasSubstr("4 times as far"), HasSubstr("sim3"))));
  EXPECT_THAT(Evaluated(kTruth, kTruth).warnings, Contains(HasSubstr("frame numbers")));  // 0, 1, 2, 3
}

TEST(Evaluate, OptionsThatMakeNoSenseAreRefused) {
  const auto kind = [](const EvaluationOptions& options) {
    return ErrorOf([&] { (void)Evaluated(kEstimate, kTruth, options); }).kind();
  };
  EXPECT_EQ(kind({.max_time_difference = -1}), ErrorKind::kUsage);
  EXPECT_EQ(kind({.max_time_difference = kNan}), ErrorKind::kUsage);
  EXPECT_EQ(kind({.time_offset = kNan}), ErrorKind::kUsage);
  EXPECT_EQ(kind({.delta_tolerance = -0.1}), ErrorKind::kUsage);
  for (const Delta& delta :
       {Delta{0, DeltaUnit::kMetres}, Delta{-1, DeltaUnit::kSeconds}, Delta{kNan, DeltaUnit::kMetres},
        Delta{1.5, DeltaUnit::kFrames}, Delta{1e300, DeltaUnit::kFrames}, Delta{181, DeltaUnit::kDegrees}})
    EXPECT_EQ(kind({.deltas = {delta}}), ErrorKind::kUsage) << ToString(delta);
}

// ---- several trajectories

TEST(Evaluate, EachMapIsAlignedByItselfOrAllAreOne) {
  const std::vector<TrajectoryPose> truth = Walk(200);
  const std::vector<TrajectoryPose> first(truth.begin(), truth.begin() + 80), second(truth.begin() + 120, truth.end());
  const Similarity3d elsewhere{1, QuarterTurn(), {3, 2, 1}};
  const std::vector<Estimate> maps = {{MapId(4), first}, {MapId(7), Moved(second, elsewhere)}};
  const EvaluationReport report = EvaluateTrajectories(maps, truth);
  ASSERT_EQ(report.evaluations.size(), 2U);
  EXPECT_THAT(report.evaluations[1].maps, ElementsAre(MapId(7)));
  EXPECT_NEAR(report.evaluations[0].absolute.translation.max, 0, 1e-12);
  EXPECT_NEAR(report.evaluations[1].absolute.translation.max, 0, 1e-12);
  const EvaluationReport joint = EvaluateTrajectories(maps, truth, {.joint = true});
  ASSERT_EQ(joint.evaluations.size(), 1U);
  EXPECT_THAT(joint.evaluations[0].maps, ElementsAre(MapId(4), MapId(7)));
  EXPECT_GT(joint.evaluations[0].absolute.translation.rmse, 0.5) << "they are not in one frame";
  EXPECT_NEAR(EvaluateTrajectories({{MapId(4), first}, {MapId(7), second}}, truth, {.joint = true})
                  .evaluations[0]
                  .absolute.translation.max,
              0, 1e-12);
}

TEST(Evaluate, AMapWithoutPairsIsNamedAndTheOthersGoOn) {
  const std::vector<TrajectoryPose> truth = Walk(50);
  const EvaluationReport report =
      EvaluateTrajectories({{MapId(0), truth}, {MapId(1), AlongX({5000, 5001, 5002})}}, truth);
  EXPECT_EQ(report.evaluations.size(), 1U);
  ASSERT_EQ(report.unevaluated.size(), 1U);
  EXPECT_EQ(report.unevaluated[0].map, MapId(1));
  const Error none = ErrorOf([&] { (void)EvaluateTrajectories({{MapId(0), {}}, {MapId(1), AlongX({5000})}}, truth); });
  EXPECT_EQ(none.kind(), ErrorKind::kNotPossible);
  EXPECT_THAT(none.problem(), HasSubstr("none of 2 maps"));
  EXPECT_EQ(ErrorOf([&] { (void)EvaluateTrajectories({}, truth); }).kind(), ErrorKind::kNotPossible);
}

// ---- reports

TEST(EvaluateReports, JsonHasNullForWhatIsNone) {
  const EvaluationReport report = EvaluateTrajectories(
      {{MapId(), kEstimate}}, kTruth, {.alignment = AlignmentKind::kNone, .deltas = {{500, DeltaUnit::kMetres}}});
  const auto json = nlohmann::json::parse(ToJson(report, {.input = "a.txt", .breaches = {"too far"}}));
  const auto& evaluation = json["evaluations"][0];
  EXPECT_EQ(json["input"], "a.txt");
  EXPECT_TRUE(json["reference"].is_null());
  EXPECT_EQ(json["breaches"][0], "too far");
  EXPECT_TRUE(evaluation["maps"].empty());
  EXPECT_DOUBLE_EQ(evaluation["absolute"]["translation"]["rmse"], 0.65);
  EXPECT_EQ(evaluation["relative"][0]["translation"]["count"], 0);
  EXPECT_TRUE(evaluation["relative"][0]["translation"]["rmse"].is_null());
  EXPECT_FALSE(evaluation.contains("poses"));
  EXPECT_EQ(nlohmann::json::parse(ToJson(report, {.with_errors = true}))["evaluations"][0]["poses"].size(), 4U);
}

TEST(EvaluateReports, TablesHaveARowForEachPair) {
  const EvaluationReport report =
      EvaluateTrajectories({{MapId(3), kEstimate}}, kTruth, {.alignment = AlignmentKind::kNone});
  EXPECT_THAT(ErrorTable(report), HasSubstr("\n3,1,0.5,0,1,0.3,0.4,0,0,0,1,1,1,0,0,0,0,0,1\n"));
  EXPECT_THAT(AlignedTrajectory(report), HasSubstr("\n1 1 0.3 0.4 0 0 0 1\n"));
  EXPECT_THAT(AlignedTrajectory(report), ::testing::Not(HasSubstr("# map")));
}

}  // namespace
}  // namespace slamdb
