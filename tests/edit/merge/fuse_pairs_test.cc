// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "slamdb/edit/merge/fuse.h"
#include "slamdb/model/index.h"
#include "tests/edit/soundness.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

Map& MapOf(Atlas& atlas) { return atlas.maps[0]; }

MapPoint& PointOf(Map& map, MapPointId id) { return *std::ranges::find(map.points, id, &MapPoint::id); }

bool SeenTogether(const MapPoint& a, const MapPoint& b) {
  return std::ranges::any_of(a.observations, [&](const Observation& seen) {
    return std::ranges::find(b.observations, seen.keyframe, &Observation::keyframe) != b.observations.end();
  });
}

// Points of which no keyframe sees two.
std::vector<MapPointId> Strangers(const Map& map, std::size_t count) {
  std::vector<const MapPoint*> chosen;
  for (const MapPoint& point : map.points) {
    if (point.observations.size() > 6 || chosen.size() == count) continue;
    if (std::ranges::none_of(chosen, [&](const MapPoint* other) { return SeenTogether(point, *other); }))
      chosen.push_back(&point);
  }
  std::vector<MapPointId> ids;
  for (const MapPoint* point : chosen) ids.push_back(point->id);
  return ids;
}

class FusePairsTest : public ::testing::Test {
 protected:
  // But for where points lie: what is fused here is not the same thing.
  std::set<std::string> Troubles() const {
    std::set<std::string> troubles = testing::Troubles(atlas_);
    troubles.erase("point-in-front");
    return troubles;
  }

  Atlas atlas_ = SynthesizeAtlas({.keyframes = 40, .points = 800, .features = 200, .loops = false});
  Map& map_ = MapOf(atlas_);
  const std::vector<MapPointId> ids_ = Strangers(map_, 3);
};

TEST_F(FusePairsTest, TheFirstSurvivesWhereverItStands) {
  ASSERT_EQ(ids_.size(), 3U);
  const std::size_t points = map_.points.size();
  const MapPoint kept = PointOf(map_, ids_[1]), gone = PointOf(map_, ids_[0]);
  const FuseReport report = FusePairs(map_, std::vector<std::pair<MapPointId, MapPointId>>{{ids_[1], ids_[0]}});
  EXPECT_EQ(report.fused, 1U);
  EXPECT_THAT(report.replaced, ElementsAre(Pair(ids_[0], ids_[1])));
  EXPECT_EQ(map_.points.size(), points - 1);
  const MapPoint& point = PointOf(map_, ids_[1]);
  EXPECT_EQ(point.observations.size(), kept.observations.size() + gone.observations.size());
  EXPECT_EQ(point.position, kept.position);
  EXPECT_EQ(Troubles(), std::set<std::string>());
}

// b goes into a, and then c into b: into a.
TEST_F(FusePairsTest, FollowsChains) {
  ASSERT_EQ(ids_.size(), 3U);
  const MapPointId a = ids_[2], b = ids_[0], c = ids_[1];
  const FuseReport report = FusePairs(map_, std::vector<std::pair<MapPointId, MapPointId>>{{a, b}, {b, c}, {c, a}});
  EXPECT_EQ(report.fused, 2U);
  EXPECT_THAT(report.replaced, ::testing::UnorderedElementsAre(Pair(b, a), Pair(c, a)));
  for (const KeyFrame& keyframe : map_.keyframes)
    for (const MapPointId slot : keyframe.features.map_points) EXPECT_TRUE(slot != b && slot != c);
  EXPECT_EQ(Troubles(), std::set<std::string>());
}

// c may not follow b into a, as a keyframe sees both a and c.
TEST_F(FusePairsTest, KeepsApartWhatOneKeyframeSees) {
  const KeyFrame& keyframe = map_.keyframes[10];
  std::vector<MapPointId> seen;
  std::ranges::copy_if(keyframe.features.map_points, std::back_inserter(seen),
                       [](MapPointId id) { return id.has_value(); });
  const std::size_t points = map_.points.size();
  const FuseReport report = FusePairs(map_, std::vector<std::pair<MapPointId, MapPointId>>{{seen[0], seen[1]}});
  EXPECT_EQ(report.fused, 0U);
  EXPECT_EQ(report.seen_together, 1U);
  EXPECT_EQ(map_.points.size(), points);
}

TEST_F(FusePairsTest, PassesOverWhatIsNotThere) {
  const FuseReport report = FusePairs(
      map_, std::vector<std::pair<MapPointId, MapPointId>>{{ids_[0], MapPointId(1U << 30)}, {ids_[0], ids_[0]}});
  EXPECT_EQ(report.fused, 0U);
}

}  // namespace
}  // namespace slamdb
