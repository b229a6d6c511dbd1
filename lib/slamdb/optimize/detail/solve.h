// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <string>
#include <string_view>

#include "slamdb/base/progress.h"

namespace slamdb::detail {

struct Solution {
  int iterations = 0;
  bool converged = false;
  std::string solver;  // of the linear systems: `dense-schur`
};

// How to minimise.
struct SolveSteps {
  int most;                  // iterations
  double tolerance;          // it has settled when a step gains less than this share of the cost
  std::string_view stage;    // for the listener
  const Progress& progress;  // may be empty
};

// Minimises. `cameras`: how many poses are free; it decides how the linear systems are solved.
// `points`: the blocks to be eliminated first; without any, the system is factored as a whole.
// On one thread, because Ceres adds up in the order in which its threads come.
//
// Throws what the listener throws; the blocks then hold the last step.
Solution Solve(ceres::Problem& problem, std::size_t cameras, std::vector<double*> points, const SolveSteps& steps);

// Problems that own neither costs nor losses nor manifolds.
ceres::Problem::Options BorrowingProblem();

}  // namespace slamdb::detail
