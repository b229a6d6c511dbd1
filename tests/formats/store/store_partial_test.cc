// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

class StorePartial : public ::testing::Test {
 protected:
  StorePartial() : atlas_(SoundAtlas()) { SaveIn(path_, atlas_); }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
  Atlas atlas_;
};

TEST_F(StorePartial, ByMap) {
  ReadOptions options;
  options.selection.map = atlas_.maps[1].id;
  const Atlas part = LoadFrom(path_, "a", options);
  Atlas expected = atlas_;
  expected.maps.erase(expected.maps.begin());
  EXPECT_EQ(FirstDifference(part, expected), "");
}

TEST_F(StorePartial, ByKeyframeRange) {
  ReadOptions options;
  options.selection.first_keyframe = 3;
  options.selection.last_keyframe = 6;
  const Atlas part = LoadFrom(path_, "a", options);
  Atlas expected = atlas_;
  for (Map& map : expected.maps) {
    std::erase_if(map.keyframes, [](const KeyFrame& k) { return k.id.value() < 3 || k.id.value() > 6; });
  }
  EXPECT_EQ(FirstDifference(part, expected), "");
}

TEST_F(StorePartial, ByTime) {
  ReadOptions options;
  const auto& keyframes = atlas_.maps[0].keyframes;
  options.selection.begin_time = keyframes[2].timestamp;
  options.selection.end_time = keyframes[5].timestamp;
  const Atlas part = LoadFrom(path_, "a", options);
  ASSERT_EQ(part.maps[0].keyframes.size(), 4U);
  EXPECT_EQ(part.maps[0].keyframes.front().id, keyframes[2].id);
  EXPECT_EQ(part.maps[0].keyframes.back().id, keyframes[5].id);
}

TEST_F(StorePartial, ByBox) {
  Eigen::AlignedBox3f box;
  for (std::size_t i = 0; i < 40; ++i) box.extend(atlas_.maps[0].points[i].position);
  const Eigen::Vector3f shrink = 0.2F * box.sizes();
  for (const auto& tried : {box, Eigen::AlignedBox3f(box.min() + shrink, box.max() - shrink)}) {
    ReadOptions options;
    options.selection.box = tried;
    const Atlas part = LoadFrom(path_, "a", options);
    Atlas expected = atlas_;
    for (Map& map : expected.maps)
      std::erase_if(map.points, [&](const MapPoint& p) { return !tried.contains(p.position); });
    EXPECT_EQ(FirstDifference(part, expected), "");
    EXPECT_LT(part.maps[0].points.size(), atlas_.maps[0].points.size());
  }
}

TEST_F(StorePartial, UnboundedBoxFindsPointsAtInfinityAndNoNan) {
  SaveIn(path_, OddAtlas(), "odd");
  const float infinity = std::numeric_limits<float>::infinity();
  ReadOptions options;
  options.selection.box = Eigen::AlignedBox3f(Eigen::Vector3f(0.5F, 0, 0), Eigen::Vector3f::Constant(infinity));
  const Atlas part = LoadFrom(path_, "odd", options);
  ASSERT_EQ(part.maps[0].points.size(), 2U);
  EXPECT_EQ(part.maps[0].points[0].id, MapPointId(8));
  EXPECT_EQ(part.maps[0].points[1].id, MapPointId(0x8000000000000001U));
}

TEST_F(StorePartial, IdsBeyondTheSignBit) {
  SaveIn(path_, OddAtlas(), "odd");
  const auto ids = [&](std::uint64_t first, std::uint64_t last) {
    ReadOptions options;
    options.selection.first_keyframe = first;
    options.selection.last_keyframe = last;
    const Atlas part = LoadFrom(path_, "odd", options);
    std::vector<std::uint64_t> found;
    for (const KeyFrame& keyframe : part.maps[0].keyframes) found.push_back(keyframe.id.value());
    return found;
  };
  EXPECT_THAT(ids(2, 0xfedcba9876543210U), ::testing::ElementsAre(2, 2, 2, 0xfedcba9876543210U));
  EXPECT_THAT(ids(0xfedcba9876543210U, 0xfffffffffffffffeU), ::testing::ElementsAre(0xfedcba9876543210U));
  EXPECT_THAT(ids(1, 1), ::testing::ElementsAre(1));
}

TEST_F(StorePartial, WithoutFeatures) {
  ReadOptions options;
  options.features = FeatureColumns::kNone;
  const Atlas part = LoadFrom(path_, "a", options);
  Atlas expected = atlas_;
  for (Map& map : expected.maps) {
    for (KeyFrame& keyframe : map.keyframes) {
      const Features& old = keyframe.features;
      Features counts;
      counts.count = old.count;
      counts.left_count = old.left_count;
      counts.right_count = old.right_count;
      keyframe.features = counts;
    }
  }
  EXPECT_EQ(FirstDifference(part, expected), "");
}

// What is not selected is not even read: damage there goes unnoticed.
TEST_F(StorePartial, TheRestIsNotRead) {
  Sql(path_,
      "UPDATE keyframe_features SET points = x'00' WHERE keyframe IN "
      "(SELECT row FROM keyframe WHERE id = (SELECT max(id) FROM keyframe))");
  ReadOptions options;
  options.selection.map = atlas_.maps[0].id;
  EXPECT_NO_THROW(LoadFrom(path_, "a", options));
  EXPECT_THAT(ErrorOf([&] { LoadFrom(path_); }), ::testing::HasSubstr("table keyframe_features, row "));
}

TEST_F(StorePartial, PartSizes) {
  std::vector<PartSize> sizes;
  ReadOptions options;
  options.part_sizes = &sizes;
  LoadFrom(path_, "a", options);
  ASSERT_FALSE(sizes.empty());
  EXPECT_EQ(sizes[0].part, "features");
  EXPECT_GT(sizes[0].bytes, 10000U);
}

}  // namespace
}  // namespace slamdb::store_test
