// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/optimize/detail/solve.h"

#include <gmock/gmock.h>

#include <deque>

#include "slamdb/optimize/detail/costs.h"
#include "tests/optimize/shaken.h"

namespace slamdb::detail {
namespace {

struct Solved {
  Solution solution;
  double cost = 0;
};

// A shaken map, as if `cameras` poses of it were free.
Solved SolveAsIfOf(std::size_t cameras, bool eliminates = true) {
  Atlas atlas = testing::MakeTruth({"", Sensor::kMonocular, false});
  testing::Shaker().ShakePoses(atlas.maps[0], 0.005F, 0.01F);
  const AtlasIndex index(atlas);
  const Measurements measurements(index, 0);
  MapStates states(atlas.maps[0]);
  std::deque<ReprojectionCost<2>> costs;
  PoseManifold manifold;
  ceres::Problem problem(BorrowingProblem());
  for (const Measurement& measurement : measurements.all())
    problem.AddResidualBlock(&costs.emplace_back(measurement), nullptr,
                             states.poses[measurement.keyframe].values.data(), states.points[measurement.point].data());
  std::vector<double*> points;
  for (auto& pose : states.poses) problem.SetManifold(pose.values.data(), &manifold);
  problem.SetParameterBlockConstant(states.poses[0].values.data());
  for (auto& point : states.points)
    if (eliminates && problem.HasParameterBlock(point.data())) points.push_back(point.data());
  Solved solved{Solve(problem, cameras, points, {100, 1e-9, "", {}})};
  problem.Evaluate({}, &solved.cost, nullptr, nullptr, nullptr);
  return solved;
}

TEST(Solve, TakesTheSolverThatTheSizeAsksFor) {
  for (const auto& [cameras, name] :
       {std::pair(12U, "dense-schur"), std::pair(500U, "sparse-schur"), std::pair(20000U, "iterative-schur")}) {
    const Solved solved = SolveAsIfOf(cameras);
    EXPECT_EQ(solved.solution.solver, name);
    EXPECT_TRUE(solved.solution.converged) << name;
    EXPECT_NEAR(solved.cost, 0, 1e-3) << name;
  }
  const Solved whole = SolveAsIfOf(12, false);
  EXPECT_EQ(whole.solution.solver, "sparse-cholesky");
  EXPECT_NEAR(whole.cost, 0, 1e-3);
}

}  // namespace
}  // namespace slamdb::detail
