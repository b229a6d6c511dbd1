// SPDX-License-Identifier: BSD-3-Clause
// Analytic derivatives against differences, through the manifold that the optimiser moves along.
#include "slamdb/optimize/detail/costs.h"

#include <gmock/gmock.h>

#include "slamdb/model/detail/rotations.h"
#include "slamdb/optimize/detail/inertial_links.h"
#include "tests/optimize/shaken.h"

namespace slamdb::detail {
namespace {

using testing::MakeTruth;
using testing::OptimizeWorld;
using testing::Shaker;

constexpr double kStep = 1e-6;

std::vector<double> ErrorsOf(const ceres::CostFunction& cost, const std::vector<std::vector<double>>& blocks) {
  std::vector<const double*> pointers;
  for (const auto& block : blocks) pointers.push_back(block.data());
  std::vector<double> errors(static_cast<std::size_t>(cost.num_residuals()));
  EXPECT_TRUE(cost.Evaluate(pointers.data(), errors.data(), nullptr));
  return errors;
}

std::vector<double> Stepped(std::vector<double> block, std::size_t direction, double step) {
  if (block.size() != 7) {
    block[direction] += step;
    return block;
  }
  std::vector<double> delta(6, 0), moved(7);
  delta[direction] = step;
  EXPECT_TRUE(PoseManifold().Plus(block.data(), delta.data(), moved.data()));
  return moved;
}

// The largest difference, over what the largest derivative of the row is.
double LargestDifference(const ceres::CostFunction& cost, const std::vector<std::vector<double>>& blocks) {
  const auto rows = static_cast<std::size_t>(cost.num_residuals());
  std::vector<std::vector<double>> jacobians;
  std::vector<double*> places;
  std::vector<const double*> pointers;
  for (const auto& block : blocks) jacobians.emplace_back(rows * block.size());
  for (auto& jacobian : jacobians) places.push_back(jacobian.data());
  for (const auto& block : blocks) pointers.push_back(block.data());
  std::vector<double> errors(rows);
  EXPECT_TRUE(cost.Evaluate(pointers.data(), errors.data(), places.data()));
  double largest = 0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const std::size_t columns = blocks[b].size(), free = columns == 7 ? 6 : columns;
    for (std::size_t direction = 0; direction < free; ++direction) {
      auto ahead = blocks, behind = blocks;
      ahead[b] = Stepped(blocks[b], direction, kStep);
      behind[b] = Stepped(blocks[b], direction, -kStep);
      const std::vector<double> more = ErrorsOf(cost, ahead), less = ErrorsOf(cost, behind);
      for (std::size_t row = 0; row < rows; ++row) {
        const double difference = (more[row] - less[row]) / (2 * kStep);
        const double analytic = jacobians[b][row * columns + direction];
        largest = std::max(largest, std::abs(difference - analytic) / std::max(1.0, std::abs(analytic)));
      }
    }
  }
  return largest;
}

std::vector<double> Numbers(const PoseState& pose) { return {pose.values.begin(), pose.values.end()}; }
template <class Vector>
std::vector<double> Numbers(const Vector& vector) {
  return {vector.data(), vector.data() + vector.size()};
}

class ReprojectionCosts : public ::testing::TestWithParam<OptimizeWorld> {};

TEST_P(ReprojectionCosts, HaveTheDerivativesThatDifferencesHave) {
  Atlas atlas = MakeTruth(GetParam());
  Shaker shaker;
  shaker.ShakePoses(atlas.maps[0], 0.02F, 0.05F);
  shaker.ShakePoints(atlas.maps[0], 0.05F);
  const AtlasIndex index(atlas);
  const Measurements measurements(index, 0);
  const MapStates states(atlas.maps[0]);
  ASSERT_GT(measurements.all().size(), 100U);
  bool right = false, depth = false;
  for (std::size_t i = 0; i < measurements.all().size(); i += 7) {
    const Measurement& measurement = measurements.all()[i];
    const std::vector<std::vector<double>> blocks = {Numbers(states.poses[measurement.keyframe]),
                                                     Numbers(states.points[measurement.point])};
    right |= measurement.eye->right;
    depth |= measurement.has_depth();
    if (measurement.has_depth())
      EXPECT_LT(LargestDifference(ReprojectionCost<3>(measurement), blocks), 1e-4);
    else
      EXPECT_LT(LargestDifference(ReprojectionCost<2>(measurement), blocks), 1e-4);
  }
  EXPECT_EQ(right, GetParam().sensor == Sensor::kFisheyeStereo);
  EXPECT_EQ(depth, GetParam().sensor == Sensor::kStereo || GetParam().sensor == Sensor::kRgbd);
}

INSTANTIATE_TEST_SUITE_P(Sensors, ReprojectionCosts,
                         ::testing::Values(testing::kOptimizeWorlds[0], testing::kOptimizeWorlds[2],
                                           testing::kOptimizeWorlds[4], testing::kOptimizeWorlds[5]),
                         [](const auto& each) { return std::string(each.param.name); });

// A pinhole camera at the origin: fx 100, cx 50; a point 2 ahead and 0.1 to the right is at column 55. With a baseline
// of 0.2 (20 pixels times lengths) the right camera has it 10 columns to the left.
TEST(ReprojectionCost, IsTheErrorInStandardDeviations) {
  const Eye eye{.lens = {.fx = 100, .fy = 100, .cx = 50, .cy = 40}, .baseline_fx = 20};
  Measurement measurement{.eye = &eye, .pixel = {54, 42}, .right_x = 44, .inverse_sigma = 0.5};
  const std::vector<std::vector<double>> blocks = {Numbers(PoseState()), {0.1, 0.05, 2}};
  EXPECT_THAT(ErrorsOf(ReprojectionCost<3>(measurement), blocks),
              ::testing::ElementsAre(::testing::DoubleNear(0.5, 1e-12), ::testing::DoubleNear(0.25, 1e-12),
                                     ::testing::DoubleNear(0.5, 1e-12)));
}

TEST(ReprojectionCost, IsLargeAndFlatBehindTheCamera) {
  const Eye eye{.lens = {.fx = 100, .fy = 100, .cx = 50, .cy = 40}};
  const Measurement measurement{.eye = &eye, .pixel = {54, 42}, .right_x = -1};
  const std::vector<std::vector<double>> blocks = {Numbers(PoseState()), {0.1, 0.05, -2}};
  EXPECT_THAT(ErrorsOf(ReprojectionCost<2>(measurement), blocks), ::testing::Each(::testing::Ge(100)));
  EXPECT_EQ(LargestDifference(ReprojectionCost<2>(measurement), blocks), 0);
}

class InertialCosts : public ::testing::Test {
 protected:
  const Atlas atlas_ = MakeTruth({"", Sensor::kStereo, true});
  std::uint64_t unusable_ = 0;
  const std::vector<InertialLink> links_ = FindInertialLinks(atlas_.maps[0], unusable_);
  const MapStates states_{atlas_.maps[0]};

  std::vector<std::vector<double>> BlocksOf(const InertialLink& link) const {
    return {Numbers(states_.poses[link.first]), Numbers(states_.velocities[link.first]),
            Numbers(states_.biases[link.first]), Numbers(states_.poses[link.second]),
            Numbers(states_.velocities[link.second])};
  }
};

TEST_F(InertialCosts, AreNothingAtTheTruth) {
  ASSERT_EQ(links_.size(), atlas_.maps[0].keyframes.size() - 1);
  EXPECT_EQ(unusable_, 0U);
  for (const InertialLink& link : links_)
    for (const double error : ErrorsOf(InertialCost(link), BlocksOf(link))) EXPECT_NEAR(error, 0, 0.2);
}

TEST_F(InertialCosts, HaveTheDerivativesThatDifferencesHave) {
  const std::vector<double> off = {0.02, -0.03, 0.01, 0.05, -0.02, 0.04};
  for (const InertialLink& link : links_) {
    auto blocks = BlocksOf(link);
    for (std::size_t i = 0; i < 3; ++i) blocks[1][i] += off[i];
    for (std::size_t i = 0; i < 6; ++i) blocks[2][i] += off[i] / 10;
    for (std::size_t i = 0; i < 6; ++i) blocks[3] = Stepped(blocks[3], i, off[i]);
    EXPECT_LT(LargestDifference(InertialCost(link), blocks), 1e-4);
    EXPECT_LT(LargestDifference(BiasWalkCost(link), {blocks[2], Numbers(states_.biases[link.second])}), 1e-4);
  }
}

TEST(Rotations, ComeBackFromTheirAxisAndAngle) {
  for (const Eigen::Vector3d& turn : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1e-9, 0, 0),
                                      Eigen::Vector3d(0.3, -1, 2), Eigen::Vector3d(-2, 1, 2)}) {
    EXPECT_NEAR((AxisAngleOf(Turn(turn)) - turn).norm(), 0, 1e-12);
    const Eigen::Quaterniond other(-Turn(turn).coeffs());
    EXPECT_NEAR((AxisAngleOf(other) - turn).norm(), 0, 1e-12);
    EXPECT_TRUE((RightJacobian(turn) * InverseRightJacobian(turn)).isIdentity(1e-9));
  }
}

TEST(PoseManifold, GoesBackToWhereItCameFrom) {
  PoseState pose;
  pose.rotation() = Turn(Eigen::Vector3d(0.1, 0.2, -0.3));
  pose.translation() = Eigen::Vector3d(1, 2, 3);
  const std::vector<double> delta = {0.3, -0.2, 0.1, 1, -1, 2};
  std::vector<double> moved(7), back(6);
  PoseManifold manifold;
  ASSERT_TRUE(manifold.Plus(pose.values.data(), delta.data(), moved.data()));
  ASSERT_TRUE(manifold.Minus(moved.data(), pose.values.data(), back.data()));
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(back[i], delta[i], 1e-12);
}

}  // namespace
}  // namespace slamdb::detail
