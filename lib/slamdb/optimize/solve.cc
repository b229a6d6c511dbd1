// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/optimize/detail/solve.h"

#include <ceres/iteration_callback.h>
#include <glog/logging.h>

#include <exception>
#include <memory>
#include <mutex>

namespace slamdb::detail {
namespace {

// Poses up to which the reduced system is solved as a dense one, and up to which it is factored at all.
constexpr std::size_t kMostDense = 80, kMostFactored = 3000;

// Tells the listener, and ends the work where it throws: what it threw goes on behind the solver.
class Teller final : public ceres::IterationCallback {
 public:
  explicit Teller(const SolveSteps& steps) : steps_(steps) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    try {
      if (steps_.progress) steps_.progress(steps_.stage, static_cast<double>(summary.iteration) / steps_.most);
      return ceres::SOLVER_CONTINUE;
    } catch (...) {
      thrown_ = std::current_exception();
      return ceres::SOLVER_ABORT;
    }
  }

  void Rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  const SolveSteps& steps_;
  std::exception_ptr thrown_;
};

// Ceres warns on standard error of steps that it then makes smaller: a library has no business there. What it goes by
// is one number for all threads, so that the first who solves sets it and the last one sets it back.
class Silence {
 public:
  Silence() {
    const std::scoped_lock lock(mutex_);
    if (solving_++ > 0) return;
    level_ = FLAGS_minloglevel;
    FLAGS_minloglevel = google::GLOG_FATAL;
  }
  ~Silence() {
    const std::scoped_lock lock(mutex_);
    if (--solving_ == 0) FLAGS_minloglevel = level_;
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  static inline std::mutex mutex_;
  static inline int solving_ = 0, level_ = 0;
};

ceres::LinearSolverType SolverFor(std::size_t cameras, bool eliminates) {
  if (!eliminates || cameras == 0) return ceres::SPARSE_NORMAL_CHOLESKY;
  if (cameras <= kMostDense) return ceres::DENSE_SCHUR;
  return cameras <= kMostFactored ? ceres::SPARSE_SCHUR : ceres::ITERATIVE_SCHUR;
}

std::string NameOf(ceres::LinearSolverType type) {
  switch (type) {
    case ceres::DENSE_SCHUR:
      return "dense-schur";
    case ceres::SPARSE_SCHUR:
      return "sparse-schur";
    case ceres::ITERATIVE_SCHUR:
      return "iterative-schur";
    default:
      return "sparse-cholesky";
  }
}

}  // namespace

ceres::Problem::Options BorrowingProblem() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

Solution Solve(ceres::Problem& problem, std::size_t cameras, std::vector<double*> points, const SolveSteps& steps) {
  ceres::Solver::Options options;
  options.linear_solver_type = SolverFor(cameras, !points.empty());
  options.preconditioner_type = ceres::SCHUR_JACOBI;
  if (!ceres::IsSparseLinearAlgebraLibraryTypeAvailable(ceres::SUITE_SPARSE))
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  if (options.linear_solver_type != ceres::SPARSE_NORMAL_CHOLESKY) {
    options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (double* point : points) options.linear_solver_ordering->AddElementToGroup(point, 0);
    std::vector<double*> blocks;
    problem.GetParameterBlocks(&blocks);
    for (double* block : blocks)
      if (!options.linear_solver_ordering->IsMember(block)) options.linear_solver_ordering->AddElementToGroup(block, 1);
  }
  options.max_num_iterations = steps.most;
  options.function_tolerance = steps.tolerance;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  Teller teller(steps);
  options.callbacks.push_back(&teller);
  ceres::Solver::Summary summary;
  const Silence silence;
  ceres::Solve(options, &problem, &summary);
  teller.Rethrow();
  return {static_cast<int>(summary.num_successful_steps + summary.num_unsuccessful_steps),
          summary.termination_type == ceres::CONVERGENCE, NameOf(summary.linear_solver_type_used)};
}

}  // namespace slamdb::detail
