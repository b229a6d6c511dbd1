// SPDX-License-Identifier: BSD-3-Clause
// Counters and origins of points between sessions.
#include <cstdlib>
#include <filesystem>

#include "slamdb/formats/formats.h"
#include "slamdb/live/bridge.h"
#include "slamdb/live/checkpointer.h"
#include "tests/live/world.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/temporary_folder.h"

namespace slamdb::live {
namespace {

using ::testing::SizeIs;

MapPoint* OnlyPoint(Atlas& atlas) { return atlas.GetAllMaps().front()->GetAllMapPoints().front(); }

class Counters : public ::testing::Test {
 protected:
  Counters() { World::Observe(point, keyframe, 3); }

  const TemporaryFolder folder;
  World world;
  KeyFrame* keyframe = world.AddKeyFrame();
  MapPoint* point = world.AddPoint(keyframe);
};

TEST_F(Counters, SurviveInAStore) {
  point->IncreaseVisible(6);  // 7
  point->IncreaseFound(2);    // 3
  point->mnOriginMapId = 7;
  const std::string location = folder / "maps.db#lab";
  world.atlas.Save(location);
  const Atlas::Loaded loaded = Atlas::Load(location);
  MapPoint* again = OnlyPoint(*loaded.atlas);
  EXPECT_EQ(again->GetFound(), 3);
  EXPECT_FLOAT_EQ(again->GetFoundRatio(), 3.0F / 7);
  EXPECT_EQ(again->mnOriginMapId, 7U);
  again->IncreaseFound();
  EXPECT_EQ(ToModel(*loaded.atlas).maps[0].points[0].found_count, 4);
}

TEST_F(Counters, AreSeenByACheckpointer) {
  const std::string location = folder / "maps.db#lab";
  Checkpointer checkpointer(world.atlas, location, {.interval = 0});
  EXPECT_EQ(checkpointer.Save().points, 0U);
  point->IncreaseFound(4);
  EXPECT_EQ(checkpointer.Save().points, 1U);
  EXPECT_EQ(OnlyPoint(*Atlas::Load(location).atlas)->GetFound(), 5);
}

TEST_F(Counters, GoOverToTheReplacement) {
  MapPoint* better = world.AddPoint(keyframe);
  point->IncreaseFound(4);
  point->Replace(better);
  EXPECT_EQ(ToModel(world.atlas).maps[0].points[0].found_count, 6);
}

TEST_F(Counters, BeginAnewWhereAFileHasNone) {
  const std::string path = folder / "lab.osa";
  world.atlas.Save(path);
  const slamdb::Atlas none = ReadAtlas(path);
  ASSERT_THAT(none.maps[0].points, SizeIs(1));
  ASSERT_FALSE(none.maps[0].points[0].has_tracking());
  const LiveAtlas live = FromModel(none);
  MapPoint* again = OnlyPoint(*live.atlas);
  EXPECT_EQ(again->GetFound(), 1);
  EXPECT_EQ(again->mnOriginMapId, world.map()->GetId()) << "for want of better";
  EXPECT_THAT(ToModel(*live.atlas), EqualsAtlas(none)) << "what was not recorded is not made up";
  again->IncreaseVisible();
  slamdb::MapPoint record = ToModel(*live.atlas).maps[0].points[0];
  EXPECT_EQ(record.visible_count, 2);
  EXPECT_EQ(record.found_count, slamdb::MapPoint::kNoCount);
  EXPECT_EQ(record.origin_map, slamdb::MapPoint::kNoOrigin);
  again->mnOriginMapId = 5;
  EXPECT_EQ(ToModel(*live.atlas).maps[0].points[0].origin_map, 5U);
}

}  // namespace
}  // namespace slamdb::live
