// SPDX-License-Identifier: BSD-3-Clause
// Live map points, whose links go through PreSave and PostLoad.
#include "slamdb/live/boost.h"
#include "slamdb/live/bridge.h"
#include "tests/boost/archives.h"
#include "tests/boost/points.h"
#include "tests/live/world.h"

namespace slamdb::live {
namespace {

using slamdb::testing::Load;
using slamdb::testing::Loaded;
using slamdb::testing::Saved;

template <class Kind>
class BoostLive : public ::testing::Test {
 protected:
  BoostLive() : world_(Eyes::kStereo) {
    for (int i = 0; i < 2; ++i) keyframes_[i] = world_.AddKeyFrame({static_cast<float>(i), 0, 0});
    for (int i = 0; i < 2; ++i) {
      points_[i] = world_.AddPoint(keyframes_[0], {0, static_cast<float>(i), 4});
      for (int k = 0; k < 2; ++k) World::Observe(points_[i], keyframes_[k], 4 * i + k);
      points_[i]->ComputeDistinctiveDescriptors();
      points_[i]->UpdateNormalAndDepth();
    }
    keyframe_set_ = {keyframes_[0], keyframes_[1]};
    point_set_ = {points_[0], points_[1]};
  }

  World world_;
  KeyFrame* keyframes_[2];
  MapPoint* points_[2];
  std::set<KeyFrame*> keyframe_set_;
  std::set<MapPoint*> point_set_;
};
TYPED_TEST_SUITE(BoostLive, slamdb::testing::Kinds);

TYPED_TEST(BoostLive, APointComesBackWithItsLinks) {
  MapPoint& point = *this->points_[1];
  point.PreSave(this->keyframe_set_, this->point_set_);
  const std::string bytes = Saved<TypeParam>(point);

  MapPoint other({9, 9, 9}, this->keyframes_[1], this->world_.map());
  Load<TypeParam>(bytes, other);
  EXPECT_EQ(other.mnId, point.mnId);
  EXPECT_EQ(other.mnFirstKFid, point.mnFirstKFid);
  EXPECT_EQ(other.mnFirstFrame, point.mnFirstFrame);
  EXPECT_EQ(other.nObs, point.nObs);
  EXPECT_EQ(other.GetWorldPos(), point.GetWorldPos());
  EXPECT_EQ(other.GetNormal(), point.GetNormal());
  EXPECT_EQ(other.GetMaxDistanceInvariance(), point.GetMaxDistanceInvariance());
  EXPECT_EQ(other.GetMinDistanceInvariance(), point.GetMinDistanceInvariance());
  const cv::Mat descriptor = point.GetDescriptor(), other_descriptor = other.GetDescriptor();
  ASSERT_EQ(descriptor.total(), 32U);
  EXPECT_TRUE(std::equal(descriptor.datastart, descriptor.dataend, other_descriptor.datastart));
  EXPECT_FALSE(other.isBad());

  std::map<long unsigned int, KeyFrame*> keyframes;
  for (KeyFrame* keyframe : this->keyframes_) keyframes[keyframe->mnId] = keyframe;
  std::map<long unsigned int, MapPoint*> points;
  other.PostLoad(keyframes, points);
  EXPECT_EQ(other.GetObservations(), point.GetObservations());
  EXPECT_EQ(other.GetReferenceKeyFrame(), this->keyframes_[0]);
}

// The same bytes as the point of the atlas at rest, and as another program's class: each reads the others'.
TYPED_TEST(BoostLive, APointAtRestIsTheSameBytes) {
  const orb::MapPoint theirs = orb::MakePoint(3);
  const std::string bytes = Saved<TypeParam>(theirs);
  MapPoint point({9, 9, 9}, this->keyframes_[0], this->world_.map());
  Load<TypeParam>(bytes, point);
  EXPECT_EQ(point.mnId, 3U);
  EXPECT_EQ(point.mBackupObservationsId1, theirs.mBackupObservationsId1);
  EXPECT_EQ(point.mBackupObservationsId2, theirs.mBackupObservationsId2);
  EXPECT_EQ(point.mBackupRefKFId, 9U);
  EXPECT_EQ(static_cast<long long>(point.mBackupReplacedId), 88);
  EXPECT_TRUE(Saved<TypeParam>(point) == bytes);
  const auto at_rest = Loaded<slamdb::MapPoint, TypeParam>(Saved<TypeParam>(point));
  slamdb::testing::ExpectSame(at_rest, theirs);
  EXPECT_TRUE(Saved<TypeParam>(at_rest) == bytes);
}

// No archive holds a point's counters and origin: they are not recorded afterwards either.
TYPED_TEST(BoostLive, WhatTheArchiveDoesNotHoldStaysUnrecorded) {
  const std::string bytes = Saved<TypeParam>(*this->points_[1]);
  auto* point = new MapPoint();
  Load<TypeParam>(bytes, *point);
  point->mnId = MapPointId::kNone;
  point->UpdateMap(this->world_.map());
  this->world_.map()->AddMapPoint(point);
  EXPECT_EQ(point->mnOriginMapId, this->world_.map()->GetId());
  const slamdb::Atlas atlas = ToModel(this->world_.atlas);
  const slamdb::MapPoint& record =
      *std::ranges::find(atlas.maps[0].points, MapPointId(point->mnId), &slamdb::MapPoint::id);
  EXPECT_FALSE(record.has_tracking());
}

TYPED_TEST(BoostLive, NoLinksWithoutPreSave) {
  MapPoint point({1, 2, 3}, this->keyframes_[0], this->world_.map());
  const auto record = Loaded<slamdb::MapPoint, TypeParam>(Saved<TypeParam>(point));
  EXPECT_TRUE(record.observations.empty());
  EXPECT_FALSE(record.reference.has_value());
  EXPECT_FALSE(record.replaced_by.has_value());
  EXPECT_FALSE(record.has_descriptor());
  EXPECT_EQ(record.position, Eigen::Vector3f(1, 2, 3));
}

}  // namespace
}  // namespace slamdb::live
