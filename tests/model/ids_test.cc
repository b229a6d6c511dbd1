// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/ids.h"

#include <gtest/gtest.h>

#include <type_traits>
#include <unordered_set>

namespace slamdb {
namespace {

static_assert(!std::is_convertible_v<KeyFrameId, MapPointId>);
static_assert(!std::is_convertible_v<std::uint64_t, KeyFrameId>);

TEST(Id, IsNoneByDefault) {
  EXPECT_FALSE(KeyFrameId());
  EXPECT_TRUE(KeyFrameId(0));
  EXPECT_EQ(KeyFrameId(), KeyFrameId(static_cast<std::uint64_t>(-1)));
}

TEST(Id, PrintsAsPeopleNameIt) {
  EXPECT_EQ(ToString(MapId(0)), "map 0");
  EXPECT_EQ(ToString(KeyFrameId(77)), "kf 77");
  EXPECT_EQ(ToString(MapPointId(4312)), "mp 4312");
  EXPECT_EQ(ToString(CameraId(1)), "camera 1");
  EXPECT_EQ(ToString(KeyFrameId()), "kf none");
}

TEST(Id, OrdersAndHashes) {
  EXPECT_LT(KeyFrameId(3), KeyFrameId(4));
  const std::unordered_set<MapPointId> ids = {MapPointId(1), MapPointId(2), MapPointId(1)};
  EXPECT_EQ(ids.size(), 2U);
}

}  // namespace
}  // namespace slamdb
