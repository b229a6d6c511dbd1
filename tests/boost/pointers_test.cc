// SPDX-License-Identifier: BSD-3-Clause
// Objects through pointers. Boost tracks the classes that a program archives so, also their values: as another
// program's classes are.
#include <memory>

#include "slamdb/boost.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/boost/archives.h"
#include "tests/boost/points.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

using testing::Load;
using testing::Loaded;
using testing::Saved;

// ORB-SLAM3's class Map with our keyframes and points.
struct PointerMap {
  unsigned long mnId = 0, mnInitKFid = 0, mnMaxKFid = 0;
  int mnBigChangeIdx = 0;
  std::vector<KeyFrame*> keyframes;
  std::vector<MapPoint*> points;
  std::vector<unsigned long> mvBackupKeyFrameOriginsId;
  unsigned long mnBackupKFinitialID = 0, mnBackupKFlowerID = 0;
  bool mbImuInitialized = false, mbIsInertial = false, mbIMU_BA1 = false, mbIMU_BA2 = false;

  template <class Archive>
  void serialize(Archive& archive, const unsigned int /*version*/) {
    archive& mnId& mnInitKFid& mnMaxKFid& mnBigChangeIdx;
    archive& keyframes& points& mvBackupKeyFrameOriginsId;
    archive& mnBackupKFinitialID& mnBackupKFlowerID;
    archive& mbImuInitialized& mbIsInertial& mbIMU_BA1& mbIMU_BA2;
  }
};

template <class Kind>
class BoostPointer : public ::testing::Test {};
TYPED_TEST_SUITE(BoostPointer, testing::Kinds);

TYPED_TEST(BoostPointer, AListWithNullAndRepeatedPointersIsWhatAnotherProgramArchives) {
  orb::MapPoint first = orb::MakePoint(1), second = orb::MakePoint(2);
  const std::vector<orb::MapPoint*> theirs{&first, nullptr, &second, &first};
  const std::string bytes = Saved<TypeParam>(theirs);
  const auto points = Loaded<std::vector<MapPoint*>, TypeParam>(bytes);
  ASSERT_EQ(points.size(), 4U);
  const std::unique_ptr<MapPoint> first_again(points[0]), second_again(points[2]);
  EXPECT_EQ(points[1], nullptr);
  EXPECT_EQ(points[3], points[0]);
  testing::ExpectSame(*points[0], first);
  testing::ExpectSame(*points[2], second);
  EXPECT_TRUE(Saved<TypeParam>(points) == bytes);
}

TYPED_TEST(BoostPointer, ATrackedValueIsWhatAnotherProgramArchives) {
  const orb::MapPoint theirs = orb::MakePoint(7);
  const std::string bytes = Saved<TypeParam>(theirs);
  const auto point = Loaded<MapPoint, TypeParam>(bytes);
  testing::ExpectSame(point, theirs);
  EXPECT_TRUE(Saved<TypeParam>(point) == bytes);
}

TYPED_TEST(BoostPointer, AMapIsWhatAnotherProgramArchives) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 3, .points = 40, .features = 50, .threads = 1});
  Map& map = atlas.maps[0];
  map.repeated_points = {{.position = 3, .owner_map = 0, .row = 1}};
  PointerMap theirs;
  theirs.mnId = map.id.value();
  theirs.mnInitKFid = map.initial_keyframe.value();
  theirs.mnMaxKFid = map.max_keyframe_id;
  theirs.mnBigChangeIdx = map.big_change_index;
  for (KeyFrame& keyframe : map.keyframes) theirs.keyframes.push_back(&keyframe);
  for (MapPoint& point : map.points) theirs.points.push_back(&point);
  theirs.points.insert(theirs.points.begin() + 3, &map.points[1]);
  for (const KeyFrameId id : map.origins) theirs.mvBackupKeyFrameOriginsId.push_back(id.value());
  theirs.mnBackupKFinitialID = map.first_keyframe.value();
  theirs.mnBackupKFlowerID = map.lowest_keyframe.value();
  const std::string bytes = Saved<TypeParam>(theirs);
  EXPECT_TRUE(Saved<TypeParam>(map) == bytes);
  Atlas loaded = atlas;
  loaded.maps[0] = Loaded<Map, TypeParam>(bytes);
  EXPECT_EQ(FirstDifference(loaded, atlas), "");
}

// That the program archives pointers to points does not change what an atlas looks like, nor a point of the atlas what
// a pointer to it leads to.
TYPED_TEST(BoostPointer, AnAtlasIsItsOwn) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 3, .points = 40, .features = 50, .threads = 1});
  atlas.encoding = {};
  MapPoint* const point = &atlas.maps[0].points[2];
  const std::string bytes = Saved<TypeParam>(atlas, point);
  Atlas loaded;
  MapPoint* pointer = nullptr;
  Load<TypeParam>(bytes, loaded, pointer);
  const std::unique_ptr<MapPoint> owned(pointer);
  EXPECT_EQ(FirstDifference(loaded, atlas), "");
  ASSERT_NE(pointer, nullptr);
  EXPECT_EQ(pointer->position, point->position);
}

}  // namespace
}  // namespace slamdb
