// SPDX-License-Identifier: BSD-3-Clause
// Clocks that differ, fixes that are far off, and times without a position.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>

#include "slamdb/base/error.h"
#include "slamdb/edit/frame/transform_atlas.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/trajectories.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/statistics.h"
#include "slamdb/synthetic/synthesize.h"

namespace slamdb {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const Similarity3d kMove{1, Eigen::Quaterniond(0.4, 0.1, -0.8, 0.3).normalized(), {12, -3, 5}};

// A path with a speed that changes, and turns.
Eigen::Vector3d PlaceAt(double seconds) {
  return {3 * std::sin(0.7 * seconds) + 0.4 * seconds, 2 * std::cos(0.45 * seconds), 0.5 * std::sin(1.3 * seconds)};
}

// Keyframes of that path at about twice a second, from `begin` on.
Map Walk(double begin, double seconds) {
  Map map;
  map.id = MapId(0);
  std::mt19937_64 random(3);
  for (double time = 0; time < seconds; time += 0.3 + 0.01 * static_cast<double>(random() % 40)) {
    KeyFrame& keyframe = map.keyframes.emplace_back();
    keyframe.id = KeyFrameId(map.keyframes.size() - 1);
    keyframe.timestamp = begin + time;
    keyframe.camera_from_world.translation = -PlaceAt(time).cast<float>();
  }
  return map;
}

std::vector<TimedPosition> Reference(double begin, double ahead, double from, double to, double step,
                                     double noise = 0) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal(0, noise > 0 ? noise : 1);
  std::vector<TimedPosition> reference;
  for (double time = from; time < to; time += step) {
    Eigen::Vector3d place = kMove * PlaceAt(time);
    if (noise > 0) place += Eigen::Vector3d(normal(random), normal(random), normal(random));
    reference.push_back({begin + ahead + time, place});
  }
  return reference;
}

TrajectoryAlignmentOptions Estimating(bool with_scale) {
  return {.estimate_time_offset = true, .fit = {.with_scale = with_scale, .leave_out_gross = true}};
}

TEST(TimeOffset, IsFoundWithinAMillisecond) {
  constexpr double kBegin = 1.7e9;
  const Map map = Walk(kBegin, 40);
  for (const double ahead : {0.0, 0.0137, -0.25, 3600.05, -86400.123})
    for (const bool with_scale : {false, true}) {
      const auto reference = Reference(kBegin, ahead, -5, 50, 0.05);
      const TrajectoryAlignment alignment = AlignToTrajectory(map, reference, Estimating(with_scale));
      EXPECT_NEAR(alignment.time_offset, ahead, 1e-3) << ahead << with_scale;
      EXPECT_EQ(alignment.rival_time_offset, alignment.time_offset);
      EXPECT_EQ(alignment.pairs, map.keyframes.size());
      EXPECT_LE((alignment.reference_from_map.translation - kMove.translation).norm(), 1e-2);
    }
}

TEST(TimeOffset, IsFoundInNoiseAndHalfAnOverlap) {
  const Map map = Walk(1.7e9, 40);
  const auto noisy = Reference(1.7e9, 12.34, -5, 50, 0.05, 0.01);
  EXPECT_NEAR(AlignToTrajectory(map, noisy, Estimating(false)).time_offset, 12.34, 5e-3);
  const auto half = Reference(1.7e9, 12.34, 15, 60, 0.05);
  EXPECT_NEAR(AlignToTrajectory(map, half, Estimating(false)).time_offset, 12.34, 5e-3);
}

TEST(TimeOffset, IsFoundOfFixesOnceASecond) {
  const Map map = Walk(1.7e9, 60);
  TrajectoryAlignmentOptions options = Estimating(false);
  options.max_time_difference = 1;
  EXPECT_NEAR(AlignToTrajectory(map, Reference(1.7e9, -17.5, -20, 90, 1), options).time_offset, -17.5, 0.1);
}

TEST(TimeOffset, IsAddedWhenGiven) {
  const Map map = Walk(1.7e9, 20);
  const auto reference = Reference(1.7e9, 3600.05, 0, 20, 0.05);
  const TrajectoryAlignment alignment = AlignToTrajectory(map, reference, {.time_offset = 3600.05});
  EXPECT_EQ(alignment.pairs, map.keyframes.size());
  EXPECT_LT(alignment.residuals.max, 0.1);  // of the nearest samples
}

TEST(TimeOffset, ThatWouldOverlapIsNamed) {
  const Map map = Walk(1.7e9, 20);
  try {
    static_cast<void>(AlignToTrajectory(map, Reference(1.7e9, 3600.05, 0, 20, 0.05), {}));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("the map covers 1700000000.000 to"), HasSubstr("the reference 1700003600.050 to"),
                      HasSubstr("ahead by 3600.050 s"), HasSubstr("FitOptions::time_offset")));
  }
}

TEST(GrossOutliers, AreLeftOutAndNamed) {
  Atlas atlas;
  atlas.maps.push_back(Walk(1.7e9, 20));
  auto reference = Reference(1.7e9, 0, 0, 20, 0.01, 0.01);
  TransformOptions options{.to = OntoTrajectory{reference, {}}};
  Atlas clean = atlas;
  const TransformReport without = TransformAtlas(clean, options);
  EXPECT_TRUE(without.maps[0].alignment->outliers.empty());
  for (TimedPosition& sample : reference)
    if (std::abs(sample.timestamp - atlas.maps[0].keyframes[4].timestamp) < 0.05) sample.position.x() += 9e5;
  options.to = OntoTrajectory{reference, {}};
  Atlas spoiled = atlas;
  const TransformReport report = TransformAtlas(spoiled, options);
  ASSERT_EQ(report.maps[0].alignment->outliers.size(), 1U);
  EXPECT_EQ(report.maps[0].alignment->outliers[0].timestamp, atlas.maps[0].keyframes[4].timestamp);
  ASSERT_EQ(report.maps[0].warnings.size(), 1U);
  EXPECT_THAT(report.maps[0].warnings[0],
              AllOf(HasSubstr("1 pair of"), HasSubstr("900000"), HasSubstr("gross outliers")));
  EXPECT_LE((report.maps[0].target_from_source.translation - without.maps[0].target_from_source.translation).norm(),
            0.05);
  // All pairs count where the owner says so.
  options.to = OntoTrajectory{reference, {.outlier_distance = INFINITY}};
  Atlas carried = atlas;
  EXPECT_EQ(TransformAtlas(carried, options).maps[0].alignment->inliers, atlas.maps[0].keyframes.size());
}

TEST(GrossOutliers, OfFixesDoNotMoveTheOrigin) {
  Atlas atlas;
  atlas.maps.push_back(Walk(1.7e9, 20));
  const LocalFrame frame({47, 8, 400});
  std::vector<GpsFix> fixes;
  for (const TimedPosition& sample : Reference(1.7e9, 0, 0, 20, 0.1))
    fixes.push_back({sample.timestamp, frame.ToGeodetic(sample.position)});
  fixes.front().place = {40, 8, 400};
  const TransformReport report = TransformAtlas(atlas, {.to = OntoEarth{.fixes = fixes}});
  EXPECT_NEAR(report.origin->latitude, 47, 0.01);
}

TEST(TimesWithoutAPosition, ArePairedWithNothing) {
  const Map map = Walk(1.7e9, 20);
  auto reference = Reference(1.7e9, 0, 0, 20, 0.01);
  for (TimedPosition& sample : reference)
    if (std::abs(sample.timestamp - map.keyframes[4].timestamp) < 0.02) sample.position.setConstant(NAN);
  const TrajectoryAlignment alignment = AlignToTrajectory(map, reference, {.max_time_difference = 1});
  EXPECT_EQ(alignment.pairs, map.keyframes.size() - 1);
}

TEST(Umeyama, LeavesSoundPairsAlone) {
  const Map map = Walk(1.7e9, 30);
  const auto reference = Reference(1.7e9, 0, 0, 30, 0.01, 0.02);
  const auto plain = AlignToTrajectory(map, reference, {});
  const auto robust = AlignToTrajectory(map, reference, {.fit = {.leave_out_gross = true}});
  EXPECT_EQ(robust.inliers, plain.inliers);
  EXPECT_EQ(robust.residuals.rmse, plain.residuals.rmse);
}

// Real maps and their ground truth, by another clock. An error of the map looks like an offset: a map that is exact to
// millimetres tells milliseconds.
struct Session {
  const char* name;
  double tolerance;  // seconds
};
void PrintTo(const Session& session, std::ostream* out) { *out << session.name; }
class RealOffset : public ::testing::TestWithParam<Session> {};
INSTANTIATE_TEST_SUITE_P(Maps, RealOffset,
                         ::testing::Values(Session{"stereo_inertial", 2e-3}, Session{"mono_dist", 5e-3},
                                           Session{"race_mono", 5e-3}, Session{"session_b", 1e-2},
                                           Session{"mono_small", 1e-2}, Session{"session_a", 1e-2},
                                           Session{"fisheye_stereo", 2e-2}, Session{"session_small_a", 3e-2}),
                         [](const auto& session) { return std::string(session.param.name); });

TEST_P(RealOffset, IsFoundWithinMilliseconds) {
  const char *atlases = std::getenv("SLAMDB_ATLASES"), *meaning = std::getenv("SLAMDB_MEANING");
  if (atlases == nullptr || meaning == nullptr) GTEST_SKIP() << "set SLAMDB_ATLASES and SLAMDB_MEANING";
  const std::string name = GetParam().name;
  const Atlas atlas = ReadAtlas(std::string(atlases) + "/" + name + ".osa");
  const auto truth = std::filesystem::path(meaning).parent_path() / "ground_truth" / (name + "_frames.txt");
  std::vector<TimedPosition> reference;
  for (const TrajectoryPose& pose : ReadTrajectory(truth.string()))
    reference.push_back({pose.timestamp + 1234.5678, pose.position});
  const TrajectoryAlignment alignment =
      AlignToTrajectory(atlas.maps[0], reference, Estimating(!IsMetric(atlas.maps[0])));
  EXPECT_NEAR(alignment.time_offset, 1234.5678, GetParam().tolerance);
  EXPECT_EQ(alignment.rival_time_offset, alignment.time_offset);
}

}  // namespace
}  // namespace slamdb
