// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/fragments.h"

#include <gmock/gmock.h>

#include "slamdb/base/error.h"
#include "tests/edit/soundness.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/equals_atlas.h"

namespace slamdb::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

// Maps 5, 6 and 8 with 3, 9 and 6 keyframes, and an empty one, 7; the later the map, the earlier its time.
Atlas Maps() {
  Atlas atlas;
  for (const std::size_t keyframes : {3, 9, 0, 6}) {
    Map& map = atlas.maps.emplace_back();
    map.id = MapId(4 + atlas.maps.size());
    for (std::size_t i = 0; i < keyframes; ++i) {
      KeyFrame& keyframe = map.keyframes.emplace_back();
      keyframe.id = KeyFrameId(100 * map.id.value() + i);
      keyframe.timestamp = 1000 - static_cast<double>(keyframe.id.value());
      if (i > 0) keyframe.parent = map.first_keyframe;
      if (i == 0) map.first_keyframe = map.initial_keyframe = map.lowest_keyframe = keyframe.id;
    }
  }
  return atlas;
}

std::vector<std::uint64_t> IdsAfter(const FragmentOptions& options) {
  Atlas atlas = Maps();
  DropFragments(atlas, options);
  std::vector<std::uint64_t> ids;
  for (const Map& map : atlas.maps) ids.push_back(map.id.value());
  return ids;
}

TEST(DropFragments, DropsEmptyAndSmallMaps) {
  EXPECT_THAT(IdsAfter({}), ElementsAre(5, 6, 8));
  EXPECT_THAT(IdsAfter({.min_keyframes = 3}), ElementsAre(5, 6, 8));
  EXPECT_THAT(IdsAfter({.min_keyframes = 4}), ElementsAre(6, 8));
  EXPECT_THAT(IdsAfter({.largest = 1}), ElementsAre(6));
  EXPECT_THAT(IdsAfter({.largest = 9}), ElementsAre(5, 6, 8));
}

TEST(DropFragments, OrdersWhatStays) {
  EXPECT_THAT(IdsAfter({.order = MapOrder::kSize}), ElementsAre(6, 8, 5));
  EXPECT_THAT(IdsAfter({.order = MapOrder::kTime}), ElementsAre(8, 6, 5));
  EXPECT_THAT(IdsAfter({.order = MapOrder::kId}), ElementsAre(5, 6, 8));
}

TEST(DropFragments, Reports) {
  Atlas atlas = Maps();
  const FragmentReport report = DropFragments(atlas, {.largest = 1});
  ASSERT_EQ(report.maps.size(), 4U);
  EXPECT_EQ(report.maps[1].keyframes, 9U);
  EXPECT_EQ(report.maps[1].begin_time, 1000 - 608);
  EXPECT_EQ(report.maps[1].end_time, 1000 - 600);
  EXPECT_TRUE(report.maps[1].kept);
  EXPECT_FALSE(report.maps[3].kept);
  EXPECT_EQ(report.removed.maps, 3U);
  EXPECT_EQ(report.removed.keyframes, 9U);
}

TEST(DropFragments, RefusesToLeaveNothing) {
  Atlas atlas = Maps();
  EXPECT_THAT([&] { DropFragments(atlas, {.min_keyframes = 10}); },
              ThrowsMessage<Error>(HasSubstr("the largest has 9")));
  EXPECT_EQ(atlas.maps.size(), 4U);
}

TEST(DropFragments, LeavesASoundAtlasWithoutFragmentsAlone) {
  for (const SyntheticOptions& kind : SensorKinds()) {
    const Atlas atlas = SynthesizeAtlas(kind);
    Atlas same = atlas;
    DropFragments(same, {.order = MapOrder::kId});
    EXPECT_THAT(same, EqualsAtlas(atlas)) << NameOf(kind);
  }
}

TEST(DropFragments, HealsWhatLoadingLeft) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, "mono_small_newmap");
  Notices notices;
  Atlas atlas = ReadOrbslam3(path, {}, notices);
  const auto empty_maps = [&] {
    return std::ranges::count_if(atlas.maps, [](const Map& map) { return map.keyframes.empty(); });
  };
  EXPECT_EQ(empty_maps(), 1);
  DropFragments(atlas, {});
  EXPECT_EQ(empty_maps(), 0);
  EXPECT_THAT(Troubles(atlas), IsEmpty());
}

}  // namespace
}  // namespace slamdb::testing
