// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/index.h"

#include <gmock/gmock.h>

#include <random>
#include <unordered_map>

namespace slamdb {
namespace {

using ::testing::ElementsAre;

Map MapOf(std::uint64_t id, std::initializer_list<std::uint64_t> keyframes,
          std::initializer_list<std::uint64_t> points) {
  Map map;
  map.id = MapId(id);
  for (const std::uint64_t keyframe : keyframes) map.keyframes.emplace_back().id = KeyFrameId(keyframe);
  for (const std::uint64_t point : points) map.points.emplace_back().id = MapPointId(point);
  return map;
}

TEST(AtlasIndex, FindsRowsPerMapAndAnywhere) {
  Atlas atlas;
  atlas.maps.push_back(MapOf(0, {5, 3, 9}, {100, 7}));
  atlas.maps.push_back(MapOf(4, {46, 47}, {~std::uint64_t{1}, 1}));
  atlas.cameras.push_back({.id = CameraId(2)});
  const AtlasIndex index(atlas);
  EXPECT_EQ(index.KeyFrameRow(0, KeyFrameId(9)), 2u);
  EXPECT_EQ(index.KeyFrameRow(0, KeyFrameId(46)), kNoRow);
  EXPECT_EQ(index.FindKeyFrame(1, KeyFrameId(47)), &atlas.maps[1].keyframes[1]);
  EXPECT_EQ(index.LocateKeyFrame(KeyFrameId(47)), (EntityRow{1, 1}));
  EXPECT_FALSE(index.LocateKeyFrame(KeyFrameId(4)));
  EXPECT_EQ(index.FindPoint(1, MapPointId(~std::uint64_t{1})), &atlas.maps[1].points[0]);
  EXPECT_EQ(index.LocatePoint(MapPointId(7)), (EntityRow{0, 1}));
  EXPECT_EQ(index.MapRow(MapId(4)), 1u);
  EXPECT_EQ(index.FindCamera(CameraId(2)), &atlas.cameras[0]);
  EXPECT_EQ(index.FindCamera(CameraId(0)), nullptr);
  EXPECT_TRUE(index.duplicate_keyframes().empty());
}

TEST(AtlasIndex, NeverFindsNone) {
  Atlas atlas;
  atlas.maps.push_back(MapOf(0, {MapId::kNone, 0}, {MapId::kNone}));
  const AtlasIndex index(atlas);
  EXPECT_EQ(index.KeyFrameRow(0, KeyFrameId()), kNoRow);
  EXPECT_EQ(index.FindPoint(0, MapPointId()), nullptr);
  EXPECT_FALSE(index.LocatePoint(MapPointId()));
}

TEST(AtlasIndex, KnowsDuplicates) {
  Atlas atlas;
  atlas.maps.push_back(MapOf(0, {1, 2, 1}, {}));
  atlas.maps.push_back(MapOf(0, {8, 2}, {}));
  const AtlasIndex index(atlas);
  EXPECT_EQ(index.KeyFrameRow(0, KeyFrameId(1)), 0u);
  EXPECT_THAT(index.duplicate_keyframes(), ElementsAre(DuplicateId{{0, 2}, {0, 0}}, DuplicateId{{1, 1}, {0, 1}}));
  EXPECT_THAT(index.duplicate_maps(), ElementsAre(DuplicateId{{0, 1}, {0, 0}}));
}

TEST(AtlasIndex, OfNothing) {
  const Atlas atlas;
  const AtlasIndex index(atlas);
  EXPECT_FALSE(index.LocateKeyFrame(KeyFrameId(0)));
  EXPECT_EQ(index.MapRow(MapId(0)), kNoRow);
}

// Dense and sparse ids alike agree with a standard map.
TEST(IdTable, AgreesWithAStandardMap) {
  std::mt19937_64 random(7);
  for (const std::uint64_t spread : {std::uint64_t{500}, std::uint64_t{20'000}, ~std::uint64_t{0} - 1}) {
    std::vector<std::uint64_t> ids(1000);
    for (std::uint64_t& id : ids) id = random() % spread;
    const auto [lowest, highest] = std::ranges::minmax(ids);
    IdTable table(lowest, highest, ids.size());
    std::unordered_map<std::uint64_t, std::uint32_t> expected;
    for (std::uint32_t row = 0; row < ids.size(); ++row) {
      const auto [place, is_new] = expected.emplace(ids[row], row);
      EXPECT_EQ(table.Insert(ids[row], row), is_new ? kNoRow : place->second);
    }
    for (const auto& [id, row] : expected) EXPECT_EQ(table.Find(id), row);
    for (int i = 0; i < 1000; ++i) {
      const std::uint64_t id = random();
      EXPECT_EQ(table.Find(id), expected.contains(id) ? expected[id] : kNoRow);
    }
    EXPECT_EQ(table.Find(MapId::kNone), kNoRow);
  }
}

}  // namespace
}  // namespace slamdb
