// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/ids/origin.h"

#include <gmock/gmock.h>

#include "tests/edit/worlds.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

// Two maps of 12 keyframes; the second has one of origin 0 and one of origin 5.
Atlas Mixed() {
  Atlas atlas = MakeWorld(kWorlds[0], 2);
  atlas.maps[1].keyframes[0].origin_map = 0;
  atlas.maps[1].keyframes[1].origin_map = 5;
  atlas.next_ids.map = 6;
  return atlas;
}

std::map<std::uint32_t, std::uint64_t> After(const OriginOptions& options) {
  Atlas atlas = Mixed();
  const OriginReport report = ReassignOrigins(atlas, options);
  EXPECT_THAT(report.before, ElementsAre(Pair(0, 13), Pair(1, 10), Pair(5, 1)));
  EXPECT_THAT(TroubleCounts(atlas), IsEmpty());
  return report.after;
}

std::string ErrorOf(const OriginOptions& options) {
  Atlas atlas = Mixed();
  const Atlas before = atlas;
  const std::string text = slamdb::ErrorOf([&] { ReassignOrigins(atlas, options); });
  EXPECT_THAT(atlas, EqualsAtlas(before));
  return text;
}

TEST(Origin, Set) { EXPECT_THAT(After({.set = 0}), ElementsAre(Pair(0, 24))); }
TEST(Origin, FromMap) { EXPECT_THAT(After({.from_map = true}), ElementsAre(Pair(0, 12), Pair(1, 12))); }
TEST(Origin, Replace) { EXPECT_THAT(After({.replace = {{5, 1}}}), ElementsAre(Pair(0, 13), Pair(1, 11))); }
TEST(Origin, ReplaceAllAtOnce) {
  EXPECT_THAT(After({.replace = {{5, 1}, {1, 0}}}), ElementsAre(Pair(0, 23), Pair(1, 1)));
}
TEST(Origin, Shift) { EXPECT_THAT(After({.shift = 10}), ElementsAre(Pair(10, 13), Pair(11, 10), Pair(15, 1))); }
TEST(Origin, Compact) { EXPECT_THAT(After({.compact = true}), ElementsAre(Pair(0, 13), Pair(1, 10), Pair(2, 1))); }
TEST(Origin, InTheOrderOfTheOptions) {
  EXPECT_THAT(After({.from_map = true, .replace = {{1, 9}}, .shift = 1, .compact = true}),
              ElementsAre(Pair(0, 12), Pair(1, 12)));
}

TEST(Origin, CounterStaysAbove) {
  Atlas atlas = Mixed();
  EXPECT_EQ(ReassignOrigins(atlas, {.set = 40}).next_map_after, 41U);
  EXPECT_EQ(atlas.next_ids.map, 41U);
}

TEST(Origin, UnknownTwiceAndCircles) {
  EXPECT_THAT(ErrorOf({.replace = {{3, 0}}}), HasSubstr("no keyframe or point has origin map 3; origins are 0, 1, 5"));
  EXPECT_THAT(ErrorOf({.replace = {{1, 0}, {1, 5}}}), HasSubstr("origin map 1 is replaced twice"));
  EXPECT_THAT(ErrorOf({.replace = {{1, 0}, {0, 5}, {5, 1}}}), HasSubstr("back to it"));
  EXPECT_THAT(ErrorOf({.shift = -1}), HasSubstr("would become -1"));
}

// Points have origins of their own, where they are recorded.
class OriginOfPoints : public ::testing::Test {
 protected:
  OriginOfPoints() : atlas_(Mixed()) {
    atlas_.maps[0].points[0].origin_map = 0;
    atlas_.maps[1].points[0].origin_map = 0;
    atlas_.maps[1].points[1].origin_map = 4;  // no keyframe is of that map
  }
  OriginReport Reassign(const OriginOptions& options) { return ReassignOrigins(atlas_, options); }
  std::vector<std::uint32_t> Points() const {
    return {atlas_.maps[0].points[0].origin_map, atlas_.maps[1].points[0].origin_map,
            atlas_.maps[1].points[1].origin_map, atlas_.maps[1].points[2].origin_map};
  }

  static constexpr std::uint32_t kNone = MapPoint::kNoOrigin;
  Atlas atlas_;
};

TEST_F(OriginOfPoints, Set) {
  const OriginReport report = Reassign({.set = 9});
  EXPECT_THAT(Points(), ElementsAre(9, 9, 9, kNone));
  EXPECT_THAT(report.points_before, ElementsAre(Pair(0, 2), Pair(4, 1)));
  EXPECT_THAT(report.points_after, ElementsAre(Pair(9, 3)));
  EXPECT_EQ(report.points_changed, 3U);
  EXPECT_EQ(report.changed, 24U);
}

TEST_F(OriginOfPoints, FromMap) {
  EXPECT_EQ(Reassign({.from_map = true}).points_changed, 2U);
  EXPECT_THAT(Points(), ElementsAre(0, 1, 1, kNone));
}

TEST_F(OriginOfPoints, ReplaceWhatOnlyAPointHas) {
  const OriginReport report = Reassign({.replace = {{4, 20}}});
  EXPECT_THAT(Points(), ElementsAre(0, 0, 20, kNone));
  EXPECT_EQ(report.changed, 0U);
  EXPECT_EQ(report.next_map_after, 21U);
}

TEST_F(OriginOfPoints, CompactCountsThemIn) {
  EXPECT_THAT(Reassign({.compact = true}).after, ElementsAre(Pair(0, 13), Pair(1, 10), Pair(3, 1)));
  EXPECT_THAT(Points(), ElementsAre(0, 0, 2, kNone));
}

}  // namespace
}  // namespace slamdb
