// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/close_loops.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "slamdb/base/error.h"
#include "slamdb/checks/check.h"
#include "tests/align/bent.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/kind_of.h"

namespace slamdb::testing {
namespace {

using ::testing::Contains;
using ::testing::IsEmpty;

constexpr Bend kBend = {.radians = 0.1, .shift = 0.4};

// Rules of severity error or warning that find something.
std::set<std::string> Troubles(const Atlas& atlas) {
  std::set<std::string> troubles;
  for (const RuleResult& result : CheckAtlas(atlas, {}).results)
    if (result.severity != Severity::kNote) troubles.insert(result.id);
  return troubles;
}

class CloseLoopsOf : public ::testing::TestWithParam<Sensor> {
 protected:
  void SetUp() override {
    if (!CanOptimize()) GTEST_SKIP() << "needs Ceres";
  }
};
INSTANTIATE_TEST_SUITE_P(All, CloseLoopsOf,
                         ::testing::Values(Sensor::kMonocular, Sensor::kStereo, Sensor::kRgbd, Sensor::kFisheyeStereo));

TEST_P(CloseLoopsOf, BringsKeyframesWhereTheyAre) {
  const Atlas truth = MakeTwoRounds(GetParam());
  const bool mono = GetParam() == Sensor::kMonocular;
  Atlas atlas = MakeMissedLoop(GetParam(), {.scale = mono ? 0.93 : 1, .radians = 0.1, .shift = 0.4});
  const double before = TrajectoryError(atlas.maps[0], truth.maps[0], mono);
  const CloseLoopsReport report = CloseLoops(atlas, {.adjust_bundle = false});
  EXPECT_GT(report.closed, 0U);
  EXPECT_LT(TrajectoryError(atlas.maps[0], truth.maps[0], mono), 0.4 * before);
  EXPECT_THAT(Troubles(atlas), IsEmpty());
}

TEST_P(CloseLoopsOf, RecordsTheLoopOnBothSides) {
  Atlas atlas = MakeMissedLoop(GetParam(), kBend);
  const std::int32_t changes = atlas.maps[0].big_change_index;
  const std::size_t points = atlas.maps[0].points.size();
  const CloseLoopsReport report = CloseLoops(atlas, {.adjust_bundle = false});
  const Map& map = atlas.maps[0];
  std::size_t edges = 0;
  for (const KeyFrame& keyframe : map.keyframes)
    for (const KeyFrameId other : keyframe.loop_edges) {
      const KeyFrame& there = *std::ranges::find(map.keyframes, other, &KeyFrame::id);
      EXPECT_THAT(there.loop_edges, Contains(keyframe.id));
      EXPECT_TRUE(keyframe.not_erase && there.not_erase);
      ++edges;
    }
  EXPECT_EQ(edges, 2 * report.maps[0].constraints);
  EXPECT_EQ(map.big_change_index, changes + 1);
  EXPECT_GT(report.maps[0].fused.fused, 0U);
  EXPECT_EQ(map.points.size(), points - report.maps[0].fused.fused);
}

// Both rounds see the same points from then on, so keyframes of one are covisible with those of the other.
TEST_P(CloseLoopsOf, MakesBothEndsCovisible) {
  Atlas atlas = MakeMissedLoop(GetParam(), kBend);
  CloseLoops(atlas, {.adjust_bundle = false});
  const KeyFrame& early = atlas.maps[0].keyframes[20];
  EXPECT_TRUE(
      std::ranges::any_of(early.connections, [](const Connection& each) { return each.keyframe >= KeyFrameId(40); }));
}

TEST_P(CloseLoopsOf, LeavesAMapThatLiesRight) {
  const Atlas before = MakeMissedLoop(GetParam(), {});
  Atlas atlas = before;
  EXPECT_EQ(CloseLoops(atlas).closed, 0U);
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

class CloseLoopsTest : public CloseLoopsOf {};

TEST_F(CloseLoopsTest, BundleAdjustmentMakesItBetter) {
  const Atlas truth = MakeTwoRounds(Sensor::kRgbd);
  Atlas bent = MakeMissedLoop(Sensor::kRgbd, kBend), adjusted = bent;
  CloseLoops(bent, {.adjust_bundle = false});
  const CloseLoopsReport report = CloseLoops(adjusted);
  EXPECT_LT(TrajectoryError(adjusted.maps[0], truth.maps[0], false),
            0.5 * TrajectoryError(bent.maps[0], truth.maps[0], false));
  ASSERT_TRUE(report.maps[0].optimization.bundle);
  EXPECT_THAT(Troubles(adjusted), IsEmpty());
}

TEST_F(CloseLoopsTest, FindsNothingMoreTheSecondTime) {
  Atlas atlas = MakeMissedLoop(Sensor::kRgbd, kBend);
  CloseLoops(atlas);
  EXPECT_EQ(CloseLoops(atlas).closed, 0U);
}

TEST_F(CloseLoopsTest, IsTheSameForAnyNumberOfThreads) {
  Atlas one = MakeMissedLoop(Sensor::kMonocular, kBend), four = one;
  CloseLoops(one, {.threads = 1});
  CloseLoops(four, {.threads = 4});
  EXPECT_THAT(one, EqualsAtlas(four));
}

TEST_F(CloseLoopsTest, LooksAtTheMapsThatItIsGivenAlone) {
  const Atlas before = MakeMissedLoop(Sensor::kRgbd, kBend);
  Atlas atlas = before;
  EXPECT_EQ(KindOf([&] { CloseLoops(atlas, {.maps = {MapId(9)}}); }), ErrorKind::kNotFound);
  EXPECT_THAT(atlas, EqualsAtlas(before));
  EXPECT_THAT(CloseLoops(atlas, {.maps = {atlas.maps[0].id}}).maps, ::testing::SizeIs(1));
}

TEST(CloseLoopsOfNothing, HasNothingToDo) {
  Atlas empty;
  EXPECT_EQ(CloseLoops(empty).closed, 0U);
  empty.maps.emplace_back();
  EXPECT_THAT(CloseLoops(empty).maps, IsEmpty());
}

}  // namespace
}  // namespace slamdb::testing
