// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "slamdb/formats/format.h"

namespace slamdb {
namespace {

KeyFrame KeyFrameOf(std::uint64_t id, double timestamp) {
  KeyFrame keyframe;
  keyframe.id = KeyFrameId(id);
  keyframe.timestamp = timestamp;
  return keyframe;
}

TEST(Selection, HasEverythingByDefault) {
  const Selection selection;
  EXPECT_TRUE(selection.everything());
  EXPECT_TRUE(selection.Has(KeyFrameOf(KeyFrameId::kNone, std::nan(""))));
  EXPECT_TRUE(selection.Has(MapPoint{}));
}

TEST(Selection, IsNotEverythingWithAnyPartSet) {
  EXPECT_FALSE(Selection{.map = MapId(0)}.everything());
  EXPECT_FALSE(Selection{.first_keyframe = 1}.everything());
  EXPECT_FALSE(Selection{.last_keyframe = 5}.everything());
  EXPECT_FALSE(Selection{.begin_time = 0}.everything());
  EXPECT_FALSE(Selection{.end_time = 9}.everything());
  EXPECT_FALSE(Selection{.box = Eigen::AlignedBox3f()}.everything());
}

TEST(Selection, BoundsAreInclusive) {
  const Selection selection{.first_keyframe = 2, .last_keyframe = 4, .begin_time = 10, .end_time = 20};
  EXPECT_TRUE(selection.Has(KeyFrameOf(2, 10)));
  EXPECT_TRUE(selection.Has(KeyFrameOf(4, 20)));
  EXPECT_FALSE(selection.Has(KeyFrameOf(1, 10)));
  EXPECT_FALSE(selection.Has(KeyFrameOf(5, 10)));
  EXPECT_FALSE(selection.Has(KeyFrameOf(3, 9.9)));
  EXPECT_FALSE(selection.Has(KeyFrameOf(3, 20.1)));
  EXPECT_FALSE(selection.Has(KeyFrameOf(3, std::nan(""))));
}

TEST(Selection, BoxHoldsPoints) {
  const Selection selection{.box = Eigen::AlignedBox3f(Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(1, 1, 1))};
  MapPoint point;
  point.position = {1, 0.5F, 0};
  EXPECT_TRUE(selection.Has(point));
  point.position.x() = 1.5F;
  EXPECT_FALSE(selection.Has(point));
  point.position.x() = std::nanf("");
  EXPECT_FALSE(selection.Has(point));
}

}  // namespace
}  // namespace slamdb
