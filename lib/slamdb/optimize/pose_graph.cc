// SPDX-License-Identifier: BSD-3-Clause
// A node is world_from_camera with a scale of its own: quaternion x y z w, centre, log of the scale.
#include "slamdb/optimize/pose_graph.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/manifold.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/model/detail/map_extent.h"
#include "slamdb/model/detail/rotations.h"
#include "slamdb/model/index.h"
#include "slamdb/optimize/detail/essential_graph.h"
#include "slamdb/optimize/detail/find_map.h"
#include "slamdb/optimize/detail/inertial_links.h"
#include "slamdb/optimize/detail/solve.h"

namespace slamdb {
namespace {

constexpr double kTolerance = 1e-10;  // steps cost next to nothing

using Node = std::array<double, 8>;

// A node turns in the world about its centre, and shifts.
class NodeManifold final : public ceres::Manifold {
 public:
  explicit NodeManifold(PoseFreedom freedom) : turns_(freedom == PoseFreedom::kUpright ? 1 : 3) {
    scales_ = freedom == PoseFreedom::kSimilarity ? 1 : 0;
  }
  int AmbientSize() const override { return 8; }
  int TangentSize() const override { return turns_ + 3 + scales_; }

  bool Plus(const double* x, const double* delta, double* sum) const override {
    const Eigen::Vector3d turn =
        turns_ == 1 ? Eigen::Vector3d(0, 0, delta[0]) : Eigen::Vector3d(delta[0], delta[1], delta[2]);
    Eigen::Map<Eigen::Quaterniond>{sum} = (detail::Turn(turn) * Eigen::Map<const Eigen::Quaterniond>(x)).normalized();
    for (int i = 0; i < 3; ++i) sum[4 + i] = x[4 + i] + delta[turns_ + i];
    sum[7] = x[7] + (scales_ == 1 ? delta[turns_ + 3] : 0);
    return true;
  }
  bool PlusJacobian(const double* x, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 8, Eigen::Dynamic, Eigen::RowMajor>> result(jacobian, 8, TangentSize());
    result.setZero();
    // Half the product of an axis and the quaternion.
    const double qx = x[0] / 2, qy = x[1] / 2, qz = x[2] / 2, qw = x[3] / 2;
    Eigen::Matrix<double, 4, 3> by_turn;
    by_turn << qw, qz, -qy, -qz, qw, qx, qy, -qx, qw, -qx, -qy, -qz;
    result.topLeftCorner(4, turns_) = by_turn.rightCols(turns_);
    result.block(4, turns_, 3, 3).setIdentity();
    if (scales_ == 1) result(7, turns_ + 3) = 1;
    return true;
  }
  // Ceres asks for these in no minimisation.
  bool Minus(const double*, const double*, double*) const override { return false; }
  bool MinusJacobian(const double*, double*) const override { return false; }

 private:
  int turns_, scales_;
};

// How an edge between two nodes is off: turn, shift in units of the first, log of the scale.
struct EdgeError {
  const detail::PoseEdge* edge;

  template <class T>
  bool operator()(const T* first, const T* second, T* residuals) const {
    const Eigen::Map<const Eigen::Quaternion<T>> a(first), b(second);
    const Eigen::Map<const Eigen::Matrix<T, 3, 1>> a_center(first + 4), b_center(second + 4);
    const Similarity3d& measured = edge->first_from_second;
    const Eigen::Quaternion<T> turn = measured.rotation.cast<T>().conjugate() * (a.conjugate() * b);
    const Eigen::Matrix<T, 3, 1> shift = (a.conjugate() * (b_center - a_center)) * exp(-first[7]);
    Eigen::Matrix<T, 7, 1> errors;
    errors.template head<3>() = (turn.w() < T(0) ? T(-2) : T(2)) * turn.vec();
    errors.template segment<3>(3) = shift - measured.translation.cast<T>();
    errors[6] = second[7] - first[7] - T(std::log(measured.scale));
    Eigen::Map<Eigen::Matrix<T, 7, 1>> result(residuals);
    result = edge->root_information.cast<T>() * errors;
    return true;
  }
};
using EdgeCost = ceres::AutoDiffCostFunction<EdgeError, 7, 8, 8>;

PoseFreedom FreedomOf(const Map& map) {
  if (detail::KnowsGravity(map)) return PoseFreedom::kUpright;
  // The scale of a part that a lone camera saw is only as good as how it was joined.
  const bool knows_scale = map.imu_initialized || std::ranges::all_of(map.keyframes, detail::MeasuresDepth);
  return knows_scale ? PoseFreedom::kRigid : PoseFreedom::kSimilarity;
}

class Graph {
 public:
  Graph(const Map& map, const detail::MapStates& states, const PoseGraphOptions& options, PoseGraphReport& report)
      : manifold_(report.freedom) {
    edges_ = detail::EssentialGraph(map, states, options, detail::MedianDepth(map, states), report);
    for (const detail::PoseState& pose : states.poses) {
      const Similarity3d world = pose.WorldFromCamera();
      Node& node = nodes_.emplace_back();
      Eigen::Map<Eigen::Quaterniond>{node.data()} = world.rotation;
      Eigen::Map<Eigen::Vector3d>{node.data() + 4} = world.translation;
    }
    moved_.assign(nodes_.size(), 0);
    for (const detail::PoseEdge& edge : edges_) moved_[edge.first] = moved_[edge.second] = 1;
    for (std::uint32_t row = 0; row < moved_.size(); ++row) {
      report.keyframes += moved_[row];
      if (moved_[row] && (anchor_ == kNoRow || map.keyframes[row].id == map.initial_keyframe)) anchor_ = row;
    }
  }

  bool IsFixed(std::uint32_t row) const { return row == anchor_; }
  bool Takes(std::uint32_t row) const { return moved_[row] != 0; }

  void Solve(const PoseGraphOptions& options, PoseGraphReport& report) {
    if (anchor_ == kNoRow || options.constraints.empty()) return;
    ceres::Problem problem(detail::BorrowingProblem());
    std::vector<std::unique_ptr<EdgeCost>> costs;
    for (const detail::PoseEdge& edge : edges_) {
      costs.push_back(std::make_unique<EdgeCost>(new EdgeError{&edge}));
      problem.AddResidualBlock(costs.back().get(), nullptr, nodes_[edge.first].data(), nodes_[edge.second].data());
    }
    for (std::uint32_t row = 0; row < nodes_.size(); ++row)
      if (moved_[row]) problem.SetManifold(nodes_[row].data(), &manifold_);
    problem.SetParameterBlockConstant(nodes_[anchor_].data());
    problem.Evaluate({}, &report.cost_before, nullptr, nullptr, nullptr);
    const detail::Solution solution = detail::Solve(
        problem, nodes_.size(), {}, {options.iterations, kTolerance, "bending the map", options.progress});
    problem.Evaluate({}, &report.cost_after, nullptr, nullptr, nullptr);
    report.iterations = solution.iterations;
    report.converged = solution.converged;
  }

  PoseGraphReport::Gap Gap(std::size_t constraints) const {
    PoseGraphReport::Gap gap;
    for (std::size_t i = 0; i < constraints; ++i) {
      const detail::PoseEdge& edge = edges_[i];
      const Similarity3d is = WorldFromNode(edge.first).Inverse() * WorldFromNode(edge.second);
      const Eigen::Quaterniond off = edge.first_from_second.rotation.conjugate() * is.rotation;
      gap.degrees += std::pow(detail::AxisAngleOf(off).norm() * 180 / std::numbers::pi, 2);
      gap.translation += (is.translation - edge.first_from_second.translation).squaredNorm();
      gap.scale += std::pow(std::log(is.scale / edge.first_from_second.scale), 2);
    }
    const auto count = static_cast<double>(std::max<std::size_t>(constraints, 1));
    for (double* value : {&gap.degrees, &gap.translation, &gap.scale}) *value = std::sqrt(*value / count);
    return gap;
  }

  Similarity3d WorldFromNode(std::uint32_t row) const {
    const Node& node = nodes_[row];
    return {std::exp(node[7]), Eigen::Quaterniond(node.data()), Eigen::Vector3d(node[4], node[5], node[6])};
  }

 private:
  NodeManifold manifold_;
  std::vector<detail::PoseEdge> edges_;
  std::vector<Node> nodes_;
  std::vector<std::uint8_t> moved_;
  std::uint32_t anchor_ = kNoRow;
};

// Moves cameras to their nodes; what a node sees, points above all, scales about it.
void Follow(const Map& map, const Graph& graph, const detail::MapStates& before, detail::MapStates& after,
            PoseGraphReport& report) {
  std::vector<Similarity3d> motions(map.keyframes.size());
  detail::Moved settled{std::vector<std::uint8_t>(map.keyframes.size(), 0),
                        std::vector<std::uint8_t>(map.points.size(), 0)};
  for (std::uint32_t row = 0; row < map.keyframes.size(); ++row) {
    if (!graph.Takes(row)) continue;
    settled.keyframes[row] = 1;
    if (graph.IsFixed(row)) continue;
    const Similarity3d node = graph.WorldFromNode(row);
    motions[row] = node * before.poses[row].WorldFromCamera().Inverse();
    after.poses[row].SetWorldFromCamera(node.rotation, node.translation);
    report.largest_shift = std::max(report.largest_shift, (node.translation - before.poses[row].Center()).norm());
  }
  detail::CarryAlong(map, settled, motions, after);
}

// Keyframes are not farther apart than the camera went; ten times that is another unit.
void RequireSize(const Map& map, const std::vector<PoseConstraint>& constraints) {
  const double path = detail::TrajectoryOf(map).length;
  for (const PoseConstraint& constraint : constraints)
    if (const double apart = constraint.first_from_second.translation.norm(); path > 0 && apart > 10 * path)
      throw Error(ErrorKind::kNotPossible,
                  detail::Concat("the constraint between ", constraint.first, " and ", constraint.second,
                                 " says that they are ", detail::Digits(apart, 3), " apart, and the camera went ",
                                 detail::Digits(path, 3), " in all: is it of other units?"));
}

// Constraints that contradict the map by far, or each other, tear it apart.
void RequireBetter(const PoseGraphReport& report) {
  constexpr double kMostDegrees = 5, kMostLogScale = 0.2;  // that a part of the gap may grow by while others close
  const PoseGraphReport::Gap &before = report.gap_before, &after = report.gap_after;
  const bool better = std::isfinite(report.largest_shift) && report.cost_after <= report.cost_before &&
                      after.translation <= before.translation && after.degrees <= before.degrees + kMostDegrees &&
                      after.scale <= before.scale + kMostLogScale;
  if (!better)
    throw Error(ErrorKind::kNotPossible,
                "the map cannot be bent to the constraints: they contradict it, or each other, or are of other units");
}

}  // namespace

PoseGraphReport OptimizePoseGraph(Atlas& atlas, MapId id, const PoseGraphOptions& options) {
  Map& map = atlas.maps[detail::FindMap(atlas, id)];
  const detail::MapStates before(map);
  PoseGraphReport report{.freedom = FreedomOf(map)};
  RequireSize(map, options.constraints);
  Graph graph(map, before, options, report);
  report.gap_before = graph.Gap(report.constraints);
  graph.Solve(options, report);
  report.gap_after = graph.Gap(report.constraints);
  if (report.constraints == 0) return report;
  RequireBetter(report);
  detail::MapStates after = before;
  Follow(map, graph, before, after, report);
  detail::Record(before, after, options.threads, map);
  return report;
}

}  // namespace slamdb
