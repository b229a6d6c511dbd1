// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/camera.h"

#include "slamdb/base/error.h"
#include "tests/live/world.h"

namespace slamdb::live {
namespace {

TEST(Pinhole, ProjectsAndUnprojects) {
  const Pinhole camera({100, 200, 320, 240});
  EXPECT_EQ(camera.project(Eigen::Vector3f(1, 1, 2)), Eigen::Vector2f(370, 340));
  EXPECT_EQ(camera.project(cv::Point3f(1, 1, 2)), cv::Point2f(370, 340));
  EXPECT_EQ(camera.project(Eigen::Vector3d(1, 1, 2)), Eigen::Vector2d(370, 340));
  EXPECT_TRUE(camera.project(Eigen::Vector3f(1, 1, -2)).hasNaN());
  EXPECT_EQ(camera.unprojectEig({370, 340}), Eigen::Vector3f(0.5F, 0.5F, 1));
  EXPECT_EQ(camera.unproject({370, 340}), cv::Point3f(0.5F, 0.5F, 1));
  EXPECT_EQ(camera.toK_()(1, 1), 200);
  EXPECT_EQ(camera.toK().at<float>(0, 2), 320);
  EXPECT_EQ(camera.GetType(), GeometricCamera::CAM_PINHOLE);
  EXPECT_EQ(camera.size(), 4U);
  EXPECT_THROW(Pinhole({1, 2}), Error);
}

TEST(KannalaBrandt8, ProjectsAndUnprojects) {
  const KannalaBrandt8 plain({100, 100, 320, 240, 0, 0, 0, 0});
  const Eigen::Vector2f pixel = plain.project(Eigen::Vector3f(1, 0, 1));  // 45 degrees: radius pi / 4
  EXPECT_NEAR(pixel.x(), 320 + 100 * M_PI / 4, 1e-3);
  EXPECT_FLOAT_EQ(pixel.y(), 240);
  const KannalaBrandt8 lens({190, 190, 254, 256, 0.003F, 0.001F, -0.002F, 0.0002F});
  EXPECT_EQ(lens.GetType(), GeometricCamera::CAM_FISHEYE);
  for (const Eigen::Vector3f& ray : {Eigen::Vector3f(0.3F, -0.2F, 1), Eigen::Vector3f(-1.5F, 0.4F, 1)}) {
    const Eigen::Vector2f seen = lens.project(ray);
    EXPECT_LT((lens.unprojectEig({seen.x(), seen.y()}) - ray).norm(), 1e-4F);
  }
}

TEST(Frame, SeesWhatIsInItsFrustum) {
  World world;
  KeyFrame* keyframe = world.AddKeyFrame();
  MapPoint* point = world.AddPoint(keyframe, {1, 0, 4});
  World::Observe(point, keyframe, 3);
  point->UpdateNormalAndDepth();  // range: from 4 * 8 / 128 to 4 * 8
  Frame frame = world.MakeFrame({0, 0, 0});
  EXPECT_TRUE(frame.isInFrustum(point, 0.5F));
  EXPECT_TRUE(point->mbTrackInView);
  EXPECT_FALSE(point->mbTrackInViewR);
  EXPECT_FLOAT_EQ(point->mTrackProjX, 345);
  EXPECT_FLOAT_EQ(point->mTrackProjY, 240);
  EXPECT_FLOAT_EQ(point->mTrackProjXR, 345 - 10.0F / 4);
  EXPECT_FLOAT_EQ(point->mTrackViewCos, 1);
  EXPECT_EQ(point->mnTrackScaleLevel, 3);
  frame.SetPose({Quaternionf::Identity(), {0, 0, 100}});
  EXPECT_FALSE(frame.isInFrustum(point, 0.5F)) << "too far";
  frame.SetPose({Quaternionf::Identity(), {20, 0, 0}});
  EXPECT_FALSE(frame.isInFrustum(point, 0.5F)) << "outside the image";
  frame.SetPose({Quaternionf::Identity(), {0, 0, -5}});
  EXPECT_FALSE(frame.isInFrustum(point, 0.5F)) << "behind";
  frame.SetPose({Quaternionf(0, 0, 1, 0), {0, 0, 8}});  // from the other side
  EXPECT_FALSE(frame.isInFrustum(point, 0.5F)) << "viewing angle";
}

TEST(Frame, LeavesNoTraceOfAnEarlierHit) {
  World world;
  KeyFrame* keyframe = world.AddKeyFrame();
  MapPoint* point = world.AddPoint(keyframe, {1, 0, 4});
  World::Observe(point, keyframe, 3);
  point->UpdateNormalAndDepth();
  Frame frame = world.MakeFrame({0, 0, 0});
  const Rigid3f misses[] = {{Quaternionf::Identity(), {0, 0, 100}},  // too far
                            {Quaternionf::Identity(), {20, 0, 0}},   // outside the image
                            {Quaternionf::Identity(), {0, 0, -5}},   // behind
                            {Quaternionf(0, 0, 1, 0), {0, 0, 8}}};   // from the other side
  for (const Rigid3f& miss : misses) {
    frame.SetPose({});
    ASSERT_TRUE(frame.isInFrustum(point, 0.5F));
    frame.SetPose(miss);
    ASSERT_FALSE(frame.isInFrustum(point, 0.5F));
    EXPECT_FALSE(point->mbTrackInView);
    EXPECT_EQ(point->mTrackProjX, -1);
    EXPECT_EQ(point->mTrackProjY, -1);
    EXPECT_EQ(point->mTrackProjXR, -1);
    EXPECT_EQ(point->mnTrackScaleLevel, -1);
  }
}

TEST(Frame, KeepsTheImagesOfAPairApart) {
  World world(Eyes::kFisheyePair);
  KeyFrame* keyframe = world.AddKeyFrame();
  MapPoint* point = world.AddPoint(keyframe, {0, 0, 4});
  World::Observe(point, keyframe, 3);
  point->UpdateNormalAndDepth();
  Frame frame = world.MakeFrame({0, 0, 0});
  ASSERT_TRUE(frame.isInFrustum(point, 0.5F));
  ASSERT_TRUE(point->mbTrackInView && point->mbTrackInViewR);
  EXPECT_GE(point->mnTrackScaleLevelR, 0);
  frame.SetPose({Quaternionf(Eigen::AngleAxisf(1.3F, Eigen::Vector3f::UnitY())), {0, 0, 0}});
  frame.isInFrustum(point, 0.999F);
  EXPECT_EQ(point->mTrackProjX >= 0, point->mbTrackInView);
  EXPECT_EQ(point->mTrackProjXR >= 0, point->mbTrackInViewR);
  frame.SetPose({Quaternionf::Identity(), {0, 0, 100}});
  ASSERT_FALSE(frame.isInFrustum(point, 0.5F));
  EXPECT_EQ(point->mTrackProjX, -1);
  EXPECT_EQ(point->mTrackProjXR, -1);
  EXPECT_EQ(point->mTrackProjYR, -1);
  EXPECT_EQ(point->mnTrackScaleLevel, -1);
  EXPECT_EQ(point->mnTrackScaleLevelR, -1);
}

TEST(GeometricCamera, KnowsItsParameters) {
  Pinhole camera({1, 2, 3, 4});
  camera.setParameter(7, 2);
  EXPECT_EQ(camera.getParameter(2), 7);
  EXPECT_EQ(KindOf([&] { (void)camera.getParameter(-1); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { camera.setParameter(1, 4); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { Pinhole made({1, 2, 3}); }), ErrorKind::kUsage);
}

}  // namespace
}  // namespace slamdb::live
