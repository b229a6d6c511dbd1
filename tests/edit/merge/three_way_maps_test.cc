// SPDX-License-Identifier: BSD-3-Clause
// Which maps of three atlases are one.
#include <gmock/gmock.h>

#include "slamdb/edit/frame/transform.h"
#include "slamdb/edit/ids/renumber.h"
#include "slamdb/edit/merge/join.h"
#include "slamdb/edit/merge/merge.h"
#include "slamdb/edit/merge/three_way.h"
#include "slamdb/model/derive.h"
#include "tests/edit/merge/branched.h"
#include "tests/support/kind_of.h"

namespace slamdb {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Atlas Together(const Atlas& a, const Atlas& b) { return MergeAtlases({a, b}).atlas; }

TEST(ThreeWayMaps, AreMatchedByKeyframesNotByIds) {
  Branched branched = Branch(kWorlds[4]);
  branched.ours.maps[0].id = MapId(3);
  branched.ours.next_ids.map = 4;
  branched.theirs.maps[0].id = MapId(3);
  branched.theirs.next_ids.map = 4;
  const ThreeWayResult merged = MergeThreeWays(branched.base, branched.ours, branched.theirs);
  ASSERT_THAT(merged.atlas.maps, SizeIs(1));
  EXPECT_EQ(merged.atlas.maps[0].id, MapId(3));
  EXPECT_EQ(merged.atlas.maps[0].keyframes.size(), kOld + 2 * kNew);
}

TEST(ThreeWayMaps, NewOnesAreAddedAndUntouchedOnesGoWhenDeleted) {
  const Branched branched = Branch(kWorlds[4]);
  const Atlas alone = MakeWorld(kWorlds[4], 1, 77), of_ours = MakeWorld(kWorlds[4], 1, 78),
              of_theirs = MakeWorld(kWorlds[4], 1, 79);
  const Atlas base = Together(alone, branched.base);
  const auto with = [&](const Atlas& side, const Atlas& added) {
    Atlas all = Together(Together(alone, side), added);
    all.maps.erase(all.maps.begin());
    return all;
  };
  const ThreeWayResult merged =
      MergeThreeWays(base, with(branched.ours, of_ours), with(branched.theirs, of_theirs), {.fuse = std::nullopt});
  EXPECT_THAT(merged.atlas.maps, SizeIs(3));
  EXPECT_THAT(TroubleCounts(merged.atlas), IsEmpty());
  EXPECT_EQ(merged.report.keyframes.deleted_by_both, 12U);
  EXPECT_EQ(merged.report.keyframes.added_by_ours, kNew + 12);
  EXPECT_EQ(merged.report.keyframes.added_by_theirs, kNew + 12);
}

TEST(ThreeWayMaps, WhatOneSideJoinedIsJoined) {
  const Branched branched = Branch(kWorlds[4]);
  const Atlas other = MakeWorld(kWorlds[4], 1, 77);
  const Atlas base = Together(branched.base, other);
  Atlas ours = base, theirs = Together(branched.theirs, other);
  const Similarity3d placed{1, Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitY())), {3, 0, 1}};
  JoinMaps(ours, {.first = base.maps[0].id, .second = base.maps[1].id, .first_from_second = placed});
  ASSERT_THAT(ours.maps, SizeIs(1));
  for (const bool swapped : {false, true}) {
    ThreeWayResult merged = swapped ? MergeThreeWays(base, theirs, ours) : MergeThreeWays(base, ours, theirs);
    ASSERT_THAT(merged.atlas.maps, SizeIs(1));
    EXPECT_EQ(merged.atlas.maps[0].keyframes.size(), kOld + kNew + 12);
    EXPECT_THAT(TroubleCounts(merged.atlas), IsEmpty());
    ASSERT_THAT(merged.report.maps, SizeIs(1));
    EXPECT_THAT(merged.report.maps[0].base, SizeIs(2));
  }
}

// Each its own way: it lies between, whoever is ours, and what neither moved stays.
TEST(ThreeWayMaps, WhatBothSidesJoinedLiesBetween) {
  const Branched branched = Branch(kWorlds[4]);
  const Atlas base = Together(branched.base, MakeWorld(kWorlds[4], 1, 77));
  const auto joined = [&](double shift) {
    Atlas side = base;
    const Similarity3d placed{1, Eigen::Quaterniond::Identity(), {shift, 0, 0}};
    JoinMaps(side, {.first = base.maps[0].id, .second = base.maps[1].id, .first_from_second = placed});
    return side;
  };
  const Atlas one = joined(5), other = joined(5.02);
  for (const bool swapped : {false, true}) {
    const ThreeWayResult merged = swapped ? MergeThreeWays(base, other, one) : MergeThreeWays(base, one, other);
    ASSERT_THAT(merged.atlas.maps, SizeIs(1));
    EXPECT_THAT(TroubleCounts(merged.atlas), IsEmpty());
    const IdTable rows = KeyFrameTable(merged.atlas.maps[0]);
    for (std::size_t map : {0, 1})
      for (const KeyFrame& before : base.maps[map].keyframes) {
        const KeyFrame& after = merged.atlas.maps[0].keyframes.at(rows.Find(before.id.value()));
        const Eigen::Vector3f moved = CameraCenter(after) - CameraCenter(before);
        EXPECT_LT((moved - Eigen::Vector3f(map == 0 ? 0 : 5.01F, 0, 0)).norm(), 1e-4F) << ToString(before.id);
      }
  }
}

// Ours keeps the ids of its maps, and what theirs made in a map was made in that.
TEST(ThreeWayMaps, OfOtherIdsGoByThoseOfOurs) {
  const Branched branched = Branch(kWorlds[4]);
  const Atlas other = MakeWorld(kWorlds[4], 1, 77);
  const Atlas base = Together(branched.base, other), ours = Together(branched.ours, other);
  Atlas theirs = Together(branched.theirs, other);
  const MapId first = base.maps[0].id, second = base.maps[1].id;
  IdMap swapped;
  swapped[IdKind::kMap] = {{first.value(), second.value()}, {second.value(), first.value()}};
  ApplyIdMap(theirs, swapped);
  const ThreeWayResult merged = MergeThreeWays(base, ours, theirs);
  EXPECT_THAT(TroubleCounts(merged.atlas), IsEmpty());
  ASSERT_THAT(merged.atlas.maps, SizeIs(2));
  EXPECT_EQ(merged.atlas.maps[0].id, first);
  EXPECT_EQ(merged.atlas.maps[1].id, second);
  for (const Map& map : merged.atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes) EXPECT_EQ(MapId(keyframe.origin_map), map.id);
}

TEST(ThreeWayMaps, ASplitOneIsRefused) {
  const Branched branched = Branch(kWorlds[4]);
  Atlas split = branched.ours;
  const Atlas half = Part(branched.ours, [](std::size_t row) { return row < 6; });
  Atlas rest = Part(branched.ours, [](std::size_t row) { return row >= 6; });
  std::erase_if(rest.maps[0].points,
                [&](const MapPoint& point) { return static_cast<bool>(AtlasIndex(half).LocatePoint(point.id)); });
  split.maps = {half.maps[0], rest.maps[0]};
  split.maps[1].id = MapId(9);
  split.next_ids.map = 10;
  EXPECT_THAT(ErrorOf([&] { (void)MergeThreeWays(branched.base, split, branched.theirs); }),
              AllOf(HasSubstr("ours: map 0 of base is split there, into map 0 and map 9"), HasSubstr("JoinMaps")));
}

}  // namespace
}  // namespace slamdb
