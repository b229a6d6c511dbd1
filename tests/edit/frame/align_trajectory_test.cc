// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/align_trajectory.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "slamdb/base/error.h"
#include "slamdb/edit/frame/transform.h"
#include "slamdb/model/derive.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/kind_of.h"

namespace slamdb {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const Similarity3d kMove{1, Eigen::Quaterniond(0.4, 0.1, -0.8, 0.3).normalized(), {12, -3, 5}};

Map Walk(Sensor sensor, bool inertial = false) {
  SyntheticOptions options;
  options.sensor = sensor;
  options.inertial = inertial;
  options.keyframes = 20;
  options.points = 100;
  options.features = 100;
  return SynthesizeAtlas(options).maps[0];
}

std::vector<TimedPosition> PathOf(const Map& map, const Similarity3d& moved_by = {}, bool body = false) {
  std::vector<TimedPosition> path;
  for (const KeyFrame& keyframe : map.keyframes) {
    const Eigen::Vector3f center = body ? WorldFromBody(keyframe).translation : CameraCenter(keyframe);
    path.push_back({keyframe.timestamp, moved_by * center.cast<double>()});
  }
  return path;
}

void ExpectNear(const Similarity3d& actual, const Similarity3d& expected) {
  EXPECT_NEAR(actual.scale, expected.scale, 1e-5);
  EXPECT_LE(actual.rotation.angularDistance(expected.rotation), 1e-5);
  EXPECT_LE((actual.translation - expected.translation).norm(), 1e-4);
}

std::string MessageOf(const Map& map, const std::vector<TimedPosition>& reference) {
  try {
    static_cast<void>(AlignToTrajectory(map, reference, {}));
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(AlignToTrajectory, FindsTheMoveInAnyOrder) {
  const Map map = Walk(Sensor::kRgbd);
  std::vector<TimedPosition> reference = PathOf(map, kMove);
  std::ranges::reverse(reference);
  const TrajectoryAlignment alignment = AlignToTrajectory(map, reference, {});
  ExpectNear(alignment.reference_from_map, kMove);
  EXPECT_EQ(alignment.keyframes, 20U);
  EXPECT_EQ(alignment.pairs, 20U);
  EXPECT_EQ(alignment.inliers, 20U);
  EXPECT_LT(alignment.residuals.max, 1e-5);
}

TEST(AlignToTrajectory, AlignsTheBodyWhenAsked) {
  const Map map = Walk(Sensor::kStereo, true);
  const std::vector<TimedPosition> reference = PathOf(map, kMove, true);
  ExpectNear(AlignToTrajectory(map, reference, {.body = true, .fit = {.with_scale = false}}).reference_from_map, kMove);
  EXPECT_EQ(KindOf([&] { return AlignToTrajectory(Walk(Sensor::kRgbd), reference, {.body = true}); }),
            ErrorKind::kNotPossible);
  EXPECT_GT(AlignToTrajectory(map, reference, {.fit = {.with_scale = false}}).residuals.max, 1e-3);
}

// A reference at 2, 4, 6, ... s and keyframes at every second along the x axis and a hook.
TEST(AlignToTrajectory, InterpolatesSmallGapsOnly) {
  Map map;
  std::vector<TimedPosition> reference;
  for (int i = 0; i <= 10; ++i) {
    const Eigen::Vector3d position(i, i < 5 ? 0 : i - 5, 0);
    KeyFrame& keyframe = map.keyframes.emplace_back();
    keyframe.id = KeyFrameId(static_cast<std::uint64_t>(i));
    keyframe.timestamp = i;
    keyframe.camera_from_world.translation = -position.cast<float>();
    if (i % 2 == 1) reference.push_back({static_cast<double>(i), position});
  }
  TrajectoryAlignmentOptions options{.max_time_difference = 1};
  const TrajectoryAlignment near = AlignToTrajectory(map, reference, options);
  EXPECT_EQ(near.pairs, 11U);  // the ends are one second off and take what is nearest
  options.max_time_difference = 0.5;
  const TrajectoryAlignment exact = AlignToTrajectory(map, reference, options);
  EXPECT_EQ(exact.pairs, 5U);
  EXPECT_LT(exact.residuals.max, 1e-9);
}

TEST(AlignToTrajectory, TellsWhyNothingFits) {
  const Map map = Walk(Sensor::kRgbd);
  std::vector<TimedPosition> later = PathOf(map);
  for (TimedPosition& sample : later) sample.timestamp += 1000;
  EXPECT_THAT(MessageOf(map, later),
              AllOf(HasSubstr("map 0: 0 of 20 keyframes"), HasSubstr("the map covers"), HasSubstr("the reference")));
  EXPECT_THAT(MessageOf(map, {}), HasSubstr("no time at all"));
  std::vector<TimedPosition> line = PathOf(map);
  for (std::size_t i = 0; i < line.size(); ++i) line[i].position = {static_cast<double>(i), 0, 0};
  EXPECT_THAT(MessageOf(map, line), AllOf(HasSubstr("map 0"), HasSubstr("one line")));
}

// As `evaluate` has it.
TEST(AlignToTrajectory, TheMedianOfAnEvenNumberIsBetweenTheTwoMiddleOnes) {
  const Map map = Walk(Sensor::kRgbd);
  std::vector<TimedPosition> reference = PathOf(map, kMove);
  for (std::size_t i = 0; i < reference.size(); ++i)
    reference[i].position.z() += (i % 2 == 0 ? 1e-3 : -1e-3) * static_cast<double>(i);
  const TrajectoryAlignment alignment = AlignToTrajectory(map, reference, {});
  ASSERT_EQ(alignment.inliers, 20U);
  std::vector<double> residuals;
  const std::vector<TimedPosition> laid = PathOf(map, alignment.reference_from_map);
  for (std::size_t i = 0; i < laid.size(); ++i) residuals.push_back((laid[i].position - reference[i].position).norm());
  std::ranges::sort(residuals);
  ASSERT_GT(residuals[10] - residuals[9], 1e-6);
  EXPECT_NEAR(alignment.residuals.median, (residuals[9] + residuals[10]) / 2, 1e-12);
}

TEST(TrajectoryOf, IsThatOfTheOnlyMapWithKeyframes) {
  Atlas atlas;
  atlas.maps.push_back(Walk(Sensor::kRgbd));
  atlas.maps.emplace_back();  // which has none
  atlas.maps[0].keyframes[2].bad = true;
  const std::vector<TimedPosition> trajectory = TrajectoryOf(atlas);
  ASSERT_EQ(trajectory.size(), atlas.maps[0].keyframes.size() - 1);
  EXPECT_EQ(trajectory[0].timestamp, atlas.maps[0].keyframes[0].timestamp);
  EXPECT_EQ(trajectory[0].position, CameraCenter(atlas.maps[0].keyframes[0]).cast<double>());
  EXPECT_EQ(trajectory[2].timestamp, atlas.maps[0].keyframes[3].timestamp);
  atlas.maps.push_back(atlas.maps[0]);
  EXPECT_EQ(KindOf([&] { return TrajectoryOf(atlas); }), ErrorKind::kNotPossible);
  EXPECT_EQ(KindOf([] { return TrajectoryOf(Atlas()); }), ErrorKind::kNotPossible);
}

}  // namespace
}  // namespace slamdb
