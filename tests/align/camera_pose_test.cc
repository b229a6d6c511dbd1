// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/camera_pose.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <optional>
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

// The left picture of a keyframe, whose keypoints lie where a camera of another focal length would have its points.
class Shot {
 public:
  explicit Shot(Sensor sensor, double focal_factor = 1)
      : atlas_(SynthesizeAtlas({.sensor = sensor, .keyframes = 12, .points = 600, .pixel_noise = 0, .threads = 1})),
        map_(atlas_, 0, 1),
        features_(FeaturesOf(atlas_, atlas_.maps[0].keyframes[5])),
        truth_(PoseOf(map_.views()[map_.LeftView(5)])) {
    Camera camera = features_.camera;
    for (const std::size_t focal : {0U, 1U}) camera.parameters[focal] *= static_cast<float>(focal_factor);
    const Lens lens = *Lens::Of(camera);
    for (const Seen& seen : map_.SeenBy(map_.LeftView(5))) {
      Eigen::Vector2d pixel;
      if (!lens.Project(truth_ * map_.points()[seen.point].position, pixel)) continue;
      features_.keypoints[seen.keypoint].x = static_cast<float>(pixel.x());
      features_.keypoints[seen.keypoint].y = static_cast<float>(pixel.y());
      matches_.push_back({seen.keypoint, seen.point, 0});
    }
    exact_.assign(features_.keypoints.begin(), features_.keypoints.end());
    query_ = MakeQuery(features_);
  }
  Shot(const Shot&) = delete;
  Shot& operator=(const Shot&) = delete;

  // Moves each keypoint by a standard deviation of its level.
  void AddNoise(std::mt19937_64& draws) {
    std::normal_distribution<float> normal;
    for (std::size_t row = 0; row < exact_.size(); ++row) {
      const auto sigma = static_cast<float>(query_->view.ScaleOf(exact_[row].octave));
      features_.keypoints[row].x = exact_[row].x + sigma * normal(draws);
      features_.keypoints[row].y = exact_[row].y + sigma * normal(draws);
    }
  }

  PoseFinder finder() const { return {map_, query_->view, query_->rays}; }
  const CameraPose& truth() const { return truth_; }
  const std::vector<PictureMatch>& matches() const { return matches_; }

 private:
  const Atlas atlas_;
  const MapViews map_;
  PictureFeatures features_;  // the query refers to its keypoints
  const CameraPose truth_;
  std::vector<PictureMatch> matches_;
  std::vector<Keypoint> exact_;
  std::optional<PictureQuery> query_;
};

class EveryLens : public ::testing::TestWithParam<Sensor> {};
INSTANTIATE_TEST_SUITE_P(Lenses, EveryLens, ::testing::Values(Sensor::kStereo, Sensor::kFisheyeStereo));

TEST_P(EveryLens, FindsTheFocalLengthThatTookThePicture) {
  for (const double factor : {0.9, 1.0, 1.05}) {
    const Shot shot(GetParam(), factor);
    ASSERT_GE(shot.matches().size(), 40U);
    EXPECT_NEAR(shot.finder().FitFocalLength(shot.matches(), shot.truth()).factor, factor, 1e-3);
    CameraPose start = shot.truth();  // as where a pose was found with the wrong one
    start.translation += Eigen::Vector3d(0.02, -0.03, 0.05);
    EXPECT_NEAR(shot.finder().FitFocalLength(shot.matches(), start).factor, factor, 1e-3);
  }
}

// Over many draws of the keypoints' noise, errors are as large as the covariance says: of rotation, then of position.
TEST_P(EveryLens, CovarianceIsThatOfManyTrials) {
  constexpr int kTrials = 100;
  Shot shot(GetParam());
  std::mt19937_64 draws(11);
  Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero(), claimed = sum;
  double focal_sum = 0, focal_claimed = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    shot.AddNoise(draws);
    const PoseFit fit = shot.finder().Refine(shot.matches(), shot.truth(), 20);
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(fit.pose.rotation.transpose() * shot.truth().rotation));
    Eigen::Matrix<double, 6, 1> error;
    error << turn.angle() * turn.axis(), fit.pose.center() - shot.truth().center();
    sum += error * error.transpose() / kTrials;
    claimed += fit.covariance / kTrials;
    const FocalFit focal = shot.finder().FitFocalLength(shot.matches(), shot.truth());
    focal_sum += (focal.factor - 1) * (focal.factor - 1) / kTrials;
    focal_claimed += focal.deviation * focal.deviation / kTrials;
  }
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(std::sqrt(sum(i, i) / claimed(i, i)), 1, 0.3) << i;
  EXPECT_NEAR(std::sqrt(focal_sum / focal_claimed), 1, 0.3);
  EXPECT_GT(claimed.diagonal().tail(3).sum(), 4 * claimed.diagonal().head(3).sum())
      << "or it would not show which block is which";
  const Eigen::Matrix<double, 6, 1> shares = claimed.diagonal().cwiseSqrt();
  for (int i = 0; i < 6; ++i)  // errors of rotation and position hang together as the covariance says
    for (int j = 0; j < i; ++j)
      EXPECT_NEAR(sum(i, j) / (shares[i] * shares[j]), claimed(i, j) / (shares[i] * shares[j]), 0.5) << i << " " << j;
}

}  // namespace
}  // namespace slamdb::detail
