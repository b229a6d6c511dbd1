// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/observe.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>

#include "tests/edit/soundness.h"

namespace slamdb {
namespace {

class AddObservationsTest : public ::testing::Test {
 protected:
  // A point, a keyframe that does not see it, and a keypoint of that which is no point.
  SeenPoint Unseen() const {
    for (const MapPoint& point : map_.points)
      for (const KeyFrame& keyframe : map_.keyframes) {
        if (std::ranges::find(point.observations, keyframe.id, &Observation::keyframe) != point.observations.end())
          continue;
        const auto& slots = keyframe.features.map_points;
        const auto free = std::ranges::find(slots, MapPointId());
        if (free != slots.end()) return {point.id, keyframe.id, static_cast<std::uint32_t>(free - slots.begin())};
      }
    return {};
  }
  const MapPoint& PointOf(MapPointId id) const { return *std::ranges::find(map_.points, id, &MapPoint::id); }
  const KeyFrame& KeyFrameOf(KeyFrameId id) const { return *std::ranges::find(map_.keyframes, id, &KeyFrame::id); }

  Atlas atlas_ = SynthesizeAtlas({.keyframes = 20, .points = 400, .features = 300, .loops = false});
  Map& map_ = atlas_.maps[0];
};

TEST_F(AddObservationsTest, RecordsBothSidesAndWhatFollows) {
  const SeenPoint seen = Unseen();
  ASSERT_TRUE(seen.point);
  const MapPoint before = PointOf(seen.point);
  EXPECT_EQ(AddObservations(map_, std::array{seen}), 1U);
  const MapPoint& point = PointOf(seen.point);
  EXPECT_EQ(KeyFrameOf(seen.keyframe).features.map_points[seen.keypoint], seen.point);
  EXPECT_EQ(point.observations.size(), before.observations.size() + 1);
  EXPECT_TRUE(std::ranges::is_sorted(point.observations, {}, &Observation::keyframe));
  EXPECT_GT(point.observation_count, before.observation_count);
  EXPECT_NE(point.normal, before.normal);
  std::set<std::string> troubles = testing::Troubles(atlas_);
  troubles.erase("point-in-front");  // it is not where the keypoint is
  EXPECT_EQ(troubles, std::set<std::string>());
}

TEST_F(AddObservationsTest, PassesOverWhatIsTakenOrNotThere) {
  const SeenPoint seen = Unseen();
  const MapPoint& own = map_.points.front();
  const Observation& first = own.observations.front();
  const SeenPoint taken{seen.point, first.keyframe, static_cast<std::uint32_t>(first.left)};
  const SeenPoint again{own.id, first.keyframe, seen.keypoint};
  const SeenPoint beyond{seen.point, seen.keyframe, 1U << 30};
  const std::array useless{taken,
                           again,
                           beyond,
                           SeenPoint{MapPointId(1U << 30), seen.keyframe, seen.keypoint},
                           SeenPoint{seen.point, KeyFrameId(1U << 30), seen.keypoint},
                           SeenPoint{}};
  EXPECT_EQ(AddObservations(map_, useless), 0U);
  EXPECT_EQ(AddObservations(map_, std::array{seen, seen}), 1U);
}

}  // namespace
}  // namespace slamdb
