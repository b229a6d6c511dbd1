// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/camera_pose.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "slamdb/align/detail/picture_query.h"
#include "slamdb/synthetic/synthesize.h"

namespace slamdb::detail {
namespace {

double DistanceOf(const CameraPose& one, const CameraPose& other) {
  return (one.rotation - other.rotation).norm() + (one.translation - other.translation).norm();
}

TEST(SolveP3p, FindsThePoseAmongAtMostFour) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int trial = 0; trial < 500; ++trial) {
    CameraPose truth;
    truth.rotation = Eigen::Quaterniond(number(random), number(random), number(random), number(random))
                         .normalized()
                         .toRotationMatrix();
    truth.translation = {number(random), number(random), number(random)};
    std::array<Eigen::Vector3d, 3> rays, points;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d in_camera(number(random), number(random), 2 + number(random));
      rays[i] = in_camera.normalized();
      points[i] = truth.rotation.transpose() * (in_camera - truth.translation);
    }
    const std::vector<CameraPose> poses = SolveP3p(rays, points);
    EXPECT_LE(poses.size(), 4U);
    double nearest = 1;
    for (const CameraPose& pose : poses) nearest = std::min(nearest, DistanceOf(pose, truth));
    EXPECT_LT(nearest, 1e-4) << "trial " << trial;
  }
}

TEST(SolveP3p, HasNoneForPointsOnALineOrNowhere) {
  const std::array<Eigen::Vector3d, 3> rays = {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.1, 0, 1).normalized(),
                                               Eigen::Vector3d(0.2, 0, 1).normalized()};
  EXPECT_TRUE(SolveP3p(rays, {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(2, 0, 0)}).empty());
  const Eigen::Vector3d nan = Eigen::Vector3d::Constant(std::nan(""));
  EXPECT_TRUE(SolveP3p(rays, {nan, nan, nan}).empty());
}

// A keyframe of a synthetic map, its points, and its own pose as the truth.
class PoseFinderTest : public ::testing::Test {
 protected:
  PoseFinderTest()
      : atlas_(SynthesizeAtlas({.sensor = Sensor::kStereo, .keyframes = 12, .points = 600, .threads = 1})),
        map_(atlas_, 0, 1),
        features_(FeaturesOf(atlas_, atlas_.maps[0].keyframes[5])),
        query_(*MakeQuery(features_)),
        finder_(map_, query_.view, query_.rays),
        truth_(PoseOf(map_.views()[5])) {
    for (const Seen& seen : map_.SeenBy(5)) matches_.push_back({seen.keypoint, seen.point, 0});
  }

  const Atlas atlas_;
  const MapViews map_;
  const PictureFeatures features_;
  const PictureQuery query_;
  const PoseFinder finder_;
  const CameraPose truth_;
  std::vector<PictureMatch> matches_;
};

TEST_F(PoseFinderTest, FindsThePoseThoughMostMatchesAreWrong) {
  ASSERT_GE(matches_.size(), 40U);
  std::vector<PictureMatch> mixed;
  for (std::size_t i = 0; i < matches_.size(); ++i) {
    PictureMatch match = matches_[i];
    if (i % 5 >= 2) match.point = matches_[(i * 7 + 3) % matches_.size()].point;  // three of five
    mixed.push_back(match);
  }
  const auto found = finder_.Find(mixed, 8, 1);
  ASSERT_TRUE(found);
  const CameraPose refined = finder_.Refine(finder_.InliersOf(mixed, *found), *found).pose;
  EXPECT_LT((refined.center() - truth_.center()).norm(), 0.05);
  EXPECT_EQ(finder_.Find(mixed, 8, 1)->translation, found->translation);
}

TEST_F(PoseFinderTest, FindsNothingWhereNothingAgrees) {
  std::vector<PictureMatch> wrong = matches_;
  for (std::size_t i = 0; i < wrong.size(); ++i) wrong[i].point = matches_[(i * 7 + 3) % matches_.size()].point;
  EXPECT_FALSE(finder_.Find(wrong, wrong.size() / 2, 1));
  EXPECT_FALSE(finder_.Find({}, 8, 1));
}

TEST_F(PoseFinderTest, RefinesToTheLeastCostAndSaysHowSureItIs) {
  CameraPose start = truth_;
  start.translation += Eigen::Vector3d(0.05, -0.03, 0.04);
  const PoseFit fit = finder_.Refine(matches_, start);
  EXPECT_LT((fit.pose.center() - truth_.center()).norm(), 0.02);
  EXPECT_EQ(fit.residuals, 2 * matches_.size());
  // At the minimum no small motion costs less: the numeric check of the derivatives.
  const double step = 1e-4;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      CameraPose moved = fit.pose;
      moved.translation[axis] += sign * step;
      EXPECT_GE(finder_.Refine(matches_, moved, 0).cost, fit.cost) << axis;
      moved = fit.pose;
      moved.rotation = Eigen::AngleAxisd(sign * step, Eigen::Vector3d::Unit(axis)).toRotationMatrix() * moved.rotation;
      EXPECT_GE(finder_.Refine(matches_, moved, 0).cost, fit.cost) << axis;
    }
  }
  const Eigen::VectorXd sigma = fit.covariance.diagonal().cwiseSqrt();
  EXPECT_GT(sigma.minCoeff(), 0);
  EXPECT_LT(sigma.maxCoeff(), 0.05);
}

}  // namespace
}  // namespace slamdb::detail
