// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/loops.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>
#include <set>

#include "slamdb/base/error.h"
#include "tests/align/bent.h"

namespace slamdb::testing {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::Field;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr Bend kBend = {.radians = 0.1, .shift = 0.4};
constexpr KeyFrameId kSecondRound(40);  // of 80 keyframes

std::vector<Loop> Missed(const LoopSearch& search) {
  std::vector<Loop> missed;
  std::ranges::copy_if(search.loops, std::back_inserter(missed),
                       [](const Loop& loop) { return loop.verdict == LoopVerdict::kMissed; });
  return missed;
}

class FindLoopsOf : public ::testing::TestWithParam<Sensor> {};
INSTANTIATE_TEST_SUITE_P(All, FindLoopsOf,
                         ::testing::Values(Sensor::kMonocular, Sensor::kStereo, Sensor::kRgbd, Sensor::kFisheyeStereo));

TEST_P(FindLoopsOf, FindsThatTheSecondRoundIsTheFirst) {
  const Atlas atlas = MakeMissedLoop(GetParam(), kBend);
  const LoopSearch search = FindLoops({&atlas, 0});
  const std::vector<Loop> missed = Missed(search);
  ASSERT_THAT(missed, Not(IsEmpty()));
  EXPECT_THAT(search.loops, Each(Field(&Loop::verdict, Not(LoopVerdict::kClosed))));
  for (const Loop& loop : missed)
    for (const AlignedPair& pair : loop.pairs) {
      EXPECT_LT(pair.first, kSecondRound);
      EXPECT_GE(pair.second, kSecondRound);
    }
}

// What is measured between two keyframes is how they truly lie, whatever the map says.
TEST_P(FindLoopsOf, MeasuresHowKeyframesTrulyLie) {
  const Atlas truth = MakeTwoRounds(GetParam()), atlas = MakeMissedLoop(GetParam(), kBend);
  const Map& map = truth.maps[0];
  const IdTable rows = KeyFrameTable(map);
  const auto true_pose = [&](KeyFrameId id) {
    const Rigid3f pose = map.keyframes[rows.Find(id.value())].camera_from_world.Normalized();
    return Similarity3d{1, pose.rotation.cast<double>(), pose.translation.cast<double>()};
  };
  const std::vector<Loop> missed = Missed(FindLoops({&atlas, 0}));
  for (const Loop& loop : missed) {
    const AlignedPair& best = loop.pairs.front();
    const Similarity3d should = true_pose(best.first) * true_pose(best.second).Inverse();
    EXPECT_LT((best.first_from_second.translation - should.translation).norm(), 0.15);
    EXPECT_LT(best.first_from_second.rotation.angularDistance(should.rotation), 0.03);
  }
}

TEST_P(FindLoopsOf, SaysThatAMapWhichLiesRightNeedsNoClosing) {
  const Atlas atlas = MakeMissedLoop(GetParam(), {});
  const LoopSearch search = FindLoops({&atlas, 0});
  ASSERT_THAT(search.loops, Not(IsEmpty()));
  EXPECT_THAT(search.loops, Each(Field(&Loop::verdict, LoopVerdict::kClosed)));
}

TEST(FindLoops, FindsNothingWhereTheCameraIsNowhereTwice) {
  const Atlas atlas = SynthesizeAtlas({.keyframes = 40, .points = 1200, .features = 300, .loops = false});
  EXPECT_THAT(FindLoops({&atlas, 0}).loops, IsEmpty());
}

TEST(FindLoops, TellsTheDriftOfTheScale) {
  const Atlas atlas = MakeMissedLoop(Sensor::kMonocular, {.scale = 0.9});
  const std::vector<Loop> missed = Missed(FindLoops({&atlas, 0}));
  ASSERT_THAT(missed, Not(IsEmpty()));
  // A round is half the way: the later end is smaller by the root of 0.9.
  for (const Loop& loop : missed) EXPECT_NEAR(loop.gap.scale, 1 / std::sqrt(0.9), 0.03);
}

TEST(FindLoops, IsTheSameForAnyNumberOfThreads) {
  const Atlas atlas = MakeMissedLoop(Sensor::kRgbd, kBend);
  const LoopSearch one = FindLoops({&atlas, 0}, {.threads = 1}), four = FindLoops({&atlas, 0}, {.threads = 4});
  ASSERT_EQ(one.loops.size(), four.loops.size());
  for (std::size_t i = 0; i < one.loops.size(); ++i) {
    EXPECT_EQ(one.loops[i].verdict, four.loops[i].verdict);
    EXPECT_EQ(one.loops[i].gap.translation, four.loops[i].gap.translation);
    EXPECT_EQ(one.loops[i].matches.size(), four.loops[i].matches.size());
    EXPECT_EQ(one.loops[i].evidence.found_share, four.loops[i].evidence.found_share);
  }
}

// No point is matched with itself: neighbours of both ends see some in common.
TEST_P(FindLoopsOf, MatchesDifferentPoints) {
  const Atlas atlas = MakeMissedLoop(GetParam(), kBend);
  for (const Loop& loop : FindLoops({&atlas, 0}).loops)
    for (const MatchedPoints& match : loop.matches) EXPECT_NE(match.first, match.second);
}

TEST(FindLoops, StandsFilesThatLie) {
  Atlas atlas = MakeMissedLoop(Sensor::kRgbd, kBend);
  Map& map = atlas.maps[0];
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  map.keyframes[3].camera_from_world.translation.x() = kNan;
  map.keyframes[5].timestamp = std::numeric_limits<double>::quiet_NaN();
  map.keyframes[50].camera = CameraId(99);
  map.points[7].position.z() = kNan;
  map.points[9].observations.front().keyframe = KeyFrameId(12345);
  map.points[11].observations.front().left = 1 << 30;
  map.keyframes[60].features.descriptors.resize(3);
  EXPECT_THAT(Missed(FindLoops({&atlas, 0})), Not(IsEmpty()));
}

}  // namespace
}  // namespace slamdb::testing
