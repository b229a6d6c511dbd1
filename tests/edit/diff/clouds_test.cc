// SPDX-License-Identifier: BSD-3-Clause
// Atlases beside point clouds of them, as other programs change them.
#include <gtest/gtest.h>

#include "slamdb/edit/diff/diff.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/formats/formats.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

Atlas World(int maps = 1) {
  return SynthesizeAtlas({.sensor = Sensor::kRgbd, .maps = maps, .keyframes = 8, .points = 150, .features = 150});
}
Atlas Through(const Atlas& atlas, std::string_view format) {
  const std::string bytes = EncodeAtlas(atlas, {.format = std::string(format)});
  return DecodeAtlas(std::as_bytes(std::span(bytes)), {.format = std::string(format)});
}
AtlasDiff Compared(Atlas before, Atlas after) {
  EXPECT_TRUE(KeepWhatCloudsHold(before, after));
  return DiffAtlases(before, after);
}

TEST(Clouds, AreTheSameAsWhatTheyWereWrittenOf) {
  Atlas atlas = World(2);
  atlas.maps[0].points[5].bad = true;
  for (const std::string format : {"ply", "pcd"}) {
    EXPECT_EQ(Compared(atlas, Through(atlas, format)).verdict(), AtlasDiff::Verdict::kSame) << format;
    EXPECT_EQ(Compared(Through(atlas, format), atlas).verdict(), AtlasDiff::Verdict::kSame) << format;
  }
  const Atlas one = World();
  EXPECT_EQ(Compared(one, Through(one, "xyz")).verdict(), AtlasDiff::Verdict::kSame) << "by rows";
  EXPECT_EQ(Compared(Through(one, "xyz"), Through(one, "ply")).verdict(), AtlasDiff::Verdict::kSame);
}

TEST(Clouds, TellWhatMovedAndWhatIsGoneById) {
  const Atlas atlas = World();
  Atlas cloud = Through(atlas, "ply");
  cloud.maps[0].points[3].position.x() += 0.25F;
  cloud.maps[0].points.erase(cloud.maps[0].points.begin() + 10);
  const AtlasDiff diff = Compared(atlas, cloud);
  EXPECT_EQ(diff.points.removed.size(), 1U);
  EXPECT_EQ(diff.points.removed[0].id, atlas.maps[0].points[10].id.value());
  EXPECT_EQ(diff.points.added.size(), 0U);
  EXPECT_EQ(diff.points.changed, 1U);
  ASSERT_EQ(diff.motions.size(), 1U);
  EXPECT_NEAR(diff.motions[0].point_distance.max, 0.25, 1e-6);
  EXPECT_EQ(diff.keyframes.before + diff.keyframes.after, 0U);
}

TEST(Clouds, MayHaveNoNormalsAndRanges) {
  const Atlas atlas = World();
  Atlas cloud = Through(atlas, "ply");
  for (MapPoint& point : cloud.maps[0].points) point.normal.setZero(), point.min_distance = point.max_distance = 0;
  EXPECT_EQ(Compared(atlas, cloud).verdict(), AtlasDiff::Verdict::kSame);
}

TEST(Clouds, LeaveAtlasesWithKeyFramesAlone) {
  Atlas before = World(), after = World();
  const Atlas copy = before;
  EXPECT_FALSE(KeepWhatCloudsHold(before, after));
  EXPECT_THAT(before, EqualsAtlas(copy));
  Atlas empty, cloud = Through(before, "ply"), same = cloud;
  EXPECT_FALSE(KeepWhatCloudsHold(cloud, same)) << "both are of one kind";
  EXPECT_FALSE(KeepWhatCloudsHold(before, empty)) << "nothing is no cloud";
}

}  // namespace
}  // namespace slamdb
