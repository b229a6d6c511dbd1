// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/covariance.h"

#include <gmock/gmock.h>

#include <Eigen/LU>
#include <cmath>

#include "slamdb/model/derive.h"
#include "slamdb/synthetic/detail/random.h"

namespace slamdb {
namespace {

using synthetic::Random;

const Camera kPinhole{.id = CameraId(0), .model = CameraModel::kPinhole, .parameters = {500, 400, 320, 240}};
const Camera kFisheye{.id = CameraId(0),
                      .model = CameraModel::kKannalaBrandt8,
                      .parameters = {200, 210, 320, 240, 0.01F, -0.02F, 0.003F, 0.0004F}};
constexpr float kBaselineFx = 50;

Eigen::Vector2d ProjectWide(const Camera& camera, const Eigen::Vector3d& x) {
  return Project(camera, x.cast<float>())->cast<double>();
}

TEST(ProjectionJacobian, IsTheDerivativeOfProject) {
  for (const Camera& camera : {kPinhole, kFisheye})
    for (const Eigen::Vector3d& x : {Eigen::Vector3d(0.3, -0.2, 2), Eigen::Vector3d(0, 0, 1.5),
                                     Eigen::Vector3d(2, 3, 1), Eigen::Vector3d(-0.7, 0, 0.9)}) {
      const auto jacobian = ProjectionJacobian(camera, x);
      ASSERT_TRUE(jacobian);
      constexpr double kStep = 1e-2;  // Project computes in float
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis);
        const Eigen::Vector2d slope = (ProjectWide(camera, x + step) - ProjectWide(camera, x - step)) / (2 * kStep);
        EXPECT_LT((jacobian->col(axis) - slope).norm(), 2e-3 * jacobian->norm()) << x.transpose();
      }
    }
  EXPECT_FALSE(ProjectionJacobian(kPinhole, {1, 1, -1}));
}

// Keyframes that look along z from `centers`, each with one keypoint on the point, at the octaves given.
struct World {
  Atlas atlas;
  MapPoint point;

  World(const Camera& camera, const Eigen::Vector3f& position, const std::vector<Eigen::Vector3f>& centers,
        const std::vector<int>& octaves, bool stereo = false) {
    atlas.cameras = {camera};
    Map& map = atlas.maps.emplace_back();
    point.position = position;
    for (std::size_t i = 0; i < centers.size(); ++i) {
      KeyFrame& keyframe = map.keyframes.emplace_back();
      keyframe.id = KeyFrameId(i);
      keyframe.camera = CameraId(0);
      keyframe.camera_from_world.translation = -centers[i];
      keyframe.pyramid = DerivePyramid(8, 1.2F);
      keyframe.intrinsics.baseline_fx = kBaselineFx;
      keyframe.features.undistorted.push_back({.x = 0, .y = 0, .class_id = -1, .octave = octaves[i]});
      keyframe.features.right_x.push_back(stereo ? 1.0F : -1.0F);
      point.observations.push_back({.keyframe = KeyFrameId(i), .left = 0});
    }
  }
  std::optional<Eigen::Matrix3d> Covariance(double sigma = 1) const {
    return PointCovariances(atlas, atlas.maps[0], sigma).Of(point);
  }
};

TEST(PointCovariances, AsComputedByHand) {
  // One stereo keyframe, the point straight ahead at depth z: u and v give x and y alone, the right image the depth
  // through u - baseline * fx / z.
  const double z = 4, fx = 500, fy = 400, bf = kBaselineFx;
  const auto covariance = World(kPinhole, {0, 0, 4}, {{0, 0, 0}}, {0}, true).Covariance(2);
  ASSERT_TRUE(covariance);
  EXPECT_NEAR((*covariance)(0, 0), 4 * z * z / (fx * fx), 1e-12);
  EXPECT_NEAR((*covariance)(1, 1), 4 * z * z / (fy * fy), 1e-12);
  EXPECT_NEAR((*covariance)(2, 2), 4 * 2 * std::pow(z, 4) / (bf * bf), 1e-7);  // u and u_right are equally noisy
  const auto coarse = World(kPinhole, {0, 0, 4}, {{0, 0, 0}}, {3}, true).Covariance(2);
  EXPECT_TRUE(coarse->isApprox(std::pow(1.2, 6) * *covariance, 1e-5));
}

TEST(PointCovariances, IsNotThereWithoutParallax) {
  EXPECT_FALSE(World(kPinhole, {0, 0, 4}, {{0, 0, 0}}, {0}).Covariance());
  EXPECT_FALSE(World(kPinhole, {0.5F, 0, 4}, {{0, 0, 0}, {0, 0, 0}}, {0, 1}).Covariance());
  EXPECT_FALSE(World(kPinhole, {0, 0, -4}, {{0, 0, 0}, {1, 0, 0}}, {0, 0}).Covariance());
  EXPECT_FALSE(World(kPinhole, {0, 0, 4}, {{0, 0, 0}, {1, 0, 0}}, {0, 99}).Covariance());
  EXPECT_FALSE(World(kPinhole, {NAN, 0, 4}, {{0, 0, 0}, {1, 0, 0}}, {0, 0}).Covariance());
}

// Draws noisy keypoints of the point again and again, triangulates each time by Gauss-Newton, and returns the spread.
Eigen::Matrix3d Spread(const World& world, double sigma, bool stereo) {
  const Camera& camera = world.atlas.cameras[0];
  const Eigen::Vector3d truth = world.point.position.cast<double>();
  constexpr int kTrials = 20'000;
  Random random({7});
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<Eigen::Vector3d> seen;  // u, v, u in the right image
    for (const KeyFrame& keyframe : world.atlas.maps[0].keyframes) {
      const Eigen::Vector3d x = truth + keyframe.camera_from_world.translation.cast<double>();
      const double noise = sigma * std::pow(1.2, keyframe.features.undistorted[0].octave);
      const Eigen::Vector2d pixel = ProjectWide(camera, x);
      seen.emplace_back(pixel.x() + noise * random.Normal(), pixel.y() + noise * random.Normal(),
                        pixel.x() - kBaselineFx / x.z() + noise * random.Normal());
    }
    Eigen::Vector3d estimate = truth;
    for (int step = 0; step < 4; ++step) {
      Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
      Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
      for (std::size_t i = 0; i < seen.size(); ++i) {
        const KeyFrame& keyframe = world.atlas.maps[0].keyframes[i];
        const Eigen::Vector3d x = estimate + keyframe.camera_from_world.translation.cast<double>();
        const double weight = std::pow(1.2, -2 * keyframe.features.undistorted[0].octave);
        Eigen::Matrix3d jacobian;
        jacobian.topRows<2>() = *ProjectionJacobian(camera, x);
        jacobian.row(2) = jacobian.row(0) + Eigen::RowVector3d(0, 0, kBaselineFx / (x.z() * x.z()));
        const Eigen::Vector2d pixel = ProjectWide(camera, x);
        Eigen::Vector3d residual = seen[i] - Eigen::Vector3d(pixel.x(), pixel.y(), pixel.x() - kBaselineFx / x.z());
        if (!stereo) jacobian.row(2).setZero();
        normal += weight * jacobian.transpose() * jacobian;
        gradient += weight * jacobian.transpose() * residual;
      }
      estimate += normal.inverse() * gradient;
    }
    spread += (estimate - truth) * (estimate - truth).transpose() / kTrials;
  }
  return spread;
}

void ExpectTheSpread(const World& world, double sigma, bool stereo) {
  const auto predicted = world.Covariance(sigma);
  ASSERT_TRUE(predicted);
  const Eigen::Matrix3d spread = Spread(world, sigma, stereo);
  EXPECT_LT((*predicted - spread).norm(), 0.05 * spread.norm()) << *predicted << "\n\n" << spread;
}

TEST(PointCovariances, PredictWhatMonteCarloFinds) {
  const std::vector<Eigen::Vector3f> centers{{0, 0, 0}, {0.4F, 0.1F, 0}, {0.9F, -0.2F, 0.3F}, {1.2F, 0, -0.5F}};
  ExpectTheSpread(World(kPinhole, {0.5F, -0.3F, 3}, centers, {0, 2, 1, 4}), 0.7, false);
  ExpectTheSpread(World(kPinhole, {-0.5F, 0.3F, 2}, {centers[0], centers[1]}, {1, 0}), 0.5, false);
  ExpectTheSpread(World(kPinhole, {0.5F, -0.3F, 3}, {centers[0], centers[2]}, {0, 2}, true), 0.5, true);
  ExpectTheSpread(World(kFisheye, {1.5F, -0.3F, 1.5F}, centers, {0, 2, 1, 4}), 0.3, false);
}

}  // namespace
}  // namespace slamdb
