// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/optimize_joined.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "slamdb/base/error.h"
#include "slamdb/checks/check.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/statistics.h"
#include "slamdb/model/umeyama.h"
#include "tests/align/trial.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/kind_of.h"

namespace slamdb::testing {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

std::set<std::string> Troubles(const Atlas& atlas) {
  std::set<std::string> troubles;
  for (const RuleResult& result : CheckAtlas(atlas, {}).results)
    if (result.severity != Severity::kNote) troubles.insert(result.id);
  return troubles;
}

// Where cameras of the room are, by id.
std::map<KeyFrameId, Eigen::Vector3d> Places(const SyntheticSessions& sessions) {
  std::map<KeyFrameId, Eigen::Vector3d> places;
  for (std::size_t map = 0; map < sessions.atlas.maps.size(); ++map)
    for (const KeyFrame& keyframe : sessions.atlas.maps[map].keyframes)
      places[keyframe.id] = sessions.room_from_map[map] * CameraCenter(keyframe).cast<double>();
  return places;
}

double ErrorOf(const Map& map, const std::map<KeyFrameId, Eigen::Vector3d>& places) {
  std::vector<Eigen::Vector3d> is, should;
  for (const KeyFrame& keyframe : map.keyframes) {
    is.emplace_back(CameraCenter(keyframe).cast<double>());
    should.push_back(places.at(keyframe.id));
  }
  return SolveUmeyama(is, should, {.with_scale = !IsMetric(map)}).rms;
}

// How many points keyframes of both sessions see.
std::size_t SeenByBoth(const Map& map, const std::vector<KeyFrameId>& first) {
  return static_cast<std::size_t>(std::ranges::count_if(map.points, [&](const MapPoint& point) {
    const auto of_first = std::ranges::count_if(point.observations, [&](const Observation& seen) {
      return std::ranges::find(first, seen.keyframe) != first.end();
    });
    return of_first > 0 && of_first < std::ssize(point.observations);
  }));
}

class OptimizeJoinedTest : public ::testing::TestWithParam<std::pair<Sensor, bool>> {
 protected:
  void SetUp() override {
    if (!CanOptimize()) GTEST_SKIP() << "needs Ceres";
  }

  // Two sessions that lie where they should, joined.
  void Join(Sensor sensor, bool inertial) {
    SyntheticOptions options = PairOfSessions(sensor, inertial, 0.5, 7);
    options.pixel_noise = options.outliers = 0;
    const SyntheticSessions sessions = SynthesizeSessions(options);
    places_ = Places(sessions);
    atlas_ = sessions.atlas;
    joined_ = JoinAlignedMaps(atlas_);
    ASSERT_THAT(joined_.joins, SizeIs(1));
  }

  Atlas atlas_;
  JoinAlignedReport joined_;
  std::map<KeyFrameId, Eigen::Vector3d> places_;
};
INSTANTIATE_TEST_SUITE_P(Sensors, OptimizeJoinedTest,
                         ::testing::Values(std::pair{Sensor::kMonocular, false}, std::pair{Sensor::kRgbd, false},
                                           std::pair{Sensor::kFisheyeStereo, false}));

TEST_P(OptimizeJoinedTest, FindsPointsOfEachSessionInPicturesOfTheOther) {
  Join(GetParam().first, GetParam().second);
  const std::size_t before = SeenByBoth(atlas_.maps[0], joined_.keyframes[0]);
  const auto rounds = OptimizeJoined(atlas_, joined_, {.method = OptimizeMethod::kPoseGraph});
  ASSERT_THAT(rounds, SizeIs(1));
  EXPECT_GT(rounds[0].observations + rounds[0].fused.fused, 0U);
  EXPECT_GE(SeenByBoth(atlas_.maps[0], joined_.keyframes[0]), before);
  EXPECT_TRUE(rounds[0].optimization.pose_graph);
  EXPECT_FALSE(rounds[0].optimization.bundle);
  EXPECT_THAT(Troubles(atlas_), IsEmpty());
}

TEST_P(OptimizeJoinedTest, EveryMethodKeepsTheMapSoundAndWhereItShouldLie) {
  Join(GetParam().first, GetParam().second);
  const double before = ErrorOf(atlas_.maps[0], places_);
  for (const OptimizeMethod method : {OptimizeMethod::kSeam, OptimizeMethod::kFull}) {
    Atlas atlas = atlas_;
    const auto rounds = OptimizeJoined(atlas, joined_, {.method = method});
    ASSERT_THAT(rounds, SizeIs(method == OptimizeMethod::kFull ? 2 : 1));
    for (const OptimizedJoin& round : rounds) {
      EXPECT_EQ(round.optimization.map, atlas.maps[0].id);
      ASSERT_TRUE(round.optimization.bundle);
      EXPECT_LE(round.optimization.bundle->cost_after, round.optimization.bundle->cost_before);
    }
    EXPECT_LT(ErrorOf(atlas.maps[0], places_), before + 0.002);
    EXPECT_THAT(Troubles(atlas), IsEmpty()) << NameOf(method);
  }
}

TEST_P(OptimizeJoinedTest, IsTheSameForAnyNumberOfThreads) {
  Join(GetParam().first, GetParam().second);
  Atlas other = atlas_;
  OptimizeJoined(atlas_, joined_, {.threads = 1});
  OptimizeJoined(other, joined_, {.threads = 4});
  EXPECT_THAT(atlas_, EqualsAtlas(other));
}

using OptimizeJoined_ = OptimizeJoinedTest;

TEST_F(OptimizeJoined_, LeavesWhatWasNotJoined) {
  const SyntheticSessions sessions = SynthesizeSessions(PairOfSessions(Sensor::kRgbd, false, 0, 7));
  Atlas atlas = sessions.atlas;
  const JoinAlignedReport joined = JoinAlignedMaps(atlas);
  EXPECT_THAT(OptimizeJoined(atlas, joined), IsEmpty());
  EXPECT_THAT(atlas, EqualsAtlas(sessions.atlas));
}

TEST(OptimizeJoinedWithoutCeres, SaysWhatIsMissing) {
  if (CanOptimize()) GTEST_SKIP() << "Ceres is there";
  SyntheticSessions sessions = SynthesizeSessions(PairOfSessions(Sensor::kRgbd, false, 0.5, 7));
  const JoinAlignedReport joined = JoinAlignedMaps(sessions.atlas);
  EXPECT_EQ(KindOf([&] { OptimizeJoined(sessions.atlas, joined); }), ErrorKind::kUnsupported);
}

}  // namespace
}  // namespace slamdb::testing
