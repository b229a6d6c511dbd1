// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "slamdb/base/error.h"
#include "tests/support/corrupt.h"
#include "tests/support/kind_of.h"
#include "tests/view/page_data.h"

namespace slamdb::testing {
namespace {

using ::testing::ElementsAre;

enum Status : std::uint8_t { kSame, kAdded, kRemoved, kMoved, kChanged };

class ViewDiff : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!HasViewPage()) GTEST_SKIP() << "built without esbuild";
  }
  const Atlas& before = SoundAtlas(Base::kRgbd);
  Atlas after = before;
  std::size_t points = before.maps[0].points.size(), keyframes = before.maps[0].keyframes.size();
};

TEST_F(ViewDiff, SameAtlasesAreTheSame) {
  const PageData page = DataOf({&before, &after}, {.diff = true});
  for (const char* name : {"points/status", "keyframes/status"})
    EXPECT_THAT(page.OneByte(name), ::testing::Each(kSame)) << name;
  EXPECT_EQ(page.header.at("/diff/points/moved"_json_pointer), 0);
  EXPECT_FALSE(DataOf({&before, &after}).Has("points/status"));
}

TEST_F(ViewDiff, EveryRowSaysWhatBecameOfIt) {
  Map& map = after.maps[0];
  map.points[3].position.x() += 0.25F;
  map.points[5].max_distance *= 2;
  map.points.erase(map.points.begin() + 7);  // row n of the second is row n + 1 of the first from here on
  map.points[9].position.z() += 1;
  map.keyframes[2].camera_from_world.translation.x() += 1;
  map.keyframes[4].timestamp += 0.001;
  const PageData page = DataOf({&before, &after}, {.check = false, .diff = true});
  const std::vector<std::uint8_t> status = page.OneByte("points/status");
  ASSERT_EQ(status.size(), 2 * points - 1);
  EXPECT_EQ(status[3], kMoved);
  EXPECT_EQ(status[points + 3], kMoved);
  EXPECT_EQ(status[points + 4], kSame);
  EXPECT_EQ(status[5], kChanged);
  EXPECT_EQ(status[points + 5], kChanged);
  EXPECT_EQ(status[7], kRemoved);
  EXPECT_EQ(status[10], kMoved);
  EXPECT_EQ(status[points + 9], kMoved);
  EXPECT_THAT(page.Differences("points/moved"), ElementsAre(3, 10));
  EXPECT_EQ(page.OneByte("keyframes/status")[2], kMoved);
  EXPECT_EQ(page.OneByte("keyframes/status")[keyframes + 4], kChanged);
  EXPECT_THAT(page.Differences("keyframes/moved"), ElementsAre(2));
  EXPECT_EQ(page.header.at("/diff/points"_json_pointer),
            (nlohmann::json{{"added", 0}, {"removed", 1}, {"moved", 2}, {"changed", 1}}));
}

TEST_F(ViewDiff, WhatIsOnlyInTheSecondIsAdded) {
  const PageData page = DataOf({&after, &before}, {.check = false, .diff = true});
  Atlas less = before;
  less.maps[0].points.pop_back();
  const std::vector<std::uint8_t> status =
      DataOf({&less, &before}, {.check = false, .diff = true}).OneByte("points/status");
  EXPECT_EQ(status.back(), kAdded);
}

TEST_F(ViewDiff, IsOfTwoAtlases) {
  const ViewInput one{.atlas = &before, .name = "a", .format = {}, .facts = {}};
  EXPECT_EQ(KindOf([&] { (void)MakeViewPage({&one, 1}, {.diff = true}); }), ErrorKind::kUsage);
}

}  // namespace
}  // namespace slamdb::testing
