// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "slamdb/optimize/bundle_adjustment.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/kind_of.h"

namespace slamdb::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Keyframe 0 shares two points with 1, one with 2 and 3, none with 4.
Map SmallMap() {
  Map map;
  for (std::uint64_t id = 0; id < 5; ++id) {
    KeyFrame keyframe;
    keyframe.id = KeyFrameId(id);
    map.keyframes.push_back(keyframe);
  }
  const auto add = [&](std::initializer_list<std::uint64_t> observers) {
    MapPoint point;
    point.id = MapPointId(map.points.size());
    for (const std::uint64_t observer : observers) {
      point.observations.push_back({KeyFrameId(observer), 0, -1});
      map.keyframes[observer].features.map_points.push_back(point.id);
    }
    map.points.push_back(point);
  };
  add({0, 1});
  add({0, 1, 2});
  add({0, 3});
  return map;
}

TEST(SeamKeyFrames, AreTheGivenOnesAndThoseThatShareMost) {
  const Map map = SmallMap();
  const KeyFrameId first(0), second(1), third(2), fourth(3);
  EXPECT_THAT(SeamKeyFrames(map, std::vector{first}, 1), ElementsAre(first, second));
  EXPECT_THAT(SeamKeyFrames(map, std::vector{first}, 2),
              ElementsAre(first, second, third));  // of equals, the lowest id
  EXPECT_THAT(SeamKeyFrames(map, std::vector{first}), ElementsAre(first, second, third, fourth));
}

TEST(SeamKeyFrames, AreAtMergeAndLoopEdgesWhereNoneAreGiven) {
  Map map = SmallMap();
  EXPECT_THAT(SeamKeyFrames(map), IsEmpty());
  map.keyframes[4].merge_edges.push_back(KeyFrameId(3));
  map.keyframes[3].loop_edges.push_back(KeyFrameId(4));
  EXPECT_THAT(SeamKeyFrames(map), ElementsAre(KeyFrameId(0), KeyFrameId(3), KeyFrameId(4)));
}

TEST(SeamKeyFrames, AreNotWhereTheyAreUnknown) {
  EXPECT_EQ(KindOf([] { static_cast<void>(SeamKeyFrames(SmallMap(), std::vector{KeyFrameId(9)})); }),
            ErrorKind::kNotFound);
}

}  // namespace
}  // namespace slamdb::testing
